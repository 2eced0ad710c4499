import csv
import io
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying import FRF, InputError, ReadError, compare_modes, read_model_modes
from faying.measured.mac import mac
from faying.measured.mapping import Transform
from faying.measured.model import FullResponse, ModelModes
from faying.measured.modes import ModeSet
from faying.measured.pairing import pair_modes
from faying.output import report_measured

NODES, COUNT = 60, 8


def model(seed=0, count=COUNT):
    """Modes of equal masses at random points of a metre's box: orthogonal, hence a MAC of one or nothing."""
    rng = np.random.default_rng(seed)
    shapes = np.linalg.qr(rng.standard_normal((3 * NODES, count)))[0].T.reshape(count, NODES, 3)
    frequencies = np.sort(rng.uniform(100, 1000, count))
    return ModelModes(
        frequencies=frequencies,
        loss_factors=np.linspace(0.01, 0.02, count),
        shapes=shapes,
        points=rng.uniform(0, 1, (NODES, 3)),
        title="box",
        load=8e3,
    )


def turned(seed):
    rng = np.random.default_rng(seed)
    q, r = np.linalg.qr(rng.standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return Transform(rotation=q if np.linalg.det(q) > 0 else -q, shift=rng.standard_normal(3))


def hammered(theirs, nodes, transform, *, noise=0.0, order=None, directions="xyz", scale=1.0, rng=None):
    """A test of a model: its modes at some nodes, in a frame of its own, each of any complex scale."""
    rng = rng or np.random.default_rng(1)
    order = np.arange(len(theirs.frequencies)) if order is None else order
    axes = transform.directions(np.eye(3))[["xyz".index(d) for d in directions]]
    shapes = np.einsum("mnx,dx->mnd", theirs.shapes[order][:, nodes], axes).reshape(len(order), -1)
    shapes = shapes + noise * np.abs(shapes).max() * (
        rng.standard_normal(shapes.shape) + 1j * rng.standard_normal(shapes.shape)
    )
    shapes = shapes * np.exp(2j * np.pi * rng.uniform(size=(len(order), 1))) * rng.uniform(0.1, 10, (len(order), 1))
    here = (theirs.points[nodes] - transform.shift) @ transform.rotation
    return ModeSet(
        frequencies=scale * theirs.frequencies[order],
        loss_factors=0.03 * np.ones(len(order)),
        shapes=shapes,
        dofs=[(k + 1, d) for k in range(len(nodes)) for d in directions],
        positions={k + 1: tuple(p) for k, p in enumerate(here)},
        source="test",
    )


def test_a_model_against_itself_is_the_unit_matrix():
    theirs = model()
    c = compare_modes(hammered(theirs, np.arange(NODES), Transform()), theirs)
    np.testing.assert_allclose(c.mac, np.eye(COUNT), atol=1e-12)
    np.testing.assert_array_equal(c.pairs, np.stack([np.arange(COUNT)] * 2, axis=1))
    np.testing.assert_allclose(c.frequency_difference, 0, atol=1e-12)
    assert c.notes == ()


@settings(max_examples=40)
@given(st.integers(0, 10**6))
def test_a_noisy_sparse_turned_copy_in_another_order_still_pairs(seed):
    """A fifth of the nodes, 5 % noise, another frame, frequencies 10 % off and modes swapped."""
    rng = np.random.default_rng(seed)
    theirs, nodes, order = model(seed), rng.choice(NODES, 12, replace=False), rng.permutation(COUNT)
    wider = ModelModes(**{**vars(theirs), "frequencies": np.linspace(500, 540, COUNT)})
    c = compare_modes(
        hammered(wider, nodes, turned(seed), noise=0.05, order=order, scale=0.9, rng=rng), wider, transform=turned(seed)
    )
    np.testing.assert_array_equal(c.pairs[:, 1], order)
    np.testing.assert_allclose(c.nodes[::3], nodes)
    expected = wider.frequencies[order] / (0.9 * wider.frequencies[order]) - 1
    np.testing.assert_allclose(c.frequency_difference, expected)


def test_without_the_transformation_nothing_fits():
    theirs = model()
    test = hammered(theirs, np.arange(12), Transform(shift=np.array([5.0, 0, 0])))
    with pytest.raises(InputError, match="--frame pairs.csv"):
        compare_modes(test, theirs)


def test_points_without_partner_or_position_are_left_out_and_named():
    theirs = model()
    test = hammered(theirs, np.arange(12), Transform())
    positions = dict(test.positions) | {3: (7.0, 0.0, 0.0)}
    del positions[5]
    c = compare_modes(ModeSet(**{**vars(test), "positions": positions}), theirs)
    assert len(c.dofs) == 30
    assert any("left out: 3 (" in note for note in c.notes)
    assert any("points 5 have modes but no position" in note for note in c.notes)
    np.testing.assert_allclose(np.diag(c.mac), 1)


def test_one_direction_at_few_points():
    theirs = model()
    c = compare_modes(hammered(theirs, np.arange(20), turned(3), directions="y"), theirs, transform=turned(3))
    np.testing.assert_allclose(np.diag(c.mac), 1)
    assert mac(c.model_shapes(), c.model_shapes()).shape == (COUNT, COUNT)


def test_shapes_that_the_points_cannot_tell_apart_are_named():
    theirs = model()
    c = compare_modes(hammered(theirs, np.arange(1), Transform(), directions="z"), theirs)
    assert any("looks like" in note and "rests on frequency" in note for note in c.notes)
    np.testing.assert_array_equal(c.pairs[:, 0], c.pairs[:, 1])


def test_a_direction_that_is_no_translation():
    theirs = model()
    test = hammered(theirs, np.arange(3), Transform(), directions="x")
    odd = ModeSet(**{**vars(test), "dofs": [(1, "x"), (2, "rx"), (3, "x")]})
    with pytest.raises(InputError, match="is not a translation"):
        compare_modes(odd, theirs)
    blank = ModeSet(**{**vars(test), "dofs": [(1, ""), (2, ""), (3, "")]})
    with pytest.raises(InputError, match="--direction z"):
        compare_modes(blank, theirs)
    np.testing.assert_allclose(np.diag(compare_modes(blank.directed("x"), theirs).mac), 1)


# pairs


def test_pairs_take_the_best_sum_and_not_the_first_best():
    table = [[0.9, 0.8], [0.85, 0.1]]
    np.testing.assert_array_equal(pair_modes(table, [100, 101], [100, 101]), [[0, 1], [1, 0]])


def test_frequency_decides_where_shapes_are_alike():
    np.testing.assert_array_equal(pair_modes(np.ones((2, 2)), [100, 110], [109, 101]), [[0, 1], [1, 0]])


def test_limits_leave_modes_without_partner():
    assert len(pair_modes([[0.4]], [100], [100])) == 0
    assert len(pair_modes([[1.0]], [100], [140])) == 0
    np.testing.assert_array_equal(pair_modes([[1.0]], [100], [140], greatest_shift=0.5), [[0, 0]])
    with pytest.raises(InputError, match="least_mac"):
        pair_modes([[1.0]], [1], [1], least_mac=0)


# FRFs


def test_one_mode_is_an_oscillator():
    """m, k, eta: 1/k at rest, 1/(i k eta) at resonance; the driving point of a mass m has phi = m^-1/2."""
    m, k, eta = 3.0, 2e6, 0.02
    f = np.sqrt(k / m) / (2 * np.pi)
    one = ModelModes(
        frequencies=np.array([f]),
        loss_factors=np.array([eta]),
        shapes=np.array([[[0, 0, m**-0.5]]]),
        points=np.zeros((1, 3)),
    )
    here = (np.array([0]), np.array([[0, 0, 1.0]]))
    h = one.receptance(np.array([0.0, f, 100 * f]), here, here)[0, 0]
    np.testing.assert_allclose(h[:2], [1 / (k * (1 + 1j * eta)), 1 / (1j * k * eta)])
    assert one.frf(np.array([1000 * f]), here, here, "accelerance")[0, 0, 0] == pytest.approx(1 / m, rel=1e-5)


def test_frfs_of_the_model_itself_fit_and_obey_reciprocity():
    theirs, frame = model(), turned(5)
    nodes = np.array([4, 9, 30])
    f = np.linspace(50, 1100, 300)
    axes = frame.directions(np.eye(3))[[2, 2, 2]]
    values = theirs.frf(f, (nodes, axes), (nodes, axes), "mobility")
    np.testing.assert_allclose(values, values.transpose(1, 0, 2))
    dofs = [(k + 1, "z") for k in range(3)]
    test = hammered(theirs, nodes, frame)
    frf = FRF(frequency=f, values=values * 2, outputs=dofs, inputs=dofs, quantity="mobility")
    c = compare_modes(test, theirs, transform=frame, frf=frf)
    np.testing.assert_allclose(c.predicted * 2, values * 2 * 1.0, rtol=1e-9)
    np.testing.assert_allclose(c.frac, 1)
    far = FRF(frequency=f, values=values[:1, :1], outputs=[(99, "z")], inputs=[(99, "z")], quantity="mobility")
    alone = compare_modes(test, theirs, transform=frame, frf=far)
    assert alone.frf is None
    assert any("FRFs are not compared" in note for note in alone.notes)


# results as files


def test_table_csv_and_json(tmp_path):
    theirs = model()
    test = hammered(theirs, np.arange(12), Transform())
    test = ModeSet(
        **{
            **vars(test),
            "frequencies": test.frequencies * np.where(np.arange(COUNT) == 2, 5, 1.02),
            "loss_interval": np.tile([0.02, 0.04], (COUNT, 1)),
        }
    )
    c = compare_modes(test, theirs)
    rows = c.rows()
    assert rows[1][4] == "-1.96"
    assert rows[3][2] == "-"
    table = list(csv.reader(io.StringIO(c.csv_text())))
    assert len({len(row) for row in table}) == 1
    assert table[3][5:] == [""] * 5
    assert float(table[1][8]) == pytest.approx(1 / 1.02 - 1)
    document = json.loads(json.dumps(c.to_dict(), allow_nan=False))
    assert [p["test"] for p in document["pairs"]] == [0, 1, 3, 4, 5, 6, 7]
    assert document["points"]["without_partner"] == {}


def test_models_that_do_not_fit(tmp_path):
    with pytest.raises(InputError, match=r"need \(1, 2, 3\)"):
        ModelModes(frequencies=np.ones(1), loss_factors=np.ones(1), shapes=np.ones((1, 3, 3)), points=np.ones((2, 3)))
    with pytest.raises(ReadError, match="faying run"):
        read_model_modes(tmp_path / "absent.nc")
    file = tmp_path / "bad.nc"
    for content in (b"words", b"CDF\x02" + bytes(40), b""):
        file.write_bytes(content)
        with pytest.raises(ReadError, match="no result of Faying"):
            read_model_modes(file)


def test_a_test_without_any_partner_still_gives_a_table_and_files(tmp_path):
    theirs = model()
    test = hammered(theirs, np.arange(12), Transform(), scale=9.0)
    c = compare_modes(test, theirs)
    assert len(c.pairs) == 0
    assert all("at best" in row[5] for row in c.rows()[1:])
    made = report_measured.write(c, tmp_path)
    assert {p.name for p in made} == {"comparison.csv", "mac.svg", "shapes.png", "comparison.html"}


def plate(count=COUNT):
    """A coarse outline of 10 mm squares, its shapes linear in x and y on each: what interpolation must give back."""
    x, y = np.meshgrid(np.arange(0, 0.11, 0.01), np.arange(0, 0.06, 0.01))
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    number = np.arange(points.shape[0]).reshape(x.shape)
    a, b, c, d = (v.ravel() for v in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    gradient = np.random.default_rng(5).standard_normal((count, 3, 4))
    shapes = np.einsum("mxk,nk->mnx", gradient, np.column_stack([np.ones(len(points)), 20 * points]))
    modes = ModelModes(
        frequencies=100.0 * np.arange(1, count + 1),
        loss_factors=np.full(count, 0.01),
        shapes=shapes,
        points=points,
        triangles=triangles,
    )
    return modes, gradient


def test_points_between_nodes_are_compared_where_they_are():
    theirs, gradient = plate()
    rng = np.random.default_rng(8)
    places = np.column_stack([rng.uniform(0, 0.1, 12), rng.uniform(0, 0.05, 12), np.zeros(12)])
    shapes = np.einsum("mxk,nk->mnx", gradient, np.column_stack([np.ones(12), 20 * places])).reshape(COUNT, -1)
    test = ModeSet(
        frequencies=theirs.frequencies,
        loss_factors=theirs.loss_factors,
        shapes=shapes.astype(complex),
        dofs=[(k + 1, d) for k in range(12) for d in "xyz"],
        positions={k + 1: tuple(p) for k, p in enumerate(places)},
    )
    c = compare_modes(test, theirs, tolerance=1e-4)  # nodes are up to 7 mm away
    assert c.notes == ()
    assert len(c.dofs) == 36
    np.testing.assert_allclose(np.diag(c.mac), 1, atol=1e-12)
    np.testing.assert_allclose(c.model_shapes(), shapes, atol=1e-12)
    assert max(c.point_map.distance.values()) < 1e-12


def test_the_full_response_serves_points_beside_its_nodes():
    theirs, _ = plate(2)
    lines = np.arange(20.0, 300.0, 2.0)
    z = np.array([[0.0, 0, 1]])
    node = np.array([25])
    full = FullResponse(
        frequency=lines,
        receptance=theirs.receptance(lines, (node, z), (node, z)) - 1 / (2 * np.pi * lines) ** 2,
        outputs=(theirs.points[node], z),
        inputs=(theirs.points[node], z),
    )
    whole = ModelModes(**{**vars(theirs), "full": full})
    corners = theirs.triangles[(theirs.triangles == 25).any(axis=1)][0]
    weights = np.where(corners == 25, 0.98, 0.01)
    more = whole.with_places(corners[None], weights[None], node)
    at = (np.array([len(theirs.points)]), z)
    found = more.full_frf(lines, at, at, "receptance")
    expected = more.receptance(lines, at, at) - 1 / (2 * np.pi * lines) ** 2
    np.testing.assert_allclose(found, expected, rtol=1e-9)
