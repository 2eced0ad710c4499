"""faying new: what is found in geometry without names, what is assumed, what is refused, and the newcomer's path."""

import json
import tomllib
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.bolt.threads import COMMON, METRIC, Fastener, Thread, is_tapped, size_for_hole
from faying.case.case import checked_mesh
from faying.cli.main import cli
from faying.geometry.face_facts import PartFacts
from faying.setup import new
from faying.setup.expected import memory_of_run, unknowns_of
from faying.setup.proposal import mesh_size, rounded
from faying.study import Study
from tests.geometry.test_face_facts import box, written
from tests.helpers.laps import lapped


def call(*words, **given):
    return CliRunner().invoke(cli, list(map(str, words)), catch_exceptions=False, standalone_mode=False, **given)


@pytest.fixture(scope="module")
def lap(tmp_path_factory):
    return lapped(tmp_path_factory.mktemp("lap") / "lap.step")


@pytest.fixture(scope="module")
def made(lap):
    """The study of two nameless plates and three holes, all assumed."""
    out = call("new", lap, "--yes", "--out", lap.with_name("study.toml"))
    return lap.with_name("study.toml"), out.output


def test_three_m8_in_two_nameless_plates(made):
    path, out = made
    study = Study.read(path)
    # VDI 2230, R7: tension and torsion in a section of 6.827 mm (d_2 = 7.188 mm) reach 0.9 of the 640 MPa of class 8.8
    torque = 0.16 * 1.25e-3 + 0.58 * 7.188e-3 * 0.12
    allowed = 0.9 * 640e6 / np.hypot(4 / (np.pi * 6.827e-3**2), 3**0.5 * torque * 12 / (np.pi * 6.827e-3**3))
    assert len(study.bolts) == 3
    for bolt, force, x in zip(study.bolts, study.preloads[0].forces, (20, 50, 80), strict=True):
        assert bolt.at == pytest.approx((x * 1e-3, 20e-3, 11e-3))
        assert bolt.diameter == pytest.approx(8e-3)
        assert bolt.seat == pytest.approx((9e-3, 16e-3))  # ISO 273 medium hole; ISO 7089 washer
        assert force == pytest.approx(allowed / 1.28, rel=5e-3)
    assert len(study.joints) == 1
    assert study.parts == {"part1": "S355", "part2": "S355"}
    assert study.surface.scan.name == "study-surface.x3p"
    for word in (
        "S355 steel",
        "synthetic fine finish of 0.5 um",
        "8.8: stress at assembly 90% of yield",
        "M8 for a hole of 9 mm",
        "no support",
    ):
        assert word in out
    text = path.read_text()
    assert text.count("ASSUMED") >= 9
    assert text.startswith("#:schema ")


def test_the_faces_are_those_that_touch_and_those_under_the_heads(made):
    mesh = checked_mesh(Study.read(made[0]))
    for name, height in (("part1.joint", 10), ("part2.joint", 10), ("part1.seat", 0), ("part2.seat", 22)):
        assert 1e3 * mesh.points[mesh.face_nodes(name), 2] == pytest.approx(height)


def test_json_tells_what_was_found(lap, tmp_path):
    out = json.loads(call("new", lap, "--json", "--out", tmp_path / "s.toml").output)
    assert [bolt["size"] for bolt in out["bolts"]] == ["M8"] * 3
    assert out["joints"][0]["area"]["values"] == pytest.approx((4000 - 3 * np.pi * 4.5**2) * 1e-6, rel=1e-3)
    assert len(out["files"]) == 2


def test_nothing_is_overwritten_or_half_written(lap, tmp_path):
    out = tmp_path / "s.toml"
    (tmp_path / "s-surface.x3p").write_text("mine")
    with pytest.raises(faying.InputError, match=r"s-surface.x3p exists already; .*--force"):
        call("new", lap, "--yes", "--out", out)
    assert not out.exists()
    with pytest.raises(faying.InputError, match="no scan"):
        call("new", lap, "--yes", "--out", out, "--scan", tmp_path / "none.x3p")
    call("new", lap, "--yes", "--out", out, "--force")
    assert out.exists()
    assert (tmp_path / "s-surface.x3p").read_bytes()[:2] == b"PK"


def test_a_file_that_is_no_scan_is_refused(lap, tmp_path):
    (tmp_path / "other.toml").write_text('[geometry]\nstep = "a.step"\n')
    with pytest.raises(faying.InputError, match="other.toml is a study, not a scan"):
        call("new", lap, "--yes", "--out", tmp_path / "n.toml", "--scan", tmp_path / "other.toml")
    assert not (tmp_path / "n.toml").exists()


def test_without_a_terminal_it_asks_for_yes(lap, tmp_path):
    with pytest.raises(faying.InputError, match="no terminal to ask; give --yes"):
        call("new", lap, "--out", tmp_path / "s.toml")


def test_questions_have_defaults_and_answers_are_no_assumptions(lap, tmp_path, monkeypatch):
    from faying.cli import new as command

    monkeypatch.setattr(command.sys.stdin.__class__, "isatty", lambda _: True, raising=False)
    proposal = new.find(lap)
    runner = CliRunner()
    with runner.isolation(input="EN AW-6082 T6\n\n12 kN\n\n"):
        answers = command.asked(proposal, None)
    assert answers.materials == {"part1": "EN AW-6082 T6", "part2": "S355"}
    assert answers.preload == pytest.approx(12e3)
    assert answers.scan is None
    text, assumed = new.study_text(proposal, lap, tmp_path / "s.toml", answers)
    data = tomllib.loads(text)
    assert data["part"]["part1"]["material"] == "EN AW-6082 T6"
    assert data["bolt"][0]["preload"] == "12 kN"
    assert not [line for line in assumed if "steel for" in line]


def test_a_gap_is_closed_and_said(tmp_path):
    path = lapped(tmp_path / "gap.step", gap=0.05, names=("lower", "upper"))
    written_now = new.write(new.find(path), path, tmp_path / "s.toml", new.Answers())
    assert any("50 um apart are taken for touching" in line for line in written_now.assumed)
    study = Study.read(tmp_path / "s.toml")
    assert study.geometry.snap == pytest.approx(0.051e-3)
    assert checked_mesh(study).face("lower.joint")


def test_parts_that_do_not_touch_are_refused_with_their_distance(tmp_path):
    path = written(tmp_path / "far.step", box((0, 0, 0), (10, 10, 10), "a"), box((0, 0, 13), (10, 10, 20), "b"))
    with pytest.raises(faying.InputError, match="no flat faces of two parts touch; .* 'a' and 'b', 3 mm apart"):
        new.find(path)


def test_a_core_hole_below_a_clearance_hole_takes_a_screw(tmp_path):
    """That of M8 (6.8 mm, ISO 2306) below 9 mm (ISO 273)."""
    found = new.find(lapped(tmp_path / "tap.step", lower_diameter=6.8))
    assert [bolt.size for bolt in found.bolts] == [8, 8, 8]
    assert all("screwed into the hole of 6.8 mm" in bolt.remark for bolt in found.bolts)


def test_an_odd_hole_is_left_out_with_a_word(tmp_path):
    found = new.find(lapped(tmp_path / "tap.step", lower_diameter=5.5))
    assert not found.bolts
    (line,) = [line for line in found.remarks if "clearance holes of no common bolt" in line]
    assert line.startswith("3 rows of holes about (20, 20, 11), (50, 20, 11), (80, 20, 11) mm (5.5 mm in 'part1'")
    assert any("fill in [[bolt]]" in line for line in found.remarks)


def test_the_head_where_a_washer_has_no_room(tmp_path):
    found = new.find(lapped(tmp_path / "bore.step", holes=((50, 20),), bore=(15.0, 5.0)))
    (bolt,) = found.bolts
    assert bolt.ring == pytest.approx((9e-3, 13e-3))  # ISO 4762: the head of M8
    assert "ISO 4762" in bolt.remark


def test_a_meshed_bolt_is_a_bolt_of_its_own(tmp_path):
    from pathlib import Path

    step = Path(__file__).parents[2] / "examples" / "solid-bolt" / "blocks-and-bolt.step"
    new.write(new.find(step), step, tmp_path / "s.toml", new.Answers())
    study = Study.read(tmp_path / "s.toml")
    (bolt,) = study.bolts
    assert bolt.part == "bolt"
    assert set(bolt.faces) == {"bolt.head", "bolt.nut"}
    assert len(study.joints) == 3


@pytest.mark.parametrize("size", COMMON)
def test_every_hole_of_iso_273_finds_its_bolt(size):
    fine, medium, coarse = METRIC[size].holes
    assert size_for_hole(fine * 1e-3) == size
    assert size_for_hole(medium * 1e-3) == size
    assert size_for_hole(coarse * 1e-3) >= size  # a coarse hole of one size may be a fine one of the next
    for last_digit in (1 - 1e-15, 1.0, 1 + 1e-15):  # a hole drawn as wide as the thread takes the thread
        hole = size * 1e-3 * last_digit
        assert size_for_hole(hole) != size
        assert is_tapped(hole, size)
    assert Fastener(thread=Thread.coarse(size * 1e-3), grade="8.8").proof_load > 0


def test_no_bolt_for_holes_out_of_the_table():
    assert size_for_hole(2.5e-3) is None
    assert size_for_hole(44e-3) is None


def test_a_name_cannot_break_out_of_a_comment(tmp_path):
    path = lapped(tmp_path / "lap.step", names=('a"\\b', "upper ü"))
    text, _ = new.study_text(new.find(path), path, tmp_path / "s.toml", new.Answers())
    assert set(tomllib.loads(text)["part"]) == {'a"\\b', "upper ü"}


def test_a_washer_does_not_drive_the_mesh_beyond_the_memory(monkeypatch):
    """3 mm beside a block of 200 mm: two elements across the washer would be 40 GB."""
    washer = PartFacts(name="washer", volume=1e-6, area=1e-3, low=(0.0, 0.0, 0.0), high=(0.03, 0.03, 0.003))
    block = PartFacts(name="block", volume=8e-3, area=0.24, low=(0.0, 0.0, 0.0), high=(0.2, 0.2, 0.2))
    facts = SimpleNamespace(parts=(washer, block), faces=())
    monkeypatch.setattr("faying.setup.proposal.available", lambda: 4e9)
    size, _ = mesh_size(facts, set())
    assert size > 0.003
    assert memory_of_run(unknowns_of(facts, size)) < 0.7 * 4e9


def test_the_mesh_is_never_coarser_than_the_thickest_part(monkeypatch):
    """Where holes alone make more unknowns than are wanted, no size helps; one element across is the end."""
    monkeypatch.setattr("faying.setup.proposal.unknowns_of", lambda facts, size: 10**9)
    part = PartFacts(name="plate", volume=1e-4, area=0.0222, low=(0.0, 0.0, 0.0), high=(0.1, 0.1, 0.01))
    size, why = mesh_size(SimpleNamespace(parts=(part,)), set())
    assert size == pytest.approx(0.01)
    assert "1,000,000,000 unknowns at any size" in why


def test_an_estimate_that_rises_for_a_while_is_no_end_of_the_search(monkeypatch):
    """Beside small holes a slightly larger size counts more: the first size that fits is taken all the same."""
    monkeypatch.setattr("faying.setup.proposal.unknowns_of", lambda facts, size: 10**9 if size < 0.008 else 10**5)
    monkeypatch.setattr("faying.setup.proposal.available", lambda: 8e9)
    part = PartFacts(name="plate", volume=1e-4, area=0.0222, low=(0.0, 0.0, 0.0), high=(0.1, 0.1, 0.01))
    size, why = mesh_size(SimpleNamespace(parts=(part,)), set())
    assert size == pytest.approx(0.008, rel=0.1)
    assert "coarser than two elements" in why


def test_rounded():
    assert rounded(14863.2, 3) == pytest.approx(14900)
    assert rounded(0.0505, 2, up=True) == pytest.approx(0.051)


@pytest.mark.slow
def test_the_newcomers_path(tmp_path):
    """From a STEP file without names and a scan to frequencies between those of free and of bonded plates."""
    path = lapped(tmp_path / "lap.step")
    scan = faying.synthesize.spectral((160, 160), spacing=1e-5, D=2.2, Rq=1e-6, longest=1e-4, seed=3)
    faying.write_scan(scan, tmp_path / "mine.x3p")
    study = tmp_path / "study.toml"
    assert call("new", path, "--scan", tmp_path / "mine.x3p", "--yes", "--out", study).exit_code == 0
    assert not (tmp_path / "study-surface.x3p").exists()
    result = faying.run(study)
    elastic = result.frequencies[0]
    assert np.all(elastic > result.free * (1 - 1e-6))
    assert np.all(elastic < result.bonded * (1 + 1e-6))
    # bonded, the plates are one beam of 100 x 40 x 22 mm: its first bending about the weak axis, with shear
    # and rotation, lies some percent below Euler's 11.6 kHz (Weaver, Timoshenko, Young: 4.730^2 of a free beam)
    euler = 4.730**2 / (2 * np.pi) * np.sqrt(210e9 * 22e-3**2 / 12 / 7850) / 0.1**2
    assert 0.7 * euler < result.bonded[0] < euler
