"""However many laws a study asks for, its surface is read once."""

from dataclasses import replace
from pathlib import Path

import pytest

from faying.answer.run import run
from faying.backbones import backbone
from faying.case import alternative as other_laws
from faying.case.case import Case, surfaces_of
from faying.study import Study
from faying.study.keys.alternative import AlternativeChoice
from faying.study.keys.backbone import BackboneChoice
from faying.study.keys.law import LawChoice
from faying.study.keys.surface import SurfaceChoice

EXAMPLE = Path(__file__).parents[2] / "examples" / "two-blocks" / "study.toml"
LAWS = tuple(LawChoice(model=name) for name in ("JK", "MB", "YK"))


class Made(Exception):
    """All cases stand; what follows is not wanted."""


@pytest.fixture
def reads(monkeypatch):
    """What has been read, in order."""
    done = []
    read = SurfaceChoice.read

    def counted(choice):
        done.append(choice)
        return read(choice)

    monkeypatch.setattr(SurfaceChoice, "read", counted)
    return done


def test_laws_beside_share_the_surface(reads):
    study = Study.read(EXAMPLE)
    alternatives = tuple(AlternativeChoice(name=law.model, law=law) for law in LAWS)
    result = run(replace(study, alternatives=alternatives))
    assert result.alternatives.names == ("JK", "MB", "YK")
    assert reads == [study.surface]


def test_a_surface_of_its_own_beside_is_read_too(reads):
    study = Study.read(EXAMPLE)
    case = Case.of(study)
    rough = replace(study.surface, D=2.5)
    other = other_laws.changed(case, AlternativeChoice(name="rough", surface=rough))
    assert reads == [study.surface, rough]
    assert [surface.rough.inputs.D for surface in other.surfaces] == [2.5]
    assert [surface.rough.inputs.D for surface in case.surfaces] == [study.surface.D]


def test_laws_of_a_backbone_share_the_surface(reads, monkeypatch):
    def enough(*_):
        raise Made

    monkeypatch.setattr(backbone, "_bases", enough)
    study = Study.read(EXAMPLE)
    choice = BackboneChoice(mode=1, friction=(0.2,), amplitude=(1.0, 60.0), laws=LAWS)
    with pytest.raises(Made):
        backbone.backbones(study, choice)
    assert reads == [study.surface]


def test_joints_of_one_surface_read_it_once(reads):
    study = Study.read(EXAMPLE)
    joint = study.joints[0]
    own = replace(study.surface, D=2.2)
    joints = (joint, replace(joint, name="b", surface=own), replace(joint, name="c"))
    found = surfaces_of(replace(study, joints=joints))
    assert reads == [study.surface, own]
    assert [surface.rough.inputs.D for surface in found] == [study.surface.D, 2.2, study.surface.D]
