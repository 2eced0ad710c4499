"""Ten load cases against two preloads of the same study, on one thread.

    python benchmarks/loads.py [--size 12 6] [--friction 0.2]

The lapped plates of the examples, one end held, meshed at each size [mm]. Two preloads are two solutions from the
unloaded state, each with its own factorisations. The ten cases are forces along all axes at the free end, up to half of
the preload of a bolt, an acceleration and combinations, solved about the preload. They need one factorisation, which
is that of the modes where these are asked for. CPU seconds.
"""

import argparse
import os
import sys
import time
from dataclasses import replace
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
ROOT = Path(__file__).parent.parent
HELD = {"part": "lower", "normal": "-x"}
FREE = {"part": "upper", "normal": "+x"}


def study(size, friction):
    import tomllib

    from faying.study import Study

    file = ROOT / "examples" / "plates-and-bolts" / "plates.toml"
    data = tomllib.loads(file.read_text())
    data["geometry"]["size"] = f"{size} mm"
    data["geometry"]["face_size"] = {"upper.joint": f"{0.4 * size} mm"}
    data["support"] = [{"face": HELD}]
    data["joint"][0]["form"] = {"flat": True}
    if friction:
        data["joint"][0]["friction"] = friction
    data["bolt"] = [bolt | {"preload": "16 kN"} for bolt in data["bolt"]]
    cases = []
    for axis, most in (("x", 8000.0), ("y", 800.0), ("z", 800.0)):
        for share in (0.1, 1.0):
            parts = [f"{share * most} N" if one == axis else "0 N" for one in "xyz"]
            cases.append({"name": f"{axis} {share}", "force": [{"face": FREE, "force": parts}]})
    cases.append({"name": "100 g", "acceleration": ["0 m/s^2", "0 m/s^2", "981 m/s^2"]})
    cases.append({"name": "x and z", "combine": {"x 1.0": 1.0, "z 1.0": 1.0}})
    cases.append({"name": "x and -z", "combine": {"x 1.0": 1.0, "z 1.0": -1.0}})
    cases.append({"name": "all", "combine": {"x 1.0": 0.5, "y 1.0": 0.5, "100 g": 1.0}})
    return Study.from_dict(data | {"load": cases}, folder=file.parent)


def timed(work):
    start = time.process_time()
    out = work()
    return out, time.process_time() - start


def main():
    from faying.case.case import Case, Progress
    from faying.loads import solve

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=float, nargs="+", default=[12.0, 6.0])
    parser.add_argument("--friction", type=float)
    options = parser.parse_args()
    for size in options.size:
        plan = study(size, options.friction)
        bare = replace(plan, modes=replace(plan.modes, levels=(), intervals=False))
        case = Case.of(bare)
        case.structure.dynamic_matrices, case.structure.loads  # noqa: B018  # assembled before the clock runs
        case.engine("reanalysis").preload(0)  # libraries, and the table of the law
        state, first = timed(lambda case=case: case.engine("reanalysis").preload(0))
        engine = case.engine("reanalysis")
        _, second = timed(lambda engine=engine: engine.preload(0))

        springs = case.structure.springs(state.pressures)
        base, factor = timed(lambda c=case, s=state, k=springs, e=engine: solve.preloaded_case(c, s, k, e, modes=False))
        found, ten = timed(lambda base=base, plan=plan: solve.answers(base, plan.load_cases, Progress(0)))
        print(
            f"{case.structure.mesh.unknowns:7,} unknowns: two preloads {first + second:.2f} s, factorisation "
            f"{factor:.2f} s, ten cases {ten:.2f} s; opened up to {found.opened.max():.0%}, superposition off by up "
            f"to {found.superposition.max():.0%}"
        )


if __name__ == "__main__":
    sys.exit(main())
