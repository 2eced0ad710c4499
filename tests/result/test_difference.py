"""Two results compared: pairs of modes, numbers of joints, and what does not compare is said."""

from dataclasses import replace

import numpy as np
import pytest

from faying.errors import InputError
from faying.result.difference import carried, compare_runs, of_joint
from tests.helpers.scenes import two_boxes

FIRST = two_boxes()


def test_a_result_does_not_differ_from_itself():
    found = compare_runs(FIRST, FIRST)
    assert found.loads == (1, 1)
    assert found.modes.tolist() == [[0, 0], [1, 1], [2, 2]]
    assert found.mac == pytest.approx(1.0)
    assert np.all(found.frequency_change == 0)
    assert found.notes == ()


def test_modes_are_found_by_their_shapes_in_another_order_on_another_mesh():
    """The shapes are those of one formula on both meshes, the second run has its first two modes exchanged."""
    finer = two_boxes(counts=(4, 8))
    order = [1, 0, 2]
    f = np.array([[240.0, 105.0, 590.0], [273.0, 99.0, 610.0]])
    second = two_boxes(counts=(4, 8), frequencies=f, shapes=finer.shapes[:, order])
    found = compare_runs(FIRST, second)
    assert found.modes.tolist() == [[0, 1], [1, 0], [2, 2]]
    assert found.mac.min() > 0.85  # the third is one and a half waves over 9 and over 12 elements
    assert found.frequency_change == pytest.approx([99 / 110 - 1, 273 / 260 - 1, 0.0])
    rows = found.mode_rows()
    assert rows[1][:4] == ["1, 2", "110.00", "99.00", "-10.00"]
    assert found.notes == ()


def test_a_mode_of_another_kind_has_no_partner():
    shapes = np.array(FIRST.shapes, dtype=float)
    shapes[:, 2] = 0.0
    shapes[:, 2, :, 1] = 1.0  # all along y, in which no other moves
    found = compare_runs(FIRST, two_boxes(shapes=shapes))
    assert found.modes.tolist() == [[0, 0], [1, 1]]
    assert "modes of the first run without a partner: 3 (610 Hz)" in found.notes
    assert "modes of the second run without a partner: 3 (610 Hz)" in found.notes


def test_another_structure_is_paired_by_number_and_says_so():
    found = compare_runs(FIRST, two_boxes(lengths=(0.1, 0.4)))
    assert found.modes.tolist() == [[0, 0], [1, 1], [2, 2]]
    assert np.isnan(found.mac).all()
    assert "mm apart, so modes are paired by their number" in found.notes[0]
    assert found.mode_rows()[1][-1] == "-"


def test_pressures_are_means_over_the_area():
    """Half of the area under 2 MPa, a quarter under 4, a quarter open: mean 2, greatest 4, 25 % open."""
    weights = FIRST.weights
    share = (np.cumsum(weights) - weights / 2) / weights.sum()
    pressure = np.select([share < 0.5, share < 0.75], [2e6, 4e6], 0.0) * np.array([[1.0], [1.0]])
    parts = [float(weights[pressure[0] == p].sum() / weights.sum()) for p in (2e6, 4e6, 0.0)]
    assert parts == pytest.approx([0.5, 0.25, 0.25], abs=0.05)
    second = two_boxes(pressure=pressure)
    joint = of_joint(second, 1, 0)
    assert joint.mean == pytest.approx(2e6 * parts[0] + 4e6 * parts[1], rel=1e-12)
    assert joint.greatest == 4e6
    assert joint.open_share == pytest.approx(parts[2], rel=1e-12)
    rows = compare_runs(FIRST, second).joint_rows()
    assert rows[1][0] == "flange"
    assert rows[1][1:4:2] == ["mean pressure [MPa]", f"{joint.mean / 1e6:.3g}"]
    assert rows[3][1:] == [
        "open share of the area [%]",
        "0.0",
        f"{100 * parts[2]:.1f}",
        f"{100 * parts[2]:+.1f} points",
    ]
    p, above = carried(second, 1)
    at = [float(above[p <= level][-1]) for level in (1e6, 2e6)]
    assert at[0] == pytest.approx(1 - parts[2])
    assert np.interp(3e6, p, above) <= parts[0] + parts[1]
    assert above[-1] == 0
    # the area under the curve is the mean pressure, whatever the law: integral of the share over the pressure
    fine = carried(FIRST, 1)
    area = np.sum(np.diff(fine[0]) * fine[1][1:])
    assert area == pytest.approx(of_joint(FIRST, 1, 0).mean, rel=1e-9)


def test_preloads_are_those_that_both_have():
    other = two_boxes(loads=np.array([8e3, 12e3]))
    assert compare_runs(FIRST, other).loads == (1, 0)
    assert compare_runs(FIRST, other, 8e3).loads == (1, 0)
    apart = compare_runs(FIRST, two_boxes(loads=np.array([3e3, 12e3])))
    assert apart.loads == (1, 1)
    assert apart.notes == ("the preloads differ: 8 kN in the first run, 12 kN in the second",)
    with pytest.raises(InputError, match=r"preload = 5 kN: the first run has no such preload; it has 2 kN, 8 kN"):
        compare_runs(FIRST, FIRST, 5e3)


def test_preloads_of_one_force_that_others_went_before_are_not_the_same():
    fallen = replace(two_boxes(loads=np.array([12e3, 8e3])), carried=np.array([0.0, 12e3]))
    found = compare_runs(FIRST, fallen)
    assert found.loads == (1, 1)
    assert "the joints have not carried the same: '8 kN' in the first run, '8 kN after 12 kN' in" in found.notes[0]
    both = replace(two_boxes(loads=np.array([8e3, 8e3])), carried=np.array([0.0, 12e3]))
    assert compare_runs(FIRST, both).loads == (1, 0)


def test_joints_that_only_one_run_has_are_named():
    found = compare_runs(FIRST, two_boxes(names=("flange 2",)))
    assert found.notes == ("only the first run has the joints flange", "only the second run has the joints flange 2")
    assert found.joint_rows()[1:] == []


def test_a_fine_mesh_on_one_part_counts_no_more_than_a_coarse_one():
    """A motion of the first box alone against one of both: MAC is the share of the area that the first box has."""
    how = {"lengths": (0.2, 0.1), "counts": (2, 12)}
    boxes = two_boxes(**how)
    corners = boxes.outline[boxes.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    first = np.zeros(len(boxes.outline), dtype=bool)
    first[boxes.triangles[boxes.part_of_triangle == 0].ravel()] = True
    assert first.mean() < 0.4
    shapes = np.zeros((2, 1, len(first), 3))
    shapes[:, :, :, 2] = 1.0
    every = two_boxes(**how, shapes=shapes, **one_mode(boxes))
    only = two_boxes(**how, shapes=shapes * first[:, None], **one_mode(boxes))
    found = compare_runs(every, only)
    assert found.modes.tolist() == [[0, 0]]
    assert found.mac[0] == pytest.approx(area[boxes.part_of_triangle == 0].sum() / area.sum(), rel=1e-6)


def one_mode(result):
    """The fields of modes with the first one alone."""
    return {
        **{
            name: getattr(result, name)[:, :1]
            for name in ("frequencies", "loss_factors", "loss_error", "shapes_imaginary")
        },
        **{name: getattr(result, name)[:1] for name in ("free", "bonded")},
        "mac": result.mac[:, :1, :1],
    }
