"""Modes of solids by CalculiX and of NAFEMS' tests, and a joint with contact by CalculiX."""

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import structures

import faying
from faying.fe.elasticity import assemble
from faying.fe.mesh import Mesh
from faying.numerics.modes import lowest_modes
from peers.rows import Problem, Row, worst
from tests.helpers import ccx, ccx_contact
from tests.helpers.boxes import block

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=8000.0)


@dataclass(frozen=True, kw_only=True)
class Solid:
    """A test of NAFEMS with hex20.

    counts: elements; size [m]; shaped: from the points of the box to those of the solid; held: unknowns (of 3n) at
    rest, from the points of the box; rigid: motions that are left; printed: frequencies [Hz]; bound: of these.
    """

    counts: tuple[int, int, int]
    size: tuple[float, float, float]
    shaped: Callable
    held: Callable
    printed: tuple[float, ...]
    bound: float
    rigid: int = 0


def held(points, *where):
    """Unknowns of each axis that are at rest: pairs of an axis and which points."""
    return np.unique(np.concatenate([3 * np.flatnonzero(there) + axis for axis, there in where]))


def tapered(points):
    x, y, z = points.T
    return np.stack([x, y * (1 - 0.8 * x / 10), z], axis=1)


def rhombic(points):
    x, y, z = points.T
    return np.stack([x + y * np.sqrt(0.5), y * np.sqrt(0.5), z], axis=1)


def edges(points):
    """Points on the four sides of a plate of 10 m."""
    return (np.abs(points[:, :2] - 5) > 5 - 1e-6).any(axis=1)


SOLIDS = {
    "FV32": Solid(  # half of the thickness, which slides on its middle plane: plane stress
        counts=(16, 8, 1),
        size=(10.0, 5.0, 0.025),
        shaped=lambda p: tapered(p - [0, 2.5, 0]),
        held=lambda p: held(p, (0, p[:, 0] < 1e-6), (1, p[:, 0] < 1e-6), (2, p[:, 2] < 1e-6)),
        printed=(44.623, 130.03, 162.70, 246.05, 379.90, 391.44),
        bound=5e-3,
    ),
    "FV52": Solid(  # the mesh of the test
        counts=(4, 4, 1),
        size=(10.0, 10.0, 1.0),
        shaped=lambda p: p,
        held=lambda p: held(p, (2, edges(p) & (p[:, 2] < 1e-6))),
        printed=(45.897, 109.44, 109.44, 167.89, 193.59, 206.19, 206.19),
        bound=0.03,
        rigid=3,
    ),
    "FV22": Solid(
        counts=(12, 12, 2),
        size=(10.0, 10.0, 1.0),
        shaped=rhombic,
        held=lambda p: held(p, *((axis, edges(p)) for axis in range(3))),
        printed=(133.95,),
        bound=0.02,
    ),
}
SOLIDS["FV52, 12 x 12 x 2 elements"] = replace(SOLIDS["FV52"], counts=(12, 12, 2))


def meshed(solid):
    box, cells = block("hex20", solid.counts, solid.size)
    mesh = Mesh(points=solid.shaped(box), parts={"p": (cells,)}, faces={}, face_part={})
    return mesh, solid.held(box)


def ours(solid, count):
    """Elastic frequencies [Hz]; the mass as CalculiX integrates it."""
    mesh, fixed = meshed(solid)
    free = np.setdiff1d(np.arange(mesh.unknowns), fixed)
    K, M = (A[free][:, free] for A in assemble(mesh, {"p": STEEL}, mass="stiffness"))
    return lowest_modes(K, M, solid.rigid + count, shift_frequency=10.0).frequencies[solid.rigid :]


def printed(name, python):
    solid = SOLIDS[name]
    found = ours(solid, len(solid.printed))
    return [worst("elastic frequency", found, solid.printed, bound=solid.bound, unit="Hz")]


def by_ccx(name, python):
    solid = SOLIDS[name]
    mesh, fixed = meshed(solid)
    with tempfile.TemporaryDirectory() as folder:
        ccx.run(Path(folder), ccx.deck(mesh, {"p": STEEL}, step=ccx.held_step(fixed, solid.rigid + 6)))
        theirs = ccx.frequencies(Path(folder))[solid.rigid : solid.rigid + 6]
    bound = 1e-5 if solid.rigid else 1e-6
    return [worst("elastic frequency", ours(solid, 6), theirs, bound=bound, unit="Hz")]


def specimen(python):
    mesh = structures.meshed(55)
    with tempfile.TemporaryDirectory() as folder:
        theirs = structures.calculix(mesh, Path(folder))["frequencies"][6:]
    found = structures.ours(mesh)["frequencies"][6:]
    return [worst("elastic frequency", found, theirs, bound=1e-5, unit="Hz")]


def pried(python):
    preload = 4e3  # N
    made, pairs, loads = ccx_contact.pried_bolt()
    found = faying.load_cases(made.solve(preload, modes=2), loads, modes=False)
    with tempfile.TemporaryDirectory() as folder:
        forces, motions, _ = ccx_contact.answers(Path(folder), made, pairs, preload, loads)
    rows = []
    for k, load in enumerate(loads):
        far = np.linalg.norm(motions[k].reshape(-1, 3), axis=1).max()
        for what, unit, a, b, bound in (
            ("bolt force", "N", found.bolt_force[k, 0], forces[k + 1, 0], 1e-3),
            ("change of it", "N", found.bolt_force[k, 0] - preload, forces[k + 1, 0] - forces[0, 0], 0.01),
            ("greatest motion", "um", found.displacement[k] * 1e6, far * 1e6, 0.02),
        ):
            rows.append(Row(quantity=f"{what}, {load.name}", ours=a, theirs=b, bound=bound, unit=unit))
    return rows


PRINTED = {
    "FV32": "The numbers that are printed are of a fine mesh in plane stress: half a percent for either mesh.",
    "FV52": "The numbers that are printed are of Mindlin's plate on its middle plane, where the solid stands on its "
    "lower edges: 3 %, as solids of Altair OptiStruct and Autodesk Fusion are 2.4 and 2.8 % lower in the first mode.",
    "FV52, 12 x 12 x 2 elements": "As on the mesh of the test.",
    "FV22": "The number that is printed is of Mindlin's plate; a solid of Altair SimSolid is 0.84 % higher, and our "
    "mesh has 12 elements a side: 2 %.",
}
CCX = "The same mesh and element: 8 printed digits, and the tests of tests/witness/test_calculix.py, give 1e-6."
FREE = " CalculiX factorises the singular stiffness of a structure that can move: 1e-5."
PROBLEMS = [
    *(
        Problem(name=f"NAFEMS {name}", peer="NAFEMS", seconds=5, bound=PRINTED[name], solve=partial(printed, name))
        for name in SOLIDS
    ),
    *(
        Problem(
            name=f"NAFEMS {name}",
            peer="CalculiX",
            seconds=10,
            bound=CCX + (FREE if solid.rigid else ""),
            solve=partial(by_ccx, name),
        )
        for name, solid in SOLIDS.items()
    ),
    Problem(name="T-specimen, 15 modes", peer="CalculiX", seconds=30, bound=CCX + FREE, solve=specimen),
    Problem(
        name="pried bolt with contact",
        peer="CalculiX",
        seconds=90,
        bound="As in tests/loads/test_calculix.py: a thousandth of the preload, 1 % of its change, 2 % of motions, as "
        "the points of contact are not the same.",
        solve=pried,
    ),
]
