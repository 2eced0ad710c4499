"""STEP files whose parts touch: the faces that gluing cuts keep their names, all of them and no more."""

import numpy as np
import pytest

import faying
from faying.fe.faces import face_centre
from faying.fe.geometry import mesh_step


def named(solid, name, **faces):
    """The solid with its name; faces: name -> test of a face."""
    solid = next(iter(solid.solids))
    solid.name = name
    for face in solid.faces:
        face.name = next((label for label, test in faces.items() if test(face)), "")
    return solid


def at(height):
    return lambda face: abs(face.center.z - height) < 1e-6


def step(tmp_path, *solids):
    from netgen.occ import Compound

    path = tmp_path / "parts.step"
    Compound(list(solids)).WriteStep(str(path))
    return path


def area(mesh, name):
    """Area of a face [mm2]; its nodes are its part's."""
    assert np.isin(mesh.face_nodes(name), mesh.part_nodes(mesh.face_part[name])).all()
    return face_centre(mesh.points, mesh.face(name))[2] * 1e6


def plate_and_block(**changes):
    from netgen.occ import Box, Pnt

    plate = named(Box(Pnt(0, 0, 0), Pnt(60, 30, 10)), "plate", top=at(10), bottom=at(0))
    block = named(Box(Pnt(40, 10, changes.get("low", 10)), Pnt(70, 40, 20)), "block", foot=at(changes.get("low", 10)))
    return plate, block


def test_faces_that_overlap_in_part(tmp_path):
    mesh = mesh_step(step(tmp_path, *plate_and_block()), size=8e-3, local_size={"foot": 4e-3})
    assert area(mesh, "top") == pytest.approx(1800, rel=1e-9)
    assert area(mesh, "foot") == pytest.approx(900, rel=1e-9)
    both = mesh.points[mesh.face_nodes("top")][:, None] - mesh.points[mesh.face_nodes("foot")]
    assert np.count_nonzero(np.linalg.norm(both, axis=2) < 1e-9) > 10  # the nodes meet on the overlap


def test_two_faces_of_one_name_of_which_one_is_cut(tmp_path):
    from netgen.occ import Box, Pnt

    base = named(Box(Pnt(0, 0, 0), Pnt(60, 30, 10)) - Box(Pnt(28, 0, 6), Pnt(32, 30, 10)), "base", pads=at(10))
    block = named(Box(Pnt(40, 10, 10), Pnt(50, 20, 20)), "block", foot=at(10))
    mesh = mesh_step(step(tmp_path, base, block), size=8e-3)
    assert area(mesh, "pads") == pytest.approx(2 * 28 * 30, rel=1e-9)


@pytest.mark.parametrize("size", [3e-3, 20e-3])
def test_a_pin_flush_with_the_plate_is_no_piece_of_its_face(tmp_path, size):
    """Its end is meshed with nodes on its rim alone, all of which lie on the plate's face, too."""
    from netgen.occ import Box, Pnt

    _, block = plate_and_block()
    drilled = Box(Pnt(0, 0, 0), Pnt(60, 30, 10)) - Box(Pnt(12, 12, -1), Pnt(18, 18, 11))
    pin = named(Box(Pnt(12, 12, 0), Pnt(18, 18, 10)), "pin")
    mesh = mesh_step(step(tmp_path, named(drilled, "plate", top=at(10)), pin, block), size=size)
    assert area(mesh, "top") == pytest.approx(1800 - 36, rel=1e-9)
    assert mesh.points[mesh.face_nodes("top"), 2] == pytest.approx(10e-3)


def test_parts_that_run_into_each_other(tmp_path):
    with pytest.raises(
        faying.InputError, match="the parts plate, block run into each other: .* may touch, not overlap"
    ):
        mesh_step(step(tmp_path, *plate_and_block(low=9.5)), size=8e-3)
