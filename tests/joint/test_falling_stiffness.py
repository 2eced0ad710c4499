"""Stiffness falls to nothing with the pressure, without a jump, and so do frequencies move with the preload."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.case.case import Case
from faying.contact import PowerLaw, TabulatedLaw
from faying.contact.build import kinds
from faying.contact.models.half_space import HalfSpace
from faying.fe.interface import join
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.preload_case import PreloadCase
from faying.joint.structure import Structure
from faying.study import Study
from tests.contact.test_python_first import MATES
from tests.helpers import studies
from tests.helpers.laws import Given
from tests.helpers.plates import STEEL, stacked
from tests.helpers.rings import discs

# first points scatter, as those of a scan of which few spots touch: k falls with rising pressure from 16 to 50 kPa
SCATTERED = "pressure [kPa],k_n [MPa/um]\n16,0.34\n50,0.3\n100,0.8\n300,1.9\n1000,6\n100000,400\n"


def table(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(SCATTERED)
    return TabulatedLaw.from_csv(path)


def stiff_laws():
    """Every law that has a stiffness and asks for no file, on one surface."""
    labels = [label for label in kinds() if label not in ("Table", "GW-measured", "Power law", "auto")]
    made, _ = MATES.laws(labels)
    yield from (law for law in made.values() if law.at_pressure(law.greatest_pressure).k_n is not None)
    yield PowerLaw(C=1e-9, m=0.4)


def rises(values, tolerance):
    """Whether values rise up to a share, and no step to the next is more than two times."""
    return np.all(values >= (1 - tolerance) * np.maximum.accumulate(values)) and np.all(values[1:] <= 2 * values[:-1])


def falls_to_nothing(law):
    """k_n, k_t and k_load from the end of a law down to 1e-12 of it, and at 0.

    GW-JG and GW-ZMC have a k_n of their own that falls by 3e-4. k_load of a solved contact, the slope between
    solved pressures, scatters by 6 % of so small a map. Near its end it falls: spots that carry the hardness flow.
    """
    end, least = law.model.greatest_pressure, law.least_pressure
    p = np.unique(np.concatenate([end * np.geomspace(1e-12, 1, 2000), least * (1 + np.array([-1e-9, 0, 1e-9]))]))
    near = np.abs(p / least - 1) < 1e-8
    k_n, k_t = law.stiffness(p)
    approach = np.array([law.approach(float(one)) for one in p[::50]])
    pressure, k_load = law.pressure(approach)
    assert pressure == pytest.approx(p[::50], rel=1e-3)
    for k in (k_n, k_t):
        assert rises(k, 1e-3)
        assert k[near] == pytest.approx(k[near][0], rel=1e-6)
        assert np.all(np.diff(k[p < least]) > 0)
        assert k[0] < 1e-2 * k[-1]
    assert rises(k_load[p[::50] <= least], 0.0) if np.any(p[::50] <= least) else True
    solved = isinstance(law.model, HalfSpace)
    k_load = k_load[pressure < end / 10] if solved else k_load
    assert np.all(k_load >= (1 - (0.06 if solved else 1e-6)) * np.maximum.accumulate(k_load))
    assert np.array_equal(np.concatenate(law.stiffness(np.zeros(3))), np.zeros(6))
    assert np.array_equal(np.concatenate(law.pressure(np.array([-1e-9, 0.0]))), np.zeros(4))


def test_every_law_falls_to_nothing_with_the_pressure():
    checked = 0
    for model in stiff_laws():
        falls_to_nothing(JointLaw(model=model))
        checked += 1
    assert checked > 10


def test_a_table_whose_first_points_scatter_falls_to_nothing_too(tmp_path):
    law = JointLaw(model=table(tmp_path))
    below = np.geomspace(1e-6, 1, 50) * law.least_pressure
    for k in law.stiffness(below):
        assert rises(k, 0.0)
    p, k_load = law.pressure(np.linspace(0, law.approach(law.least_pressure), 50)[1:])
    assert np.all(np.diff(k_load) > 0)
    assert np.all(np.diff(p) > 0)


def test_one_hertzian_spot_keeps_its_power():
    """p = C w^(3/2) has k in proportion to p^(1/3)."""
    law = JointLaw(model=Given(k_n=lambda p: 1e9 * p ** (1 / 3), k_t=lambda p: 1e9 * p ** (1 / 3)))
    p = np.geomspace(1e-9, 1e6, 31)
    assert law.stiffness(p)[0] == pytest.approx(1e9 * p ** (1 / 3), rel=1e-6)


def frequencies(tmp_path, loads):
    """Two blocks, of which a quarter is open, under rising preloads [N] (n,): (n, modes) [Hz]."""
    studies.write(tmp_path / "study.toml")
    table(tmp_path)
    study = Study.read(tmp_path / "study.toml").with_("law", {"model": "table", "file": str(tmp_path / "table.csv")})
    sizes = dict.fromkeys(study.geometry.face_size, 6e-3)
    study = replace(
        study,
        geometry=replace(study.geometry, size=12e-3, face_size=sizes),
        preloads=tuple(PreloadCase(forces=(float(load),)) for load in loads),
    )
    case = Case.of(study)
    engine, joint = case.engine("reanalysis"), case.structure.joints[0]
    out = []
    for k in range(len(loads)):
        preload = engine.preload(k)
        out.append(engine.vibrate(case.structure.springs(preload.pressures)).damped.frequencies)
    shut = preload.pressures[0] > 0
    assert 0.5 < joint.interface.weights @ shut / joint.interface.area < 0.95
    return np.array(out)


def of_two(mesh, preloads, law, hole=0.0, crown=0.0):
    """Two frequencies (n, 2) [Hz] of two parts under rising preloads [N] of a bolt; crown: gap at 10 mm from it [m]."""
    faces, seats = ("low.top", "high.bottom"), ("low.bottom", "high.top")
    joint = FittedJoint(name="j", faces=faces, interface=join(mesh, *faces), law=law)
    middle = mesh.points[mesh.face_nodes(faces[0])].mean(axis=0)
    away = np.linalg.norm(joint.interface.positions - middle, axis=1) / 10e-3
    joint = replace(joint, interface=replace(joint.interface, gap=crown * away**2))
    structure = Structure(
        mesh=mesh,
        materials=dict.fromkeys(mesh.parts, STEEL),
        joints=(joint,),
        bolts=(faying.Bolt("b", seats, at=tuple(middle), seat=(hole, 18e-3)),),
    )
    states = [structure.solve(preload=float(load), modes=2) for load in preloads]
    shut = [joint.interface.weights @ (s.preload.pressures[0] > 0) / joint.interface.area for s in states]
    assert 0.02 < min(shut) <= max(shut) < 0.98
    return np.array([state.frequencies for state in states])


def off_cubic(values):
    """Relative distance of each value (n, m), evenly spaced, from the cubic through its two neighbours on each side."""
    cubic = (-values[:-4] + 4 * values[1:-3] + 4 * values[3:-1] - values[4:]) / 6
    return np.abs(values[2:-2] / cubic - 1)


@pytest.mark.parametrize("count", [9, pytest.param(200, marks=pytest.mark.slow)])
def test_frequencies_move_smoothly_with_the_preload(count, tmp_path):
    """Points at the rim come to touch one after another."""
    assert np.all(off_cubic(frequencies(tmp_path, 9.2e3 + 25.0 * np.arange(count))) < 1e-5)


@pytest.mark.parametrize("count", [9, pytest.param(200, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ["plates", "crowned discs"])
def test_frequencies_of_parts_that_lift_off_are_smooth(name, count, tmp_path):
    """Plates that lift off at both ends, and discs that touch over more and more of a crown."""
    loads = 4e3 + 10.0 * np.arange(count)
    if name == "plates":
        mesh = stacked(counts=(20, 6, 1), size=(0.12, 0.04, 0.01))
        found = of_two(mesh, loads, JointLaw(model=table(tmp_path)))
    else:
        mesh = discs(np.linspace(4e-3, 20e-3, 9), 16, [0.0, 10e-3])
        found = of_two(mesh, loads, JointLaw(model=MATES.law("gw")), hole=8e-3, crown=1e-6)
    assert np.all(off_cubic(found) < 1e-5)
