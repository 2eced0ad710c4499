"""Contact of rough maps on a half-space, areal parameters of heights, and universal files."""

import tempfile
from functools import partial
from pathlib import Path

import numpy as np

import faying
from faying.measured.modes import ModeSet
from faying.surface.form import prepared
from faying.surface.scan import Scan
from peers.peer import ask
from peers.rows import Problem, Row, worst
from tests.helpers.self_affine import self_affine

ROOT = Path(__file__).parents[2]
CURVE = ("Sk", "Spk", "Svk", "Smr1", "Smr2", "Sxp", "Vmp", "Vmc", "Vvc", "Vvv", "Sal", "Str")
SOLVERS = {"Tamaas": "tamaas", "ContactMechanics": "contactmechanics"}


def traction(python, code, h, pressure, hardness=None, tol=1e-6):
    """Pressure over E* (n, n) of another code on a unit square."""
    return ask(python, "half_space.py", SOLVERS[code], heights=h, pressure=pressure, hardness=hardness or 0.0, tol=tol)[
        "traction"
    ]


def pressed(code, n, pressure, hardness, python):
    h = self_affine(n)
    ours = faying.solve_half_space(h, 1 / n, E_star=1.0, pressure=pressure, hardness=hardness)
    theirs = traction(python, code, h, pressure, hardness)
    bound = 1e-2 if hardness else 1e-3
    rows = [
        Row(quantity="area in contact", ours=ours.area, theirs=np.count_nonzero(theirs > 0) / n**2, bound=bound),
    ]
    if hardness:
        hard = np.count_nonzero(theirs > hardness * (1 - 1e-6)) / n**2
        return [*rows, Row(quantity="area at hardness", ours=ours.saturated, theirs=hard, bound=bound)]
    rms = [float(np.sqrt((p**2).mean())) for p in (ours.traction, theirs)]
    return [*rows, Row(quantity="rms pressure over E*", ours=rms[0], theirs=rms[1], bound=bound)]


def small_map(code, python):
    side, modulus = 32 * 10e-6, 100e9
    h = np.loadtxt(ROOT / "reference-problems/8-rough-contact/map.csv", delimiter=",") * 1e-6
    rows = []
    for mega in (20, 100):
        ours = faying.solve_half_space(h, 10e-6, E_star=modulus, pressure=mega * 1e6, tol=1e-12)
        theirs = traction(python, code, h / side, mega * 1e6 / modulus, tol=1e-12) * modulus
        for name, unit, a, b in (
            ("area in contact", "", ours.area, np.count_nonzero(theirs > 0) / theirs.size),
            ("greatest pressure", "MPa", ours.traction.max() * 1e-6, theirs.max() * 1e-6),
        ):
            rows.append(Row(quantity=f"{name} at {mega} MPa", ours=a, theirs=b, unit=unit, bound=1e-6))
    return rows


def heights(code, python):
    n = 256
    z = prepared(Scan(heights=self_affine(n) * n * 1e-6, spacing=(1e-6, 1e-6))).scan.heights
    slope = 20e-6 * np.arange(n) / n
    one, sloped = (Scan(heights=h, spacing=(1e-6, 1e-6)).roughness() for h in (z, z + slope + slope[:, None]))
    theirs = ask(python, "heights.py", code, heights=z * 1e6, sloped=(z + slope + slope[:, None]) * 1e6, spacing=1.0)
    lengths = {"Sq": one.Sq, "Sa": one.Sa, "Sz": one.Sz, "Sq of the slope": sloped.Sq}
    ours = {name: value * 1e6 for name, value in lengths.items()}
    ours |= {"Ssk": one.Ssk, "Sku": one.Sku, "Sdq": one.Sdq, "Sdr": one.Sdr}
    areal = vars(Scan(heights=z, spacing=(1e-6, 1e-6)).areal())
    ours |= {name: value * (1 if name in ("Smr1", "Smr2", "Str") else 1e6) for name, value in areal.items()}
    return [
        Row(
            quantity=name,
            ours=ours[name],
            theirs=float(value),
            unit="" if name in ("Ssk", "Sku", "Sdq", "Sdr", "Smr1", "Smr2", "Str") else "um",
            bound=1 / n if (code, name) == ("surfacetopography", "Sdq") else 2e-3 if name in CURVE else 1e-9,
        )
        for name, value in theirs.items()
    ]


def read_file(python):
    path = ROOT / "examples/hammer-test/blocks.uff"
    ours, theirs = faying.read_uff(path).frf(), ask(python, "universal_file.py", source=str(path))
    return [
        Row(
            quantity="sum of the FRFs",
            ours=float(np.abs(ours.rows()).sum()),
            theirs=float(theirs["magnitude"]),
            bound=1e-12,
            unit="m/s2/N",
        ),
        Row(quantity="last line", ours=ours.frequency[-1], theirs=float(theirs["last"]), bound=1e-12, unit="Hz"),
    ]


def written_file(python):
    frf = faying.read_uff(ROOT / "examples/hammer-test/blocks.uff").frf()
    rng = np.random.default_rng(1)
    modes = ModeSet(
        frequencies=np.sort(rng.uniform(100, 3000, 4)),
        loss_factors=rng.uniform(1e-3, 1e-1, 4),
        shapes=rng.normal(size=(4, len(frf.outputs))).astype(complex),
        dofs=frf.outputs,
        positions=frf.positions,
    )
    with tempfile.TemporaryDirectory() as folder:
        path = faying.write_uff(Path(folder) / "out.uff", modes, frf)
        theirs = ask(python, "universal_file.py", source=str(path))
    total = float(np.abs(frf.rows()).sum())
    return [
        Row(quantity="sum of the FRFs", ours=total, theirs=float(theirs["magnitude"]), bound=1e-11, unit="m/s2/N"),
        worst("frequency of mode", modes.frequencies, theirs["frequency"], bound=5e-6, unit="Hz"),
        worst("damping ratio of mode", modes.loss_factors / 2, theirs["damping"], bound=5e-6, unit=""),
    ]


ELASTIC = (
    "Both end at a residual of 1e-6 or less, so that points whose gap or pressure is that small may count otherwise: "
    "a thousandth, as in tests/halfspace/test_witness.py."
)
HARD = "As in tests/halfspace/test_witness.py: one in a hundred of the points, as the peers converge slowly here."
SMALL = "The same discrete problem, with one answer: reference-problems/8-rough-contact gives 1e-6."
PROBLEMS = [
    *(
        Problem(
            name="reference problem 8, rough contact", peer=code, seconds=2, bound=SMALL, solve=partial(small_map, code)
        )
        for code in SOLVERS
    ),
    *(
        Problem(
            name=f"half-space {n}, p/E* {pressure:g}" + (f", H/E* {hardness:g}" if hardness else ""),
            peer=code,
            seconds=seconds,
            bound=HARD if hardness else ELASTIC,
            solve=partial(pressed, code, n, pressure, hardness),
        )
        for n, pressure, hardness, seconds in (
            (512, 0.002, None, 3),
            (512, 0.01, None, 6),
            (1024, 0.002, None, 21),
            (512, 0.002, 0.005, 36),
        )
        for code in SOLVERS
    ),
    *(
        Problem(
            name="areal parameters",
            peer=peer,
            seconds=3,
            bound="The same definitions in double precision: 1e-9." + more,
            solve=partial(heights, peer.lower()),
        )
        for peer, more in (
            ("SurfaceTopography", " Its gradient halves the weight of the edges, of 2 rows in 256: 1/256 for Sdq."),
            ("surfalize", " Its bearing curve has 10,000 heights, its autocorrelation no point between: 2e-3."),
        )
    ),
    Problem(
        name="universal file, read",
        peer="pyuff",
        seconds=2,
        bound="The same digits of one text: rounding of a sum. Faying reads by this package: units, directions and "
        "order of the functions are compared.",
        solve=read_file,
    ),
    Problem(
        name="universal file, written",
        peer="pyuff",
        seconds=2,
        bound="Data set 58 has 12 digits, data set 55 has 6: half of the last, for a leading digit of 1.",
        solve=written_file,
    ),
]
