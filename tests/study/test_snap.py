"""A small gap of the CAD model: closed by snap with a note, kept without it."""

import numpy as np
import pytest

import faying
from faying.case.case import build
from faying.numerics.modes import lowest_modes
from faying.study import Study
from tests.helpers import meshfiles
from tests.helpers.boxes import row


def study(folder, gap, snap=None):
    mesh = row(
        [0.05, 0.04], [3, 3], kinds=("hex8", "hex8"), sections=((2, 2), (2, 2)), width=0.02, height=0.02, gap=gap
    )
    (folder / "model.inp").write_text(meshfiles.abaqus(mesh))
    text = meshfiles.STUDY.replace('unit = "mm"', 'unit = "mm"' + (f'\nsnap = "{snap}"' if snap else ""))
    (folder / "study.toml").write_text(text)
    return Study.read(folder / "study.toml")


def frequencies(structure, force):
    found = structure.assembly().solve(force * structure.loads[:, 0])
    K, _ = structure.coupled(structure.springs(found.pressures))
    return lowest_modes(K, structure.dynamic_matrices[1], 9, shift_frequency=structure.shift_frequency).frequencies[6:]


def test_a_gap_that_is_closed_is_that_of_faces_that_touch(tmp_path):
    touching = build(study(tmp_path, 0.0))
    closed = build(study(tmp_path, 5e-5, "0.1 mm"))
    assert np.all(closed.joints[0].interface.gap == 0)
    assert frequencies(closed, 3e3) == pytest.approx(frequencies(touching, 3e3), rel=2e-3)
    (note,) = [note for note in closed.notes if note.code == "snapped"]
    assert note.text == "joint: the faces are up to 50 um apart; geometry.snap = 100 um closes that"
    assert not [note for note in touching.notes if note.code == "snapped"]


def test_a_gap_wider_than_snap_stays(tmp_path):
    for snap in (None, "0.04 mm"):
        apart = build(study(tmp_path, 5e-5, snap))
        assert apart.joints[0].interface.gap == pytest.approx(5e-5)
        assert not [note for note in apart.notes if note.code == "snapped"]


def test_snap_must_be_a_length(tmp_path):
    for snap, message in (("0.05", "has no unit"), ("-1 mm", "must be positive")):
        with pytest.raises(faying.InputError, match=f"geometry.snap.*{message}"):
            study(tmp_path, 5e-5, snap)
