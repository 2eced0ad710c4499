"""Frequency and damping against amplitude by tmdsimpy, in its own interpreter: python backbone.py CASE.npz OUT.npz.

Settings of the continuation are those of tmdsimpy's own example of the Brake-Reuss beam.
"""

import contextlib
import io
import sys
import time

import numpy as np
import tmdsimpy.utils.harmonic as hutils
from tmdsimpy.continuation import Continuation
from tmdsimpy.jax.nlforces.elastic_dry_fric_2d import ElasticDryFriction2D
from tmdsimpy.jax.solvers import NonlinearSolverOMP
from tmdsimpy.nlforces.vector_jenkins import VectorJenkins
from tmdsimpy.vibration_system import VibrationSystem

REPEATS = 3  # of the evaluation that is timed


def system(case):
    """The vibrating system with one friction element at each point."""
    found = VibrationSystem(case["mass"], case["stiffness"], C=np.zeros_like(case["mass"]))
    for row in zip(*(case[name] for name in ("slip", "closing", "k_t", "k_n", "depth")), strict=True):
        slip, closing, k_t, k_n, depth = row
        if case["law"] == "jenkins":
            Q = slip[None]
            element = VectorJenkins(Q, Q.T, float(k_t), float(case["friction"] * k_n * depth))
        else:
            Q = np.stack([slip, closing])
            element = ElasticDryFriction2D(
                Q, Q.T, float(k_t), float(k_n), float(case["friction"]), u0=0.0, meso_gap=-float(depth)
            )
        found.add_nl_force(element)
    return found


def main(given, out):
    case = dict(np.load(given))
    case["law"] = str(case["law"])
    vib, h, Nt = system(case), np.arange(int(case["harmonics"]) + 1), int(case["samples"])
    n, count = len(case["mass"]), 2 * int(case["harmonics"]) + 1

    start = time.process_time()
    forces = vib.total_aft(case["trial"].ravel(), 1.0, h, Nt=Nt)[0]
    str(forces[0])
    compiled, start = time.process_time() - start, time.process_time()
    for _ in range(REPEATS):
        str(vib.total_aft(case["trial"].ravel(), 1.0, h, Nt=Nt)[1][0, 0])
    evaluation = (time.process_time() - start) / REPEATS

    Fl = np.zeros(count * n)
    Fl[:n] = case["static"]
    Fl[n : 2 * n] = case["mass"] @ case["shape"]
    U = np.zeros(count * n + 3)
    U[2 * n : 3 * n] = case["shape"]
    U[-3], U[-1] = case["frequency"], np.log10(case["low"])
    U[-2] = 2e-4 * U[-3]

    def residual(Uwxa, calc_grad=True):
        # VectorJenkins takes no calc_grad
        return vib.epmc_res(Uwxa, Fl, h, Nt=Nt, calc_grad=calc_grad or case["law"] == "jenkins")

    residual(U)
    first, last = np.log10(case["low"]), np.log10(case["high"])
    solver = NonlinearSolverOMP(
        config={
            "max_steps": 12,
            "reform_freq": 2,
            "verbose": False,
            "xtol": None,
            "rtol": 1e-9,
            "etol": None,
            "xtol_rel": 1e-6,
            "rtol_rel": None,
            "etol_rel": None,
            "stopping_tol": ["xtol"],
            "accepting_tol": ["xtol_rel", "rtol"],
        }
    )
    CtoP = hutils.harmonic_wise_conditioning(U, n, h, delta=1e-3)
    CtoP[:n] = np.abs(case["high"]) * 1e-2
    CtoP[-3:-1] = np.abs(U[-3:-1])
    CtoP[-1] = abs(last - first)
    config = {
        "DynamicCtoP": True,
        "TargetNfev": 4,
        "MaxSteps": int(case["most"]),
        "dsmin": 0.02,
        "dsmax": 0.175,
        "verbose": 0,
        "xtol": 1e-6 * np.sqrt(len(U)),
        "corrector": "Ortho",
        "nsolve_verbose": False,
        "FracLam": 0.5,
        "FracLamList": [0.9, 0.1, 1.0, 0.0],
        "backtrackStop": 0.05,
    }
    wall, start = time.perf_counter(), time.process_time()
    with contextlib.redirect_stdout(io.StringIO()):
        curve = Continuation(solver, ds0=0.08, CtoP=CtoP, config=config).continuation(residual, U, first, last)
    np.savez(
        out,
        forces=forces,
        compiled=compiled,
        evaluation=evaluation,
        seconds=time.process_time() - start,
        wall=time.perf_counter() - wall,
        amplitude=10 ** curve[:, -1],
        frequency=curve[:, -3],
        damping=curve[:, -2] / (2 * curve[:, -3]),
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
