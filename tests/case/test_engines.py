"""One study has one answer, whatever engine solves it and whatever memory is free."""

import os
import subprocess
import sys
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.answer.run import run
from faying.case import changed
from faying.errors import InputError
from faying.joint.shared_modes import RANGE_ERROR
from faying.numerics.solve import available
from faying.result import Result
from faying.result.fields import GROUP
from faying.result.vibration import VibrationResponse
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
    """Two blocks and a bolt, coarse."""
    path = tmp_path_factory.mktemp("engines") / "study.toml"
    studies.write(path)
    one = path.read_text().replace('["2 kN", "6 kN"]', '"6 kN"')
    path.write_text(one.replace("count = 6", "count = 3").replace("levels = []", 'levels = ["1 m/s^2", "100 m/s^2"]'))
    return Study.read(path)


@pytest.fixture(scope="module")
def plenty(study):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FAYING_MEMORY", "inf")
        return run(study)


@by_parts
@pytest.mark.parametrize("gigabytes", ["0.05", pytest.param("0.06", marks=pytest.mark.slow)])
def test_free_memory_decides_nothing(study, plenty, gigabytes, monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", gigabytes)
    short = run(study)
    assert short.solver == "pardiso-by-parts"
    agree(short, plenty)


@pytest.mark.slow
def test_threads_decide_nothing(study, plenty, tmp_path):
    """Another process, as libraries read the number of their threads when they are loaded."""
    file = tmp_path / "two-threads.nc"
    code = "import sys, faying; faying.run(sys.argv[1]).save(sys.argv[2])"
    two = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "2")
    path = study.folder / "study.toml"
    subprocess.run([sys.executable, "-c", code, str(path), str(file)], env=os.environ | two, check=True)
    agree(faying.load(file), plenty)


# how an engine came to its answer, and shapes of twins, which may turn
OWN = {"imbalance", "newton_steps", "factor_memory", "loss_error", "rigid", "provenance", "solver", "bolt_numbers"}
SHAPES = {"shapes": 1e-4, "shapes_imaginary": 1e-2, "mac": 1e-4, "frac": 2e-4}
SHAPES |= {"stress_spread": 1e-4}  # of a bolt, the root of a difference that rounding leaves
# estimates: from the strains of a shape that is right to 1e-4; the residual of a response in the norm of each factor
ESTIMATES = {"mesh_error": 5e-3, "error": 0.1}
TOLERANCES = ESTIMATES | {"loss_factors": 1e-6, "low": RANGE_ERROR, "high": RANGE_ERROR}
RESPONSE = 2 * SHAPES["shapes"]  # of its greatest value; two shapes are in each term
# ends at the least friction, where a joint slides nearly as a whole and no cycle settles, are twice as far apart
FREQUENCY, DAMPING = 1e-8, 1e-2
# intervals and draws of waves, each in a small basis of its own: at the first and the last load, and between them
IN_A_BASIS, BETWEEN = 4 * changed.TOLERANCE, changed.BETWEEN
NO_SLIP = 1e-7  # damping ratio of modes that do not slip


def agree(one, other, prefix="", span=1.0, in_a_basis=IN_A_BASIS):
    """Every field of the results of two engines, each to what it is solved to; span: of the preloads [N]."""
    prefix = "level_" if isinstance(one, VibrationResponse) else prefix
    if isinstance(one, Result):
        span, in_a_basis = max(np.ptp(one.loads), 1.0), IN_A_BASIS if len(one.loads) < 3 else BETWEEN
    for field in fields(one):
        name, a, b = prefix + field.name, getattr(one, field.name), getattr(other, field.name)
        if GROUP in field.metadata and b is not None:
            agree(a, b, f"{field.metadata[GROUP]}_", span, in_a_basis)
        elif name == "level_error":
            slips = one.slip > NO_SLIP  # else it is the error of nothing
            assert a[slips] == pytest.approx(b[slips], abs=DAMPING, nan_ok=True)
        elif name == "level_frequencies":
            # slip moves the frequency as it makes damping: so much of a frequency as the stated error is of the ratio
            left = np.abs(a / b - 1) / (1e-7 + other.error * other.slip)
            assert np.array_equal(np.isnan(a), np.isnan(b))
            assert np.nanmax(left, initial=0.0) < 1
        elif name in ("tension", "compression") and b is not None:
            # of the greatest stress: of faces that are pressed no tension is left beside it
            least = FREQUENCY * float(np.nanmax(other.von_mises))
            assert a == pytest.approx(b, rel=1e-6, abs=least, nan_ok=True), name
        elif name == "wave_slopes" and b is not None:
            # differences of frequencies, each to what it is found to
            most = 2 * in_a_basis * np.nanmax(other.frequencies) / span
            assert a == pytest.approx(b, abs=most, nan_ok=True)
        elif field.name not in OWN:
            alike(name, a, b, in_a_basis)


def alike(name, a, b, in_a_basis):
    """One field."""
    if is_dataclass(b):
        agree(a, b)
    elif isinstance(b, tuple):
        for mine, theirs in zip(a, b, strict=True):
            alike(name, mine, theirs, in_a_basis)
    elif not (isinstance(b, np.ndarray) and b.dtype.kind in "fc"):
        assert np.array_equal(a, b) if isinstance(b, np.ndarray) else a == b, name
    elif b.dtype.kind == "c":
        assert a == pytest.approx(b, abs=RESPONSE * float(np.abs(b).max(initial=0.0)), nan_ok=True), name
    elif name.startswith("interval"):  # both ends of two things together are found in the basis of each by itself
        assert a == pytest.approx(b, rel=BETWEEN, abs=BETWEEN, nan_ok=True), name
    elif name.startswith("wave"):
        assert a == pytest.approx(b, rel=in_a_basis, abs=in_a_basis, nan_ok=True), name
    elif name in ("level_low", "level_high"):
        assert a == pytest.approx(b, rel=2 * DAMPING, abs=NO_SLIP, nan_ok=True), name
    elif name.startswith(("level_", "surface_")):  # the latter: stress under vibration
        assert a == pytest.approx(b, rel=DAMPING, abs=NO_SLIP, nan_ok=True), name
    else:
        rel = SHAPES.get(name) or TOLERANCES.get(name.removeprefix("alternative_"), FREQUENCY)
        least = rel if name in SHAPES or "loss" in name else 1e-7
        assert a == pytest.approx(b, rel=rel, abs=least * float(np.nanmax(np.abs(b), initial=1e-3)), nan_ok=True), name


def test_newton_and_lanczos_as_they_are_written_give_the_same(study, plenty):
    agree(run(study, engine="direct"), plenty)


@pytest.mark.slow
def test_damping_at_levels_does_not_depend_on_what_else_is_asked_for(study, plenty):
    """Another load before it, and the ends of an interval."""
    first = replace(study.preloads[0], forces=(4e3,))
    among = replace(study, preloads=(first, *study.preloads), modes=replace(study.modes, intervals=True))
    one, more = plenty, run(among)
    # equilibrium from another start is off by rounding, of which passes make 2e-3 where most of a joint slides
    for name in ("slip", "low", "high"):
        found, alone = getattr(more.levels, name)[-1], getattr(one.levels, name)[0]
        assert found == pytest.approx(alone, rel=3e-3, abs=NO_SLIP)


@pytest.mark.slow
def test_a_joint_that_slips_has_one_answer(study):
    """Its state depends on the load before."""
    joints = tuple(replace(joint, friction=0.2) for joint in study.joints)
    changed = replace(study, joints=joints)
    agree(run(changed), run(changed, engine="direct"))


@pytest.mark.slow
@pytest.mark.parametrize("example", EXAMPLES, ids=str)
def test_every_example_has_one_answer(example, tmp_path):
    study = Study.read(copied(ROOT / example, tmp_path / "examples"))
    found = [run(study), run(study, engine="direct")]
    if example.parts[1] == "solid-bolt":
        # in one draw of waves two modes are equally like mode 2, and the basis of each engine follows either
        found = [replace(one, waves=None, interval=None) for one in found]
    agree(*found)


def test_an_engine_of_another_name_is_refused(study):
    with pytest.raises(InputError, match="engine = 'fast'; allowed: reanalysis, direct"):
        run(study, engine="fast")
