"""One study has one answer, whatever engine solves it and whatever memory is free."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import faying
from faying.answer.run import run
from faying.case.engine import RANGE_ERROR
from faying.errors import InputError
from faying.numerics.solve import available
from faying.study import Study
from tests.helpers import studies
from tests.helpers.examples import copied

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted(
    p.relative_to(ROOT) for p in (ROOT / "examples").rglob("*.toml") if p.stem not in ("uncertain", "laws-evidence")
)
by_parts = pytest.mark.skipif("pardiso" not in available(), reason="only PARDISO factorises part by part")


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """Two blocks and a bolt."""
    path = tmp_path_factory.mktemp("engines") / "study.toml"
    studies.write(path)
    one = path.read_text().replace('["2 kN", "6 kN"]', '"6 kN"')
    path.write_text(one)
    return Study.read(path)


@pytest.fixture(scope="module")
def plenty(study):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FAYING_MEMORY", "inf")
        return run(study)


@by_parts
@pytest.mark.parametrize("gigabytes", ["0.08", pytest.param("0.1", marks=pytest.mark.slow)])
def test_free_memory_decides_nothing(study, plenty, gigabytes, monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", gigabytes)
    short = run(study)
    assert short.solver == "pardiso-by-parts"
    agree(short, plenty)


def test_threads_decide_nothing(study, plenty, tmp_path):
    """Another process, as libraries read the number of their threads when they are loaded."""
    file = tmp_path / "two-threads.nc"
    code = "import sys, faying; faying.run(sys.argv[1]).save(sys.argv[2])"
    two = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "2")
    path = study.folder / "study.toml"
    subprocess.run([sys.executable, "-c", code, str(path), str(file)], env=os.environ | two, check=True)
    agree(faying.load(file), plenty)


def agree(one, other):
    """Results of two engines: frequencies to 1e-8, ends of ranges to what they are solved to, pressures to 1e-7."""
    for name in ("frequencies", "free", "bonded"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-8, abs=1e-3), name
    for name in ("low", "high"):
        if getattr(other, name) is not None:
            assert getattr(one, name) == pytest.approx(getattr(other, name), rel=RANGE_ERROR), name
    assert one.pressure == pytest.approx(other.pressure, abs=1e-7 * other.pressure.max(), nan_ok=True)
    assert one.loss_factors == pytest.approx(other.loss_factors, rel=1e-6, nan_ok=True)
    assert one.bolt_forces == pytest.approx(other.bolt_forces, rel=1e-8)
    assert one.notes == other.notes


def test_newton_and_lanczos_as_they_are_written_give_the_same(study, plenty):
    agree(run(study, engine="direct"), plenty)


@pytest.mark.slow
def test_a_joint_that_slips_has_one_answer(study):
    """Its state depends on the load before."""
    joints = tuple(replace(joint, friction=0.2) for joint in study.joints)
    changed = replace(study, joints=joints)
    agree(run(changed), run(changed, engine="direct"))


@pytest.mark.slow
@pytest.mark.parametrize("example", EXAMPLES, ids=str)
def test_every_example_has_one_answer(example, tmp_path):
    study = copied(ROOT / example, tmp_path / "examples")
    agree(run(study), run(study, engine="direct"))


def test_an_engine_of_another_name_is_refused(study):
    with pytest.raises(InputError, match="engine = 'fast'; allowed: reanalysis, direct"):
        run(study, engine="fast")
