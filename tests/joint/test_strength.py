"""Forces and pressures beyond what the parts bear are noted; so are preloads whose unit looks wrong."""

import tomllib
from dataclasses import replace
from math import pi

import numpy as np
import pytest

import faying
from faying.case.case import build
from faying.joint.joint_law import JointLaw
from faying.joint.strength import bolt_notes, material_notes, pressure_notes
from faying.setup.template import write
from faying.study import Study
from tests.helpers.laws import Given


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The structure of the template's study with another bolt, and its forces; the rest is made once."""
    folder = tmp_path_factory.mktemp("study")
    write(folder / "study.toml")
    text = (folder / "study.toml").read_text()

    def study(preload, **bolt):
        data = tomllib.loads(text)
        data["geometry"]["size"] = "12 mm"
        data["geometry"].pop("face_size", None)
        data["bolt"][0] |= {"preload": preload, **bolt}
        return Study.from_dict(data, folder=folder)

    plain = build(study("6 kN"))

    def one(preload, **bolt):
        plan = study(preload, **bolt)
        return replace(plain, bolts=plan.bolts), plan.bolt_forces

    return one


def codes(structure, forces):
    return [note.code for note in bolt_notes(structure, forces)]


def test_a_shank_beyond_the_yield_of_its_material(made):
    """355 MPa on a shank of 8 mm: 17.84 kN. The notes begin there."""
    limit = 355e6 * pi / 4 * 8e-3**2 / 1e3
    shank = {"diameter": "8 mm", "material": "45 steel", "seat": ["9 mm", "30 mm"]}
    assert codes(*made(f"{limit * 0.999:.6g} kN", **shank)) == []
    (note,) = bolt_notes(*made(["1 kN", f"{limit * 1.001:.6g} kN"], **shank))
    assert note.code == "bolt-yield"
    assert "above the yield strength of its material, 355 MPa" in note.text
    assert note.load == pytest.approx(limit * 1.001e3, rel=1e-5)


def test_a_seat_beyond_the_yield_of_its_part(made):
    """A ring of 9 to 13 mm: 355 MPa are 24.5 kN."""
    limit = 355e6 * pi / 4 * (13e-3**2 - 9e-3**2) / 1e3
    ring = {"seat": ["9 mm", "13 mm"], "at": ["0 mm", "0 mm", "0 mm"]}
    assert codes(*made(f"{limit * 0.999:.6g} kN", **ring)) == []
    assert codes(*made(f"{limit * 1.001:.6g} kN", **ring)) == ["seat-yield", "seat-yield"]


def test_a_bolt_of_known_grade_is_measured_by_its_proof_load(made):
    """M8 of class 8.8: 36.61 mm2 at 580 MPa are 21.23 kN; its material's yield strength plays no part then."""
    proof = 580 * pi / 4 * ((8 - 0.64952 * 1.25 + 8 - 1.22687 * 1.25) / 2) ** 2 / 1e3
    shank = {"diameter": "8 mm", "material": "45 steel", "seat": ["9 mm", "30 mm"], "grade": "8.8"}
    assert codes(*made(f"{0.899 * proof:.6g} kN", **shank)) == []
    (near,) = bolt_notes(*made(f"{0.91 * proof:.6g} kN", **shank))
    assert near.code == "near-proof"
    assert "91% of the proof load of M8x1.25 8.8, 21.2" in near.text
    (beyond,) = bolt_notes(*made(f"{1.01 * proof:.6g} kN", **shank))
    assert beyond.code == "beyond-proof"
    fine = shank | {"thread": "M8x1", "grade": "10.9"}
    assert codes(*made(f"{1.01 * proof:.6g} kN", **fine)) == []


def test_a_seat_is_measured_by_the_bearing_limit_of_its_part(made):
    """S355 bears 760 MPa under a head, though it yields at 355 MPa: a ring of 9 to 13 mm bears 52.5 kN."""
    limit = 760e6 * pi / 4 * (13e-3**2 - 9e-3**2) / 1e3
    ring = {"seat": ["9 mm", "13 mm"], "at": ["0 mm", "0 mm", "0 mm"]}

    def codes_of(preload):
        structure, forces = made(preload, **ring)
        parts = dict.fromkeys(structure.materials, faying.CATALOGUE["S355"])
        return codes(replace(structure, materials=parts), forces)

    assert codes_of(f"{limit * 0.999:.6g} kN") == []
    assert codes_of(f"{limit * 1.001:.6g} kN") == ["seat-yield", "seat-yield"]


@pytest.mark.parametrize(
    ("bolt", "text"),
    [
        ({"grade": "8.8"}, "grade needs the size of the thread; give thread"),
        (
            {"thread": "M8x1", "diameter": "8 mm", "pitch": "1.25 mm", "material": "45 steel"},
            "and pitch = 1.25 mm differ",
        ),
        ({"grade": "8.9", "thread": "M8"}, "not a property class of ISO 898-1"),
        ({"grade": "8.8", "thread": "8 mm"}, "should be a metric thread"),
        ({"grade": "8.8", "diameter": "8.5 mm", "material": "45 steel"}, "no coarse thread has a diameter of 8.5 mm"),
        ({"grade": 8.8, "thread": "M8"}, "grade = 8.8 should be"),
    ],
)
def test_faults_of_grades(made, bolt, text):
    with pytest.raises(faying.InputError, match=text):
        made("6 kN", **bolt)


def test_preloads_whose_unit_looks_wrong(made):
    """Less than the blocks weigh, 5.4 N, or more than their seats bear."""
    assert codes(*made("1 uN")) == ["slight-preload"]
    assert "is less than the 5.3" in bolt_notes(*made("1 uN"))[0].text or "5.4" in bolt_notes(*made("1 uN"))[0].text
    assert codes(*made("1 MN")) == ["seat-yield", "seat-yield"]
    assert codes(*made("6 kN")) == []


def test_notes_of_loads_say_what_to_do(made):
    (slight,) = bolt_notes(*made("1 uN"))
    assert "check its unit and its prefix, for example 12 kN" in slight.text
    for note in bolt_notes(*made("1 MN")):
        assert "Lower the preload, widen the seat, or give the part's bearing_limit" in note.text
    shank = {"diameter": "8 mm", "material": "45 steel", "seat": ["9 mm", "30 mm"]}
    (shank_yields,) = bolt_notes(*made("20 kN", **shank))
    assert "Lower the preload, take a thicker bolt, or give its grade" in shank_yields.text
    structure, _ = made("6 kN")
    pressure = [np.full(len(structure.joints[0].interface.weights), 1e9)]
    (crushed,) = pressure_notes(structure, pressure, 6e3)
    assert "Lower the preload, or check the area of the joint" in crushed.text


def test_a_material_whose_units_look_wrong(made):
    """7.8 g/cm^3 as 7.8 kg/m^3, or GPa in place of MPa: sound at 160 km/s. Diamond, 18 km/s, passes."""
    structure, _ = made("6 kN")
    assert material_notes(structure) == []
    for E, density, odd in ((200e9, 7.8, True), (200e12, 7800.0, True), (1140e9, 3515.0, False)):
        one = faying.Material(name="one", E=E, nu=0.1, density=density)
        notes = material_notes(replace(structure, materials=dict.fromkeys(structure.materials, one)))
        assert [note.code for note in notes] == ["odd-material"] * (2 if odd else 0)
    assert (
        "part 'upper': E = 2e+05 GPa"
        in material_notes(replace(structure, materials=faying.Material(name="one", E=200e12, nu=0.3, density=7800.0)))[
            0
        ].text
    )


def test_pressure_beyond_yield_states_its_share_of_the_area(made):
    structure, _ = made("6 kN")
    (joint,) = structure.joints
    weights = joint.interface.weights
    beyond = np.arange(len(weights)) % 7 == 0
    pressure = np.where(beyond, 356e6, 354e6)
    (note,) = pressure_notes(structure, [pressure], 6e3)
    assert note.share == pytest.approx(weights[beyond].sum() / weights.sum())
    assert note.joint == joint.name
    assert pressure_notes(structure, [np.full(len(weights), 354e6)], 6e3) == []


def test_a_law_given_in_full_needs_no_yield_strength(made):
    """Materials without yield strength say nothing."""
    plain = faying.Material(name="plain", E=200e9, nu=0.3, density=7800.0)
    structure, forces = made("1 MN")
    law = JointLaw(model=Given(k_n=lambda p: p**0.5, k_t=lambda p: p**0.5))
    bare = replace(
        structure,
        materials=dict.fromkeys(structure.mesh.parts, plain),
        joints=tuple(replace(joint, law=law) for joint in structure.joints),
    )
    assert codes(bare, forces) == []
    assert pressure_notes(bare, [np.full(len(structure.joints[0].interface.weights), 1e12)], 1e6) == []
