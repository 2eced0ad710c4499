"""Train the network of faying.surface.fpenn on exact moments of finite Weierstrass-Mandelbrot series.

Run: python benchmarks/surface_fpenn_train.py [OUTPUT.npz]     (five minutes on one core; same numbers each time)
Full-batch L-BFGS in double precision from a seeded start, so the result depends on nothing but NumPy and SciPy.
"""

import sys
from math import log
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

from faying.surface.fpenn import GAMMA, WEIGHTS, network

D_RANGE, TERMS, LOG_RATIO = (2.02, 2.98), (4, 40), (log(1e-10), log(1e-2))
HIDDEN, CASES, ROUNDS, SEED = 24, 12000, 4000, 7


def cases(count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Inputs (count, 4) and outputs (count, 2) of series with random D, ln(G/L) and number of terms, L = 1."""
    Ds = rng.uniform(D_RANGE[0], D_RANGE[1], count) - 1
    ratio = rng.uniform(*LOG_RATIO, count)
    terms = rng.integers(TERMS[0], TERMS[1] + 1, count)
    n = np.arange(TERMS[1])
    f = GAMMA**n
    power = f[None, :] ** (2 * Ds[:, None] - 4) * (n[None, :] < terms[:, None])
    level = (2 * Ds - 2) * ratio
    base = level + log(log(GAMMA) / 2)
    logs = [base + np.log(np.sum(power * (2 * np.pi * f) ** (2 * k), axis=1)) for k in range(3)]
    return np.stack([*logs, terms.astype(float)], axis=1), np.stack([Ds, level], axis=1)


def main() -> None:
    """Train, measure the error on fresh cases, write the weights."""
    rng = np.random.default_rng(SEED)
    x, y = cases(CASES, rng)
    w = {
        "input_mean": x.mean(axis=0),
        "input_scale": x.std(axis=0),
        "output_mean": y.mean(axis=0),
        "output_scale": y.std(axis=0),
    }
    shapes = {
        "w1": (4, HIDDEN),
        "b1": (HIDDEN,),
        "w2": (HIDDEN, HIDDEN),
        "b2": (HIDDEN,),
        "w3": (HIDDEN, 2),
        "b3": (2,),
    }
    start = np.concatenate(
        [
            rng.normal(0, 1 / max(s[0], 1) ** 0.5, int(np.prod(s))) if len(s) == 2 else np.zeros(s)
            for s in shapes.values()
        ]
    )
    ends = np.cumsum([0] + [int(np.prod(s)) for s in shapes.values()])
    xs = (x - w["input_mean"]) / w["input_scale"]
    ys = (y - w["output_mean"]) / w["output_scale"]

    def unpack(t: np.ndarray) -> dict[str, np.ndarray]:
        return {n: t[a:b].reshape(s) for (n, s), a, b in zip(shapes.items(), ends, ends[1:], strict=False)}

    def loss(t: np.ndarray) -> tuple[float, np.ndarray]:
        p = unpack(t)
        h1 = np.tanh(xs @ p["w1"] + p["b1"])
        h2 = np.tanh(h1 @ p["w2"] + p["b2"])
        r = h2 @ p["w3"] + p["b3"] - ys
        d3 = 2 * r / r.size
        d2 = d3 @ p["w3"].T * (1 - h2**2)
        d1 = d2 @ p["w2"].T * (1 - h1**2)
        parts = (xs.T @ d1, d1.sum(0), h1.T @ d2, d2.sum(0), h2.T @ d3, d3.sum(0))
        return float(np.mean(r**2)), np.concatenate([g.ravel() for g in parts])

    found = minimize(
        loss,
        start,
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": ROUNDS, "maxfun": 2 * ROUNDS, "maxcor": 40, "ftol": 0, "gtol": 1e-12},
    )
    w |= unpack(found.x)
    x, y = cases(100_000, np.random.default_rng(SEED + 1))
    error = network(x, w) - y
    w |= {
        "D": np.array(D_RANGE),
        "terms": np.array(TERMS),
        "log_ratio": np.array(LOG_RATIO),
        "error_D": np.abs(error[:, 0]).max(),
        "rms_D": np.sqrt(np.mean(error[:, 0] ** 2)),
        "error_log_level": np.abs(error[:, 1]).max(),
        "rms_log_level": np.sqrt(np.mean(error[:, 1] ** 2)),
    }
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else WEIGHTS
    np.savez(path, **w)
    print(
        f"{path}: {found.nit} rounds, loss {found.fun:.3g}, D error rms {w['rms_D']:.2e} largest {w['error_D']:.2e}, "
        f"level error rms {w['rms_log_level']:.2e} largest {w['error_log_level']:.2e}"
    )


if __name__ == "__main__":
    main()
