"""The parts of a structure by themselves: what nothing resists with the joints apart, and how they are factorised."""

import numpy as np
import pytest

from faying.bolt.bolt import Bolt
from faying.errors import InputError
from faying.joint.attachments import Support
from faying.numerics.by_parts import PartByPart
from faying.numerics.memory import in_single
from faying.numerics.solve import available
from tests.helpers.plates import STEEL, plates

FACES = ("high.top", "low.bottom")
pardiso = pytest.mark.skipif("pardiso" not in available(), reason="only PARDISO factorises part by part")


@pytest.mark.parametrize(
    ("made", "count"),
    [
        ({}, 12),
        ({"bolts": (Bolt(name="b", faces=FACES),)}, 12),  # a force alone resists nothing
        ({"bolts": (Bolt(name="b", faces=FACES, diameter=8e-3, material=STEEL),)}, 6),  # a shank is a beam
        ({"supports": (Support(face="low.left"),)}, 6),
        ({"supports": (Support(face="low.left"), Support(face="high.left", stiffness=1e6))}, 0),
    ],
)
def test_what_nothing_resists_with_the_joints_apart(made, count):
    structure = plates(**made)
    motions = structure.unjoined_motions()
    assert motions.shape[1] == np.linalg.matrix_rank(motions) == count
    stiffness = structure.dynamic_matrices[0]
    assert np.abs(stiffness @ motions).max(initial=0.0) < 1e-9 * stiffness.diagonal().max()
    assert not np.any(motions[structure.fixed])


@pardiso
def test_short_memory_chooses_part_by_part(monkeypatch):
    need = in_single(plates().mesh.unknowns) / 1e9
    monkeypatch.setenv("FAYING_MEMORY", str(3 * need))
    assert plates().solver() == "pardiso"
    monkeypatch.setenv("FAYING_MEMORY", str(1.5 * need))
    structure = plates()
    assert isinstance(structure.solver(), PartByPart)
    monkeypatch.setenv("FAYING_MEMORY", str(3 * need))
    assert isinstance(structure.solver(), PartByPart)  # what was decided stands: factors have taken memory since
    assert structure.solver("pardiso") == "pardiso"  # what was asked for by name is done
    with pytest.raises(InputError, match="nothing"):
        structure.solver("nothing")
