"""`faying modes`: of a study, of matrices in files, and over two processes by SLEPc."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import load_npz

import faying.fe.slepc_worker as worker
from faying.cli import main
from tests.helpers.studies import write

WORKER = Path(worker.__file__)


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
    of_files = values(
        capsys,
        [
            "modes",
            "--stiffness",
            str(out / "stiffness.npz"),
            "--mass",
            str(out / "mass.npz"),
            "--count",
            "9",
            "--shift",
            "800 Hz",
        ],
    )
    assert np.all(of_study[:6] < 1)
    assert of_files[6:] == pytest.approx(of_study[6:], rel=1e-10)
    assert len((out / "dofs.txt").read_text().splitlines()) == load_npz(out / "mass.npz").shape[0]


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
    assert "--mass goes with --stiffness" in fault(capsys, ["modes", study, "--mass", str(out / "mass.npz")])
    assert "name the mass too" in fault(capsys, ["modes", "--stiffness", str(out / "stiffness.npz")])
    (tmp_path / "bad.npz").write_bytes(b"no zip")
    both = ["modes", "--stiffness", str(tmp_path / "bad.npz"), "--mass", str(out / "mass.npz")]
    assert "cannot be read as a sparse matrix" in fault(capsys, both)
    gone = ["modes", "--stiffness", str(tmp_path / "gone.npz"), "--mass", str(out / "mass.npz")]
    assert "no file" in fault(capsys, gone)
    text = ["modes", "--stiffness", str(out / "stiffness.npz"), "--mass", "mass.txt"]
    assert "should be .mtx or .npz" in fault(capsys, text)
    (tmp_path / "job.sti").write_text("")
    two = ["modes", "--stiffness", str(tmp_path / "job.sti"), "--mass", str(out / "mass.npz")]
    assert "brings its mass with it" in fault(capsys, two)
    (tmp_path / "file").write_text("")
    assert "cannot make the folder" in fault(capsys, ["modes", study, "--export", str(tmp_path / "file" / "x")])


def test_without_slepc_the_way_is_told(exported, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "slepc4py", None)
    out = exported / "out"
    argv = ["modes", "--stiffness", str(out / "stiffness.npz"), "--mass", str(out / "mass.npz"), "--slepc"]
    text = fault(capsys, argv)
    assert "needs petsc4py and slepc4py" in text
    assert "mpiexec -n 4 python3" in text


def python_with_slepc():
    """An interpreter that has slepc4py: this one, or the system's."""
    look = (
        "import glob, sys\nfor p in ('petsc', 'slepc'):\n"
        "    sys.path += glob.glob(f'/usr/lib/{p}dir/{p}*/*-real/lib/python3/dist-packages')\n"
        "from petsc4py import PETSc\nfrom slepc4py import SLEPc\nimport scipy\n"
    )
    for python in (sys.executable, "/usr/bin/python3"):
        if (
            Path(python).exists()
            and not subprocess.run([python, "-c", look], capture_output=True, check=False).returncode
        ):
            return python
    return None


@pytest.mark.slow
def test_slepc_on_two_processes(exported, capsys):
    python, mpiexec = python_with_slepc(), shutil.which("mpiexec")
    if python is None or mpiexec is None:
        pytest.skip("needs mpiexec and a Python with petsc4py and slepc4py (Debian: python3-slepc4py, python3-scipy)")
    out = exported / "out"
    files = [str(out / "stiffness.npz"), str(out / "mass.npz")]
    # Open MPI asks twice before it lets root start two processes on one core
    environment = os.environ | {
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
    }
    done = subprocess.run(
        [mpiexec, "-n", "2", python, str(WORKER), *files, "--count", "20", "--shift", "800"],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout)
    assert found["processes"] == 2
    ours = values(capsys, ["modes", "--stiffness", files[0], "--mass", files[1], "--count", "20", "--shift", "800 Hz"])
    theirs = np.array(found["frequencies"]["values"])
    assert np.all(theirs[:6] < 1)
    assert theirs[6:] == pytest.approx(ours[6:], rel=1e-8)
