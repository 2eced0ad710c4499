"""Three preloads with contact, each with 15 elastic modes about it: Faying beside CalculiX on the same mesh and law.

    python benchmarks/contact_preload.py [--size 55] [--most 15]

The flat T-specimen under the JK law, in a process of its own each, on one thread. CalculiX gets the deck that `faying
attach` writes (node to surface, the law as a table), a *STATIC step for each preload and a *FREQUENCY step about it.
Its tangential stiffness is the law's at the mean pressure of 8 kN, that of Faying the law's at each point. Both count
from their input files. Sizes as in structures.py. CalculiX is stopped after `--most` times the CPU time of Faying, and
what it has of the first preload is told: then that many times is a lower bound.
"""

import argparse
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
ROOT = Path(__file__).parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]

FACES = ("upper.joint", "lower.joint")
LOADS = ("4 kN", "8 kN", "12 kN")
MODES = 15
STUDY = """[geometry]
mesh = "model.inp"
unit = "mm"
[part.upper]
material = "45 steel"
[part.lower]
material = "45 steel"
[surface]
D = 2.39
G = "1.53e-10 m"
scan_area = "16 mm^2"
[[joint]]
name = "flange"
faces = ["upper.joint", "lower.joint"]
friction = 0.9
[[bolt]]
faces = ["upper.seat.left", "lower.seat.left"]
preload = {loads}
[[bolt]]
faces = ["upper.seat.right", "lower.seat.right"]
preload = {loads}
[modes]
count = {modes}
"""


def study_in(folder, loads=LOADS):
    """The study on the mesh that stands in a folder."""
    import faying

    text = STUDY.replace("{loads}", json.dumps(list(loads))).replace("{modes}", str(MODES))
    (folder / "study.toml").write_text(text)
    return faying.Study.read(folder / "study.toml")


def ours(folder):
    """Preloads and modes at three loads, as `faying run` solves them."""
    from faying.case.case import Case, Progress
    from faying.case.solve import solve

    begin = time.process_time()
    case = Case.of(study_in(folder))
    engine = case.engine("reanalysis")
    states = [solve(case, k, engine, Progress(0), ranges=False) for k in range(len(LOADS))]
    return {
        "cpu": time.process_time() - begin,
        "peak_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9,
        "frequencies": [s.damped.frequencies.tolist() for s in states],
        "unknowns": case.structure.mesh.unknowns,
    }


def calculix(folder):
    """The same by ccx, whose input file Faying writes."""
    import numpy as np

    from faying.case.case import build
    from faying.decks import calculix as deck
    from faying.export.attach import attach
    from tests.helpers import ccx

    study = study_in(folder, LOADS[1:2])
    found = attach(folder / "model.inp", FACES, unit="mm", study=study, pressure="solve")
    structure = build(study)
    mesh = structure.mesh
    n = mesh.numbers
    steel = structure.materials["upper"]
    names = {name: name.replace(".", "_") for name in FACES}
    text = (folder / "model.inp").read_text().replace(",\n elset=", ",elset=")
    contact = deck.contact(found.deck)
    for old, new in names.items():
        text, contact = text.replace(old, new), contact.replace(old, new)
    lines = [text]
    for part in mesh.parts:
        lines += [f"*MATERIAL,NAME=M{part}", "*ELASTIC", f"{steel.E * 1e-6:.12e},{steel.nu}"]
        lines += ["*DENSITY", f"{steel.density * 1e-12:.12e}", f"*SOLID SECTION,ELSET={part},MATERIAL=M{part}"]
    # three nodes of the upper stem's end hold the rigid motions; the forces of the bolts balance
    end = np.flatnonzero(mesh.points[:, 2] > mesh.points[:, 2].max() - 1e-6)
    x, y = mesh.points[end, 0], mesh.points[end, 1]
    corner = [end[np.argmin(x + y)], end[np.argmax(x - y)], end[np.argmax(y - x)]]
    lines += [contact, "*BOUNDARY", f"{n[corner[0]]},1,3", f"{n[corner[1]]},2,3", f"{n[corner[2]]},3,3"]
    for load in LOADS:
        force = float(load.split()[0]) * 1e3 * structure.loads.sum(axis=1)
        lines += ["*STEP,INC=500", "*STATIC", "0.25,1.", "*CLOAD,OP=NEW"]
        lines += [f"{n[i // 3]},{i % 3 + 1},{f:.12e}" for i, f in enumerate(force) if f]
        lines += ["*NODE FILE", "U", "*END STEP"]
        lines += ["*STEP,PERTURBATION", "*FREQUENCY,SOLVER=ARPACK", str(MODES), "*END STEP"]
    begin = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        ccx.run(folder, "\n".join(lines) + "\n")
    except AssertionError:  # out of time
        return {"cpu": None, "steps": (folder / "job.sta").read_text().splitlines()[2:]}
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    dat = (folder / "job.dat").read_text()
    found = [float(v) for v in re.findall(r"^ +\d+(?: +\S+)? +\S+ +(\S+) +0\.0000000E\+00$", dat, re.M)]
    return {
        "cpu": used.ru_utime + used.ru_stime - begin.ru_utime - begin.ru_stime,
        "peak_gb": used.ru_maxrss * 1024 / 1e9,
        "frequencies": np.array(found).reshape(len(LOADS), -1).tolist(),
    }


def main():
    """Print both as a table."""
    import numpy as np

    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--size", type=int, default=55, help="thousands of unknowns: 55, 70, 150")
    ask.add_argument("--most", type=float, default=15, help="times the CPU time of Faying after which ccx is stopped")
    ask.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    ask.add_argument("--seconds", type=int, help=argparse.SUPPRESS)
    given = ask.parse_args()
    if given.seconds:  # for ccx, which inherits it; this process takes few
        resource.setrlimit(resource.RLIMIT_CPU, (given.seconds, resource.RLIM_INFINITY))
    if given.one:
        print(json.dumps({"ours": ours, "ccx": calculix}[given.one[0]](Path(given.one[1]))))
        return
    from structures import meshed

    from tests.helpers import meshfiles

    with tempfile.TemporaryDirectory() as place:
        (Path(place) / "model.inp").write_text(meshfiles.abaqus(meshed(given.size)))
        rows = {}
        for who in ("ours", "ccx"):
            command = [sys.executable, __file__, "--one", who, place]
            if who == "ccx":
                most = round(given.most * rows["ours"]["cpu"])
                command += ["--seconds", str(most)]
            done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
            rows[who] = json.loads(done.stdout.splitlines()[-1])
            if rows[who]["cpu"] is None:
                print(f"ccx was stopped after {most} CPU s, {given.most:g} times ours. Increments that it had done:")
                print("\n".join(rows[who]["steps"]) or "none")
                return
            print(f"{who:5s} {rows[who]['cpu']:8.1f} CPU s, peak {rows[who]['peak_gb']:.2f} GB", flush=True)
        a, b = (np.array(rows[who]["frequencies"]) for who in ("ours", "ccx"))
        b = b[:, -a.shape[1] :]
        print(f"{rows['ours']['unknowns']:,} unknowns; ccx takes {rows['ccx']['cpu'] / rows['ours']['cpu']:.1f} times")
        print("frequencies differ by", np.abs(b / a - 1).max(axis=1))


if __name__ == "__main__":
    main()
