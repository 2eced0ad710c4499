"""What a law lacks is told before anything is meshed."""

import tomllib
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.answer.run import run
from faying.case import case
from faying.case.case import build
from faying.cli import main
from faying.errors import InputError, ReadError
from faying.geometry.selectors import Selector
from faying.study import Study
from faying.sweeps.axes import axis_of
from faying.sweeps.sweep import sweep
from faying.text import toml
from tests.helpers.studies import write

IN_FULL = {"density": "3e9 1/m^2", "radius": "60 um", "sigma": "0.5 um"}


@pytest.fixture
def study(tmp_path):
    write(tmp_path / "study.toml")
    data = tomllib.loads((tmp_path / "study.toml").read_text())

    data["joint"][0]["tangential"] = "law"

    def made(**tables):
        return Study.from_dict({key: value for key, value in (data | tables).items() if value}, folder=tmp_path)

    return made


@pytest.fixture
def no_mesh(monkeypatch):
    def meshing(geometry):
        raise AssertionError("it was meshed")

    monkeypatch.setattr(case, "mesh_of", meshing)


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ({"model": "gw", **IN_FULL}, "GW defines no tangential stiffness"),
        ({"model": "gw-ke"}, "needs|smoothed"),
        ({"model": "jk", "alpha": 1.5}, "alpha = 1.5"),
    ],
)
def test_faults_of_a_law_come_before_the_mesh(study, no_mesh, law, message):
    for call in (run, build):
        with pytest.raises(faying.InputError, match=message):
            call(study(law=law))


def test_a_material_that_a_law_cannot_use(study, no_mesh):
    soft = {"E": "200 GPa", "nu": 0.3, "density": "7800 kg/m^3"}
    plan = study(material={"elastic": soft}, part={"upper": {"material": "elastic"}, "lower": {"material": "elastic"}})
    with pytest.raises(faying.InputError, match="neither body yields|neither hardness nor yield_strength"):
        run(plan)


def test_a_face_given_by_a_point_has_the_material_of_its_part(study, no_mesh):
    plan = study(law={"model": "gw", **IN_FULL})
    geometry = replace(plan.geometry, face={"below": Selector(part="lower", nearest=(0.0, 0.0, 0.0))})
    moved = replace(plan, geometry=geometry, joints=(replace(plan.joints[0], faces=("upper.joint", "below")),))
    with pytest.raises(faying.InputError, match="no tangential stiffness"):
        run(moved)


def test_a_sweep_without_any_law_to_use_is_refused_before_the_mesh(study, no_mesh, tmp_path):
    plan = study(law={"model": "gw", **IN_FULL})
    axes = (axis_of("law.sigma=0.3 um:0.8 um:3"), axis_of("bolt.preload=1 kN:3 kN:3"))
    with pytest.raises(faying.InputError, match="no tangential stiffness"):
        sweep(plan, axes, tmp_path / "out.nc")
    assert not list(tmp_path.glob("out*"))
    # one value that can be used is enough: the other points have no answer, and say why
    with pytest.raises(AssertionError, match="it was meshed"):
        sweep(study(), (axis_of("law.alpha=0.2,0.3"),), tmp_path / "out.nc")


def test_frequencies_of_a_model_are_not_headed_test():
    """Tables, figures and JSON call them what they are."""
    from dataclasses import replace as changed

    from faying.output import table
    from faying.result import MeasuredComparison
    from faying.result import figure as structure
    from faying.style import new_figure
    from tests.helpers.results import small_result

    found = small_result()
    listed = np.array([[100.0, 200.0]] * len(found.loads))
    given = MeasuredComparison(source="s", frequencies=listed, predicted=1.01 * listed, modes=np.zeros((2, 2), int))
    for kind, heading in (("test", "test"), ("model", "reference model")):
        one = changed(found, comparison=changed(given, kind=kind))
        column = [row[1] for row in table.comparison(one)]
        assert f"{heading} [Hz]" in column
        assert ("test [Hz]" in column) is (kind == "test")
        ax = structure.comparison(new_figure(3, 3).add_subplot(), one)
        assert ax.get_ylabel() == f"difference from the {heading} [%]"
        assert one.to_dict()["comparison"]["kind"] == kind


@pytest.mark.parametrize("text", ["a = " + "[" * 5000 + "]" * 5000, "a = " + "9" * 5000], ids=["nested", "digits"])
@pytest.mark.parametrize("command", ["run", "check"])
def test_a_text_that_toml_cannot_hold_is_refused_in_words(tmp_path, capsys, text, command):
    (tmp_path / "s.toml").write_text(text)
    with pytest.raises(SystemExit) as stop:
        main([command, str(tmp_path / "s.toml")])
    assert stop.value.code == 1
    said = " ".join("".join(capsys.readouterr()).split())
    assert "is not TOML" in said
    assert ("nested too deep" if "[" in text else "5000 digits") in said
    assert "recursion" not in said
    assert "sys." not in said


def test_init_of_a_folder_asks_for_a_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in (".", str(tmp_path)):
        with pytest.raises(SystemExit) as stop:
            main(["init", name])
        assert stop.value.code == 1
        assert "is a folder; name the study's file" in capsys.readouterr().err


@pytest.mark.parametrize("text", ["a." * 30_000 + "b = 1", "a = " + 20_000 * "[", "[" + "a." * 5_000 + "b]"])
def test_a_text_that_nests_without_end_is_refused_in_little_memory(tmp_path, text):
    """The parser of Python takes 3 GB for 60 kB of dotted names."""
    (tmp_path / "deep.toml").write_text(f'title = "x"\n{text}\n')
    tracemalloc.start()
    with pytest.raises(ReadError, match="nested too deep"):
        Study.read(tmp_path / "deep.toml")
    assert tracemalloc.get_traced_memory()[1] < 1e8
    tracemalloc.stop()


DOTS = " ".join(f"{k}.5" for k in range(60))


@pytest.mark.parametrize(
    "line",
    [
        f"a = [{DOTS.replace(' ', ', ')}]",
        f"# measured [Hz]: {DOTS}",
        f'a = "{" . " * 60}"  # {" . " * 60}',
        f'a = """\n{DOTS}\n"""',
        "a = 'one.two.three.x3p'\n[b.c.d]\ne.f = 1",
        f'a = "{"A sentence. " * 60}"',
    ],
)
def test_dots_of_numbers_texts_and_comments_nest_nothing(line):
    assert toml(line) == tomllib.loads(line)


@pytest.mark.parametrize("key", ["a", '"="', "'.'", "a" * 81])
@pytest.mark.parametrize("form", ["{} = 1", "[{}]", "[[{}]]", "x = {{ y = 1, {} = 2 }}"])
def test_dotted_names_of_every_form_end_at_forty(key, form):
    text = form.format(".".join(60 * [key]))
    tomllib.loads(text)  # which is legal
    with pytest.raises(ValueError, match="nested too deep"):
        toml(text)


def test_a_path_to_change_that_nests_without_end_is_refused_in_little_memory(study):
    tracemalloc.start()
    with pytest.raises(InputError, match="keys with dots"):
        study().with_("a." * 30_000 + "b", 1)
    assert tracemalloc.get_traced_memory()[1] < 1e8
    tracemalloc.stop()
