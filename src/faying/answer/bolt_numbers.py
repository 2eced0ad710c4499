"""From the states of a case to the numbers of its bolts, and to the conductance of its joints."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from faying.bolt.bolt import FittedBolt
from faying.bolt.solid_bolt import FittedSolidBolt
from faying.bolt.vdi2230 import embedding_guide
from faying.case.case import Case, materials_at
from faying.case.solve import LoadedCase
from faying.contact.conductance import contact_conductance
from faying.errors import InputError
from faying.joint.clamping import Clamping, clamping, cone_of
from faying.joint.load_path import Cut, LoadPaths
from faying.joint.strength import least_seat_area, seat_limit
from faying.joint.structure import Structure
from faying.materials import ContactPair
from faying.result.bolts import BoltNumbers
from faying.study.keys.surface import Surface
from faying.surface.roughness import mean_peak_to_valley
from faying.typing import Array

NAN = float("nan")
LIKE = 3  # loads before, whose motions are combined to start from
CARRIES = 0.01  # of a bolt's force: a joint that carries less of it plays no part in its embedding


def bolt_numbers(case: Case, states: Sequence[LoadedCase], shapes: Sequence[Array]) -> BoltNumbers | None:
    """Find the numbers of the bolts of a case under each load; None where it has no bolts.

    shapes: of the modes (m, nodes, 3), mass-normalised, under each load. Raises NotConverged where what a bolt clamps
    has no stiffness against its force.
    """
    structure = case.structure
    bolts = structure.fitted_bolts
    if not bolts:
        return None
    paths = LoadPaths.of(structure)
    found: list[Clamping] = []
    for state in states:
        stiffness, _ = structure.coupled(state.springs)
        like = np.concatenate([one.motions for one in found[-LIKE:]], axis=1) if found else None
        found.append(clamping(structure, stiffness, state.modes, state.springs, like=like))
    bolt, members = (np.stack([getattr(c, name) for c in found]) for name in ("bolt", "members"))
    forces = np.array([s.preload.bolt_forces for s in states])
    motion = np.stack([_modal_forces(structure, one) for one in shapes])
    omega = 2 * np.pi * np.stack([s.damped.frequencies for s in states])
    embedding = np.stack([_embedding(structure, c, s) for c, s in zip(found, states, strict=True)], axis=1)
    height = cache(lambda number: _height(case.surfaces[number]))
    guide = np.array([_guide(height, cuts) for cuts in paths.cuts])
    return BoltNumbers(
        compliance=bolt,
        member_compliance=members,
        load_factor=np.stack([c.load_factor for c in found]),
        cone_compliance=np.array([cone_of(structure, paths, index) for index in range(len(bolts))]),
        modal_force=motion,
        modal_force_by_acceleration=motion / omega[:, :, None] ** 2,
        proof_share=forces / [NAN if b.bolt.fastener is None else b.bolt.fastener.proof_load for b in bolts],
        seat_pressure=forces / [least_seat_area(one) for one in bolts],
        seat_limit=np.array([_limit(structure, one) for one in bolts]),
        embedding=embedding,
        embedding_loss=_embedding_of(structure, found, embedding) / (bolt + members),
        embedding_guide=guide,
        embedding_guide_loss=guide / (bolt + members),
    )


def _modal_forces(structure: Structure, shapes: Array) -> Array:
    """Force [N/m] in each bolt (m, b) while the point that moves most in a mode (m, nodes, 3) moves by 1 m."""
    most = np.linalg.norm(shapes, axis=2).max(axis=1)
    forces = shapes.reshape(len(shapes), -1) @ structure.bolt_force_operator.T
    rigid = [bool(bolt.rigidity) for bolt in structure.fitted_bolts]
    return np.asarray(np.where(rigid, forces, NAN) / most[:, None])


def _limit(structure: Structure, fitted: FittedBolt | FittedSolidBolt) -> float:
    """The pressure [Pa] that the softer of a bolt's seats bears; NaN for a meshed bolt, or where one is not known."""
    if not isinstance(fitted, FittedBolt):
        return NAN
    limits = [seat_limit(structure, seat.face) for seat in fitted.pressed]
    return NAN if None in limits else min(limit[0] for limit in limits if limit is not None)


def _embedding(structure: Structure, found: Clamping, state: LoadedCase) -> Array:
    """Lasting approach [m] (2, joints, bolts), weighted as a bolt's clamp force spreads over each joint.

    By reciprocity the seats of a bolt approach each other by the sum of an approach times the traction of 1 N.
    """
    out = np.full((2, len(structure.joints), len(structure.fitted_bolts)), NAN)
    for number, (joint, springs, spread) in enumerate(
        zip(structure.under(state.preload).joints, state.springs, found.traction, strict=True)
    ):
        bounds = joint.law.lasting_approach(springs.pressure)
        if bounds is not None and not joint.per_node:
            out[:, number] = np.stack([spread @ (springs.interface.weights * bound) for bound in bounds])
    return out


def _embedding_of(structure: Structure, found: Sequence[Clamping], embedding: Array) -> Array:
    """Sum (2, loads, bolts) [m] over the joints that carry a bolt's force; NaN where one of them predicts nothing."""
    weights = [joint.interface.weights for joint in structure.joints]
    carried = np.array(
        [
            [np.abs(spread @ w) if spread.shape[1] == len(w) else np.ones(len(spread)) for spread, w in pairs]
            for pairs in ([*zip(c.traction, weights, strict=True)] for c in found)
        ]
    )
    return np.asarray(np.where(carried > CARRIES, embedding, np.nan_to_num(embedding)).sum(axis=2))


def _guide(height: Callable[[int], float], cuts: Sequence[Cut]) -> float:
    """Embedding [m] of thread, both seats and the joints of a bolt by the guideline; NaN where no scan gives Rz.

    height: Rz [m] of the surface of each joint. The seats are taken to be as rough as the roughest of these joints; of
    joints side by side the roughest counts.
    """
    if not cuts:
        return NAN
    try:
        values = [embedding_guide(max(height(number) for number in cut.joints)) for cut in cuts]
    except InputError:
        return NAN
    return values[0][0] + 2 * max(value[1] for value in values) + sum(value[2] for value in values)


def _height(surface: Surface) -> float:
    """Rz [m] of the scan of a surface. Raises InputError where there is none."""
    if surface.scans is None:
        raise InputError("no scan gives Rz")
    return mean_peak_to_valley(surface.scans[0])


def conductances(case: Case, states: Sequence[LoadedCase]) -> dict[str, Any]:
    """Conductance of each joint (loads, joints) for heat [W/K] and current [S], as fields of the result.

    NaN where a material's value is not known; a field is left out where none is. Clean metal in vacuum.
    """
    out: dict[str, Any] = {}
    for field, kind in (("thermal_conductance", "conductivity"), ("electrical_conductance", "resistivity")):
        values = np.full((len(states), len(case.structure.joints)), NAN)
        for number, joint in enumerate(case.structure.joints):
            pair = ContactPair(*materials_at(case.study, case.structure.mesh, case.study.joints[number]))
            known = [getattr(m, kind) for m in (pair.first, pair.second)]
            if None in known:
                continue
            first, second = (1 / k if kind == "conductivity" else k for k in known)
            # the stiffness is that of the law's own pair, one of whose bodies may be taken as rigid
            E_star = (joint.law.model.made_for or pair).E_star
            for row, state in enumerate(states):
                springs = state.springs[number]
                h = contact_conductance(springs.k_n, E_star=E_star, resistivities=(first, second))
                values[row, number] = springs.interface.weights @ h
        if np.isfinite(values).any():
            out[field] = values
    return out
