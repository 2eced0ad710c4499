"""A structure as a user writes it in Python: the same numbers as a study, and wrong calls are refused in words."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.case.case import Case
from faying.joint.modal import ModesChoice
from faying.study import Study
from tests.helpers.plates import LAW, STEEL, stacked
from tests.helpers.preloads import pulled
from tests.helpers.studies import write

FACES = ("low.top", "high.bottom")
SEATS = ("high.top", "low.bottom")


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "study.toml"
    write(path)
    plan = Study.read(path)
    return replace(pulled(plan, 6e3), modes=ModesChoice(count=6), uncertain=None)


@pytest.fixture(scope="module")
def result(study):
    return faying.run(study)


@pytest.fixture(scope="module")
def made(study):
    case = Case.of(study)
    mesh = case.structure.mesh
    law = case.structure.joints[0].law.model
    return faying.Structure(
        mesh,
        materials="45 steel",
        joints=[faying.Joint(("upper.joint", "lower.joint"), law)],
        bolts=[faying.Bolt("bolt", ("upper.seat", "lower.seat"))],
    )


@pytest.fixture(scope="module")
def state(made):
    return made.solve(preload="6 kN", modes=6)


def test_a_state_is_what_a_study_computes(result, state):
    """Mesh, law and preload alike: frequencies, damping, pressures and shapes agree to rounding."""
    assert state.modes.frequencies == pytest.approx(result.frequencies[0], rel=1e-10)
    assert state.modes.loss_factors == pytest.approx(result.loss_factors[0], rel=1e-10)
    assert state.modes.damping == pytest.approx(result.loss_factors[0] / 2, rel=1e-10)
    assert state.pressures["joint 1"] == pytest.approx(result.pressure[0], rel=1e-10)
    nodes, _ = state.structure.outline()
    shapes = state.modes.shapes[:, nodes]
    assert shapes == pytest.approx(result.shapes[0], abs=1e-6 * np.abs(shapes).max())


@pytest.mark.slow
def test_both_engines_give_one_state(made, state):
    direct = made.solve("6 kN", modes=6, engine="direct")
    assert direct.modes.frequencies == pytest.approx(state.modes.frequencies, rel=1e-8)
    assert direct.modes.damping == pytest.approx(state.modes.damping, rel=1e-6)
    (name,) = state.pressures
    assert direct.pressures[name] == pytest.approx(state.pressures[name], abs=1e-7 * state.pressures[name].max())
    with pytest.raises(faying.InputError, match="engine = 'fast'"):
        made.solve("6 kN", engine="fast")


def test_a_state_says_what_its_law_assumes_and_where_it_ends(result, state):
    """The notes of a study on its law are those of the state, so that none of them is lost in Python."""
    wanted = {(note.code, note.text.partition(",")[0]) for note in result.notes}
    found = {(note.code, note.text.partition(",")[0].replace("joint 1", "joint")) for note in state.notes}
    for code in ("assumed", "outside-validity", "open", "no-loss"):
        assert {text for c, text in found if c == code} == {text for c, text in wanted if c == code}


def test_a_force_that_a_bolt_does_not_bear_is_noted_in_python_too(made):
    """Less than the 5.4 N that the blocks weigh, as a study says it."""
    assert [note.code for note in made.solve("1 N", modes=1).notes if note.code == "slight-preload"]


def test_a_mesh_of_a_step_file_is_that_of_a_study(study, made):
    mesh = faying.read_mesh(study.geometry.step, size=study.geometry.size, face_size=study.geometry.face_size)
    assert np.array_equal(mesh.points, made.mesh.points)
    assert mesh.faces.keys() == made.mesh.faces.keys()


def test_text_with_units_and_mappings_are_the_same_forces(made, state):
    for preload in (6e3, "6000 N", {"bolt": "6 kN"}):
        again = made.solve(preload, modes=6)
        assert np.array_equal(again.modes.frequencies, state.modes.frequencies)


def test_shapes_have_a_definite_sign(state):
    shapes = state.modes.shapes.reshape(len(state.modes), -1)
    for shape in shapes:
        size = np.abs(shape)
        assert shape[np.argmax(size >= (1 - 1e-3) * size.max())] > 0


def test_everything_prints_in_a_dozen_lines_and_plots(made, state, tmp_path):
    for one in (made.mesh, made, state, state.modes):
        assert 2 <= len(repr(one).splitlines()) <= 12
        assert max(map(len, repr(one).splitlines())) < 200
        assert one._repr_html_().startswith("<table>")
    axes = made.plot(), made.mesh.plot(), state.plot_pressure(), state.modes.plot(1), state.plot("joint 1")
    for number, ax in enumerate(axes):
        file = tmp_path / f"{number}.png"
        ax.figure.savefig(file)
        assert file.stat().st_size > 5000
    import matplotlib.pyplot

    matplotlib.pyplot.close("all")


def test_volume_and_mass_are_those_of_the_blocks():
    """Two plates of 80 x 40 x 10 mm."""
    mesh = stacked()
    assert sum(mesh.volumes.values()) == pytest.approx(2 * 0.08 * 0.04 * 0.01, rel=1e-12)
    structure = faying.Structure(mesh, "45 steel", [faying.Joint(FACES, LAW)])
    assert structure.mass == pytest.approx(7800 * sum(mesh.volumes.values()), rel=1e-12)


def test_one_material_for_all_parts_or_one_for_each():
    mesh, joint = stacked(), faying.Joint(FACES, LAW)
    one = faying.Structure(mesh, "45 steel", [joint])
    each = faying.Structure(mesh, {"low": "45 steel", "high": STEEL}, [joint])
    assert one.materials == each.materials == {"low": STEEL, "high": STEEL}


def test_a_law_of_other_materials_is_noted():
    """A law made for steel on a joint of aluminium would be taken without a word otherwise."""
    structure = faying.Structure(stacked(), "EN AW-6082 T6", [faying.Joint(FACES, LAW)])
    (note,) = [note for note in structure.notes if note.code == "law-materials"]
    assert "109.9 GPa" in note.text  # E/(2 (1 - nu^2)) of the steel
    assert "38.46 GPa" in note.text  # and of the aluminium
    assert not [n for n in faying.Structure(stacked(), "45 steel", [faying.Joint(FACES, LAW)]).notes if "law" in n.code]


def test_a_bolt_takes_text_with_units():
    bolt = faying.Bolt("b", SEATS, diameter="8 mm", material="45 steel", seat=("9 mm", "13 mm"))
    assert (bolt.diameter, *bolt.seat) == pytest.approx((8e-3, 9e-3, 13e-3), rel=1e-14)
    assert bolt.material is faying.CATALOGUE["45 steel"]


WRONG = {
    "Joint without faces": (lambda: faying.Joint(law=LAW), "it needs faces, law"),
    "Joint without law": (lambda: faying.Joint(FACES), "it needs faces, law"),
    "Joint with a number": (lambda: faying.Joint(FACES, law=3), "law = 3; give a ContactLaw"),
    "Joint of one face": (lambda: faying.Joint(("low.top", "low.top"), LAW), "name two faces"),
    "Joint with a word": (lambda: faying.Joint("low.top", LAW), r"faces = 'low.top'; give \(text, text\)"),
    "Joint with friction": (lambda: faying.Joint(FACES, LAW, friction=-1.0), "not a coefficient of friction"),
    "misspelt": (lambda: faying.Bolt("b", SEATS, diamter=8e-3), "did you mean diameter"),
    "wrong unit": (lambda: faying.Bolt("b", SEATS, diameter="8 kN", material="45 steel"), "not in a unit like m"),
    "bolt without material": (lambda: faying.Bolt("b", SEATS, diameter=8e-3), "needs both diameter and material"),
    "unknown material": (lambda: faying.Structure(stacked(), "steel", []), 'did you mean "45 steel"'),
    "a part left out": (lambda: faying.Structure(stacked(), {"low": "45 steel"}, []), "nothing about part 'high'"),
    "a part too many": (
        lambda: faying.Structure(stacked(), dict.fromkeys(("low", "high", "top"), "45 steel"), []),
        "name part 'top', which is not there",
    ),
    "no material": (lambda: faying.Structure(stacked(), None, []), "materials = None; give text"),
    "unknown face": (
        lambda: faying.Structure(stacked(), "45 steel", [faying.Joint(("low.tip", "high.bottom"), LAW)]),
        "the faces are .*'low.top'",
    ),
    "unknown seat": (
        lambda: faying.Structure(stacked(), "45 steel", [faying.Joint(FACES, LAW)], [faying.Bolt("b", ("a", "c"))]),
        "bolt 'b' names the face 'a'",
    ),
    "no list": (lambda: faying.Structure(stacked(), "45 steel", faying.Joint(FACES, LAW)), "joints = .* give a list"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_calls_are_refused_in_words(case):
    call, text = WRONG[case]
    with pytest.raises(faying.InputError, match=text):
        call()


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"preload": -5e3}, "must be positive"),
        ({"preload": "8 mm"}, "not in a unit like N"),
        ({"preload": True}, "preload = True; give a number, text"),
        ({"preload": {"blot": "6 kN"}}, "names bolt 'blot', which is not there; the bolts are 'bolt'"),
        ({"preload": {}}, "misses bolt 'bolt'"),
        ({}, "preload"),
        ({"preload": 6e3, "modes": 0}, "modes = 0; give how many elastic modes"),
        ({"preload": 6e3, "modes": True}, "modes = True"),
        ({"preload": 6e3, "modes": 2.5}, "modes = 2.5"),
        ({"preload": 6e3, "damping": "none"}, '"hysteretic" or "viscous"'),
        ({"preload": 6e3, "solver": "fast"}, "the solvers are"),
        ({"preload": 6e3, "order": ["nut"]}, "should name every bolt"),
    ],
)
def test_wrong_loads_are_refused_in_words(made, given, text):
    with pytest.raises(faying.InputError, match=text):
        made.solve(**given)


def test_a_structure_without_bolts_says_what_is_missing():
    with pytest.raises(faying.InputError, match="has no bolts"):
        faying.Structure(stacked(), "45 steel", [faying.Joint(FACES, LAW)]).solve("6 kN")


def test_wrong_pictures_are_refused_in_words(state):
    for mode in (0, 7, -1):
        with pytest.raises(faying.InputError, match="numbered from 1 to 6"):
            state.modes.plot(mode)
    for mode in (True, "first", None, 1.5):
        with pytest.raises(faying.InputError, match="mode = .*; give a whole number"):
            state.modes.plot(mode)
    with pytest.raises(faying.InputError, match="the joints are 'joint 1'"):
        state.plot_pressure("flange")
    with pytest.raises(faying.InputError, match="three dimensions"):
        state.modes.plot(1, ax=3)
