"""A deck that somebody else published: the Brake-Reuss beam of Abaqus4Joints, with local frames and couplings."""

import os
from pathlib import Path

import numpy as np
import pytest

import faying

DATA = Path(os.environ.get("FAYING_DATA", Path(__file__).parents[2] / "../shared/data"))


@pytest.mark.slow
def test_the_deck_of_abaqus4joints():
    """Half of its nodes are written in local frames (*System): the beam is 720 mm long only if these are applied."""
    path = DATA / "abaqus4joints" / "Job.inp"
    if not path.is_file():
        pytest.skip(f"{path} is absent: assets/demo/Job.inp of Nidish96/Abaqus4Joints; set FAYING_DATA")
    mesh = faying.read_mesh(path, unit="m")
    assert len(mesh.faces) == 48
    assert mesh.points[:, 0].min() == pytest.approx(-0.36, abs=1e-6)
    assert mesh.points[:, 0].max() == pytest.approx(0.36, abs=1e-6)
    assert len(mesh.parts) == 14
    halves = [np.ptp(mesh.points[mesh.part_nodes(name), 0]) for name in ("TOPBEAM_Set-1", "BOTBEAM_Set-1")]
    assert halves[0] == pytest.approx(halves[1], rel=1e-6)
    assert any("reference points are left out" in note.text for note in mesh.notes)
