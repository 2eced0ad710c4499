"""Assemblies of every kind of bolted joint, from a STEP file without names to a result, without an edit."""

import json
import re
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.answer.run import run
from faying.cli.main import cli
from faying.geometry.cad import read_parts
from faying.setup import new
from faying.setup.check import check
from faying.study import Study
from faying.units import parse
from tests.helpers import assemblies
from tests.helpers.proposed import proposed


@dataclass(frozen=True, kw_only=True)
class Kind:
    """What an assembly has, counted by hand.

    left_out: parts that are not meshed; bolts: how many, and of which size [mm]; seats: outer diameter of the seat
    [mm]; rows: of joints, one behind the other, that carry the force of all bolts; pair: the first of two modes that
    differ by a turn alone, from 0; dowels: how many; says: what the study says of it.
    """

    parts: int
    joints: int
    bolts: tuple[int, int]
    seat: float
    left_out: int = 0
    rows: int = 1
    pair: int | None = None
    dowels: int = 0
    says: tuple[str, ...] = ()


KINDS = {
    # heads: ISO 4762; washers: ISO 7089; a countersunk head ends where its cone does
    "t_slots": Kind(parts=2, joints=2, bolts=(2, 8), seat=16, says=("T-slot of 'base'",)),
    "counterbored": Kind(parts=2, joints=1, bolts=(3, 8), seat=13, says=("screwed into",)),
    "countersunk": Kind(parts=2, joints=1, bolts=(2, 6), seat=13.2, says=("a countersunk head",)),
    "studded": Kind(parts=2, joints=1, bolts=(2, 10), seat=16, left_out=4, says=("'stud 1', 'stud 2', 'nut 1'",)),
    "spacers": Kind(parts=6, joints=6, bolts=(2, 10), seat=20, rows=3),
    "stepped_lap": Kind(parts=2, joints=1, bolts=(2, 10), seat=20, says=("(shoulders, registers)",)),
    "segments": Kind(parts=5, joints=4, bolts=(8, 10), seat=20, pair=2, says=("up to 1 mm apart",)),
    "cover": Kind(parts=2, joints=1, bolts=(4, 6), seat=12, dowels=2, says=("6 mm (ISO 2338)",)),
    "channel": Kind(parts=2, joints=1, bolts=(2, 8), seat=16, says=("for a slot 9 mm wide",)),
}


# tests/study/test_ordinary_joints.py looks at what `new` finds of these
OTHERS = {
    "flanges": Kind(parts=2, joints=1, bolts=(6, 10), seat=20, pair=0),
    "raised_flanges": Kind(parts=2, joints=1, bolts=(6, 10), seat=20, pair=0),
    "bracket": Kind(parts=2, joints=1, bolts=(2, 10), seat=16),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("assemblies")


@pytest.fixture(scope="module")
def made(folder):
    """Name -> the study of that assembly, written once."""

    @cache
    def of(name):
        path = assemblies.made(name, folder / f"{name}.step")
        return path, proposed(path, assemblies.SIZES[name])

    return of


@pytest.mark.parametrize("name", KINDS)
def test_new_finds_parts_joints_and_bolts(made, name):
    kind, study = KINDS[name], Study.read(made(name)[1])
    assert len(study.parts) == kind.parts
    assert len(study.geometry.leave_out) == kind.left_out
    assert len(study.joints) == kind.joints
    count, size = kind.bolts
    assert [bolt.diameter for bolt in study.bolts] == pytest.approx([size * 1e-3] * count)
    assert [bolt.seat[1] for bolt in study.bolts] == pytest.approx([kind.seat * 1e-3] * count)
    assert len(study.dowels) == kind.dowels
    written = made(name)[1].read_text()
    for words in kind.says:
        assert words in written


def test_pins_as_parts_are_dowels(folder):
    path = assemblies.cover(folder / "pins.step", pins_drawn=True)
    study = Study.read(proposed(path, "8 mm"))
    assert study.geometry.leave_out == ("pin 1", "pin 2")
    assert (len(study.bolts), len(study.dowels)) == (4, 2)
    assert np.array(study.dowels[0].ends) == pytest.approx(np.array([(60, 10, 18), (60, 10, 40)]) * 1e-3)
    assert "'pin 1', 'pin 2': dowels, which carry only shear" in path.with_suffix(".toml").read_text()
    said = [one.text for one in check(path.with_suffix(".toml"), mesh=False).findings if one.code == "dowel"]
    assert said == [f"dowel 'dowel {k}': 6 mm thick, 12 mm in 'frame', 10 mm in 'cover'" for k in (1, 2)]


def test_hollow_pins_are_said_to_count_as_solid(folder):
    found = new.find(assemblies.cover(folder / "tubes.step", pins_drawn=True, bore=4.0))
    assert len(found.dowels) == 2
    assert all("it is hollow and counts as solid" in dowel.remark for dowel in found.dowels)


def test_open_holes_of_a_clearance_size_are_bolts_although_a_pin_would_fit(folder):
    """10 mm is the coarse clearance hole of M8 and the diameter of a pin: the study says so."""
    path = assemblies.flanges(folder / "ten.step", hole=10.0)
    found = new.find(path)
    assert (len(found.bolts), len(found.dowels)) == (6, 0)
    words = "if the holes are those of a dowel, give a [[dowel]] in its place"
    assert all(words in bolt.remark for bolt in found.bolts)


def checked(toml):
    """The findings of `faying check`, none of which is a fault."""
    done = CliRunner().invoke(cli, ["check", str(toml), "--json"], standalone_mode=False)
    found = json.loads(done.output)
    assert done.return_value == 0, found
    return found["findings"]


@pytest.mark.slow
@pytest.mark.parametrize("name", assemblies.MADE)
def test_run_carries_the_preload_between_free_and_bonded(made, name):
    path, toml = made(name)
    kind, study = (KINDS | OTHERS)[name], Study.read(toml)
    assert (len(study.parts), len(study.joints), len(study.bolts)) == (kind.parts, kind.joints, kind.bolts[0])
    findings = checked(toml)
    found = run(study)
    held = read_parts(path)
    volumes = {part: 1e-9 * solid.mass for part, solid in zip(held.names, held.solids, strict=True)}
    density = faying.CATALOGUE["S355"].density
    expected = [volumes[part] * density for part in found.parts]
    assert found.part_masses == pytest.approx(expected, rel=2e-3)
    force = sum(study.preloads[0].forces)
    assert found.pressure[0] @ found.weights == pytest.approx(kind.rows * force, rel=1e-6)
    for number, joint in enumerate(found.joints):
        here = found.joint_of_point == number
        mean = found.pressure[0][here] @ found.weights[here] / found.weights[here].sum()
        (said,) = [
            one["text"] for one in findings if one["text"].startswith(f"joint '{joint}'") and " press " in one["text"]
        ]
        pressure = parse(re.search(r" press ([\d.]+ \w+) on it", said)[1], "Pa")
        assert pressure == pytest.approx(mean, rel=0.3)
    assert np.all(found.free <= found.frequencies[0] * (1 + 1e-6))
    assert np.all(found.frequencies[0] <= found.bonded * (1 + 1e-6))
    if kind.pair is not None:
        pair = slice(kind.pair, kind.pair + 2)
        first, second = found.frequencies[0, pair]
        assert second / first - 1 < found.mesh_error[0, pair].sum()
