"""`faying run --mpi`: the answer of a factorisation, from two processes of mpiexec."""

import json

import numpy as np
import pytest

from faying.cli import main
from faying.study import Study
from tests.helpers.mpi import mpi as mpi
from tests.helpers.studies import TEXT, write


def coarse(folder):
    """The two blocks in 12,000 unknowns, under one preload, with a form, so that no form is tried beside it."""
    path = folder / "study.toml"
    write(path)
    text = TEXT.format(name="study.toml", step="two-blocks.step")
    text = text.replace('"upper.joint" = "4 mm"', '"upper.joint" = "7 mm"').replace('["2 kN", "6 kN"]', '"6 kN"')
    path.write_text(text.replace("[[bolt]]", '[joint.form]\ncrown_along = "1 um"\n\n[[bolt]]', 1))
    return path


def result(capsys, *argv):
    capsys.readouterr()
    with pytest.raises(SystemExit) as end:
        main(["run", *argv, "--no-files", "--json"])
    told = capsys.readouterr()
    assert not end.value.code, told.err
    return json.loads(told.out)


@pytest.mark.slow
def test_a_run_gives_the_answer_of_a_factorisation(mpi, tmp_path, capsys):
    path = str(coarse(tmp_path))
    plain, over = result(capsys, path), result(capsys, path, "--mpi", "2")

    def both(key):
        return np.array(over[key]["values"]), np.array(plain[key]["values"])

    for key, least in {"frequencies": 1e-8, "free": 1e-8, "bonded": 1e-8, "loss_factors": 1e-6}.items():
        found, wanted = both(key)
        assert found == pytest.approx(wanted, rel=least), key
    for key in ("total_k_n", "total_k_t", "greatest_pressure"):
        found, wanted = both(key)
        assert found == pytest.approx(wanted, rel=1e-6), key
    found, wanted = (np.array(one["bolt_numbers"]["member_compliance"]["values"]) for one in (over, plain))
    assert found == pytest.approx(wanted, rel=1e-6)
    assert over["solver"] == "mpi, 2 processes"
    assert any("memory of each process" in note["text"] for note in over["notes"])
    assert not [path for path in mpi.iterdir() if path.name.startswith("faying-mpi")]


def test_a_study_names_it(tmp_path):
    path = coarse(tmp_path)
    path.write_text(path.read_text().replace("[modes]", '[modes]\nsolver = "mpi"'))
    assert Study.read(path).modes.solver == "mpi"


def test_a_backbone_is_refused_before_the_work(tmp_path, capsys):
    path = coarse(tmp_path)
    path.write_text(path.read_text() + "\n[backbone]\nmode = 1\n")
    with pytest.raises(SystemExit) as end:
        main(["run", str(path), "--mpi", "2", "--no-files"])
    assert end.value.code == 1
    assert "[backbone] needs a factorisation" in capsys.readouterr().err
