"""The same mesh in CalculiX: writes the input, runs ccx, reads matrices and frequencies."""

import os
import subprocess

import numpy as np

ELEMENT = {"tet4": "C3D4", "tet10": "C3D10", "hex8": "C3D8I", "hex20": "C3D20", "wedge6": "C3D6", "wedge15": "C3D15"}


def deck(mesh, materials, springs=(), *, step):
    """Lengths in mm, stresses in MPa, tonnes: CalculiX is meant for such numbers. springs: (node, node, N/m x3)."""
    from faying.fe.solids import kind_of

    lines = ["*NODE,NSET=NALL"]
    lines += [f"{i + 1},{x:.12e},{y:.12e},{z:.12e}" for i, (x, y, z) in enumerate(mesh.points * 1e3)]
    number = 0
    for part, blocks in mesh.parts.items():
        for cells in blocks:
            lines.append(f"*ELEMENT,TYPE={ELEMENT[kind_of(cells)]},ELSET={part.upper()}")
            for nodes in cells + 1:
                number += 1
                words = [str(number), *map(str, nodes)]
                lines += [",".join(words[k : k + 10]) + "," * (k + 10 < len(words)) for k in range(0, len(words), 10)]
    for part in mesh.parts:
        m = materials[part]
        lines += [
            f"*MATERIAL,NAME=M{part}",
            "*ELASTIC",
            f"{m.E * 1e-6:.12e},{m.nu}",
            "*DENSITY",
            f"{m.density * 1e-12:.12e}",
        ]
        lines += [f"*SOLID SECTION,ELSET={part.upper()},MATERIAL=M{part}"]
    for i, (a, b, stiffness) in enumerate(springs):
        for axis, k in enumerate(stiffness):
            number += 1
            lines += [f"*ELEMENT,TYPE=SPRING2,ELSET=S{i}_{axis}", f"{number},{a + 1},{b + 1}"]
            lines += [f"*SPRING,ELSET=S{i}_{axis}", f"{axis + 1},{axis + 1}", f"{k * 1e-3:.12e}"]
    return "\n".join([*lines, *step]) + "\n"


def held_step(fixed, count):
    """The first modes with unknowns (of 3n) that are at rest."""
    held = [f"{one // 3 + 1},{one % 3 + 1}" for one in fixed]
    return ["*BOUNDARY", *held, "*STEP", "*FREQUENCY,SOLVER=ARPACK", f"{count}", "*END STEP"]


def run(folder, text):
    """Run ccx in `folder` on the input and return what it printed."""
    (folder / "job.inp").write_text(text)
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}
    done = subprocess.run(["ccx", "job"], cwd=folder, capture_output=True, text=True, env=environment, check=False)
    assert "Job finished" in done.stdout or (folder / "job.sti").exists(), done.stdout[-3000:]
    return done.stdout


def frequencies(folder):
    """Frequencies [Hz] from job.dat; rigid motions come as small or imaginary numbers."""
    out = []
    for line in (folder / "job.dat").read_text().splitlines():
        words = line.split()
        if len(words) == 5 and words[0].isdigit():
            out.append(float(words[3]))
        elif out and line.strip().startswith("P A R T"):
            break
    return np.array(out)
