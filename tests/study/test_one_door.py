"""A decision is made in one place: what one command or key says of a law, a surface or a file, every other says too."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.case.case import Case
from faying.cli.scan.law import command as law_command
from faying.contact.build import AUTO, build, kinds
from faying.decks.included import included
from faying.study import Study
from faying.study.keys.surface import SurfaceChoice
from faying.study.part_folder import fingerprint
from tests.helpers import meshfiles
from tests.helpers.boxes import row
from tests.helpers.studies import write

STEEL = faying.CATALOGUE["45 steel"]


@pytest.fixture
def folder(tmp_path):
    write(tmp_path / "study.toml")
    return tmp_path


def study(folder, **tables):
    import tomllib

    data = tomllib.loads((folder / "study.toml").read_text())
    return Study.from_dict(data | tables, folder=folder)


@pytest.fixture(scope="module")
def gappy(tmp_path_factory):
    """A rough scan of 96 x 96 points, a fifth of them missing in patches."""
    scan = faying.synthesize.spectral(D=2.3, G=1e-10, shape=(96, 96), spacing=5e-6, seed=3)
    heights = np.array(scan.heights)
    rng = np.random.default_rng(0)
    for _ in range(90):
        y, x = rng.integers(0, 92, 2)
        heights[y : y + 5, x : x + 5] = np.nan
    path = tmp_path_factory.mktemp("scan") / "gappy.x3p"
    faying.write_scan(faying.Scan(heights=heights, spacing=scan.spacing), path)
    return path


def test_law_and_run_take_the_same_inputs_from_a_scan_with_missing_points(gappy, folder):
    """Both take slopes and curvatures from measured points alone; filled ones would smooth them."""
    words = ["--scan", str(gappy), "--model", "gw", "--material", "45 steel", "--against", "same", "--json"]
    words += ["--counter", "smooth"]
    out = json.loads(CliRunner().invoke(law_command, words, catch_exceptions=False, standalone_mode=False).output)
    surface = SurfaceChoice(scan=gappy, counter="smooth").read()
    law = build("gw", {}, surface.rough, faying.ContactPair(STEEL, STEEL))
    assert out["parameters"]["radius"]["values"] == pytest.approx(law.radius, rel=1e-12)
    filled = np.asarray(surface.rough.scan.heights)
    smooth = type(surface.rough.inputs).from_heights(
        filled, surface.rough.scan.spacing, D=surface.rough.inputs.D, G=surface.rough.inputs.G
    )
    assert smooth.summit_radius > 1.02 * law.radius


@pytest.mark.parametrize("spelling", ["jk", "JK", "j-k", "j_k"])
def test_any_spelling_of_a_law_is_that_law(folder, spelling):
    assert study(folder, law={"model": spelling}).law.model == "JK"


def test_every_parameter_that_a_law_declares_is_a_key(folder):
    found = study(folder, law={"model": "jk", "shear_stress": "1 MPa"})
    law = found.law.make(found.surface.read(), STEEL, STEEL).law
    assert law.shear_stress == 1e6


def test_the_source_of_a_material_is_kept_and_shown(folder):
    own = {"E": "200 GPa", "nu": 0.3, "density": "7800 kg/m^3", "yield_strength": "355 MPa", "friction": 0.2}
    plan = study(folder, material={"mine": own | {"source": "data sheet 7"}})
    assert plan.materials["mine"].source == "data sheet 7"
    used = replace(plan, parts=dict.fromkeys(plan.parts, "mine"))
    from faying.answer.run import _sources

    assert "material mine: data sheet 7" in _sources(Case.of(used))


def test_a_sweep_depends_on_every_file_that_a_key_names(folder):
    """Each file in turn: where its bytes change, another sweep is meant."""
    (folder / "gap.csv").write_text("x,y,gap\n0,0,0\n40,0,0\n0,30,0\n40,30,0.1\n")
    (folder / "law.csv").write_text("pressure [MPa],k_n [MPa/um],k_t [MPa/um]\n0.01,1,0.5\n50,900,400\n")
    gap = {"file": "gap.csv", "xy_unit": "mm", "gap_unit": "um"}
    faces = ["upper.joint", "lower.joint"]
    plan = study(
        folder,
        joint=[{"name": "j", "faces": faces, "form": {"gap": gap}, "law": {"model": "table", "file": "law.csv"}}],
    )
    assert {file.name for file in plan.files} == {"gap.csv", "law.csv", plan.geometry.file.name}
    before = fingerprint(plan, [], 1e-6)
    for file in plan.files:
        content = file.read_bytes()
        file.write_bytes(content + b"\n")
        assert fingerprint(plan, [], 1e-6) != before, file.name
        file.write_bytes(content)
    assert fingerprint(plan, [], 1e-6) == before


def test_a_sweep_depends_on_the_files_that_a_mesh_includes(tmp_path):
    """A deck names its nodes, these name more: what changes in any of them is another model."""
    mesh = row([0.05, 0.04], [2, 1], kinds=("hex8", "hex8"), sections=((2, 1), (2, 1)), width=0.02, height=0.01)
    head, _, rest = meshfiles.abaqus(mesh).partition("*Element")
    nodes = head[head.index("\n", head.index("*Node")) + 1 :]
    (tmp_path / "study.toml").write_text(meshfiles.STUDY)
    (tmp_path / "model.inp").write_text("*Include,\n input=all.inp\n*Element" + rest)
    (tmp_path / "all.inp").write_text("*Node, INPUT=nodes.txt\n")
    (tmp_path / "nodes.txt").write_text(nodes)
    plan = Study.read(tmp_path / "study.toml")
    assert {file.name for file in plan.files} == {"model.inp", "all.inp", "nodes.txt"}
    before = fingerprint(plan, [], 1e-6)
    (tmp_path / "nodes.txt").write_text(nodes.replace("0, 0, 0", "0, 0, 0.0", 1))
    assert fingerprint(plan, [], 1e-6) != before
    (tmp_path / "a.bdf").write_text("BEGIN BULK\nINCLUDE 'b.bdf'\n")
    (tmp_path / "b.bdf").write_text("include a.bdf\n")
    assert [file.name for file in included(tmp_path / "a.bdf")] == ["b.bdf"]


def test_documented_laws_are_public_names():
    for kind in kinds().values():
        if kind.label == AUTO:
            continue  # a choice among laws
        assert kind.law.__name__ in dir(faying.contact), kind.label


def test_the_readme_commands_list_equals_the_commands():
    """`faying --help` lists each command; each has a help text of its own."""
    from faying.cli.main import COMMANDS, cli

    for name in COMMANDS:
        done = CliRunner().invoke(cli, [name, "--help"])
        assert done.exit_code == 0, name
        assert "Usage:" in done.output
        assert all(len(line) <= 80 for line in done.output.splitlines()), name
    assert (Path(faying.__file__).parent / "py.typed").exists()
