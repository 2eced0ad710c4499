"""The example with a solid bolt: its head overlaps the seat only in part, and every joint carries the preload."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.case.case import build, checked_mesh
from faying.fe.sides import face_centre
from faying.joint.modal import ModesChoice
from faying.joint.tighten import tighten
from faying.study import Study
from tests.helpers.preloads import pulled

STUDY = Path(__file__).parents[2] / "examples/solid-bolt/study.toml"


@pytest.fixture(scope="module")
def study():
    return Study.read(STUDY)


@pytest.fixture(scope="module")
def structure(study):
    return build(study)


def test_faces_that_overlap_in_part_keep_their_names(structure):
    """The head reaches over the rim of the hole and the seat beyond the head; gluing has cut both."""
    mesh = structure.mesh
    for name, area in (
        ("bolt.head", pi * (6.5**2 - 4**2)),
        ("bolt.nut", pi * (6.5**2 - 4**2)),
        ("upper.seat", pi * (8**2 - 4.5**2)),
        ("lower.seat", pi * (8**2 - 4.5**2)),
    ):
        _, _, found = face_centre(mesh.points, mesh.face(name))
        assert found == pytest.approx(area * 1e-6, rel=1e-3), name
    head = structure.joints[1].interface
    assert head.weights.sum() == pytest.approx(pi * (6.5**2 - 4.5**2) * 1e-6, rel=1e-3)


def test_every_joint_carries_the_preload(structure):
    found = tighten(structure, structure.assembly(), [2e3])
    for joint, pressure in zip(structure.joints, found.pressures, strict=True):
        assert joint.interface.weights @ pressure == pytest.approx(2e3, rel=1e-6), joint.name


def test_a_nut_that_is_bonded_where_it_overlaps_its_seat_is_held_in_check_and_run(tmp_path):
    """87 of the 139 nodes under the nut are those of the seat."""
    text = STUDY.read_text().replace('"blocks-and-bolt.step"', f'"{STUDY.parent.as_posix()}/blocks-and-bolt.step"')
    start, end = text.index('name = "nut"'), text.index("[[bolt]]")
    nut = 'name = "nut"\nfaces = ["bolt.nut", "lower.seat"]\nbonded = true\n\n'
    path = tmp_path / "bonded.toml"
    path.write_text(text[:start] + nut + text[end:])
    assert not faying.check(path).faults
    mesh = build(Study.read(path)).mesh
    assert mesh.is_shared("bolt.nut", wholly=False)
    assert not mesh.is_shared("bolt.nut")
    assert not mesh.is_shared("bolt.head", wholly=False)


def test_a_bolt_that_is_no_part_is_named(study):
    wrong = replace(study, bolts=(replace(study.bolts[0], part="screw"),))
    with pytest.raises(Exception, match="bolt 'M8' is the part 'screw', which is not in blocks-and-bolt.step"):
        checked_mesh(wrong)


@pytest.mark.slow
def test_the_bolt_moves_with_the_blocks(structure):
    """Tight, all three parts have but the six rigid motions."""
    from faying.numerics.modes import lowest_modes

    found = tighten(structure, structure.assembly(), [2e3])
    K, _ = structure.coupled(structure.springs(found.pressures))
    modes = lowest_modes(K, structure.dynamic_matrices[1], 8, shift_frequency=structure.shift_frequency)
    assert np.all(modes.frequencies[:6] < 1.0)
    assert modes.frequencies[6] > 5e3


@pytest.mark.slow
def test_a_sweep_over_its_preload(study, tmp_path):
    """Against full solutions of the same study, at an end and between the ends."""
    from faying.answer.run import run
    from faying.sweeps.axes import axis_of
    from faying.sweeps.sweep import sweep

    fine = dict.fromkeys(("bolt.head", "bolt.nut", "upper.seat", "lower.seat"), 4e-3)
    coarse = replace(study.geometry, size=15e-3, face_size={"upper.joint": 7e-3, **fine})
    plan = replace(study, geometry=coarse, modes=ModesChoice(count=4))
    swept = sweep(plan, (axis_of("bolt.preload=1 kN:3 kN:3"),), tmp_path / "out.nc")
    for place, force in ((1, 2e3), (2, 3e3)):
        full = run(pulled(plan, force))
        assert swept.frequencies[place] == pytest.approx(full.frequencies[0], rel=1e-5)
