"""STEP files whose parts touch: the faces that gluing cuts keep their names, all of them and no more."""

import numpy as np
import pytest

import faying
from faying.fe.sides import face_centre
from faying.geometry.geometry import mesh_step
from faying.geometry.selectors import Selector


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
    match = (
        r"gluing makes 3 solids of 2: 'plate' and 'block' share 20 x 20 x 0.5 mm about \(50, 20, 9.75\) mm; parts may"
    )
    with pytest.raises(faying.InputError, match=match):
        mesh_step(step(tmp_path, *plate_and_block(low=9.5)), size=8e-3)


def test_solids_of_one_name_are_numbered(tmp_path):
    from netgen.occ import Box, Pnt

    both = [named(Box(Pnt(0, 0, z), Pnt(20, 20, z + 10)), "plate") for z in (0, 10)]
    assert sorted(mesh_step(step(tmp_path, *both), size=10e-3).parts) == ["plate_1", "plate_2"]


@pytest.mark.parametrize(
    ("point", "match"),
    [
        (
            (0.03, 0.01, 0.5),
            r"nearest face of 'plate' .* is 490 mm away, more than 1 mm: number .* about \(30, 15, 10\) mm.*its unit",
        ),
        ((0.0, 0.01, 0.01), r"face 'x': 2 faces fit part = 'plate', nearest = \(0, 10, 10\) mm: .*\(30, 15, 10\)"),
        ((0.0, 0.0, 0.0), "3 faces fit part = 'plate'"),
    ],
)
def test_a_point_names_one_face(tmp_path, point, match):
    with pytest.raises(faying.InputError, match=match):
        mesh_step(step(tmp_path, *plate_and_block()), size=8e-3, faces={"x": Selector(part="plate", nearest=point)})


def test_a_point_near_one_face_names_it(tmp_path):
    at_side = {
        "side": Selector(part="plate", nearest=(0.0, 0.01, 0.005)),
        "far": Selector(part="plate", nearest=(0.0605, 0.01, 0.005)),
    }
    mesh = mesh_step(step(tmp_path, *plate_and_block()), size=8e-3, faces=at_side)
    assert mesh.points[mesh.face_nodes("side"), 0] == pytest.approx(0.0, abs=1e-12)
    assert mesh.points[mesh.face_nodes("far"), 0] == pytest.approx(0.06)


def test_a_mesh_beyond_the_memory_is_refused_before_it_is_made(tmp_path, monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", "4")
    with pytest.raises(
        faying.InputError, match=r"edges of 0.1 mm make about .* elements .* 4 GB are free: take .* mm or more"
    ):
        mesh_step(step(tmp_path, *plate_and_block()), size=1e-4)


def test_a_death_of_the_cad_kernel_is_an_error(tmp_path, monkeypatch):
    """A segmentation fault in the child, as mutated files cause it, does not end this process."""
    import faying.apart as module

    path = step(tmp_path, *plate_and_block())
    dying = "import os, signal, sys; os.kill(os.getpid(), signal.SIGSEGV); "
    run = module.subprocess.run

    def killed(command, **given):
        return run([command[0], "-c", dying, *command[3:]], **given)

    monkeypatch.setattr(module.subprocess, "run", killed)
    with pytest.raises(faying.ReadError, match="the CAD kernel died on it .signal 11.; repair the geometry"):
        mesh_step(path, size=8e-3)


def test_a_mesh_is_kept_beside_the_file_and_read_again(tmp_path, monkeypatch):
    import faying.geometry.geometry as module

    monkeypatch.delenv("FAYING_CACHE", raising=False)
    path, kept = step(tmp_path, *plate_and_block()), tmp_path / "kept"
    first = mesh_step(path, size=8e-3, cache=kept)
    other = mesh_step(path, size=8e-3, local_size={"foot": 4e-3}, cache=kept)
    assert len(other.points) > len(first.points)  # another question is another file
    assert len(list(kept.iterdir())) == 2

    def asked(*_, **__):
        raise AssertionError("meshed again")

    monkeypatch.setattr(module, "ask_kernel", asked)
    again = mesh_step(path, size=8e-3, cache=kept)
    np.testing.assert_array_equal(again.points, first.points)
    assert again.face_part == first.face_part
    for name in first.parts:
        np.testing.assert_array_equal(again.parts[name][0], first.parts[name][0])
    path.write_bytes(path.read_bytes() + b" ")  # another file, even by a space
    with pytest.raises(AssertionError, match="meshed again"):
        mesh_step(path, size=8e-3, cache=kept)


@pytest.mark.parametrize("cut", [0.2, 0.5, 0.9])
def test_a_step_file_cut_short_is_an_error(tmp_path, cut):
    path = step(tmp_path, *plate_and_block())
    whole = path.read_bytes()
    path.write_bytes(whole[: int(cut * len(whole))])
    with pytest.raises(faying.ReadError):
        mesh_step(path, size=8e-3)


def test_the_estimate_of_the_size_of_a_mesh():
    """Elements and unknowns of meshes as netgen makes them: right within a factor of two."""
    from netgen.occ import Box, OCCGeometry, Pnt

    from faying.geometry.geometry import ELEMENTS, UNKNOWNS

    for size in (3.0, 6.0):
        mesh = OCCGeometry(Box(Pnt(0, 0, 0), Pnt(60, 40, 30))).GenerateMesh(maxh=size, grading=0.4)
        mesh.SecondOrder()
        elements, unknowns = len(mesh.Elements3D()), 3 * len(mesh.Points())
        assert 0.5 < ELEMENTS * 72000 / size**3 / elements < 2
        assert 0.5 < UNKNOWNS * elements / unknowns < 2


def test_a_mesher_that_gives_up_is_a_fault_of_the_file(tmp_path, monkeypatch):
    """Netgen raises an exception of its own that Python cannot name (NgException)."""
    from netgen.occ import Box, OCCGeometry, Pnt

    from faying.geometry import geometry

    def stopped(*_, **__):
        raise RuntimeError("Stop in surface meshing")

    path = step(tmp_path, named(Box(Pnt(0, 0, 0), Pnt(10, 10, 10)), "box"))
    monkeypatch.setattr(OCCGeometry, "GenerateMesh", stopped)
    request = geometry._Request(file=path.name, size=5e-3, local_size={}, selectors={}, snap=0.0)
    with pytest.raises(faying.InputError, match=r"parts.step cannot be meshed with size 5 mm \(Stop in surface"):
        geometry._mesh_arrays(path, request)
