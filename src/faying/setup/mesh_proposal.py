"""What a study of a mesh file may be: joints of named faces that touch, bolts of its pretension sections."""

from collections.abc import Sequence
from math import pi, sqrt
from pathlib import Path

import numpy as np

from faying.bolt.threads import nearest_size
from faying.decks.meshfile import read_mesh, read_pretensions
from faying.decks.raw import Pretension
from faying.fe.line import across
from faying.fe.mesh import Mesh
from faying.geometry.face_facts import FaceFacts, GeometryFacts, TouchingFaces
from faying.geometry.mesh_facts import mesh_facts
from faying.setup.bolt_proposal import BoltProposal, to_nanometres
from faying.setup.face_names import FaceNames
from faying.setup.proposal import Proposal, named_joints, snapped, touching
from faying.typing import Array

ALONG = 0.9  # cosine between the axis of a bolt and the normal of its seats
ROUND = 0.03  # of a nominal diameter: how far the circle of the section's area may be from it


def propose_mesh(path: Path, unit: str | None) -> Proposal:
    """Propose joints and bolts for a mesh file.

    Args:
        path: the mesh file.
        unit: length unit of its coordinates.

    Raises:
        ReadError, InputError: as `read_mesh`.
    """
    mesh = read_mesh(path, unit=unit)
    assert unit is not None
    sets = _halves(path, mesh)
    if sets:
        mesh = read_mesh(path, unit=unit, parts=sets)
    facts = mesh_facts(mesh)
    contacts = [
        contact
        for contact in touching(facts)
        if not any(mesh.is_shared(facts.face(*side).name) for side in contact.sides)
    ]
    snap, apart = snapped(facts, contacts)
    remarks = [note.text for note in mesh.notes]
    bolts: list[BoltProposal] = []
    for section, parts in read_pretensions(path, mesh):
        found = _bolt(mesh, facts, contacts, section, parts, f"bolt {len(bolts) + 1}")
        if isinstance(found, str):
            remarks.append(found)
        else:
            bolts.append(found)
    remarks += apart
    if not contacts and len(facts.parts) > 1:
        remarks.append("no two flat named faces touch: name those of the joints in the file, or write [[joint]]")
    return Proposal(
        facts=facts,
        faces={},
        joints=named_joints(facts, contacts, FaceNames(facts, snap)),
        bolts=tuple(bolts),
        size=0.0,
        snap=snap,
        left_out=(),
        remarks=tuple(remarks),
        unit=unit,
        sets=sets,
        counted=mesh.unknowns,
    )


def _halves(path: Path, mesh: Mesh) -> dict[str, str]:
    """Sets that make one part of the two halves of each bolt that the file cuts at its section; none without such."""
    joined: dict[str, str] = {}
    for section, parts in read_pretensions(path, mesh):
        if len(section.twins) and len(parts) == 2:
            joined[f"bolt{len(joined) + 1}"] = " + ".join(parts)
    halves = {one for some in joined.values() for one in some.split(" + ")}
    return {part: part for part in mesh.parts if part not in halves} | joined if joined else {}


def _bolt(
    mesh: Mesh,
    facts: GeometryFacts,
    contacts: Sequence[TouchingFaces],
    section: Pretension,
    parts: Sequence[str],
    name: str,
) -> BoltProposal | str:
    """The bolt of a section; why there is none, where its part or its seats are not known."""
    if len(parts) != 1:
        place_words = "no solid holds it, as of a beam" if not parts else f"it is on {', '.join(map(repr, parts))}"
        return f"{section.text}: no bolt is proposed, as {place_words}; give the bolt by hand"
    part = parts[0]
    places = mesh.points[np.isin(mesh.numbers, section.nodes)]
    middle, axis = places.mean(axis=0), _axis(places, section)
    met = {side for contact in contacts for side in contact.sides}
    seats: dict[bool, list[FaceFacts]] = {True: [], False: []}
    for face in facts.by_part[part]:
        thread = mesh.is_shared(face.name)  # what holds it there is one with it
        depth = float((np.array(face.centre) - middle) @ axis)
        back = face.facing(axis) * np.sign(-depth) > ALONG
        if thread or (back and face.side in met):
            seats[depth > 0].append(face)
    if not seats[True] or not seats[False]:
        return (
            f"{section.text}: no bolt is proposed, as the bolt {part!r} has no named faces that touch other parts "
            "under its head and its nut; name them in the file"
        )
    ends = [max(some, key=lambda face: (not mesh.is_shared(face.name), face.area)) for some in seats.values()]
    head, nut = sorted(ends, key=lambda face: mesh.is_shared(face.name))
    size = _size(places, axis)
    force = section.force if section.force is not None and section.force > 0 else None
    pulled = "" if section.force is None else f", force {section.force:.9g} in the unit of the file"
    return BoltProposal(
        axis=axis,
        parts=(),
        head=(head,),
        end=(nut,),
        name=name,
        faces=(head.name, nut.name),
        size=size,
        at=to_nanometres(middle),
        part=part,
        force=force,
        remark=f"{section.text}{pulled}: the part {part!r} is the bolt"
        + (f", M{size:g} by the area of its section" if size else ""),
    )


def _axis(places: Array, section: Pretension) -> Array:
    """Unit direction of a bolt: that of the file, else across the plane of the section."""
    if section.axis is not None:
        given = np.array(section.axis)
        return np.asarray(given / np.linalg.norm(given))
    return np.asarray(np.linalg.svd(places - places.mean(axis=0))[2][2])


def _size(places: Array, axis: Array) -> float | None:
    """Nominal diameter [mm] of a round section; None where it is none of a common bolt."""
    from scipy.spatial import ConvexHull

    area = ConvexHull((places - places.mean(axis=0)) @ across(axis)).volume  # of a plane figure it is the area
    wide = 1e3 * sqrt(4 * area / pi)
    return nearest_size(wide, lambda one: one.size, ROUND)
