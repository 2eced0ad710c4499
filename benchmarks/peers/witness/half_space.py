"""Solve one contact with another code, in its own interpreter; called by benchmarks and tests.

    python half_space.py CODE IN.npz OUT.npz

IN holds heights (n, n) over a unit square, pressure, E_star 1, hardness (0: elastic) and tol; OUT gets the traction and
the CPU seconds of the solution alone. CODE: tamaas, contactmechanics, aspher-periodic, aspher-h2.
"""

import sys
import time

import numpy as np


def tamaas(h, pressure, hardness, tol):
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.error)
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [1.0, 1.0], list(h.shape))
    model.E, model.nu = 1.0, 0.0
    if hardness:
        solver = tm.KatoSaturated(model, h, tol, hardness)
    else:
        solver = tm.PolonskyKeerRey(model, h, tol)
    solver.max_iter = 20000
    begin = time.process_time()
    solver.solve(pressure)
    return np.array(model.traction), time.process_time() - begin


def contactmechanics(h, pressure, hardness, tol):
    from ContactMechanics import PeriodicFFTElasticHalfSpace
    from ContactMechanics.Optimization import constrained_conjugate_gradients
    from SurfaceTopography import Topography

    n = h.shape[0]
    substrate = PeriodicFFTElasticHalfSpace(h.shape, 1.0, (1.0, 1.0))
    topography = Topography(h, (1.0, 1.0), periodic=True)
    begin = time.process_time()
    result = constrained_conjugate_gradients(
        substrate,
        topography,
        external_force=pressure,
        hardness=hardness / n**2 if hardness else None,
        pentol=tol * h.std(),
        maxiter=1000 if hardness else 20000,
    )
    return np.array(result.jac) * n**2, time.process_time() - begin


def aspher(backend):
    def solve(h, pressure, hardness, tol):
        from aspher import solve_nested

        if hardness:
            raise SystemExit("aspher has no hardness")
        n = h.shape[0]
        begin = time.process_time()
        found = solve_nested(n, h.max() - h, pressure, tol=tol, backend=backend, precision="float_then_double")
        return np.array(found.pressure).reshape(n, n), time.process_time() - begin

    return solve


CODES = {
    "tamaas": tamaas,
    "contactmechanics": contactmechanics,
    "aspher-periodic": aspher("periodic"),
    "aspher-h2": aspher("h2"),
}

if __name__ == "__main__":
    code, source, target = sys.argv[1:]
    given = np.load(source)
    traction, seconds = CODES[code](
        np.ascontiguousarray(given["heights"]), float(given["pressure"]), float(given["hardness"]), float(given["tol"])
    )
    np.savez(target, traction=traction, seconds=seconds)
