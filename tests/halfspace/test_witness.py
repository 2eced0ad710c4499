"""Against other codes on the same heights, each in a process of its own; skipped where the interpreter has none.

FAYING_PEERS: a Python that has them. Neither is a dependency (Tamaas is AGPL: it only ever runs in a process of its
own).
"""

import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from peers.peer import PEERS, ask, interpreter, present

from faying.halfspace import error_bound, solve_half_space

there = cache(present)


def witness(code, h, pressure, hardness=None, tol=1e-7):
    (name,) = (name for name in PEERS if name.lower() == code)
    if name not in there(interpreter()):
        pytest.skip(f"not installed: {name}: {PEERS[name].get}; set FAYING_PEERS")
    given = {"heights": h, "pressure": pressure, "hardness": hardness or 0.0, "tol": tol}
    return ask(interpreter(), "half_space.py", code, **given)["traction"]


@pytest.mark.parametrize("code", ["tamaas", "contactmechanics"])
@pytest.mark.parametrize("pressure", [0.002, 0.01])
def test_elastic_contact_of_a_self_affine_map(code, pressure, rough):
    h = rough(256)
    ours = solve_half_space(h, 1 / 256, E_star=1.0, pressure=pressure, tol=1e-8)
    theirs = witness(code, h, pressure)
    assert error_bound(h, 1 / 256, theirs, E_star=1.0) < 1e-5
    assert ours.area == pytest.approx(np.count_nonzero(theirs > 0) / h.size, rel=1e-3)
    assert ours.traction == pytest.approx(theirs, abs=1e-3 * theirs.max())


@pytest.mark.parametrize("code", ["tamaas", "contactmechanics"])
def test_contact_at_hardness_of_a_self_affine_map(code, rough):
    h = rough(128)
    ours = solve_half_space(h, 1 / 128, E_star=1.0, pressure=0.002, hardness=0.05, tol=1e-8)
    theirs = witness(code, h, 0.002, 0.05)
    if error_bound(h, 1 / 128, theirs, E_star=1.0, hardness=0.05) > 1e-4:
        pytest.skip(f"{code} did not solve the problem, by our error bound")
    assert ours.area == pytest.approx(np.count_nonzero(theirs > 0) / h.size, rel=1e-2)
    assert ours.traction == pytest.approx(theirs, abs=0.02 * 0.05)


DATA = Path(os.environ.get("FAYING_DATA", Path(__file__).parents[2].parent / "shared" / "data")) / "scans"


@pytest.mark.parametrize("name", ["test1", "test2"])
@pytest.mark.parametrize("share", [0.02, 0.1, 0.4])
def test_machined_scan_at_the_hardness_of_steel(name, share):
    file = DATA / "nanovea-st400" / f"{name}.csv"
    if not file.exists():
        pytest.skip("no measured scans: set FAYING_DATA")
    # 101 points of 5 um a side, in units of the side; H/E* = .0045
    h = np.loadtxt(file, delimiter=",")[:, 2].reshape(101, 101) * 1e-6 / (101 * 5e-6)
    hardness, pressure = 0.0045, share * 0.0045
    ours = solve_half_space(h, 1 / 101, E_star=1.0, pressure=pressure, hardness=hardness)
    assert ours.residual < 1e-6
    assert ours.pressure == pytest.approx(pressure, rel=1e-9)
    theirs = witness("tamaas", h, pressure, hardness, tol=1e-8)
    assert error_bound(h, 1 / 101, theirs, E_star=1.0, hardness=hardness) < 1e-4
    assert ours.area == pytest.approx(np.count_nonzero(theirs > 0) / h.size, rel=0.01)
    assert ours.saturated == pytest.approx(np.count_nonzero(theirs > hardness * (1 - 1e-6)) / h.size, rel=0.01)
