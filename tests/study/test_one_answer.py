"""One question, one answer: how stiff is this joint at this pressure, asked on every route."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.case.case import build, surfaces_of
from faying.cli.scan.law import command as law_command
from faying.identify.sampling.ensemble import Ensemble
from faying.setup import template
from faying.setup.reach import law_reach
from faying.study import Study
from faying.sweeps.axes import Grid, axis_of
from faying.sweeps.variant_builder import VariantBuilder
from tests.helpers import meshfiles
from tests.helpers.models import two

STEEL = faying.CATALOGUE["45 steel"]
PRESSURES = (2e6, 5e6, 12e6)
MODELS = ("jk", "gw-ke", "persson", "me", "half-space")
SCANS = ("milled", "template", "synthetic")
FACES = ("p0.right", "p1.left")
SAME = {"rel": 1e-12, "abs": 0.0}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Three scans, each with a small middle part on which contacts are solved, and a mesh of two blocks."""
    out = tmp_path_factory.mktemp("mates")
    template.surface(out / "template.x3p")
    milled = faying.read_scan("examples/t-specimen/milled.x3p")
    made = {
        "milled": milled,
        "template": faying.read_scan(out / "template.x3p"),
        "synthetic": faying.synthesize.spectral((192, 192), spacing=4e-6, D=2.3, Rq=0.6e-6, seed=5),
    }
    for name, scan in made.items():
        faying.write_scan(scan, out / f"{name}.x3p")
        faying.write_scan(scan.cropped(64 / scan.shape[0]), out / f"{name} part.x3p")
    mesh = two(("hex8", "hex8"), ((2, 2), (2, 2)), counts=(2, 2))
    (out / "model.inp").write_text(meshfiles.abaqus(mesh))
    return out


def file_of(folder, scan, model):
    """The scan that a law is asked on: a small one where its contact is solved."""
    return folder / f"{scan}{' part' if model == 'half-space' else ''}.x3p"


def study(folder, surface, model, **more):
    import tomllib

    data = tomllib.loads(meshfiles.STUDY) | {"surface": surface, "law": {"model": model}} | more
    return Study.from_dict(data, folder=folder)


def k_n(law, pressures=PRESSURES):
    return np.asarray(law.at_pressure(pressures).k_n, dtype=float).tolist()


def by_run(plan):
    (joint,) = build(plan).joints
    return joint.law.model


def by_attach(plan, folder):
    """k_n [Pa/m] that the springs of a node pair have per area, at each pressure."""
    out = []
    for p in PRESSURES:
        made = faying.attach(folder / "model.inp", FACES, unit="mm", study=plan, pressure=f"{p / 1e6} MPa")
        normal = made.pairs.own(made.pairs.stiffness)[:, 0] / made.pairs.area
        assert np.ptp(normal) <= 1e-12 * normal.max()
        out.append(float(normal[0]))
    return out


def by_check(plan):
    (surface,), (joint,) = surfaces_of(plan), plan.joints
    _, _, law = law_reach(SimpleNamespace(study=plan), joint, surface, STEEL, STEEL)
    return law


def by_recipe(design):
    """The law at the first point of a sweep or of the samples that an identification or a prediction takes."""
    laws, _, _ = VariantBuilder(design=design, pairs=((STEEL, STEEL),)).laws(0)
    return laws[0].model


def by_command(*words):
    pressures = f"{PRESSURES[0]} Pa:{PRESSURES[-1]} Pa:3"
    out = CliRunner().invoke(
        law_command, [*words, "--pressure", pressures, "--json"], catch_exceptions=False, standalone_mode=False
    )
    return json.loads(out.output)


# one law of each kind
FAST = (("template", "half-space"), ("template", "jk"), ("synthetic", "persson"))


@pytest.mark.parametrize(
    ("scan", "model"),
    [
        pytest.param(scan, model, marks=[pytest.mark.slow] * ((scan, model) not in FAST))
        for scan in SCANS
        for model in MODELS
    ],
)
def test_every_route_has_the_same_answer(folder, scan, model):
    """Study files (run, sweep, identify and predict, check, attach), the command, and three ways in Python."""
    file = file_of(folder, scan, model)
    surface = {"scan": file.name}
    plan = study(folder, surface, model)
    heights = faying.read_scan(file)
    mates = faying.Mates(heights, materials="45 steel", cache=folder / ".faying")
    law = mates.law(model)
    want = pytest.approx(k_n(law), **SAME)

    assert k_n(by_run(plan)) == want
    assert by_attach(plan, folder) == want
    scattering = study(folder, surface, model, uncertain={"friction": "0.1 to 0.6"})
    assert k_n(by_recipe(Ensemble.of(scattering, 8, 0))) == want
    sweep = Grid(study=plan, surfaces=surfaces_of(plan), axes=(axis_of("bolt.preload=1 kN,2 kN"),))
    assert k_n(by_recipe(sweep)) == want
    if model != "half-space":  # check solves no contact
        assert k_n(by_check(plan)) == want
    assert k_n(faying.Mates(heights, materials="45 steel", cache=folder / ".faying").law(model)) == want

    said = by_command("--scan", str(file), "--model", model, "--material", "45 steel")
    assert said["pressure"]["values"][::2] == pytest.approx([PRESSURES[0], PRESSURES[-1]], rel=1e-12)
    own = k_n(law, said["pressure"]["values"])
    assert said["k_n"]["values"] == pytest.approx(own, **SAME)
    assert said["law"] == law.name == by_run(plan).name
    assert said["mates"] == mates.line == f"both faces as {file.name}, unrelated; 45 steel on 45 steel"

    if {"D", "G"} <= set(law.parameters):
        area = heights.size[0] * heights.size[1]
        fit = faying.Mates.of_fit(faying.fit_fractal(heights), scan_area=area, materials="45 steel")
        assert k_n(fit.law(model)) == want
        table = mates.compare(PRESSURES, laws=[model])
        assert table.k_n.sel(law=law.name).values.tolist() == want


@pytest.mark.parametrize("model", ["jk", "yk", "mb", "me"])
def test_given_numbers_have_one_meaning_on_every_route(folder, model):
    """D and G of both faces together, in the convention of Yan and Komvopoulos, whatever that of the law."""
    numbers = {"D": 2.39, "G": "1.53e-10 m", "scan_area": "16 mm^2"}
    mates = faying.Mates.of_fractal(**numbers, materials=("45 steel", "45 steel"))
    law = mates.law(model)
    surface = surfaces_of(study(folder, numbers, "jk"))[0]
    by_study = study(folder, numbers, model).law.make(surface, STEEL, STEEL)
    quantity = "k_n" if law.at_pressure(5e6).k_n is not None else "area"
    want = getattr(law.at_pressure(PRESSURES), quantity)
    assert getattr(by_study.law.at_pressure(PRESSURES), quantity) == pytest.approx(want, **SAME)
    words = ["--D", "2.39", "--G", "1.53e-10 m", "--scan-area", "16 mm^2", "--material", "45 steel", "--model", model]
    said = by_command(*words)
    own = getattr(law.at_pressure(said["pressure"]["values"]), quantity)
    assert said[quantity]["values"] == pytest.approx(own.tolist(), **SAME)
    assert said["mates"] == mates.line
    assert "both faces together: D 2.39, G 153 pm, scan area 16 mm^2" in by_study.mates


def test_the_options_that_say_otherwise_have_one_meaning_too(folder):
    """A smooth face, another scan, a rigid body: on the command, in a study and in Python."""
    scans = [faying.read_scan(folder / f"{name} part.x3p") for name in ("milled", "template")]
    for counter, other in (("smooth", "smooth"), (str(folder / "template part.x3p"), scans[1])):
        for against, counterbody in (("same", "part"), ("rigid", "rigid")):
            plan = study(folder, {"scan": "milled part.x3p", "counter": counter}, "persson")
            plan = replace(plan, law=replace(plan.law, counterbody=counterbody))
            materials = ("45 steel", "45 steel" if against == "same" else "rigid")
            law = faying.Mates(scans[0], materials=materials, other=other).law("persson")
            assert k_n(by_run(plan)) == pytest.approx(k_n(law), **SAME)
            words = ["--scan", str(folder / "milled part.x3p"), "--counter", counter, "--against", against]
            said = by_command(*words, "--model", "persson", "--material", "45 steel")
            assert said["k_n"]["values"] == pytest.approx(k_n(law, said["pressure"]["values"]), **SAME)


def test_commands_print_the_mates_once(folder):
    words = ["--scan", str(folder / "milled part.x3p"), "--material", "45 steel", "--pressure", "5 MPa"]
    line = "mates: both faces as milled part.x3p, unrelated; 45 steel on 45 steel"
    for more in (["--model", "jk"], ["--models", "gw,persson"], ["--model", "persson"]):
        out = CliRunner().invoke(law_command, [*words, *more], catch_exceptions=False, standalone_mode=False).output
        assert out.splitlines().count(line) == 1
    plan = study(folder, {"scan": "milled part.x3p"}, "jk")
    made = faying.attach(folder / "model.inp", FACES, unit="mm", study=plan, pressure="5 MPa")
    assert made.deck.facts.count(line) == 1
