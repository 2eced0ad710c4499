"""From a mesh to 15 elastic modes: Faying beside CalculiX and beside bare PARDISO, on the same meshes and springs.

    python benchmarks/structures.py [--sizes 40 55 150] [--large] [--million] [--three-million] [--no-ccx]

The T-specimen of the examples, meshed finer and finer (its holes need 55,000 unknowns at least; 40,000 are those of the
two blocks), with springs between the facing nodes of its joint. Every contender runs in a process of its own on one
thread; medians of the CPU seconds from the mesh in memory (for ccx: from its input file) to the frequencies, and the
peak of resident memory. Modules are imported and libraries loaded before that, by two cubes solved in the same way.
"bare" gets the matrices for nothing: pypardiso as it comes, and SciPy's eigsh. "ours" factorises in single precision,
as `faying run` does; "double" is the same in double, "parts" factorises part by part. Sizes in thousands of unknowns;
--large adds 500 and 675 (ccx up to 500), --million a bar of two parts with 1,078,110 unknowns, --three-million one of
six parts, for Faying alone, in 24 GB at most. Parts of these bars are alike; "distinct" factorises each of them by
itself and keeps the factors on the disk.
"""

import argparse
import json
import os
import pickle
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
ROOT = Path(__file__).parent.parent
# largest edge in the body and on the joint [mm] for thousands of unknowns
EDGES = {40: (5.7, 2.9), 55: (60.0, 30.0), 70: (18.0, 8.0), 150: (10.0, 4.8), 500: (5.8, 3.0), 675: (4.75, 2.5)}
MODES, K_N, K_T = 21, 4e13, 2e13
MILLION, THREE_MILLION = 1000, 3000
WHO = {MILLION: ["ours", "parts", "distinct"], THREE_MILLION: ["parts"]}


def meshed(size):
    from faying.case.case import checked_mesh
    from faying.study import Study

    if size == MILLION:
        return bar()
    if size == THREE_MILLION:
        return bar([0.3] * 6, [97] * 6, (20, 10))
    plan = Study.read(ROOT / "examples" / ("hammer-test" if size == 40 else "t-specimen") / "study.toml")
    edge, at_joint = EDGES[size]
    spec = replace(plan.geometry, size=edge * 1e-3, face_size={"upper.joint": at_joint * 1e-3})
    return checked_mesh(replace(plan, geometry=spec))


def bar(lengths=(0.3, 0.3), layers=(60, 60), section=(27, 13)):
    """Bars end to end, of bricks cut into tet10."""
    sys.path[:0] = [str(ROOT)]
    from tests.helpers.boxes import stack

    return stack(list(lengths), list(layers), width=0.06, height=0.025, sections=[section] * len(layers))


def faces(mesh):
    """Names of the faces of each joint."""
    if "upper.joint" in mesh.face_part:
        return [("upper.joint", "lower.joint")]
    return [(f"p{k}.right", f"p{k + 1}.left") for k in range(len(mesh.parts) - 1)]


def shift_frequency(mesh):
    """A frequency [Hz] below the elastic modes, longer bodies lower."""
    return 20.0 / mesh.size


def joined(mesh):
    """Matrices of the parts with the springs, by Faying."""
    import numpy as np

    import faying
    from faying.fe.elasticity import assemble
    from faying.fe.interface import join

    K, M = assemble(mesh, dict.fromkeys(mesh.parts, faying.CATALOGUE["45 steel"]), mass="stiffness")
    for pair in faces(mesh):
        nodes = join(mesh, *pair).at_nodes()
        ones = np.ones(len(nodes.weights))
        K = K + nodes.springs(K_N * ones, K_T * ones)
    return K, M


def double(mesh):
    from faying.numerics.modes import lowest_modes

    return solved(mesh, lowest_modes)


def ours(mesh):
    """As `faying run` does it: the factor in single precision, the modes refined in double."""
    from functools import partial

    from faying.fe.elasticity import rigid_motions
    from faying.numerics.modal_reanalysis import refined_modes

    return solved(mesh, partial(refined_modes, rigid=rigid_motions(mesh.points)))


def parts(mesh, alike=True):
    """As `faying run` does it where memory is short: each kind of part factorised by itself."""
    from functools import partial

    import numpy as np

    from faying.fe.elasticity import rigid_motions
    from faying.joint.assembled_parts import unknowns_of
    from faying.numerics.by_parts import PartByPart
    from faying.numerics.modal_reanalysis import refined_modes

    way = PartByPart(
        [unknowns_of(mesh.part_nodes(part)) for part in mesh.parts],
        np.zeros(0, dtype=int),
        rigid_motions(mesh.points),
        stored=None if alike else True,
        alike=alike,
    )
    return solved(mesh, partial(refined_modes, rigid=rigid_motions(mesh.points), solver=way))


def distinct(mesh):
    return parts(mesh, alike=False)


def solved(mesh, modes):
    begin = time.process_time()
    K, M = joined(mesh)
    middle = time.process_time()
    found = modes(K, M, MODES, shift_frequency=shift_frequency(mesh))
    end = time.process_time()
    return {
        "cpu": end - begin,
        "modes": end - middle,
        "factor_gb": found.factorisation.memory / 1e9,
        "frequencies": found.frequencies.tolist(),
    }


def bare(mesh):
    import numpy as np
    from pypardiso import PyPardisoSolver
    from scipy.sparse import csr_matrix, triu
    from scipy.sparse.linalg import LinearOperator, eigsh

    K, M = joined(mesh)
    begin = time.process_time()
    shift = (2 * np.pi * shift_frequency(mesh)) ** 2
    upper = csr_matrix(triu(K + shift * M, format="csr"))
    solver = PyPardisoSolver(mtype=2)
    solver._check_A(upper)
    solver.set_phase(12)
    solver._call_pardiso(upper, np.zeros((K.shape[0], 1)))
    solver.set_phase(33)
    inverse = LinearOperator(K.shape, matvec=lambda x: solver._call_pardiso(upper, x), dtype=float)
    values, _ = eigsh(K, k=MODES, M=M, sigma=-shift, OPinv=inverse)
    end = time.process_time()
    return {
        "cpu": end - begin,
        "modes": end - begin,
        "frequencies": (np.sqrt(np.abs(np.sort(values))) / 2 / np.pi).tolist(),
    }


ALONE = {"ours": ours, "double": double, "bare": bare, "parts": parts, "distinct": distinct}


def calculix(mesh, folder):
    sys.path[:0] = [str(ROOT)]
    import faying
    from faying.fe.interface import join
    from tests.helpers import ccx

    nodes = join(mesh, *faces(mesh)[0]).at_nodes()
    axis = abs(nodes.normals[0]).argmax()
    springs = [
        (int(a), int(b), [(K_N if k == axis else K_T) * w for k in range(3)])
        for a, b, w in zip(nodes.first_nodes[:, 0], nodes.second_nodes[:, 0], nodes.weights, strict=True)
    ]
    step = ["*STEP", "*FREQUENCY,SOLVER=ARPACK", f"{MODES}", "*END STEP"]
    text = ccx.deck(mesh, dict.fromkeys(mesh.parts, faying.CATALOGUE["45 steel"]), springs, step=step)
    ccx.run(folder, text)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {
        "cpu": used.ru_utime + used.ru_stime,
        "peak_gb": used.ru_maxrss * 1024 / 1e9,
        "frequencies": ccx.frequencies(folder)[:MODES].tolist(),
    }


def measured(who, path):
    """Run one contender in a process of its own."""
    done = subprocess.run(
        [sys.executable, __file__, "--one", who, str(path)], capture_output=True, text=True, check=False
    )
    if done.returncode:
        return {"cpu": float("nan"), "fault": (done.stderr.strip().splitlines() or ["?"])[-1]}
    return json.loads(done.stdout.splitlines()[-1])


def one(who, path):
    mesh = pickle.loads(Path(path).read_bytes())
    if who != "ccx":  # imports are not what is measured
        ALONE[who](bar(layers=(4, 4), section=(2, 2)))
    with tempfile.TemporaryDirectory() as folder:
        if who != "ccx" and mesh.unknowns > 1e6:
            resource.setrlimit(resource.RLIMIT_AS, (24_000_000_000, 24_000_000_000))
        out = ALONE[who](mesh) if who != "ccx" else calculix(mesh, Path(folder))
    out.setdefault("peak_gb", resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9)
    print(json.dumps(out))


def compare(size, repeats, with_ccx):
    import numpy as np

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh"
        mesh = meshed(size)
        path.write_bytes(pickle.dumps(mesh))
        print(f"{mesh.unknowns:,} unknowns", flush=True)
        who = WHO.get(size, ["ours", "double", "parts", "bare", *(["ccx"] if with_ccx else [])])
        rows = {}
        for name in who:
            runs = [measured(name, path) for _ in range(repeats)]
            rows[name] = runs[-1] | {
                key: statistics.median(run[key] for run in runs) for key in ("cpu", "modes") if key in runs[-1]
            }
            row = rows[name]
            if "fault" in row:
                print(f"  {name}: {row['fault']}", flush=True)
                continue
            if name == who[0]:
                print(
                    f"  {name:8s} {row['cpu']:7.1f} CPU s, of them modes {row['modes']:7.1f}; "
                    f"peak {row['peak_gb']:.2f} GB, factor estimated {row['factor_gb']:.2f} GB",
                    flush=True,
                )
                continue
            mine = rows[who[0]]["modes" if name == "bare" else "cpu"]
            elastic = slice(6, None)
            differ = np.abs(
                np.array(row["frequencies"])[elastic] / np.array(rows[who[0]]["frequencies"])[elastic] - 1
            ).max()
            print(
                f"  {name:8s} {row['cpu']:7.1f} CPU s; {who[0]} takes {mine / row['cpu']:.3f} of it; peak "
                f"{row['peak_gb']:.2f} GB; "
                f"frequencies differ by {differ:.1e}",
                flush=True,
            )


def main():
    ask = argparse.ArgumentParser()
    ask.add_argument("--sizes", type=int, nargs="*", default=[40, 55, 150], choices=sorted(EDGES))
    ask.add_argument("--large", action="store_true")
    ask.add_argument("--million", action="store_true")
    ask.add_argument("--three-million", action="store_true")
    ask.add_argument("--no-ccx", action="store_true")
    ask.add_argument("--repeats", type=int, default=3)
    ask.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    given = ask.parse_args()
    if given.one:
        one(*given.one)
        return
    large = ((500, 675) if given.large else ()), ((MILLION,) if given.million else ())
    for size in [*given.sizes, *large[0], *large[1], *((THREE_MILLION,) if given.three_million else ())]:
        compare(size, 1 if size > 200 else given.repeats, not given.no_ccx and size <= 500)


if __name__ == "__main__":
    main()
