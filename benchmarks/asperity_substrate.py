"""What the substrate takes: eq. (1) of the JK paper, and an effective modulus, fitted to computed caps.

Run `python benchmarks/asperity_substrate.py`. A sphere's computed force F(delta; E) is the measuring stick. A cap on a
substrate is compared with: the sphere at delta_a of eq. (1), delta = delta_a (1 + (c/sqrt 2) Er sqrt(delta_a/h_a));
and the sphere at delta with 1/E = x/Ea + (1 - x)/Eb, x = 1 - exp(-alpha h_a/sqrt(R delta)).
"""

import os

import numpy as np

from faying import RIGID, Material
from faying.fe.asperity.cases import AsperityCase, solve_cases

RATIOS = (1.0, 1.5, 2.0)
CAPS = ((15e-6, 0.1e-6), (20e-6, 0.75e-6), (40e-6, 3e-6))


def material(ratio: float) -> Material:
    return Material(name="m", E=ratio * 100e9, nu=0.3, yield_strength=355e6)


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
    return cases, solve_cases(cases, progress=lambda done: print(f"{done} of {len(cases)}", end="\r"))


class Sphere:
    """Force over R^2 of a sphere at delta/R for any modulus between those computed: ln F quadratic in 1/E."""

    def __init__(self, histories: list) -> None:
        self.histories = histories

    def force(self, delta: np.ndarray, ratio: np.ndarray) -> np.ndarray:
        nodes, total = [1 / e for e in RATIOS], 0.0
        for i, history in enumerate(self.histories):
            value = np.log(np.interp(delta, history.displacement, history.force))
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
    sphere = Sphere([r.history for r in results[: len(RATIOS)]])
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
        f"{len(d)} points, 0.01 < delta/h_a < 0.3, h_a/R 0.0067 to 0.075, Ea/Eb 1 to 2, Eb/Y 282, nu 0.3, perfectly plastic"
    )
    for name, error in (
        ("eq. (1), c = 1.5", eq_1([1.5])),
        (f"eq. (1), c = {fitted[0]:.3f} (fitted)", eq_1(fitted)),
        ("sphere of the cap's modulus", eq_1([0.0])),
        (f"effective modulus, alpha = {alpha[0]:.3f} (fitted)", effective(alpha)),
    ):
        same = ratio == 1
        print(f"{name:45s} error of F: rms {100 * np.sqrt(np.mean(error**2)):5.1f} %, largest {100 * abs(error).max():5.1f} %,"
              f" rms at Ea = Eb {100 * np.sqrt(np.mean(error[same] ** 2)):5.1f} %")  # fmt: skip


if __name__ == "__main__":
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    main()
