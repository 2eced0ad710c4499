"""A preloaded structure with linear contact in CalculiX (`ccx`): the same mesh, stiffness per area and loads."""

import numpy as np

from tests.helpers.ccx import deck, run

SIDES = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))  # S1 to S6 of a brick


def surface(name, mesh, face):
    """A *SURFACE of element faces, matched by their corners."""
    wanted = {frozenset(nodes[:4]) for block in mesh.face(face) for nodes in block.tolist()}
    lines, number = [f"*SURFACE,NAME={name},TYPE=ELEMENT"], 0
    for blocks in mesh.parts.values():
        for cells in blocks:
            for nodes in cells:
                number += 1
                lines += [f"{number},S{k}" for k, side in enumerate(SIDES, 1) if frozenset(nodes[list(side)]) in wanted]
    assert len(lines) == 1 + len(wanted)
    return lines


def forces_card(force):
    """*CLOAD of nodal forces [N] (3n,)."""
    lines = ["*CLOAD"]
    for node, row in enumerate(force.reshape(-1, 3), 1):
        lines += [f"{node},{axis},{value:.12e}" for axis, value in enumerate(row, 1) if value]
    return lines


def solve(folder, mesh, materials, pairs, *, k_n, k_t, held, shrunk, temperature, forces):
    """Displacements [m] (3n,) after the bolts of the parts `shrunk` have cooled by `temperature`, and under each load.

    pairs: faces that touch; k_n, k_t [Pa/m]; held: nodes that are fixed; shrunk: parts that expand by 1e-5 1/K along z.
    """
    lines = []
    for k, (first, second) in enumerate(pairs):
        lines += surface(f"A{k}", mesh, first) + surface(f"B{k}", mesh, second)
        lines += ["*CONTACT PAIR,INTERACTION=BED,TYPE=SURFACE TO SURFACE", f"A{k},B{k}"]
    lines += ["*SURFACE INTERACTION,NAME=BED", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", f"{k_n * 1e-9:.9e}"]
    lines += ["*FRICTION", f"9.,{k_t * 1e-9:.9e}"]  # MPa/mm
    lines += ["*BOUNDARY", *(f"{node + 1},1,3" for node in held)]
    lines += ["*INITIAL CONDITIONS,TYPE=TEMPERATURE", "NALL,0."]
    for part in shrunk:
        lines += [f"*NSET,NSET=N{part.upper()}", *(f"{node + 1}," for node in mesh.part_nodes(part))]
    for number, force in enumerate([None, *forces]):
        lines += ["*STEP,INC=200", "*STATIC", "0.2,1.,1e-5,1."]
        lines += ["*TEMPERATURE", *(f"N{part.upper()},{-temperature:.12e}" for part in shrunk)]
        lines += forces_card(force) if force is not None else []
        lines += ["*NODE PRINT,NSET=NALL,FREQUENCY=1000", "U", "*END STEP"]
        assert number < 9
    text = deck(mesh, materials, step=lines)
    for part in shrunk:
        text = text.replace(f"*MATERIAL,NAME=M{part}\n", f"*MATERIAL,NAME=M{part}\n*EXPANSION,TYPE=ORTHO\n0.,0.,1e-5\n")
    run(folder, text)
    return read(folder, len(mesh.points))


def read(folder, nodes):
    """Displacements [m] at the end of each step."""
    out, rows = [], {}
    for line in [*(folder / "job.dat").read_text().splitlines(), "displacements end"]:
        words = line.split()
        if "displacements" in line:
            if rows:
                assert len(rows) == nodes
                out.append(np.array([rows[k + 1] for k in range(nodes)]).ravel() * 1e-3)
            rows = {}
        elif len(words) == 4 and words[0].isdigit():
            rows[int(words[0])] = [float(word) for word in words[1:]]
    return out
