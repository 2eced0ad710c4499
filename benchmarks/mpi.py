"""Modes over the processes of mpiexec beside one factorisation: memory and CPU time of each process, iterations.

    python benchmarks/mpi.py [--sizes 20 60 200 500] [--processes 2] [--stiffness 4e13] [--alone]

A bar of two parts with springs between their facing nodes, as in structures.py, meshed finer and finer; 15 elastic
modes. Sizes in thousands of unknowns. "direct" is `lowest_modes`, in the process of the benchmark; --alone leaves it
out. Root and small machines: Open MPI asks for OMPI_ALLOW_RUN_AS_ROOT=1, OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 and
OMPI_MCA_rmaps_base_oversubscribe=1 in the environment.
"""

import argparse
import time

import numpy as np
import structures

SIZES = {20: (16, (7, 3)), 60: (22, (10, 5)), 200: (34, (15, 7)), 500: (46, (21, 10))}


def row(size, processes, alone):
    from faying.export.modes_over_mpi import modes_over_mpi
    from faying.numerics.modes import lowest_modes

    layers, section = SIZES[size]
    mesh = structures.bar(layers=(layers, layers), section=section)
    K, M = structures.joined(mesh)
    shift = structures.shift_frequency(mesh)
    found, solver = modes_over_mpi(
        K, M, structures.MODES, shift_frequency=shift, processes=processes, points=mesh.points
    )
    cpu, peak = (", ".join(f"{value:.3g}" for value in values) for values in (solver.cpu, solver.peak / 1e9))
    print(
        f"| {K.shape[0]:,} | {solver.solutions} | {solver.steps} | {cpu} s | {peak} GB | {found.error.max() / 2:.1e} ",
        end="",
        flush=True,
    )
    if alone:
        print("|", flush=True)
        return
    begin = time.process_time()
    direct = lowest_modes(K, M, structures.MODES, shift_frequency=shift)
    apart = np.abs(found.frequencies[6:] / direct.frequencies[6:] - 1).max()
    print(
        f"| {apart:.1e} | {time.process_time() - begin:.3g} s | {direct.factorisation.memory / 1e9:.3g} GB |",
        flush=True,
    )


def main():
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--sizes", type=int, nargs="+", default=list(SIZES), choices=list(SIZES))
    ask.add_argument("--processes", type=int, default=2)
    ask.add_argument("--stiffness", type=float, default=structures.K_N, help="of the joint [Pa/m]")
    ask.add_argument("--alone", action="store_true")
    given = ask.parse_args()
    structures.K_N, structures.K_T = given.stiffness, given.stiffness / 2
    print(
        "| unknowns | solutions | iterations | CPU of each process | peak of each | estimated error | against direct "
        "| direct, CPU | its factor |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for size in given.sizes:
        row(size, given.processes, given.alone)


if __name__ == "__main__":
    main()
