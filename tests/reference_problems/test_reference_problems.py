"""The problems of reference-problems/: Faying's numbers by the code of each page, and each reference by its own route.

Independent of Faying: closed forms, transfer matrices, a dense active set, and a section of finite elements.
"""

import csv
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, trapezoid
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import erfcinv

from tests import test_words
from tests.helpers.shaken import integrated
from tests.helpers.slips import describing
from tests.reference_problems.axial_section import compliance, tapped
from tests.reference_problems.calculix_section import bonded

FOLDER = Path(__file__).parents[2] / "reference-problems"
PAGES = [FOLDER / "README.md", *sorted(FOLDER.glob("*/README.md"))]
PROBLEMS = sorted(page.parent.name for page in PAGES[1:])


def rows(problem):
    with open(FOLDER / problem / "reference.csv", newline="", encoding="utf-8") as file:
        return {row["quantity"]: row for row in csv.DictReader(file)}


LONG = ("6-tapped-bracket", "7-random-vibration")


@pytest.mark.parametrize("problem", [pytest.param(one, marks=[pytest.mark.slow] * (one in LONG)) for one in PROBLEMS])
def test_the_code_of_a_page_finds_the_reference(problem, monkeypatch):
    """Each row of the table, and no other, within its tolerance."""
    (code,) = re.findall(r"```python\n(.*?)```", (FOLDER / problem / "README.md").read_text(encoding="utf-8"), re.S)
    monkeypatch.chdir(FOLDER / problem)
    names: dict[str, dict[str, float]] = {}
    exec(code, names)
    wanted = rows(problem)
    assert set(names["found"]) == set(wanted)
    off = {
        name: f"{got:.8g} for {wanted[name]['value']}"
        for name, got in names["found"].items()
        if got != pytest.approx(float(wanted[name]["value"]), rel=float(wanted[name]["tolerance"]))
    }
    assert not off


def conductance():
    """Cooper, Mikic and Yovanovich: the fit and the theory."""
    scale, found = 50.0 * 0.14 / 1.3e-6, {}
    for mega in (2, 10):
        ratio = mega * 1e6 / 2e9
        x = np.sqrt(2) * erfcinv(2 * ratio)
        found[f"fit at {mega} MPa"] = 1.25 * scale * ratio**0.95
        found[f"theory at {mega} MPa"] = (
            scale * np.exp(-(x**2) / 2) / (2 * np.sqrt(2 * np.pi)) / (1 - np.sqrt(ratio)) ** 1.5
        )
    ratio = (10e6 / (6e9 * (1.62 * 1.3 / 0.14) ** -0.25)) ** (1 / (1 - 0.071 * 0.25))
    return found | {"fit at 10 MPa with Vickers hardness": 1.25 * scale * ratio**0.95}


def shaken_mass():
    """Miles' equation for one mass."""
    speed = np.sqrt(10e9 * 4e-4 / (7800 * 4e-4 * 0.03))
    rms = np.sqrt(np.pi / 2 * speed / (2 * np.pi) / 0.04)
    return {
        "frequency": speed / (2 * np.pi),
        "damping ratio": 0.02,
        "rms acceleration": rms,
        "rms displacement": rms / speed**2,
    } | slider()


def slider():
    """A mass on a spring and a Jenkins element: stochastic averaging, and integration in time."""
    mass, spring, limit, rest, noise = 7800 * 4e-6, 1e6, 20.0, 0.005, 20.0
    a = np.geomspace(1e-9, 1e-3, 4000)
    secant, lost = np.array([describing(spring, limit, one) for one in a]).T
    speed = np.sqrt((spring + secant) / mass)
    damping = rest + lost / (2 * np.pi * mass * speed**2 * a**2)
    spent = cumulative_trapezoid(2 * damping * speed**3 * a, a, initial=0)
    density = a * np.exp(-4 / noise * spent)

    def mean(values):
        return trapezoid(values * density, a) / trapezoid(density, a)

    square, cube, power = mean(a**2), mean(speed**3 * a**2), mean(damping * speed**3 * a**2)
    assert power == pytest.approx(noise / 4, rel=1e-3)  # over the mass: what white noise gives
    one = {"masses": np.array([mass]), "springs": np.array([spring]), "stiffness": np.array([spring])}
    x, *_ = integrated(
        **one, limits=np.array([limit]), density=noise, damping=rest, time=0.5, realisations=400, steps=40
    )
    squares = (x**2).mean(axis=(0, 2))
    assert squares.std() / 20 / squares.mean() / 2 < 0.0015  # standard error of the rms, of 400
    return {
        "slider: frequency": np.cbrt(cube / square) / (2 * np.pi),
        "slider: damping ratio": power / cube,
        "slider: rms by averaging": np.sqrt(square / 2),
        "slider: rms by integration in time": np.sqrt(squares.mean()),
    }


def lap():
    """A joint and a beam with shear, whose moment is nothing in the joint; and Coulomb's law."""
    force, area, length = 600.0, 4e-4, 0.01
    bend = 2 * force * length**3 / (3 * 200e9 * 0.02**4 / 12)
    shear = 2 * force * length / (5 / 6 * 100e9 * area)
    return {
        "displacement at 600 N": force / (100e9 * area) + bend + shear,
        "greatest pressure": 4000 / area,
        "force at which the joint slips": 0.3 * 4000,
        "friction needed at 600 N": 600 / 4000,
    }


def opening():
    """Linear pressure over a rectangle that bears no tension."""
    height, force = 0.02, 4000.0
    reach = 3 * (height / 2 - 20 / force)
    return {
        "edge pressure at 10 N m": force / height**2 + 10 / (height**3 / 6),
        "opening moment": force * height / 6,
        "edge pressure at 20 N m": 2 * force / (height * reach),
        "open share at 20 N m": 1 - reach / height,
    }


def through(links, rod, lengths=(0.03, 0.02, 0.04)):
    """Transfer matrix of three rods with a joint between; rod is the derivative of the state along x."""
    matrix = np.eye(len(rod))
    for number, length in enumerate(lengths):
        matrix = expm(rod * length) @ (links @ matrix if number else matrix)
    return matrix


def spacers():
    """Transfer matrices of rods and of beams with shear and rotatory inertia."""
    E, G, rho, side = 200e9, 100e9, 7800.0, 0.02
    area, inertia = side**2, side**4 / 12
    across, along = 1e12, 2e12

    def axial(f):
        rod = np.array([[0, 1 / (E * area)], [-rho * area * (2 * np.pi * f) ** 2, 0]])
        return through(np.array([[1, 1 / (along * area)], [0, 1]]), rod)[1, 0]

    def bending(f):
        pull = rho * (2 * np.pi * f) ** 2
        rod = np.zeros((4, 4))  # of deflection, rotation, moment, shear force
        rod[0, 1], rod[0, 3], rod[1, 2] = 1, 1 / (5 / 6 * G * area), 1 / (E * inertia)
        rod[2, 1], rod[2, 3], rod[3, 0] = -pull * inertia, -1, -pull * area
        link = np.eye(4)
        link[0, 3], link[1, 2] = 1 / (across * area), 1 / (along * inertia)
        return np.linalg.det(through(link, rod)[2:, :2])

    found = {}
    for name, left in (("axial", axial), ("bending", bending)):
        f = np.linspace(500, 28e3, 120)
        values = [left(one) for one in f]
        turns = [k for k in range(len(f) - 1) if values[k] * values[k + 1] < 0]
        found |= {f"{name} {n}": brentq(left, f[k], f[k + 1], xtol=1e-6) for n, k in enumerate(turns[:2], 1)}
    return found


def rough():
    """The dense matrix of the map, and an active set."""
    heights = np.loadtxt(FOLDER / "8-rough-contact" / "map.csv", delimiter=",") * 1e-6
    n = len(heights)
    wave = 2 * np.pi * np.fft.fftfreq(n, 10e-6)
    q = np.hypot(*np.meshgrid(wave, wave))
    answer = np.fft.ifft2(np.divide(2 / 100e9, q, where=q > 0, out=np.zeros_like(q))).real
    y, x = (one.ravel() for one in np.indices(heights.shape))
    matrix = answer[(y[:, None] - y) % n, (x[:, None] - x) % n]
    z, found = heights.ravel(), {}
    for mega in (20, 100):
        touch = np.ones(n * n, dtype=bool)
        while True:
            count = np.count_nonzero(touch)
            system = np.zeros((count + 1, count + 1))
            system[:count, :count] = matrix[np.ix_(touch, touch)]
            system[:count, count], system[count, :count] = -1, 1
            *pressed, plane = np.linalg.solve(system, np.append(z[touch], mega * 1e6 * n * n))
            pressure = np.zeros(n * n)
            pressure[touch] = pressed
            gap = matrix @ pressure - z - plane
            new = (pressure > 0) | (~touch & (gap < 0))
            if np.array_equal(new, touch):
                break
            touch = new
        assert gap[~touch].min() > 0
        found[f"share in contact at {mega} MPa"] = touch.mean()
        found[f"greatest pressure at {mega} MPa"] = pressure.max()
        found[f"mean gap at {mega} MPa"] = gap.mean()
    return found


def discs():
    """The cone of VDI 2230 Part 1:2015, eqs. (5.1/24) and (5.1/27), and finite elements of the section."""
    seat, hole, outer, length, E = 16e-3, 10.5e-3, 32e-3, 26e-3, 210e9
    tangent = 0.362 + 0.032 * np.log(length / (2 * seat)) + 0.153 * np.log(outer / seat)
    wide = seat + length * tangent
    assert wide < outer
    cone = np.log((seat + hole) * (wide - hole) / ((seat - hole) * (wide + hole)))
    return {
        "compliance of the discs": compliance(
            seat=seat, hole=hole, outer=outer, length=length, k_n=1e14, E=E, nu=0.3, size=4e-4
        ),
        "compliance by the cone": 2 / (np.pi * E * hole * tangent) * cone,
    }


BRACKET = {"seat": 16e-3, "hole": 11e-3, "thread": 10e-3, "outer": 32e-3, "base": 40e-3}
BRACKET |= {"length": 13e-3, "depth": 30e-3, "engaged": 15e-3, "parts": ((210e9, 0.3), (70e9, 0.33)), "size": 5e-4}


def bracket():
    """Cylinders and cone of VDI 2230 Part 1:2015, sections 5.1.1.1 and 5.1.2.1, and finite elements of the section."""
    d, seat, hole, outer, length = 10e-3, 16e-3, 11e-3, 32e-3, 13e-3
    nominal, core = (np.pi / 4 * one**2 for one in (d, d - 1.22687 * 1.5e-3))
    screw = (0.5 * d / nominal + (length + 0.5 * d) / core) / 210e9 + 0.33 * d / nominal / 70e9
    between, force, shut = tapped(**BRACKET, k_n=1e14, k_t=1e13, screw=screw, preload=20e3, pull=2e3)
    assert shut == 1.0
    slope = 2 * (0.348 + 0.013 * np.log(length / seat) + 0.193 * np.log(outer / seat))
    wide = seat + slope * length
    assert wide < outer
    cone = np.log((seat + hole) * (wide - hole) / ((seat - hole) * (wide + hole)))
    return {
        "compliance of the screw": screw,
        "compliance of bracket and base": between,
        "load factor": between / (screw + between),
        "force that the screw gains": force - 20e3,
        "compliance of the bracket by the cone": 2 / (210e9 * np.pi * hole * slope) * cone,
    }


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
def test_calculix_finds_the_bonded_bracket(tmp_path):
    """Halving the elements moves both by 0.2 %, as the stress at the rim of the bracket has no limit."""
    stiff = tapped(**BRACKET, k_n=1e18, k_t=1e18, screw=1e-9, preload=20e3, pull=0.0)[0]
    assert bonded(tmp_path, **BRACKET) == pytest.approx(stiff, rel=2e-3)


def stub():
    """Half of a flange as a clamped beam with shear, pulled at its middle, held by a bolt, on the bed with its end."""
    E, wide, thick, end, arm, strip, d, half = 200e9, 0.02, 0.006, 0.04, 0.02, 0.0025, 2e-3, 1000.0
    bend, shear = E * wide * thick**3 / 12, 5 / 6 * E / 2 * wide * thick
    plain, core = (np.pi / 4 * one**2 for one in (d, d - 1.22687 * 0.4e-3))
    bolt = ((0.5 * d + 0.012 + 0.4 * d) / plain + 0.5 * d / core) / E
    x = np.linspace(0, end, 8001)
    seat = np.abs(x - arm) < strip * (1 + 1e-9)

    def rise(first, last):
        """Mean deflection of the seat over that of the end, by 1 N upwards that is spread between two places."""
        place = np.linspace(first, last, 201)[:, None]
        force, moment = (place > x).mean(axis=0), np.maximum(place - x, 0).mean(axis=0)
        rotation = cumulative_trapezoid(moment / bend, x, initial=0)
        v = cumulative_trapezoid(rotation + force / shear, x, initial=0)
        return v[seat].mean() - v[-1]

    web, pull, tip = rise(0, strip), rise(arm - strip, arm + strip), rise(end, end)
    prying = (half * (web - pull - bolt) + bolt) / (pull - tip + bolt)  # 1 N of preload
    return {"force of a bolt": half + prying, "prying force": prying}


def turns():
    """Two rigid bodies on an even joint: approach and rotation, by two equations for each turn of a bolt."""
    force, side, length, d = 500.0, 0.02, 0.06, 2e-3
    plain, core = (np.pi / 4 * one**2 for one in (d, d - 1.22687 * 0.4e-3))
    axial = 200e9 / ((0.5 * d + length + 0.4 * d) / plain + 0.5 * d / core)
    joint = 100e9 * np.diag([side**2, side**4 / 12])
    arms = {"A": np.array([1, side / 8]), "B": np.array([1, -side / 8])}
    shank = {one: axial * np.outer(arm, arm) for one, arm in arms.items()}
    bend = np.diag([0, 200e9 * np.pi / 64 * d**4 / length])
    tight, lost = {}, []  # where each bolt was let go
    for turn, other in ("AB", "BA", "AB", "BA"):
        stiff, load = joint, force * arms[turn]
        if other in tight:
            stiff = joint + shank[other] + bend
            load = load + force * arms[other] + (shank[other] + bend) @ tight[other]
        now = tight[turn] = np.linalg.solve(stiff, load)
        lost.append(axial * arms["A"] @ (now - tight["A"]))
    simple = (
        axial
        * (arms["A"] @ np.linalg.solve(joint, arms["B"]))
        / (1 + axial * (arms["A"] @ np.linalg.solve(joint, arms["A"])))
    )
    assert lost[1::2] == pytest.approx([force * simple, force * simple**3], rel=0.01)  # without bending of the bolts
    return {"loss of A, one pass": lost[1], "loss of A, two passes": lost[3]}


REFERENCES = {
    "1-cone-compliance": discs,
    "2-t-stub-prying": stub,
    "6-tapped-bracket": bracket,
    "10-tightening-order": turns,
    "3-lap-joint": lap,
    "4-joint-opening": opening,
    "5-stacked-spacers": spacers,
    "7-random-vibration": shaken_mass,
    "8-rough-contact": rough,
    "9-conductance": conductance,
}


def test_each_problem_is_in_the_table_of_the_folder():
    table = PAGES[0].read_text(encoding="utf-8")
    assert set(PROBLEMS) == set(REFERENCES) == set(re.findall(r"\]\(([\w-]+)/README\.md\)", table))


@pytest.mark.parametrize("problem", REFERENCES)
def test_a_reference_is_found_again_by_its_own_route(problem):
    wanted = {name: float(row["value"]) for name, row in rows(problem).items()}
    assert REFERENCES[problem]() == pytest.approx(wanted, rel=1e-7)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.parent.name)
def test_a_page_has_the_words_of_the_documentation(page):
    text = page.read_text(encoding="utf-8")
    plain = test_words.prose(text)
    patterns = test_words.PRIVATE | test_words.HISTORY | test_words.PLACES
    assert not list(test_words.found(patterns, plain))
    assert not list(test_words.long_sentences(text))
    assert not test_words.DECIMAL.search(text)
    assert max(map(len, text.splitlines())) <= 120
