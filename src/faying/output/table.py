"""The tables of a result as plain text, for terminals, and as rows, for the report."""

from collections.abc import Iterable, Mapping
from itertools import product
from math import floor, isnan, log10
from typing import Any

import numpy as np

from faying.measured.ring_down import MeasuredBackbone
from faying.output.terminal import text as text
from faying.result import Result
from faying.result.backbone import Backbone
from faying.result.difference import of_joint
from faying.result.groups import Levels
from faying.result.run_record import preload_slope
from faying.text import in_columns, or_dash
from faying.typing import Array
from faying.units import show

Rows = list[list[str]]
FRACTAL = ["D", "95 % interval", "G", "95 % interval", "band", "implied Rq"]  # heads of `fractal`
SHOWN = 2  # modes in the table of laws
MAX_MEASURED = 12  # measured points in the table of a backbone
MIN_CHANGE = 5e-4  # per cent that three digits show
SAME = 1e-4  # relative difference of two frequencies that is not shown


def by_mode(heads: Iterable[str], cells: Iterable[Iterable[str]]) -> Rows:
    """One row per mode, counted from 1."""
    return [["mode", *heads], *([str(number), *row] for number, row in enumerate(cells, start=1))]


def by_load(result: Result, heads: Iterable[str], cells: Iterable[Iterable[str]]) -> Rows:
    """One row per preload."""
    return [["preload", *heads], *([load, *row] for load, row in zip(result.load_names, cells, strict=True))]


def modes(result: Result) -> Rows:
    """One row per mode: free, then each preload with its loss factor where one is predicted, then bonded."""
    lost = bool(np.isfinite(result.loss_factors).any())
    heads = [f"{load} [Hz]{' (loss)' * lost}" for load in result.load_names]
    pairs = zip(result.frequencies.T, result.loss_factors.T, strict=True)
    cells = [[f"{f:.2f} ({eta:.1e})" if lost else f"{f:.2f}" for f, eta in zip(*pair, strict=True)] for pair in pairs]
    if result.free is not None and result.bonded is not None:
        heads = ["free [Hz]", *heads, "bonded [Hz]"]
        bounds = zip(result.free, result.bonded, strict=True)
        cells = [[f"{a:.2f}", *row, f"{b:.2f}"] for row, (a, b) in zip(cells, bounds, strict=True)]
    return by_mode(heads, cells)


def ranges(result: Result) -> Rows:
    """One row per mode: the frequencies at both ends of the range of stiffness, to the digits that they are found to.

    Empty where no law states a range.
    """
    if result.low is None or result.high is None:
        return []
    heads = [f"{load} [Hz]" for load in result.load_names]
    ends = zip(result.low.T, result.high.T, strict=True)
    return by_mode(heads, ([f"{_five(a)} .. {_five(b)}" for a, b in zip(*pair, strict=True)] for pair in ends))


def damping(result: Result) -> Rows:
    """One row per mode: damping at each level at the last preload, with both ends; empty where there is none."""
    found = result.levels
    if found is None:
        return []
    heads = [*(f"{level:g} m/s2 [%]" for level in found.accelerations), "change of f [%]"]
    change = 100 * (found.frequencies[-1, -1] / result.frequencies[-1] - 1)
    words = ["-" if isnan(one) else f"{one:+.3f}" if abs(one) >= MIN_CHANGE else "0" for one in change]
    levels = range(len(found.accelerations))
    return by_mode(heads, ([*(damping_at(found, k, j) for k in levels), word] for j, word in enumerate(words)))


def damping_at(found: Levels, level: int, mode: int) -> str:
    """Low, median and high damping ratio [%] of a mode at one level, at the last preload."""
    return " .. ".join(f"{100 * one[-1, level, mode]:.2g}" for one in (found.low, found.damping, found.high)).replace(
        "nan", "-"
    )


def _five(value: float) -> str:
    """A number to five digits, not in powers of ten."""
    return f"{value:.{max(0, 4 - floor(log10(value)))}f}" if value > 0 else f"{value:.2f}"


def above_range(result: Result) -> Rows:
    """One row per mode: constant stiffness above the end of the law, and bonded there; empty where none is above."""
    if result.above_range is None:
        return []
    ends = (result.frequencies, result.above_range.frequencies)
    losses = (result.loss_factors, result.above_range.loss_factors)

    def cell(low: float, high: float, least: float, most: float) -> str:
        loss = "" if np.isnan(least + most) else f" ({least:.1e} .. {most:.1e})"
        return f"{low:.2f} .. {high:.2f}, {high / low - 1:+.2%}{loss}"

    heads = (f"{load} constant .. bonded [Hz] (loss)" for load in result.load_names)
    return by_mode(
        heads, ([cell(*four) for four in mode] for mode in np.stack([*ends, *losses], axis=-1).swapaxes(0, 1))
    )


def laws(result: Result) -> Rows:
    """One row per law at the last preload, the study's own first; empty where there is no other law.

    Where each law ends, the share of the joints beyond that, the share of their stiffness outside its validity range.
    Of the modes that differ most between the laws the frequency with its loss factor; two frequencies where it matters
    whether what is above the end has a constant stiffness or is bonded.
    """
    r, others = result, result.alternatives
    if others is None:
        return []
    own = r.frequencies[-1] if r.above_range is None else r.above_range.frequencies[-1]
    constant = np.stack([r.frequencies[-1], *others.frequencies[:, -1]])
    bonded = np.stack([own, *others.above_range_frequencies[:, -1]])
    losses = np.stack([r.loss_factors[-1], *others.loss_factors[:, -1]])
    ends = [min(float(law["greatest_pressure [Pa]"]) for law in r.laws), *others.reach]
    above = [r.above_range_share[-1], *others.above_range_share[:, -1]]
    outside = [r.outside_share[-1], *others.outside_share[:, -1]]
    spread = np.nanmax(bonded, axis=0) / np.nanmin(constant, axis=0)
    shown = np.sort(np.argsort(-spread)[:SHOWN])
    rows: Rows = [["law", "ends [MPa]", "beyond", "outside", *(f"mode {j + 1} [Hz] (loss)" for j in shown)]]
    names = (" + ".join(dict.fromkeys(str(law["name"]) for law in r.laws)), *others.names)
    for k, name in enumerate(names):
        if np.isnan(ends[k]) or np.isnan(constant[k]).all():
            rows.append([name, *["-"] * (3 + len(shown))])
            continue
        cells = []
        for j in shown:
            apart = bonded[k, j] / constant[k, j] - 1 > SAME
            two = f"{constant[k, j]:.1f} .. {bonded[k, j]:.1f}" if apart else f"{constant[k, j]:.1f}"
            cells.append(two + ("" if np.isnan(losses[k, j]) else f" ({losses[k, j]:.1e})"))
        rows.append([name, f"{ends[k] / 1e6:.3g}", f"{above[k]:.1%}", f"{outside[k]:.1%}", *cells])
    return rows


def waves(result: Result) -> Rows:
    """One row per mode: least, median and greatest over the draws of waves, at each load and of d f/d preload."""
    drawn = result.waves
    if drawn is None:
        return []
    heads = [f"{load} [Hz]" for load in result.load_names]
    cells = [[_over_draws(values, ".1f") for values in mode.T] for mode in np.moveaxis(drawn.frequencies, 2, 0)]
    if drawn.slopes is not None:
        heads.append("d f/d preload [Hz/kN]")
        cells = [[*row, _over_draws(1e3 * s, "+.2f")] for row, s in zip(cells, drawn.slopes.T, strict=True)]
    return by_mode(heads, cells)


def _over_draws(values: Array, form: str) -> str:
    return " .. ".join(format(np.quantile(values, share), form) for share in (0.0, 0.5, 1.0))


def waves_head(result: Result) -> str:
    """Which waves the draws have, as far as the joints have the same; empty where none are drawn."""
    if result.waves is None or not (drawn := np.isfinite(result.waves.rms)).any():
        return ""
    rms = _one_or_ends(1e6 * result.waves.rms[drawn], "um")
    low, high = (_one_or_ends(1e3 * ends, "mm") for ends in result.waves.lengths[drawn].T)
    return f"waves from {low} to {high}, rms {rms} on each face, {len(result.waves.seeds)} draws"


def _one_or_ends(values: Array, unit: str) -> str:
    least, greatest = f"{values.min():.3g}", f"{values.max():.3g}"
    return f"{least} {unit}" if least == greatest else f"{least} .. {greatest} {unit}"


def comparison(result: Result) -> Rows:
    """One row per preload and source, errors relative to the reference; then the change with preload for each."""
    c = result.comparison
    if c is None:
        return []
    count = c.frequencies.shape[1]
    rows: Rows = [["preload", "source", *(f"mode {j + 1}" for j in range(count))]]
    theirs = [] if c.published is None else [(c.published_name, c.published)]
    names = () if result.alternatives is None else result.alternatives.names
    others = [] if c.alternatives is None else list(zip(names, c.alternatives, strict=True))
    ours = [*others, ("Faying", c.predicted)]
    for i, load in enumerate(result.load_names):
        rows.append([load, f"{c.reference} [Hz]", *(f"{f:.1f}" for f in c.frequencies[i])])
        for name, values in (*theirs, *ours):
            rows.append(["", f"{name} [Hz]", *(or_dash(f, ".1f") for f in values[i])])
            errors = 100 * (values[i] / c.frequencies[i] - 1)
            rows.append(["", f"{name} error [%]", *(or_dash(e, "+.2f") for e in errors)])
    if len(result.loads) > 1:
        for name, values in ((c.reference, c.frequencies), *theirs, *ours):
            slope = preload_slope(values, result.loads) * 1e3
            rows.append(["d f/d preload", f"{name} [Hz/kN]", *(or_dash(s, "+.3f") for s in slope)])
    return rows


def joints(result: Result) -> Rows:
    """One row per preload and joint: greatest and mean pressure, open and slipping share, stiffness; imbalance.

    The slipping share has a column only where something slips; the residual force is that of the whole.
    """
    if not result.joints:
        return []
    slips = bool(np.any(result.slipping > 0))
    heads = ["preload", "joint", "greatest p [MPa]", "mean p [MPa]", "open [%]", *["slipping [%]"] * slips]
    rows: Rows = [[*heads, "total k_n [N/m]", "total k_t [N/m]", "imbalance"]]
    for (i, load), (k, name) in product(enumerate(result.load_names), enumerate(result.joints)):
        here = of_joint(result, i, k)
        rows.append(
            [
                load,
                name,
                f"{here.greatest * 1e-6:.3g}",
                f"{here.mean * 1e-6:.3g}",
                f"{100 * here.open_share:.1f}",
                *[f"{100 * result.slipping[i, k]:.1f}"] * slips,
                f"{here.stiffness:.4g}",
                f"{result.total_k_t[i, k]:.4g}",
                f"{result.imbalance[i]:.0e}",
            ]
        )
    return rows


def parts(result: Result) -> Rows:
    """One row per part with its mass, then point masses and the sum."""
    rows = [(name, float(mass)) for name, mass in zip(result.parts, result.part_masses, strict=True)]
    rows += [(f"point mass {k}", mass.mass) for k, mass in enumerate(result.masses, start=1)]
    rows.append(("sum, without bolts that are not meshed", sum(mass for _, mass in rows)))
    return [["part", "mass [kg]"], *([name, f"{mass:.4g}"] for name, mass in rows)]


def bolts(result: Result) -> Rows:
    """One row per preload: force in each bolt when all are tight; empty without bolts, or where `bolting` has it."""
    if not result.bolts or (not result.tightening and result.bolt_numbers is not None):
        return []
    cells = ([f"{force / 1e3:.3f}" for force in forces] for forces in result.bolt_forces)
    return by_load(result, (f"{name} [kN]" for name in result.bolts), cells)


def of_quantity(result: Result, name: str) -> Rows:
    """A quantity of modes: one row per mode. Of bolts, joints and the like: one row per preload, a column for each."""
    meta, values = result.shown()[name], np.asarray(getattr(result, name))
    of_modes = meta.dims == ("load", "mode")
    heads = [f"{one} [{meta.unit_text}]" for one in (result.load_names if of_modes else result.labels()[meta.dims[1]])]
    cells = [[or_dash(v, meta.shown.form) for v in row] for row in (values.T if of_modes else values)]
    return by_mode(heads, cells) if of_modes else by_load(result, heads, cells)


def bolting(result: Result) -> Rows:
    """One row per preload and bolt: compliances, load factor, strength and embedding; a dash for what is not known."""
    b = result.bolt_numbers
    if b is None:
        return []
    shape = result.bolt_forces.shape
    depth = np.where(np.isfinite(b.embedding[0]).any(axis=1), np.nansum(b.embedding, axis=2), np.nan)

    def of_all(values: Any) -> Array:
        return np.broadcast_to(values, shape).ravel()

    def bounded(bounds: Array) -> list[str]:
        return ["-" if np.isnan(low) else f"{low:.2g} .. {high:.2g}" for low, high in bounds.reshape(2, -1).T]

    rows = in_columns(
        ("preload", [load if k == 0 else "" for load in result.load_names for k in range(shape[1])], ""),
        ("bolt", [*result.bolts] * shape[0], ""),
        ("force [kN]", of_all(result.bolt_forces / 1e3), ".3f"),
        ("delta_S [um/kN]", of_all(1e9 * b.compliance), ".3g"),
        ("delta_P [um/kN]", of_all(1e9 * b.member_compliance), ".3g"),
        ("cone [um/kN]", of_all(1e9 * b.cone_compliance), ".3g"),
        ("Phi", of_all(b.load_factor), ".3f"),
        ("of proof [%]", of_all(100 * b.proof_share), ".0f"),
        ("seat [MPa]", of_all(1e-6 * b.seat_pressure), ".3g"),
        ("limit [MPa]", of_all(1e-6 * b.seat_limit), ".3g"),
        ("embedding [um]", bounded(1e6 * depth), ""),
        ("loss [kN]", bounded(1e-3 * b.embedding_loss), ""),
        ("VDI f_Z [um]", of_all(1e6 * b.embedding_guide), ".3g"),
        ("loss [kN]", of_all(1e-3 * b.embedding_guide_loss), ".2g"),
    )
    # without the columns that have nothing but dashes
    keep = [k for k in range(len(rows[0])) if k < 2 or any(row[k] != "-" for row in rows[1:])]
    return [[row[k] for k in keep] for row in rows]


def bolting_head(result: Result) -> str:
    """Heading of `bolting`, which says where no law predicts an embedding."""
    b = result.bolt_numbers
    silent = b is not None and bool(np.isnan(b.embedding).all())
    return (
        "bolts and what they clamp"
        + " (no law here has a loading curve of its own: no embedding is predicted)" * silent
    )


def modal_forces(result: Result) -> Rows:
    """One row per mode at the last preload: force in each bolt per um of motion where the mode moves most."""
    b = result.bolt_numbers
    if b is None or not np.isfinite(b.modal_force).any():
        return []
    heads = (f"{name} [{unit}]" for name in result.bolts for unit in ("N/um", "N/(m/s2)"))
    both = np.stack([1e-6 * b.modal_force[-1], b.modal_force_by_acceleration[-1]], axis=-1)
    return by_mode(heads, ([or_dash(one, ".3g") for one in mode.ravel()] for mode in both))


def conductance(result: Result) -> Rows:
    """One row per preload: conductance of heat and current of each joint; empty where no material states its own."""
    every = {"W/K": result.thermal_conductance, "S": result.electrical_conductance}
    known = {unit: values for unit, values in every.items() if values is not None}
    if not known:
        return []
    heads = (f"{name} [{unit}]" for unit in known for name in result.joints)
    return by_load(
        result, heads, ([or_dash(v, ".4g") for v in row] for row in np.concatenate([*known.values()], axis=1))
    )


EMBEDDING = (
    "delta_S, delta_P: compliance of the bolt and of what it clamps; Phi: share of a load at the seats that the bolt "
    "takes. Embedding: approach that lasts by the contact law, and what it costs if all of it came after tightening; "
    "a law without a loading curve of its own predicts none. VDI f_Z: guide value of thread, seats and joints."
)
CLEAN = "Of clean metal in vacuum; films hinder the flow, gas or grease in the gaps helps it."


def hammer(result: Result) -> Rows:
    """The hammer test against the model, one row per mode of the test; empty where there is none."""
    return [] if result.hammer is None else result.hammer.rows()


def fractal(facts: Mapping[str, Any]) -> list[str]:
    """D and G of a scan with their intervals, the band of wavelengths, and the roughness that they imply over the scan.

    facts: "D", "D_interval", and in metres "G", "G_interval", "band", "implied_Rq", or these names with " [m]".
    """

    def values(name: str) -> list[float | None]:
        found = facts.get(name, facts.get(f"{name} [m]"))
        return list(found) if isinstance(found, list | tuple) else [found]

    def cell(name: str, value: float | None) -> str:
        if value is None or not np.isfinite(value):
            return "-"
        return f"{value:.3f}" if name in ("D", "D_interval") else show(value, "m", digits=3)

    names = ("D", "D_interval", "G", "G_interval", "band", "implied_Rq")
    return [" .. ".join(cell(name, value) for value in values(name)) for name in names]


def fractals(result: Result) -> Rows:
    """D and G from scans, where a law rests on them; joints that share a scan have one row."""
    found: dict[tuple[str, ...], list[str]] = {}
    for joint, surface, law in zip(result.joints, result.surfaces, result.laws, strict=True):
        if "fitted_G [m]" in surface and law.get("D") == surface["fitted_D"]:
            cells = fractal(surface | {"D": surface["fitted_D"], "G [m]": surface["fitted_G [m]"]})
            found.setdefault((surface["origin"], *cells, show(law["G"], "m", digits=3)), []).append(joint)
    rows = [[", ".join(joints), *cells] for cells, joints in found.items()]
    return [["joint", "scan", *FRACTAL, "G of the law"], *rows] if rows else []


def backbone(curve: Backbone) -> Rows:
    """One row per amplitude, the static cycle beside the amplitudes that it was computed at."""
    return in_columns(
        ("a [m/s2]", curve.acceleration, ".4g"),
        ("f [Hz]", curve.frequency, ".3f"),
        ("damping [%]", 100 * curve.damping, ".3g"),
        ("slips", curve.slipping, ".1%"),
        ("opens", curve.open, ".1%"),
        ("loss [J]", curve.energy.sum(axis=1), ".3g"),
        ("static cycle: df, d damping", [_static_cycle(curve, level) for level in curve.acceleration], ""),
    )


def _static_cycle(curve: Backbone, level: float) -> str:
    """How far the static cycle at an amplitude is from the curve; empty where there is none."""
    found = curve.witness
    if found is None or not (here := np.abs(found.acceleration / level - 1) < 1e-9).any():
        return ""
    return f"{found.frequency_change[here][0]:+.2%}, {or_dash(found.damping_change[here][0], '+.1%')}"


def backbone_measured(curve: Backbone) -> Rows:
    """Measured points beside the curve at the same amplitude, a dozen at most over their range."""
    order = np.argsort(curve.measured_acceleration)
    shown = order[np.unique(np.linspace(0, len(order) - 1, min(len(order), MAX_MEASURED)).round().astype(int))]
    f, z = (values[shown] for values in curve.at_measured())
    measured_f, measured_z = curve.measured_frequency[shown], curve.measured_damping[shown]
    return in_columns(
        ("a [m/s2]", curve.measured_acceleration[shown], ".4g"),
        ("measured [Hz]", measured_f, ".3f"),
        ("curve [Hz]", f, ".3f"),
        ("difference", f / measured_f - 1, "+.2%"),
        ("measured [%]", 100 * measured_z, ".3g"),
        ("curve [%]", 100 * z, ".3g"),
        ("ratio", z / measured_z, ".2f"),
    )


def measured_backbone(points: MeasuredBackbone) -> Rows:
    """One row per point of a free decay, with standard errors."""
    rows: Rows = [["t [s]", "a [m/s2]", "f [Hz]", "+-", "damping [%]", "+-"]]
    names = ("time", "acceleration", "frequency", "frequency_error", "damping", "damping_error")
    for t, a, f, f_error, z, z_error in zip(*(getattr(points, name) for name in names), strict=True):
        rows.append([f"{t:.4g}", f"{a:.4g}", f"{f:.3f}", f"{f_error:.1g}", f"{100 * z:.4g}", f"{100 * z_error:.1g}"])
    return rows


def backbone_bounds(curve: Backbone) -> Rows:
    """What coarser computations change, and what the basis leaves in the full equations."""
    bounds = curve.bounds
    rows: Rows = [[f"at {bounds.acceleration:.4g} m/s2", "frequency", "damping of the joints"]]
    for name, words in (
        ("harmonics", f"harmonics 0, 1 in place of 0 to {curve.harmonics}"),
        ("points", "half of the joints' points"),
        ("samples", "half of the instants of a cycle"),
    ):
        f, z = (getattr(bounds, f"{name}_{of}") for of in ("frequency", "damping"))
        rows.append([words, or_dash(f, "+.1e"), or_dash(z, "+.2%")])
    return [*rows, ["residual of the full equations, in energy", f"{bounds.residual:.1e}", ""]]
