"""What the site is made from: keys and their words, sources, prepared curves, validation, the font, the README."""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from faying.contact.build import kinds, laws
from tests.helpers.published import KEYS, MEASURED

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
sys.path.append(str(DOCS / "_ext"))


@pytest.fixture(scope="module")
def reference():
    pytest.importorskip("sphinx", reason="the site needs the group docs")
    import faying_reference

    return faying_reference


def test_every_key_of_the_template_is_declared(reference, tmp_path):
    """`faying init` writes keys by hand: each is one that is declared."""
    import tomllib

    from faying_reference.study_keys import NAME, keys

    from faying.setup.template import TEXT

    found = {key.path for key in keys()}
    data = tomllib.loads(TEXT)

    def walk(table, where):
        for name, value in table.items():
            path = f"{where}.{name}" if where else name
            path = path if path in found else f"{where}.{NAME}"
            assert path in found or path.startswith("joint.surface"), path
            for inner in value if isinstance(value, list) else [value]:
                if isinstance(inner, dict):
                    walk(inner, path)

    walk(data, "")


def test_every_key_has_a_sentence(reference):
    from faying_reference.study_keys import keys

    assert [key.path for key in keys() if not key.meaning] == []


def test_keys_carry_what_the_readers_ask(reference):
    from faying_reference.study_keys import keys

    found = {f"{key.path} {key.model}".strip(): key for key in keys()}
    assert found["bolt.diameter"].kind == "quantity [m]"
    assert found["modes.count"].default == "10"
    assert found["geometry.step"].default == "required"
    assert found["joint.springs"].allowed == '"per-area" or "per-node"'
    assert found["law.cutoff JK"].default == "0.01"
    assert found["law.file Table"].kind == "file"
    assert "joint.law.model" not in found


DOI = re.compile(r"10\.\d{4,}/[^\s,;\"'`\]}]+")


def dois(text):
    """Each without the signs that follow it: a full stop, brackets that were opened before it."""
    for name in DOI.findall(text):
        while name[-1] in ".:" or (name[-1] == ")" and name.count(")") > name.count("(")):
            name = name[:-1]
        yield name.lower()


def test_the_sources_of_theory_and_laws_are_those_of_the_bibliography():
    listed = set(dois((DOCS / "references.bib").read_text()))
    cited = {name for path in DOCS.rglob("*.md") if "generated" not in path.parts for name in dois(path.read_text())}
    cited |= {name for law in laws().values() for name in dois(law.source)}
    assert cited - listed == set()


def test_every_law_has_its_equations_on_a_theory_page(reference):
    from faying_reference.law_pages import equations

    assert set(equations()) == {kind.law.name for kind in kinds().values() if kind.label != "auto"}


def test_the_curves_of_the_law_pages_are_those_of_the_laws(reference):
    """Of the laws that are quick: the half-space solution of this scan is compared by other tests."""
    from faying_reference.law_pages import curves

    from faying import Mates, read_scan

    mates = Mates(read_scan(ROOT / "examples" / "t-specimen" / "milled.x3p"), materials="45 steel")
    found = curves()
    names = [name for name in found if name != "half-space"]
    made, _ = mates.laws(names)
    assert set(names) <= set(made)
    for name in names:
        pressure = found[name]["pressure [Pa]"][::6]
        covered = pressure <= made[name].greatest_pressure
        response = made[name].at_pressure(pressure[covered])
        for column, value in (("area [-]", response.area), ("k_n [Pa/m]", response.k_n)):
            if value is not None:
                np.testing.assert_allclose(found[name][column][::6][covered], value, rtol=1e-4)


def test_the_table_of_published_numbers_is_complete():
    entries = json.loads((DOCS / "validation.json").read_text())
    assert len(entries) > 90
    assert {entry["test"].partition("::")[0] for entry in entries if entry.get(MEASURED)} == {
        "tests/contact/test_measured_stiffness.py",
        "tests/examples/test_t_specimen.py",
    }
    for entry in entries:
        assert tuple(entry) == (*KEYS, MEASURED) if entry.get(MEASURED) else tuple(entry) == KEYS
        off = abs(entry["ours"] - entry["published"])
        assert off <= entry["tolerance"] * (abs(entry["published"]) if entry["relative"] else 1) * (1 + 1e-5) + 1e-15
        path, _, name = entry["test"].partition("::")
        assert f"def {name.partition('[')[0]}(" in (ROOT / path).read_text(), entry["test"]


def test_the_font_is_the_one_whose_licence_lies_beside_it():
    fonts = DOCS / "_static" / "fonts"
    found = hashlib.sha256((fonts / "stix-two-math.woff").read_bytes()).hexdigest()
    assert found in (fonts / "README.txt").read_text()
    assert "SIL OPEN FONT LICENSE" in (fonts / "OFL.txt").read_text()


# what the gallery does with a script: no __file__, its folder as the working one, its path as the only argument
AS_THE_GALLERY = """
import sys
sys.argv = sys.argv[1:]
exec(compile(open(sys.argv[0]).read(), sys.argv[0], "exec"), {"__name__": "__main__", "__doc__": ""})
"""


def executed():
    """The scripts that the site's build executes, by the patterns of its configuration."""
    pattern = re.search(r'"filename_pattern": r"(.*)"', (DOCS / "conf.py").read_text())[1]
    return sorted(path for path in (DOCS / "gallery").glob("*.py") if re.search(pattern, str(path)))


def test_gallery_scripts_name_nothing_that_the_gallery_lacks():
    """The slow test runs them; this one finds the commonest fault in no time."""
    scripts = executed()
    assert {"front_page", "plot_laws"} <= {path.stem for path in scripts}
    assert not [path.name for path in scripts if "__file__" in re.sub(r"#.*", "", path.read_text())]


@pytest.mark.slow
@pytest.mark.skipif("FAYING_SITE" in os.environ, reason="a site was built: its gallery ran them")
@pytest.mark.parametrize("path", executed(), ids=lambda path: path.stem)
def test_gallery_scripts_hold_what_they_say(path, tmp_path):
    """Each runs as the gallery runs it; lessons end in an assertion of their own."""
    assert "\nassert " in path.read_text() or path.stem == "front_page"
    (tmp_path / "docs" / "figures").mkdir(parents=True)
    shutil.copytree(DOCS / "gallery", tmp_path / "docs" / "gallery")
    (tmp_path / "examples").symlink_to(DOCS.parent / "examples")
    script = tmp_path / "docs" / "gallery" / path.name
    done = subprocess.run(
        [sys.executable, "-c", AS_THE_GALLERY, str(script)],
        cwd=script.parent,
        env={**os.environ, "MPLBACKEND": "agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    if path.stem == "front_page":
        assert (tmp_path / "docs" / "figures" / "t-specimen.png").stat().st_size > 50_000  # the picture of the README
