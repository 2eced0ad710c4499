"""`faying modes`: of a study, and of matrices in files."""

import json

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import load_npz

from faying.cli import main
from tests.helpers.studies import write


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    folder = tmp_path_factory.mktemp("modes")
    write(folder / "study.toml")
    main_quietly(["modes", str(folder / "study.toml"), "--export", str(folder / "out")])
    return folder


def main_quietly(argv):
    with pytest.raises(SystemExit) as end:
        main(argv)
    assert not end.value.code, argv


def values(capsys, argv):
    capsys.readouterr()
    main_quietly([*argv, "--json"])
    return np.array(json.loads(capsys.readouterr().out)["frequencies"]["values"])


def fault(capsys, argv):
    capsys.readouterr()
    with pytest.raises(SystemExit) as end:
        main(argv)
    assert end.value.code == 1
    return capsys.readouterr().err


def test_a_study_and_its_matrices_have_the_same_modes(exported, capsys):
    of_study = values(capsys, ["modes", str(exported / "study.toml"), "--count", "9"])
    out = exported / "out"
    files = ["--stiffness", str(out / "stiffness.npz"), "--mass", str(out / "mass.npz")]
    of_files = values(capsys, ["modes", *files, "--count", "9", "--shift", "800 Hz"])
    assert np.all(of_study[:6] < 1)
    assert of_files[6:] == pytest.approx(of_study[6:], rel=1e-10)
    assert len((out / "dofs.txt").read_text().splitlines()) == load_npz(out / "mass.npz").shape[0]


def test_matrices_without_directions_have_no_known_mass(exported, capsys):
    out = exported / "out"
    files = ["modes", "--stiffness", str(out / "stiffness.npz"), "--mass", str(out / "mass.npz"), "--count", "7"]
    main_quietly(files)
    assert "mass: not known" in capsys.readouterr().out
    main_quietly([*files, "--json"])
    assert json.loads(capsys.readouterr().out)["mass"]["values"] == [None, None, None]
    main_quietly(["modes", str(exported / "study.toml"), "--count", "7"])
    assert "kg along x, " in capsys.readouterr().out


def test_matrix_market_with_units(exported, capsys, tmp_path):
    """The same matrices in N/mm and tonnes as text; frequencies in Hz do not change."""
    K, M = (load_npz(exported / "out" / f"{name}.npz") for name in ("stiffness", "mass"))
    mmwrite(tmp_path / "K.mtx", K * 1e-3, symmetry="symmetric", precision=17)
    mmwrite(tmp_path / "M.mtx", M * 1e-3, symmetry="symmetric", precision=17)
    argv = ["modes", "--stiffness", str(tmp_path / "K.mtx"), "--mass", str(tmp_path / "M.mtx"), "--count", "8"]
    units = ["--stiffness-unit", "N/mm", "--mass-unit", "t"]
    plain = ["modes", "--stiffness", str(exported / "out/stiffness.npz"), "--mass", str(exported / "out/mass.npz")]
    assert values(capsys, argv + units)[6:] == pytest.approx(values(capsys, [*plain, "--count", "8"])[6:], rel=1e-9)


def test_faults(exported, capsys, tmp_path):
    out, study = exported / "out", str(exported / "study.toml")
    assert "give either a study or --stiffness" in fault(capsys, ["modes"])
    assert "--mass: for --stiffness; a study has its own" in fault(
        capsys, ["modes", study, "--mass", str(out / "mass.npz")]
    )
    assert "name the mass too" in fault(capsys, ["modes", "--stiffness", str(out / "stiffness.npz")])
    (tmp_path / "bad.npz").write_bytes(b"no zip")
    both = ["modes", "--stiffness", str(tmp_path / "bad.npz"), "--mass", str(out / "mass.npz")]
    assert "cannot be read as a sparse matrix" in fault(capsys, both)
    gone = ["modes", "--stiffness", str(tmp_path / "gone.npz"), "--mass", str(out / "mass.npz")]
    assert "no file" in fault(capsys, gone)
    text = ["modes", "--stiffness", str(out / "stiffness.npz"), "--mass", "mass.txt"]
    assert "give it as .mtx or .npz" in fault(capsys, text)
    (tmp_path / "job.sti").write_text("")
    two = ["modes", "--stiffness", str(tmp_path / "job.sti"), "--mass", str(out / "mass.npz")]
    assert "brings its mass with it" in fault(capsys, two)
    (tmp_path / "file").write_text("")
    assert "cannot make the folder" in fault(capsys, ["modes", study, "--export", str(tmp_path / "file" / "x")])


ATTACH = ["attach", "m.inp", "--face-a", "A", "--face-b", "B", "--unit", "mm", "--law", "s.toml", "--to", "abaqus"]


@pytest.mark.parametrize(
    ("argv", "said"),
    [
        ([*ATTACH, "--pressure", "5 MPa", "--preload", "8 kN"], "--preload: with --pressure solve alone"),
        ([*ATTACH, "--pressure", "5 MPa", "--mass", "m.mtx", "--modes", "3"], "--mass, --modes: with --matrices alone"),
        (["modes", "s.toml", "--stiffness-unit", "N/mm"], "--stiffness-unit: for --stiffness; a study has its own"),
        (["condense", "s.toml", "--superelement", "--element", "7"], "--element: of one joint; a superelement has"),
        (["condense", "s.toml", "--interface", "top"], "--interface: of a superelement; add --superelement"),
        (["condense", "s.toml", "--unit", "mm"], "--unit: of a deck that has units and numbers"),
    ],
)
def test_options_without_effect_are_refused(argv, said, capsys):
    """They were taken without a word: a preload that the study has not, files that are not there."""
    assert said in fault(capsys, argv)
