"""Against other codes on the same heights, each in its own interpreter; skipped where the environment names none.

FAYING_WITNESS: a Python that has tamaas; FAYING_WITNESS_CM: one that has ContactMechanics. Neither is a dependency
(Tamaas is AGPL: it only ever runs in a process of its own).
"""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from faying.halfspace import error_bound, solve_half_space

SCRIPT = Path(__file__).parents[2] / "benchmarks" / "halfspace_witness.py"
PYTHON = {"tamaas": os.environ.get("FAYING_WITNESS"), "contactmechanics": os.environ.get("FAYING_WITNESS_CM")}


def witness(code, folder, h, pressure, hardness=None, tol=1e-7):
    if PYTHON[code] is None:
        pytest.skip(f"no interpreter with {code}: set FAYING_WITNESS or FAYING_WITNESS_CM")
    given, found = folder / "in.npz", folder / "out.npz"
    np.savez(given, heights=h, pressure=pressure, hardness=hardness or 0.0, tol=tol)
    subprocess.run([PYTHON[code], SCRIPT, code, given, found], check=True, capture_output=True)
    with np.load(found) as out:
        return out["traction"]


@pytest.mark.parametrize("code", ["tamaas", "contactmechanics"])
@pytest.mark.parametrize("pressure", [0.002, 0.01])
def test_elastic_contact_of_a_self_affine_map(code, pressure, rough, tmp_path):
    h = rough(256)
    ours = solve_half_space(h, 1 / 256, E_star=1.0, pressure=pressure, tol=1e-8)
    theirs = witness(code, tmp_path, h, pressure)
    assert error_bound(h, 1 / 256, theirs, E_star=1.0) < 1e-5
    assert ours.area == pytest.approx(np.count_nonzero(theirs > 0) / h.size, rel=1e-3)
    assert ours.traction == pytest.approx(theirs, abs=1e-3 * theirs.max())


@pytest.mark.parametrize("code", ["tamaas", "contactmechanics"])
def test_contact_at_hardness_of_a_self_affine_map(code, rough, tmp_path):
    h = rough(128)
    ours = solve_half_space(h, 1 / 128, E_star=1.0, pressure=0.002, hardness=0.05, tol=1e-8)
    theirs = witness(code, tmp_path, h, 0.002, 0.05)
    if error_bound(h, 1 / 128, theirs, E_star=1.0, hardness=0.05) > 1e-4:
        pytest.skip(f"{code} did not solve the problem, by our error bound")
    assert ours.area == pytest.approx(np.count_nonzero(theirs > 0) / h.size, rel=1e-2)
    assert ours.traction == pytest.approx(theirs, abs=0.02 * 0.05)


DATA = Path(os.environ.get("FAYING_DATA", Path(__file__).parents[2].parent / "shared" / "data")) / "scans"


@pytest.mark.parametrize("name", ["test1", "test2"])
@pytest.mark.parametrize("share", [0.02, 0.1, 0.4])
def test_machined_scan_at_the_hardness_of_steel(name, share, tmp_path):
    file = DATA / "nanovea-st400" / f"{name}.csv"
    if not file.exists():
        pytest.skip("no measured scans: set FAYING_DATA")
    # 101 points of 5 um a side, in units of the side; H/E* = .0045
    h = np.loadtxt(file, delimiter=",")[:, 2].reshape(101, 101) * 1e-6 / (101 * 5e-6)
    hardness, pressure = 0.0045, share * 0.0045
    ours = solve_half_space(h, 1 / 101, E_star=1.0, pressure=pressure, hardness=hardness)
    assert ours.residual < 1e-6
    assert ours.pressure == pytest.approx(pressure, rel=1e-9)
    theirs = witness("tamaas", tmp_path, h, pressure, hardness, tol=1e-8)
    assert error_bound(h, 1 / 101, theirs, E_star=1.0, hardness=hardness) < 1e-4
    assert ours.area == pytest.approx(np.count_nonzero(theirs > 0) / h.size, rel=0.01)
    assert ours.saturated == pytest.approx(np.count_nonzero(theirs > hardness * (1 - 1e-6)) / h.size, rel=0.01)
