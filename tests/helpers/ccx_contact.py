"""A preloaded structure with linear contact in CalculiX (`ccx`): the same mesh, stiffness per area and loads."""

import re
from dataclasses import replace

import numpy as np

import faying
from faying.case.acting import acting
from faying.fe.elements import FACES, SOLIDS
from faying.fe.interface import join
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.structure import Structure
from tests.helpers.bars import even
from tests.helpers.ccx import deck, run
from tests.helpers.sides import sides_on
from tests.helpers.voxels import bolted

K_N, K_T = 2e13, 1e13  # Pa/m, of every face that touches
STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0, expansion=1e-5)

STICKS = 9.0  # friction [-] of faces that stick


def surface(name, mesh, face):
    """A *SURFACE of element faces, matched by their corners."""
    wanted = {
        frozenset(nodes[: FACES[block.shape[1]].corners]) for block in mesh.face(face) for nodes in block.tolist()
    }
    lines, number = [f"*SURFACE,NAME={name},TYPE=ELEMENT"], 0
    for blocks in mesh.parts.values():
        for cells in blocks:
            sides = [list(side) for side in SOLIDS[cells.shape[1]].shape.sides]
            for nodes in cells:
                number += 1
                lines += [f"{number},S{k}" for k, side in enumerate(sides, 1) if frozenset(nodes[side]) in wanted]
    assert len(lines) == 1 + len(wanted)
    return lines


def forces_card(force):
    """*CLOAD of nodal forces [N] (3n,), in place of those of the step before."""
    lines = ["*CLOAD,OP=NEW"]
    for node, row in enumerate(force.reshape(-1, 3), 1):
        lines += [f"{node},{axis},{value:.12e}" for axis, value in enumerate(row, 1) if value]
    return lines


def solve(folder, mesh, materials, pairs, *, held, shrunk, temperature, loads, friction):
    """Displacements [m] (3n,) after the bolts of the parts `shrunk` have cooled by `temperature`, and under each load.

    pairs: faces that touch; held: nodes that are fixed; shrunk: parts that expand by 1e-5 1/K along z;
    loads: for each step after the first, nodal forces [N] (3n,) and the rise of temperature [K] of each warm part;
    friction: of the first pair [-], while the others stick.
    """
    lines = []
    for k, (first, second) in enumerate(pairs):
        lines += surface(f"A{k}", mesh, first) + surface(f"B{k}", mesh, second)
        lines += [f"*CONTACT PAIR,INTERACTION=BED{k},TYPE=SURFACE TO SURFACE", f"A{k},B{k}"]
    for k in range(len(pairs)):
        lines += [f"*SURFACE INTERACTION,NAME=BED{k}", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR"]
        lines += [f"{K_N * 1e-9:.9e}", "*FRICTION", f"{friction if k == 0 else STICKS},{K_T * 1e-9:.9e}"]  # MPa/mm
    lines += ["*BOUNDARY", *(f"{node + 1},1,3" for node in held)]
    lines += ["*INITIAL CONDITIONS,TYPE=TEMPERATURE", "NALL,0."]
    warm = sorted({part for _, rise in loads for part in rise})
    for part in (*shrunk, *warm):
        lines += [f"*NSET,NSET=N{part.upper()}", *(f"{node + 1}," for node in mesh.part_nodes(part))]
    assert len(loads) < 9
    for force, rise in [(None, {}), *loads]:
        lines += ["*STEP,INC=200", "*STATIC", "0.2,1.,1e-5,1."]
        lines += ["*TEMPERATURE", *(f"N{part.upper()},{-temperature:.12e}" for part in shrunk)]
        lines += [f"N{part.upper()},{rise.get(part, 0.0):.12e}" for part in warm]
        if force is not None:
            lines += forces_card(force)
        lines += ["*NODE PRINT,NSET=NALL,FREQUENCY=1000", "U", "*END STEP"]
    text = deck(mesh, materials, step=lines)
    for part in shrunk:
        text = text.replace(f"*MATERIAL,NAME=M{part}\n", f"*MATERIAL,NAME=M{part}\n*EXPANSION,TYPE=ORTHO\n0.,0.,1e-5\n")
    for part in warm:
        text = text.replace(
            f"*MATERIAL,NAME=M{part}\n", f"*MATERIAL,NAME=M{part}\n*EXPANSION\n{materials[part].expansion}\n"
        )
    run(folder, text)
    return read(folder, len(mesh.points))


def preloaded(folder, mesh, materials, pairs, *, k_n, k_t, held, force, modes):
    """Displacements [m] (3n,) under nodal forces [N] (3n,), and frequencies [Hz] about that state.

    held: unknowns that are at rest, in both steps; modes: how many, 0 for none.
    """
    lines = []
    for k, (first, second) in enumerate(pairs):
        lines += surface(f"A{k}", mesh, first) + surface(f"B{k}", mesh, second)
        lines += ["*CONTACT PAIR,INTERACTION=BED,TYPE=SURFACE TO SURFACE", f"A{k},B{k}"]
    lines += ["*SURFACE INTERACTION,NAME=BED", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", f"{k_n * 1e-9:.9e}"]
    lines += ["*FRICTION", f"9.,{k_t * 1e-9:.9e}"]  # MPa/mm
    lines += ["*BOUNDARY", *(f"{one // 3 + 1},{one % 3 + 1}" for one in held)]
    lines += ["*STEP,INC=200", "*STATIC", "1.,1.,1e-5,1.", *forces_card(force)]
    lines += ["*NODE PRINT,NSET=NALL,FREQUENCY=1000", "U", "*END STEP"]
    if modes:
        lines += ["*STEP,PERTURBATION", "*FREQUENCY,SOLVER=ARPACK", f"{modes}", "*END STEP"]
    run(folder, deck(mesh, materials, step=lines))
    found = re.findall(r"^ +\d+(?: +\S+)? +\S+ +(\S+) +0\.0000000E\+00$", (folder / "job.dat").read_text(), re.M)
    return read(folder, len(mesh.points))[0], np.array([float(value) for value in found])


def read(folder, nodes):
    """Displacements [m] at the end of each step; lines behind the last node, such as eigenvalues, do not count."""
    out, rows = [], None
    for line in (folder / "job.dat").read_text().splitlines():
        words = line.split()
        if "displacements" in line:
            assert rows is None
            rows = {}
        elif rows is not None and len(words) == 4 and words[0].isdigit():
            rows[int(words[0])] = [float(word) for word in words[1:]]
            if len(rows) == nodes:
                out.append(np.array([rows[k + 1] for k in range(nodes)]).ravel() * 1e-3)
                rows = None
    assert rows is None
    return out


def at(axis, place, within=None):
    """Which nodes lie in a plane, and in a strip about the middle along x."""

    def on(points):
        there = np.abs(points[:, axis] - place) < 1e-9
        return there if within is None else there & (np.abs(points[:, 0] - within[0]) < within[1])

    return on


def structure(mesh, ends, *, held, friction=None):
    """The plates and bolts of `voxels.bolted`, and the pairs of faces that touch, that of the plates first.

    ends: further faces, by name: their part, and which of its nodes (n, 3) they have; held: the one that is fixed;
    friction: between the plates; heads and nuts stick.
    """
    faces, owner = dict(mesh.faces), dict(mesh.face_part)
    for name, (part, on) in ends.items():
        nodes = mesh.part_nodes(part)
        faces[name] = sides_on(nodes[on(mesh.points[nodes])], mesh.parts[part], len(mesh.points))
        owner[name] = part
    mesh = replace(mesh, faces=faces, face_part=owner)
    bolts = [part for part in mesh.parts if part.startswith("bolt")]
    pairs = [("lower.joint", "upper.joint")]
    for k, bolt in enumerate(bolts):
        pairs += [(f"{bolt}.head", f"upper.seat{k}"), (f"{bolt}.nut", f"lower.seat{k}")]
    joints = [
        FittedJoint(
            name=first,
            faces=(first, second),
            interface=join(mesh, first, second),
            law=even(K_N, K_T),
            friction=friction if first == "lower.joint" else None,
        )
        for first, second in pairs
    ]
    made = Structure(
        mesh=mesh,
        materials=dict.fromkeys(mesh.parts, STEEL),
        joints=joints,
        bolts=[faying.SolidBolt(name=bolt, part=bolt, faces=(f"{bolt}.head", f"{bolt}.nut")) for bolt in bolts],
        supports=[Support(face=held)],
    )
    return made, pairs


def pried_bolt():
    """Structure, pairs of faces and loads: an end of the lower plate is held, the far end of the upper one pulled."""
    mesh = bolted(places=((0.02, 0.02),), length=0.06, kind="hex20")
    ends = {"lower.end": ("lower", at(0, 0.0)), "upper.end": ("upper", at(0, 0.06))}
    loads = [
        faying.Load(f"{force:g} N", forces=[faying.Force("upper.end", force=(0, 0, force))])
        for force in (400.0, 1200.0)
    ]
    return *structure(mesh, ends, held="lower.end"), loads


def answers(folder, made, pairs, preload, loads):
    """Forces of the bolts [N] (1 + loads, bolts), motions since the preload [m] and openings of the plates [m] by ccx.

    The bolts cool along their axes until they carry the preload [N]; the loads follow, one after the other.
    """
    acts, names = acting(made, loads), [bolt.name for bolt in made.bolts]
    cold = [acting(made, [faying.Load("c", temperature={name: -1.0})])["c"].force for name in names]
    # they cool along z alone, which takes (1 - nu)/(1 + nu) of the stress along z of a cooling in all directions
    alone = (1 - STEEL.nu) / (1 + STEEL.nu)
    tied = made.joints[0].friction

    def tension(u, temperature):
        pairs = zip(made.fitted_bolts, cold, strict=True)
        return np.array([fitted.pull @ u - temperature * alone * (fitted.drawn @ one) for fitted, one in pairs])

    def run_at(temperature, steps):
        return solve(
            folder,
            made.mesh,
            made.materials,
            pairs,
            held=made.mesh.face_nodes(made.supports[0].face),
            shrunk=names,
            temperature=temperature,
            loads=steps,
            friction=STICKS if tied is None else tied,
        )

    first = 100.0
    (u,) = run_at(first, [])
    right = first * preload / tension(u, first).mean()  # linear: nothing opens on the way
    steps = [
        (np.zeros_like(u) if load.temperature else acts[load.name].force, dict(load.temperature)) for load in loads
    ]
    rest, *moved = run_at(right, steps)
    forces = np.array([tension(one, right) for one in (rest, *moved)])
    openings = [made.joints[0].interface.opening(one) for one in moved]
    return forces, [one - rest for one in moved], openings
