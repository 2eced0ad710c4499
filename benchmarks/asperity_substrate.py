"""What the substrate takes: eq. (1) of the JK paper, and an effective modulus, fitted to computed caps.

Run `python benchmarks/asperity_substrate.py`. A sphere's computed force F(delta; E) is the measuring stick. A cap on a
substrate is compared with: the sphere at delta_a of eq. (1), delta = delta_a (1 + (c/sqrt 2) Er sqrt(delta_a/h_a));
and the sphere at delta with 1/E = x/Ea + (1 - x)/Eb, x = 1 - exp(-alpha h_a/sqrt(R delta)). The second table goes
beyond
the fit: flatter caps, Ea/Eb = 4, delta up to h_a; there a cap differs from a sphere also at Ea = Eb, so the measuring
stick is the force over that of the same cap with Ea = Eb.
"""

import os

import numpy as np
from asperity_fe.drive import AsperityCase
from asperity_fe.result import AsperityResult

from faying import RIGID, Material
from faying.apart import in_processes

RATIOS = (1.0, 1.5, 2.0)
WIDER_RATIOS = (1.0, 1.5, 2.0, 4.0)
WIDER_CAPS = ((500e-6, 0.1e-6), (100e-6, 0.1e-6), (15e-6, 0.1e-6), (20e-6, 0.75e-6), (40e-6, 3e-6))
CAPS = ((15e-6, 0.1e-6), (20e-6, 0.75e-6), (40e-6, 3e-6))


def material(ratio: float) -> Material:
    return Material(name="m", E=ratio * 100e9, nu=0.3, yield_strength=355e6)


def _solved(number: int, case: AsperityCase) -> tuple[int, AsperityResult]:
    return number, case.solve()


def solved(cases: list[AsperityCase]) -> list[AsperityResult]:
    """Results of cases, in their order, by all cores."""
    return [found for _, found in sorted(in_processes(_solved, list(enumerate(cases)), os.cpu_count() or 1))]


def computed(elements: int) -> tuple[list[AsperityCase], list]:
    cases = [
        AsperityCase(
            R=1.0, h_a=1.0, cap=material(e), substrate=RIGID, foot="sliding", displacement=(0.024,), elements=50
        )
        for e in RATIOS
    ]
    cases += [
        AsperityCase(R=R, h_a=h, cap=material(e), substrate=material(1.0), displacement=(0.3 * h,), elements=elements)
        for R, h in CAPS
        for e in RATIOS
    ]
    return cases, solved(cases)


class Sphere:
    """Force over R^2 of a sphere at delta/R for any modulus between those computed: a polynomial in 1/E for ln F.

    histories: for each modulus, runs to rising displacements; the shortest run that reaches delta is read.
    """

    def __init__(self, ratios: tuple[float, ...], histories: list[list]) -> None:
        self.ratios, self.histories = ratios, histories

    def force(self, delta: np.ndarray, ratio: np.ndarray) -> np.ndarray:
        nodes, total = [1 / e for e in self.ratios], 0.0
        for i, runs in enumerate(self.histories):
            value = np.full(np.shape(delta), np.nan)
            for run in runs:
                read = np.interp(np.log(delta), np.log(run.displacement), np.log(run.force), right=np.nan)
                value = np.where(np.isnan(value), read, value)
            for j, other in enumerate(nodes):
                if j != i:
                    value = value * (1 / ratio - other) / (nodes[i] - other)
            total = total + value
        return np.exp(total)


def own_share(applied: np.ndarray, ratio: np.ndarray, c: float) -> np.ndarray:
    """Solve delta_a/delta of eq. (1) by Newton's method in its square root."""
    q = ratio * c / np.sqrt(2) * np.sqrt(applied)
    t = np.ones_like(q)
    for _ in range(40):
        t = t - (t**2 + q * t**3 - 1) / (2 * t + 3 * q * t**2)
    return t**2


def main(elements: int = 40) -> None:
    from scipy.optimize import least_squares

    cases, results = computed(elements)
    sphere = Sphere(RATIOS, [[r.history] for r in results[: len(RATIOS)]])
    rows = []
    for case, result in zip(cases[len(RATIOS) :], results[len(RATIOS) :], strict=True):
        history = result.history
        for d, F in zip(history.displacement, history.force, strict=True):
            if d > 0.01 * case.h_a:
                rows.append((case.R, case.h_a, case.cap.E / case.substrate.E, d, F))
    R, h, ratio, d, F = np.array(rows).T
    target = np.log(F / R**2)

    def eq_1(c):
        return np.log(sphere.force(own_share(d / h, ratio, c[0]) * d / R, ratio)) - target

    def effective(alpha):
        x = 1 - np.exp(-alpha[0] * h / np.sqrt(R * d))
        return np.log(sphere.force(d / R, 1 / (x / ratio + 1 - x))) - target

    fitted, alpha = least_squares(eq_1, [0.3]).x, least_squares(effective, [0.5]).x
    print(
        f"{len(d)} points, 0.01 < delta/h_a < 0.3, h_a/R 0.0067 to 0.075, Ea/Eb 1 to 2, Eb/Y 282, nu 0.3, perfectly "
        f"plastic"
    )
    for name, error in (
        ("eq. (1), c = 1.5", eq_1([1.5])),
        (f"eq. (1), c = {fitted[0]:.3f} (fitted)", eq_1(fitted)),
        ("sphere of the cap's modulus", eq_1([0.0])),
        (f"effective modulus, alpha = {alpha[0]:.3f} (fitted)", effective(alpha)),
    ):
        same = ratio == 1
        print(
            f"{name:45s} error of F: rms {100 * np.sqrt(np.mean(error**2)):5.1f} %, largest "
            f"{100 * abs(error).max():5.1f} %,"
            f" rms at Ea = Eb {100 * np.sqrt(np.mean(error[same] ** 2)):5.1f} %"
        )


def wider(alpha: float, elements: int = 32) -> None:
    """How far the effective modulus holds beyond the caps that it was fitted to."""
    tops = (2e-5, 5e-4, 0.076)
    spheres = [
        AsperityCase(
            R=1.0, h_a=1.0, cap=material(e), substrate=RIGID, foot="sliding", displacement=(d,), elements=elements
        )
        for e in WIDER_RATIOS
        for d in tops
    ]
    keys = [(R, h, top, e) for R, h in WIDER_CAPS for top in (0.1, 0.6, 1.0) for e in WIDER_RATIOS]
    caps = [
        AsperityCase(R=R, h_a=h, cap=material(e), substrate=material(1.0), displacement=(top * h,), elements=elements)
        for R, h, top, e in keys
    ]
    found = solved(spheres + caps)
    runs = [r.history for r in found]
    n = len(tops)
    sphere = Sphere(WIDER_RATIOS, [runs[i * n : (i + 1) * n] for i in range(len(WIDER_RATIOS))])
    by_key = dict(zip(keys, runs[len(spheres) :], strict=True))
    print("beyond the fit: rms and largest error of F over that with Ea = Eb, in bands of delta/h_a, delta/h_a > 0.01")
    for R, h in WIDER_CAPS:
        for e in WIDER_RATIOS[1:]:
            d, error = [], []
            for top in (0.1, 0.6, 1.0):
                run, own = by_key[R, h, top, e], by_key[R, h, top, 1.0]
                kept = (run.displacement > 0.15 * top * h) & (run.displacement > 0.01 * h)
                here = run.displacement[kept]
                x = 1 - np.exp(-alpha * h / np.sqrt(R * here))
                ratio = sphere.force(here / R, 1 / (x / e + 1 - x)) / sphere.force(here / R, np.ones_like(here))
                same = np.exp(np.interp(np.log(here), np.log(own.displacement), np.log(own.force)))
                d.append(here / h)
                error.append(np.log(ratio * same / run.force[kept]))
            at, miss = np.concatenate(d), np.concatenate(error)
            text = ""
            for low, high in ((0.01, 0.1), (0.1, 0.3), (0.3, 1.01)):
                part = miss[(at > low) & (at <= high)]
                text += (
                    f"  {low:.2f}-{high:.1f}: {100 * np.sqrt(np.mean(part**2)):4.1f}, {100 * abs(part).max():4.1f} %"
                )
            print(f"h_a/R {h / R:.4f}  Ea/Eb {e:.1f} {text}")


if __name__ == "__main__":
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    main()
    wider(0.453)
