"""The same mesh, materials and contact history in CalculiX (`ccx`), for comparison.

CalculiX gets, step by step, the heights of the nodes that touch the plane and finds everything else itself: plastic
flow, reactions, and the heights of the free nodes, which tell whether the contact was the right one.

Its CAX4 is the fully integrated element, without a mean dilatation, and it cuts our load steps in two unless told to
take each in one increment; both change the force by up to 2 % on meshes of 8 to 16 elements over the contact radius.
With `plain` elements on our side and one increment a step the two programs solve the same equations.
"""

import os
import subprocess
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from asperity_fe.body import CapState
from asperity_fe.mesh import cap_mesh
from asperity_fe.model import build


@dataclass(frozen=True)
class Seen:
    force: float  # [N]
    lowest_reaction: float  # of the touching nodes, over their mean; negative pulls
    penetration: float  # of free nodes into the plane, over the displacement
    seconds: float  # CPU time


def history(model, displacement, steps):
    """Our own run: nodes and displacements of the plane, step by step, and the last force."""
    state, at, out = model.body.virgin, None, []
    for d in np.linspace(0, np.sqrt(displacement), steps + 1)[1:] ** 2:
        at = model.press(float(d), at, state)
        state = CapState(plastic=at.balance.returned.plastic, hardened=at.balance.returned.hardened)
        out.append((float(d), model.body.surface[at.pressing]))
    return out, model.contact(at).force


def table_1_model(R, h_a, ratio, elements, material):
    """A row of Table 1, meshed more coarsely."""
    cap, below = material(100e9 * ratio), material(100e9)
    a = np.sqrt(2 * R * 0.1 * h_a / (1 + 0.24 * ratio))
    domain = 20 * np.sqrt(2 * R * h_a)
    return build(
        mesh=cap_mesh(R=R, h_a=h_a, contact_radius=float(a), elements=elements, domain=domain),
        h_a=h_a,
        materials=(cap, cap, below),
        hardening=(0.0,) * 3,
        sliding=False,
        contact_radius=float(a),
        solver=None,
    )


def sphere_model(displacement, elements, material):
    """Half of a sphere of 1 mm radius on a sliding foot, meshed for a contact at full plastic flow; all may yield."""
    a = float(np.sqrt(1.85 * 1e-3 * displacement))
    model = build(
        mesh=cap_mesh(R=1e-3, h_a=1e-3, contact_radius=a, elements=elements, domain=None),
        h_a=1e-3,
        materials=(material(100e9),) * 3,
        hardening=(0.0,) * 3,
        sliding=True,
        contact_radius=a,
        solver=None,
    )
    return replace(model, plastic_radius=np.inf)


def deck(model, touching, *, element="CAX8R", large=False, increments=2):
    """Write the input: lengths in um, stresses in MPa, so forces in uN."""
    mesh = model.mesh
    nodes = [tuple(p) for p in mesh.nodes * 1e6]
    middle = {}

    def between(a, b):
        key = (min(a, b), max(a, b))
        if key not in middle:
            middle[key] = len(nodes)
            nodes.append(tuple((np.array(nodes[a]) + nodes[b]) / 2))
        return middle[key]

    # the elements at the rim, where two corners meet, are triangles
    corners = [list(dict.fromkeys(map(int, q))) for q in mesh.quads]
    quads = corners
    if element.startswith("CAX8"):
        quads = [[*q, *(between(q[i], q[(i + 1) % len(q)]) for i in range(len(q)))] for q in corners]
    lines = ["*NODE", *(f"{i + 1},{r:.12g},{z:.12g},0." for i, (r, z) in enumerate(nodes))]
    for body in np.unique(mesh.body):
        for kind, count in ((element, 4), ("CAX6" if element.startswith("CAX8") else "CAX3", 3)):
            inside = [i for i, q in enumerate(corners) if mesh.body[i] == body and len(q) == count]
            if inside:
                lines.append(f"*ELEMENT,TYPE={kind},ELSET=B{body}")
                lines += [f"{i + 1}," + ",".join(str(n + 1) for n in quads[i]) for i in inside]
        m = model.materials[body]
        lines += [f"*MATERIAL,NAME=M{body}", "*ELASTIC", f"{m.E / 1e6:.9g},{m.nu}", "*PLASTIC"]
        lines += [f"{m.yield_strength / 1e6:.9g},0.", f"*SOLID SECTION,ELSET=B{body},MATERIAL=M{body}"]
    r, z = np.array(nodes).T
    bottom, wall = np.flatnonzero(z < z.min() + 1e-9), np.flatnonzero(r > r.max() - 1e-9)
    lines += ["*BOUNDARY", *(f"{n + 1},1,1" for n in np.flatnonzero(r < 1e-12))]
    bonded = bool(np.isin(2 * np.setdiff1d(bottom, np.flatnonzero(r < 1e-12)), model.constrained).all())
    lines += [f"{n + 1},{1 if bonded else 2},2" for n in bottom]
    lines += [f"{n + 1},1,1" for n in np.setdiff1d(wall, bottom)] if len(mesh.wall) else []
    top = {(int(a), int(b)) for a, b in zip(mesh.surface[:-1], mesh.surface[1:], strict=True)}
    lines += ["*NSET,NSET=TOP", *(f"{n + 1}," for n in [*mesh.surface[: 2 * len(touching[-1][1])]])]
    known = set()
    for d, held in touching:
        lines += [
            f"*STEP,INC=500{',NLGEOM' if large else ''}",
            "*STATIC",
            f"{1 / increments},1.,1e-6,{1 / increments}",
            "*BOUNDARY",
        ]
        held = [int(n) for n in held]
        assert known <= set(held)
        known = set(held)
        height = (model.h_a - d) * 1e6
        pinned = held + [
            middle[k] for a, b in pairwise(held) if (a, b) in top and (k := (min(a, b), max(a, b))) in middle
        ]
        lines += [f"{n + 1},2,2,{height - nodes[n][1]:.12g}" for n in pinned]
        if d == touching[-1][0]:
            lines += ["*NODE PRINT,NSET=TOP", "U", "*NODE PRINT,NSET=ALLTOP,TOTALS=YES", "RF"]
        lines.append("*END STEP")
    # a sphere's rim belongs to its foot: its reaction is not the plane's
    everything = [
        *(int(n) for n in np.setdiff1d(mesh.surface, bottom)),
        *(middle[k] for k in middle if k in {(min(p), max(p)) for p in top}),
    ]
    at = lines.index("*NSET,NSET=TOP")
    lines[at:at] = ["*NSET,NSET=ALLTOP", *(f"{n + 1}," for n in everything)]
    return "\n".join(lines) + "\n"


def run(folder, model, touching, **kind):
    """Run ccx and read what it found."""
    (folder / "job.inp").write_text(deck(model, touching, **kind))
    before = os.times()
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}
    done = subprocess.run(["ccx", "job"], cwd=folder, capture_output=True, text=True, env=environment, check=False)
    after = os.times()
    assert "Job finished" in done.stdout, done.stdout[-2000:]
    blocks, name = {}, None
    for line in (folder / "job.dat").read_text().splitlines():
        words = line.split()
        if words and words[0] in ("displacements", "forces", "total"):
            name = words[0]
            blocks[name] = []
        elif words and name:
            blocks[name].append([float(w) for w in words])
    reactions = {int(n): fy for n, _, fy, _ in blocks["forces"]}
    moved = {int(n): uy for n, _, uy, _ in blocks["displacements"]}
    d, held = touching[-1]
    corner = np.array([-reactions[int(n) + 1] for n in held])
    free = [n for n in model.mesh.surface if n not in set(held) and n + 1 in moved]
    sunk = max(model.mesh.nodes[n, 1] * 1e6 + moved[n + 1] - (model.h_a - d) * 1e6 for n in free)
    return Seen(
        force=-blocks["total"][-1][1] * 180 * 1e-6,  # CalculiX models a wedge of 2 degrees
        lowest_reaction=float(corner.min() / abs(corner.mean())),
        penetration=sunk / (d * 1e6),
        seconds=after.children_user + after.children_system - before.children_user - before.children_system,
    )
