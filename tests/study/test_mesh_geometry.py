"""A study whose geometry is a mesh file of another program."""

import numpy as np
import pytest

import faying
from faying.answer.run import run
from faying.fe.elasticity import assemble
from faying.numerics.modes import lowest_modes
from faying.study import Study
from tests.helpers import meshfiles
from tests.helpers.boxes import row

TEXT = meshfiles.STUDY


def blocks(**changes):
    given = {"kinds": ("hex20", "tet10"), "sections": ((2, 2), (3, 2)), "width": 0.02, "height": 0.015}
    return row([0.05, 0.04], [3, 3], **(given | changes))


def study(tmp_path, text=TEXT, mesh=None):
    (tmp_path / "model.inp").write_text(meshfiles.abaqus(mesh or blocks()))
    (tmp_path / "study.toml").write_text(text)
    return Study.read(tmp_path / "study.toml")


def test_run_on_a_mesh_of_bricks_and_tetrahedra_that_do_not_match(tmp_path):
    result = run(study(tmp_path))
    assert result.frequencies.shape == (2, 3)
    assert np.all(np.diff(result.frequencies, axis=0) > 0)
    for load, pressure in zip(result.loads, result.pressure, strict=True):
        assert result.weights @ pressure == pytest.approx(load, rel=1e-8)
    assert result.weights.sum() == pytest.approx(0.02 * 0.015, rel=1e-8)
    assert any("model.inp" in line for line in result.sources)
    whole = row([0.09], [9], kinds=("hex20",), sections=((2, 2),), width=0.02, height=0.015)
    K, M = assemble(whole, {"p0": faying.CATALOGUE["45 steel"]})
    solid = lowest_modes(K, M, 9, shift_frequency=1000.0).frequencies[6:]
    assert np.all(result.frequencies < 1.001 * solid)
    assert result.bonded[:3] == pytest.approx(solid, rel=0.01)


def test_element_sets_can_be_given_the_names_of_parts(tmp_path):
    text = TEXT.replace('unit = "mm"', 'unit = "mm"\nsets = { upper = "p0", lower = "p1" }')
    text = text.replace("[part.p0]", "[part.upper]").replace("[part.p1]", "[part.lower]")
    assert run(study(tmp_path, text)).frequencies.shape == (2, 3)


def test_faults(tmp_path):
    with pytest.raises(
        faying.InputError, match='geometry.unit is missing: a mesh file does not state its unit; .* unit = "mm"'
    ):
        study(tmp_path, TEXT.replace('unit = "mm"\n', ""))
    with pytest.raises(faying.InputError, match="geometry.size is for a STEP file"):
        study(tmp_path, TEXT.replace('unit = "mm"', 'unit = "mm"\nsize = "5 mm"'))
    with pytest.raises(faying.InputError, match="geometry.mesh: no file"):
        study(tmp_path, TEXT.replace("model.inp", "other.inp"))
    with pytest.raises(faying.InputError, match="part 'roof' is not in model.inp; it has p0, p1"):
        run(study(tmp_path, TEXT.replace("[part.p1]", "[part.roof]")))
    with pytest.raises(faying.InputError, match="in um the structure is .* m long; is that its unit"):
        run(study(tmp_path, TEXT.replace('unit = "mm"', 'unit = "um"')))


def test_a_part_that_no_face_holds(tmp_path):
    mesh = row(
        [0.05, 0.04, 0.03], [2, 2, 2], kinds=("hex8",) * 3, sections=((2, 2),) * 3, width=0.02, height=0.015, gap=1e-5
    )
    text = TEXT.replace("[surface]", '[part.p2]\nmaterial = "45 steel"\n[surface]')
    with pytest.raises(faying.InputError, match="part p2 has no joint"):
        run(study(tmp_path, text, mesh))
