"""What joints remember: the tables of docs/theory/history.md, and what a history costs.

    python benchmarks/history.py [faces] [places] [t-specimen] [cost]

- faces: k_n after 40 MPa over k_n on first loading, of four kinds of faces, eight draws each (six CPU minutes).
- places: k_n of flattened faces over that of fresh ones, at twelve offsets.
- t-specimen: frequencies at 4, 12, 4 kN, and the change from 4 to 12 kN under both states beside the hammer test.
- cost: CPU seconds of six preloads that fall and rise over those of the same six as they rise, in one process.

All four where none is named.
"""

import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np

import faying
from faying.contact.models.half_space import HalfSpace
from faying.halfspace.solve import solve_half_space
from faying.study import Study
from faying.surface.synthesize import spectral

ROOT = Path(__file__).parents[1]
STEEL = faying.Material(name="steel", E=206e9, nu=0.3, hardness=2e9, density=7850.0)
PAIR = faying.ContactPair(STEEL, STEEL)
SIDE, POINTS, LONGEST = 1e-3, 256, 0.25e-3
FACES = ((0.8, 0.3e-6), (0.5, 0.5e-6), (0.8, 1e-6), (0.8, 3e-6))  # Hurst exponent, rms of each face [m]
CARRIED, PRESSURES = 40e6, np.array([30e6, 20e6, 10e6, 5e6, 2e6])
GIVEN = {"E_star": PAIR.E_star, "hardness": STEEL.hardness, "tol": 1e-6}
DRAWS, OFFSETS = 8, 12
PLAIN = {"modes.intervals": False, "modes.levels": []}


def face(hurst: float, rms: float, seed: int, points: int = POINTS) -> np.ndarray:
    """Heights [m] of one face."""
    given = {"spacing": SIDE / points, "D": 3 - hurst, "Rq": rms, "longest": LONGEST, "periodic": True}
    return spectral((points, points), seed=seed, **given).heights


def faces() -> None:
    """Print the ratio of k_n of each kind of faces at each pressure: mean, least and greatest of the draws."""
    print(f"k_n after {CARRIED / 1e6:g} MPa over k_n on first loading, mean of {DRAWS} draws (least to greatest)")
    print("Hurst, rms [um]: " + ", ".join(f"{p / 1e6:g} MPa" for p in PRESSURES))
    for hurst, rms in FACES:
        ratios = []
        for draw in range(DRAWS):
            heights = face(hurst, rms, 2 * draw) + face(hurst, rms, 2 * draw + 1)
            law = HalfSpace(scan=SimpleNamespace(heights=heights, spacing=(SIDE / POINTS,) * 2), pair=PAIR, tol=1e-6)
            first = np.array([law.contact_at(float(p)).normal_stiffness(loading=False) for p in PRESSURES])
            flat = law.contact_at(CARRIED).flattened
            again = [solve_half_space(flat, SIDE / POINTS, pressure=float(p), **GIVEN) for p in PRESSURES]
            ratios.append(np.array([one.normal_stiffness(loading=False) for one in again]) / first)
        every = np.array(ratios)
        numbers = zip(every.mean(axis=0), every.min(axis=0), every.max(axis=0), strict=True)
        cells = [f"{m:.2f} ({a:.2f} to {b:.2f})" for m, a, b in numbers]
        print(f"{hurst}, {rms * 1e6:g}: " + ", ".join(cells), flush=True)


def places() -> None:
    """Print k_n of used faces over that of fresh ones, put together at offsets, and the scatter of the place."""
    points = POINTS // 2
    print(f"k_n of used over fresh faces at {OFFSETS} offsets: mean ratio; scatter of the place, fresh and used")
    for pair in range(2):
        first, second = (face(0.8, 1e-6, 2 * pair + k, points) for k in (2, 3))
        for carried, pressure in ((40e6, 10e6), (400e6, 200e6)):

            def solved(heights: np.ndarray, p: float):
                return solve_half_space(heights, SIDE / points, pressure=p, **GIVEN)

            top = solved(first + second, carried)
            lost = (top.heights - top.flattened) / 2  # of each face
            found, rng = [], np.random.default_rng(pair)
            for _ in range(OFFSETS):
                place = tuple(rng.integers(0, points, 2))
                moved = ((a, np.roll(b, place, (0, 1))) for a, b in ((first, second), (first - lost, second - lost)))
                found.append([solved(a + b, pressure).normal_stiffness(loading=False) for a, b in moved])
            fresh, used = np.array(found).T
            scatter = ", ".join(f"{one.std(ddof=1) / one.mean():.3f}" for one in (fresh, used))
            print(f"pair {pair + 1}, {pressure / 1e6:g} MPa: {used.mean() / fresh.mean():.3f}; {scatter}", flush=True)


def with_all(study: Study, values: dict) -> Study:
    """A study with values at several paths."""
    for path, value in values.items():
        study = study.with_(path, value)
    return study


def t_specimen() -> None:
    """Print frequencies at 4, 12, 4 kN, and from 4 to 12 kN on first loading, settled and in the test."""
    study = with_all(Study.read(ROOT / "examples" / "t-specimen" / "study.toml"), PLAIN | {"alternative": None})
    results = {state: faying.run(study.with_("joint.state", state)) for state in ("first", "settled")}
    shifts, test = {}, next(iter(results.values())).comparison.frequencies
    for name, one in results.items():
        shifts[name] = np.stack([f[m] for f, m in zip(one.frequencies, one.comparison.modes, strict=True)])
    back = faying.run(with_all(study, {"test": None, "bolt.preload": ["4 kN", "12 kN", "4 kN"]})).frequencies
    print("second 4 kN over the first [%]:", np.round(100 * (back[2] / back[0] - 1), 3)[:8])
    print("settled over first loading at 4 kN [%]:", np.round(100 * (shifts["settled"][0] / shifts["first"][0] - 1), 3))
    print("from 4 to 12 kN [Hz], test:", np.round(test[-1] - test[0], 1))
    for name, found in shifts.items():
        missed = np.sqrt(np.mean((test[0] * found[-1] / found[0] / test[-1] - 1) ** 2))
        same = np.sqrt(np.mean((test[0] / test[-1] - 1) ** 2))
        print(f"  {name}:", np.round(found[-1] - found[0], 1), f"rms error over that of no change {missed / same:.2f}")


def cost() -> None:
    """Print CPU seconds of a history of six preloads over those of six first loadings."""
    for name in ("t-specimen", "two-blocks", "plates-and-bolts"):
        file = "plates.toml" if name == "plates-and-bolts" else "study.toml"
        study = with_all(Study.read(ROOT / "examples" / name / file), PLAIN | {"alternative": None, "test": None})
        used = {}
        for what, loads in (
            ("meshes and laws", (2, 12)),
            ("rising", (2, 4, 6, 8, 10, 12)),
            ("history", (4, 12, 6, 10, 2, 8)),
        ):
            begin = time.process_time()
            faying.run(study.with_("bolt.preload", [f"{p} kN" for p in loads]))
            used[what] = time.process_time() - begin
        print(f"{name}: {used['history'] / used['rising']:.2f}", flush=True)


def main() -> None:
    """Print what is asked for."""
    every = {"faces": faces, "places": places, "t-specimen": t_specimen, "cost": cost}
    for name in sys.argv[1:] or every:
        every[name]()


if __name__ == "__main__":
    main()
