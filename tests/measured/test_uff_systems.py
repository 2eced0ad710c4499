"""Universal files: systems of data set 18, modes of data set 2414, labels of units, filled up lines."""

import numpy as np
import pytest

from faying import ReadError, read_uff
from faying.decks.meshfile import read_mesh
from faying.measured.frf import Dof


def dataset(number, *lines):
    return "\n".join(["    -1", f"{number:6d}", *lines, "    -1", ""])


def system(label, kind, reference, *points):
    flat = [f"{v:13.5e}" for point in points for v in point]
    return [f"{label:10d}{kind:10d}{reference:10d}{8:10d}{1:10d}", f"CS{label}", "".join(flat[:6]), "".join(flat[6:])]


def points15(*rows):
    return [f"{n:10d}{d:10d}{m:10d}{8:10d}" + "".join(f"{v:13.5e}" for v in place) for n, d, m, place in rows]


SI = dataset(164, "         1SI: Meter (newton)           2", "  1.0D+00  1.0D+00  1.0D+00", "  2.7D+02")


def mode55(rows, frequency=100.0):
    head = ["a", "NONE", "NONE", "NONE", "NONE", f"{1:10d}{2:10d}{2:10d}{8:10d}{2:10d}{3:10d}"]
    head += [f"{2:10d}{4:10d}{0:10d}{1:10d}", f"{frequency:13.5e}{1:13.5e}{0.01:13.5e}{0:13.5e}"]
    return dataset(55, *head, *(line for n, v in rows for line in (f"{n:10d}", "".join(f"{c:13.5e}" for c in v))))


def turn(angle, about):
    c, s = np.cos(angle), np.sin(angle)
    m = {"x": [[1, 0, 0], [0, c, -s], [0, s, c]], "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]]}
    return np.array(m.get(about, [[c, -s, 0], [s, c, 0], [0, 0, 1]]), float)


@pytest.mark.parametrize("scale", [1.0, 1e-2])
@pytest.mark.parametrize("padded", [False, True])
def test_systems_of_data_set_18_through_each_other(tmp_path, scale, padded):
    """A system given in a turned and shifted one, by three points; place and motion against rotation matrices."""
    first, second = turn(0.7, "z") @ turn(-0.4, "x"), turn(1.1, "y") @ turn(0.3, "z")  # columns: axes
    at, shift = np.array([0.4, -0.2, 0.1]), np.array([0.05, 0.3, -0.1])
    lines = [
        *system(3, 0, 7, shift, shift + scale * second[:, 0], shift + scale * (0.5 * second[:, 0] + 2 * second[:, 2])),
        *system(7, 0, 0, at, at + scale * first[:, 0], at + scale * (first[:, 2] - first[:, 0])),
    ]
    if padded:
        lines = [f"{line:80}" for line in lines]
    local = np.array([0.3, 0.2, -0.5])
    path = tmp_path / "a.uff"
    nodes = points15((1, 0, 0, (0, 0, 0)), (2, 3, 3, local), (5, 7, 0, local))
    rows = ((1, (0, 0, 1.0)), (2, local), (5, (1.0, 0, 0)))
    path.write_text(SI + dataset(18, *lines) + dataset(15, *nodes) + mode55(rows))
    file = read_uff(path)
    np.testing.assert_allclose(file.positions[2], at + first @ (shift + second @ local), atol=2e-5 / scale)
    np.testing.assert_allclose(file.positions[5], at + first @ local, atol=2e-5 / scale)
    modes = file.modes()
    got = modes.at(tuple(Dof(2, axis) for axis in "xyz"))[0]
    np.testing.assert_allclose(got, first @ second @ local, atol=3e-5 / scale)


@pytest.mark.parametrize(
    ("lines", "match"),
    [
        (system(1, 0, 0, (0, 0, 0), (1, 0, 0), (2, 0, 0)), "are on one line"),
        (system(1, 0, 4, (0, 0, 0), (1, 0, 0), (0, 0, 1)), "refers to system 4, which is not in the file"),
        (system(1, 1, 0, (0, 0, 0), (1, 0, 0), (0, 0, 1)), "cylindrical or spherical"),
        (system(1, 0, 0, (0, 0, 0), (1, 0, 0), (0, 0, 1))[:3], "no three points"),
        (
            [
                *system(1, 0, 2, (0, 0, 0), (1, 0, 0), (0, 0, 1)),
                *system(2, 0, 1, (0, 0, 0), (1, 0, 0), (0, 0, 1)),
            ],
            "refer to each other",
        ),
    ],
)
def test_systems_that_cannot_be(tmp_path, lines, match):
    path = tmp_path / "a.uff"
    path.write_text(SI + dataset(18, *lines) + dataset(15, *points15((1, 1, 1, (0, 0, 0)))))
    with pytest.raises(ReadError, match=match):
        read_uff(path)


@pytest.mark.parametrize("number", [18, 2420])
def test_a_system_given_twice(tmp_path, number):
    one = dataset(18, *system(1, 0, 0, (0, 0, 0), (1, 0, 0), (0, 0, 1)))
    other = dataset(18, *system(1, 0, 0, (0, 0, 0), (0, 1, 0), (0, 0, 1)))
    if number == 2420:
        rows = ["".join(f"{v:25.16e}" for v in row) for row in np.eye(4, 3) * -1]
        other = dataset(2420, f"{1:10d}", "part", f"{1:10d}{0:10d}{8:10d}", "LOCAL", *rows)
    path = tmp_path / "a.uff"
    nodes = dataset(15, *points15((1, 1, 1, (0, 0, 0))))
    path.write_text(one + one + nodes)
    assert read_uff(path).positions == {1: (0, 0, 0)}
    path.write_text(one + other + nodes)
    with pytest.raises(ReadError, match="system 1 appears twice, differently"):
        read_uff(path)


def mode2414(rows, *, analysis=2, result=8, data=2, count=3, frequency=100.0, damping=0.01, pole=0j, location=1):
    head = ["         1", "Mode 1", f"{location:10d}", *["NONE"] * 5]
    head += [f"{1:10d}{analysis:10d}{2:10d}{result:10d}{data:10d}{count:10d}", f"{0:10d}" * 8, f"{0:10d}" * 2]
    head += ["".join(f"{v:13.5e}" for v in (0, frequency, 0, 1, damping, 0))]
    head += ["".join(f"{v:13.5e}" for v in (pole.real, pole.imag, 0, 0, 0, 0))]
    body = []
    for n, values in rows:
        body.append(f"{n:10d}")
        body += ["".join(f"{v:13.5e}" for v in values[k : k + 6]) for k in range(0, len(values), 6)]
    return dataset(2414, *head, *body)


def test_modes_of_data_set_2414(tmp_path):
    path = tmp_path / "a.unv"
    six = [(1, [0, 0, 1.0, 0.1, 0.2, 0.3]), (4, [0, -2.0, -1.0, 0, 0, 0])]
    pole = 2 * np.pi * 55 * (-0.02 + 1j * np.sqrt(1 - 0.02**2))
    twin = [(1, [0, 0, 0, 0, -1.0, 1e-3]), (4, [0, 0, 1.0, 0.5, 0, 0])]
    static = mode2414([(1, [0, 0, 1.0])], analysis=1)
    path.write_text(mode2414(six, count=6) + static + mode2414(twin, analysis=7, data=5, frequency=0, pole=pole))
    file = read_uff(path)
    modes = file.modes()
    np.testing.assert_allclose(modes.frequencies, [55, 100], rtol=1e-5)
    np.testing.assert_allclose(modes.loss_factors, [0.04, 0.02], rtol=1e-4)
    found = modes.at((Dof(1, "z"), Dof(4, "y"), Dof(4, "z")))
    np.testing.assert_allclose(found, [[-1 + 1e-3j, 1 + 0.5j, 0], [1, -2, -1]], atol=1e-6)
    assert any("holds results of analysis type 1, result type 8" in note for note in file.warnings)


def test_modes_that_stand_in_both_data_sets_are_read_once(tmp_path):
    path = tmp_path / "a.unv"
    path.write_text(mode55([(1, (0, 0, 1.0))], 90.0) + mode2414([(1, [0, 0, 1.0])]))
    file = read_uff(path)
    assert file.modes().frequencies == pytest.approx([90.0])
    assert any("1 of data sets 2414 are left out" in note for note in file.warnings)


@pytest.mark.parametrize(
    "text",
    [mode2414([(1, [0, 1.0])]), mode2414([(1, [0, 0, 1.0])], data=9), mode2414([]), mode2414([(1, [1.0])], count=1)],
)
def test_damaged_modes_of_data_set_2414(tmp_path, text):
    path = tmp_path / "a.unv"
    path.write_text(text)
    with pytest.raises(ReadError, match='the mode "Mode 1" of data set 2414'):
        read_uff(path)


F = np.array([10.0, 20.0, 30.0, 45.0])
H = np.array([1 - 0.1j, 2 - 0.2j, 3 - 0.3j, -1 + 0.5j])


def frf58(top="m/s^2", bottom="N", over="Hz", *, f=F, h=H, kind=12, abscissa=18, tail=0):
    """An uneven complex FRF in single precision, its last line filled up with `tail` zeros."""
    head = ["x", "NONE", "01-Jan-2020", "NONE", "NONE", "    4         0    0         0 NONE               1   3 NONE"]
    head[-1] += f"{1:16d}{3:4d}"
    head += [f"{5:10d}{len(f):10d}{0:10d}" + f"{0.0:13.5e}" * 3]
    labels = ((abscissa, over), (kind, top), (13, bottom), (0, "NONE"))
    head += [f"{code:10d}" + "    0" * 3 + " NONE                " + f" {label:20}" for code, label in labels]
    flat = [v for x, y in zip(f, h, strict=True) for v in (x, y.real, y.imag)] + [0.0] * tail
    return dataset(58, *head, *("".join(f"{v:13.5e}" for v in flat[k : k + 6]) for k in range(0, len(flat), 6)))


@pytest.mark.parametrize(
    ("labels", "factor"),
    [
        (("g's", "N"), 9.80665),
        (("G", "N"), 9.80665),
        (("gn", "lbf"), 9.80665 / 4.4482216152605),
        (("M/S^2", "N"), 1),
        (("M/SEC2", "NEWTON"), 1),
        (("mm/s2", "kN"), 1e-6),
        (("(m/s^2)/N", "NONE"), 1),
        (("g/N", ""), 9.80665),
        (("NONE", "NONE"), 1),
        (("Unknown", "N"), 1),
        (("in/s^2", "N"), 0.0254),
    ],
)
def test_labels_of_the_ordinate(tmp_path, labels, factor):
    path = tmp_path / "a.uff"
    path.write_text(SI + frf58(*labels))
    np.testing.assert_allclose(read_uff(path).frf().values[0, 0], H * factor, rtol=1e-5)


@pytest.mark.parametrize(
    "labels", [("dB", "NONE"), ("mV", "N"), ("EU", "N"), ("m/s", "N"), ("m/s^2", "V"), ("", "lbf")]
)
@pytest.mark.parametrize("units", [SI, ""])
def test_labels_that_are_not_known_are_quoted(tmp_path, labels, units):
    path = tmp_path / "a.uff"
    path.write_text(units + frf58(*labels))
    wrong = labels[1] if labels[0] in ("m/s^2", "") else labels[0]
    with pytest.raises(ReadError, match=f'data set {2 if units else 1}: the unit "{wrong}" .* is not a unit'):
        read_uff(path).frf()
    with pytest.raises(ReadError, match=f'the unit "{wrong}"'):
        read_uff(path).frf(quantity="accelerance")


@pytest.mark.parametrize(
    ("label", "factor"),
    [("Hz", 1), ("NONE", 1), ("kHz", 1e3), ("rad/s", 1 / (2 * np.pi)), ("RPM", 1 / 60), ("MHz", 1e6)],
)
def test_labels_of_the_abscissa(tmp_path, label, factor):
    path = tmp_path / "a.uff"
    path.write_text(frf58(over=label))
    np.testing.assert_allclose(read_uff(path).frf().frequency, F * factor, rtol=1e-6)


@pytest.mark.parametrize(
    ("label", "code", "match"),
    [("order", 18, '"order" of its abscissa'), ("mhz", 18, "MHz or mHz"), ("s", 17, "type 17"), ("rpm", 19, "type 19")],
)
def test_abscissas_that_are_no_frequency(tmp_path, label, code, match):
    path = tmp_path / "a.uff"
    path.write_text(frf58(over=label, abscissa=code))
    with pytest.raises(ReadError, match=match):
        read_uff(path).frf()


@pytest.mark.parametrize(("count", "tail"), [(3, 3), (4, 0), (3, 0)])
def test_zeros_that_fill_up_the_last_line_are_no_values(tmp_path, count, tail):
    path = tmp_path / "a.uff"
    path.write_text(SI + frf58(f=F[:count], h=H[:count], tail=tail))
    frf = read_uff(path).frf()
    np.testing.assert_allclose(frf.frequency, F[:count])
    np.testing.assert_allclose(frf.values[0, 0], H[:count], rtol=1e-6)


def test_values_beyond_the_announced_ones_are_damage(tmp_path):
    path = tmp_path / "a.uff"
    path.write_text(SI + frf58().replace(f"{5:10d}{4:10d}{0:10d}", f"{5:10d}{3:10d}{0:10d}"))
    with pytest.raises(ReadError, match="4 values where its header announces 3"):
        read_uff(path)


def mesh(groups, between="", system=1):
    places = [(0, 0, 0), (20, 0, 0), (20, 20, 0), (0, 20, 0), (0, 0, 10), (20, 0, 10), (20, 20, 10), (0, 20, 10)]
    nodes = [
        line
        for k, place in enumerate(places, 1)
        for line in (f"{k:10d}{system if k > 4 else 1:10d}{1:10d}{11:10d}", "".join(f"{v:25.16E}" for v in place))
    ]
    cells = ["".join(f"{v:10d}" for v in row) for row in ((1, 115, 2, 1, 7, 8), range(1, 9), (2, 44, 2, 1, 7, 4))]
    cells.append("".join(f"{v:10d}" for v in (5, 6, 7, 8)))
    return between + dataset(2411, *nodes) + dataset(2412, *cells) + dataset(2467, *groups)


HEAD = "         1" + "         0" * 6
TOP = [HEAD + f"{1:10d}", "Top", "         8         2         0         0"]


@pytest.mark.parametrize(
    "groups",
    [
        [HEAD + f"{0:10d}", "Empty", "", *TOP],
        [*TOP, HEAD + f"{0:10d}", "Empty", ""],
        [HEAD + f"{0:10d}", "Empty", *TOP],
        [HEAD + f"{0:10d}", "A", "", HEAD + f"{0:10d}", "B", "", *TOP, ""],
    ],
)
def test_empty_groups_of_meshes(tmp_path, groups):
    path = tmp_path / "a.unv"
    path.write_text(mesh(groups))
    found = read_mesh(path, unit="mm")
    assert set(found.faces) == {"Top"}
    assert {int(n) for faces in found.faces["Top"] for n in found.numbers[faces].ravel()} == {5, 6, 7, 8}


def test_test_and_mesh_readers_agree_on_export_systems(tmp_path):
    rows = [[0.0, 1, 0], [0, 0, 1], [1, 0, 0], [1000.0, 0, 0]]
    lines = ["".join(f"{v:25.16e}" for v in row) for row in rows]
    between = dataset(2420, f"{1:10d}", "part", f"{2:10d}{0:10d}{8:10d}", "LOCAL", *lines)
    path = tmp_path / "a.unv"
    path.write_text(mesh(TOP, between, system=2))
    as_mesh, as_test = read_mesh(path, unit="mm"), read_uff(path, length_unit="mm")
    order = np.argsort(as_mesh.numbers)
    np.testing.assert_allclose(as_mesh.points[order], [as_test.positions[k] for k in range(1, 9)])
    assert any("name the export system 2" in str(note) for note in as_mesh.notes)
    assert any("name the export system 2" in note for note in as_test.warnings)
    path.write_text(mesh(TOP, between, system=1))
    assert not any("export system" in note for note in read_uff(path, length_unit="mm").warnings)
    assert not read_mesh(path, unit="mm").notes
