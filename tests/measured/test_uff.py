import gc
import warnings
from dataclasses import replace

import numpy as np
import pytest
import pyuff

from faying import FRF, InputError, ReadError, identify_modes, read_uff, write_uff
from faying.measured.frf import Dof
from faying.measured.modes import ModeSet
from faying.measured.tested import read_test

SYSTEM = [[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]  # rows: axes turned by 90 degrees about z


def raw(path, *sets):
    pyuff.UFF(str(path)).write_sets([dict(s) for s in sets], mode="overwrite")
    return path


def function(**changes):
    f = np.arange(20.0)
    return {
        "type": 58,
        "func_type": 4,
        "rsp_node": 1,
        "rsp_dir": 3,
        "ref_node": 2,
        "ref_dir": -3,
        "data": f * (1 + 2j),
        "x": f,
        "abscissa_spacing": 1,
        "abscissa_spec_data_type": 18,
        "ordinate_spec_data_type": 12,
        "orddenom_spec_data_type": 13,
    } | changes


def units(length=1.0, force=1.0):
    return {
        "type": 164,
        "units_code": 9,
        "units_description": "mine",
        "temp_mode": 1,
        "length": length,
        "force": force,
        "temp": 1.0,
        "temp_offset": 0.0,
    }


def nodes(**changes):
    zero = np.zeros(2, dtype=int)
    return {
        "type": 2411,
        "node_nums": np.array([1, 2]),
        "def_cs": zero,
        "disp_cs": zero,
        "color": zero,
        "x": np.array([1.0, 100.0]),
        "y": np.array([2.0, 200.0]),
        "z": np.array([3.0, 300.0]),
    } | changes


def shape(**changes):
    return {
        "type": 55,
        "analysis_type": 2,
        "data_ch": 2,
        "spec_data_type": 8,
        "load_case": 1,
        "mode_n": 1,
        "freq": 12.0,
        "modal_damp_vis": 0.01,
        "node_nums": [1, 2],
        "r1": np.array([1.0, 0.5]),
        "r2": np.zeros(2),
        "r3": np.zeros(2),
    } | changes


def modes(**changes):
    values = {
        "frequencies": np.array([51.5177, 142.1786]),
        "loss_factors": np.array([5.6e-4, 0.02]),
        "shapes": np.array([[1.0, -0.25, 0.5], [0.3, 1.0, -0.7]]),
        "dofs": [(3, "x"), (3, "-z"), (7, "y")],
        "positions": {3: (0.1, -0.2, 0.3), 7: (1.0, 2.0, 3.0)},
        "frequency_interval": np.array([[51.5, 51.6], [142.1, 142.2]]),
        "loss_interval": np.array([[3e-4, 8e-4], [0.019, 0.021]]),
    }
    return ModeSet(**(values | changes))


# real files


def test_real_frfs(measured_frfs):
    frf = read_uff(measured_frfs / "derived_3frf_accelerance.uff").frf()
    assert (frf.quantity, frf.values.shape, frf.frequency[-1]) == ("accelerance", (1, 3, 1001), 1000.0)
    first = complex((measured_frfs / "meas_point_1.txt").read_text().split()[0])
    assert frf.values[0, 0, 0] == pytest.approx(first, rel=1e-11)
    assert any("SI (m/s^2/N) is assumed" in word for word in frf.warnings)


def test_a_header_that_is_not_ascii_still_gives_quantity_and_unit(measured_frfs):
    frf = read_uff(measured_frfs / "non_ascii_header.uff").frf()
    assert frf.quantity == "accelerance"  # from "(1/N)*(m/s²)", whose last sign is one byte of Latin-1
    np.testing.assert_allclose(frf.values[0, 0, :2], [0.407994, -0.0599924 - 0.055326j])
    assert frf.frequency[1] == pytest.approx(0.195313)


def test_a_power_spectrum_is_read_and_is_no_frf(measured_frfs):
    file = read_uff(measured_frfs / "sample_dataset58_psd.uff")
    assert [f.kind for f in file.functions] == ["power spectral density"]
    assert file.functions[0].values.shape == (3201,)
    assert file.functions[0].values[1].real == pytest.approx(1.255863e-6)
    with pytest.raises(ReadError, match="no FRF .* only power spectral density"):
        file.frf()


def test_real_mode_shapes(measured_frfs):
    found = read_uff(measured_frfs / "uff55_translation.uff").modes()
    np.testing.assert_allclose(found.frequencies, [10, 12, 13])
    assert len(found.dofs) == 12
    np.testing.assert_allclose(found.at((Dof(4, "y"),))[0], 0.724863)


# round trips


@pytest.mark.parametrize("turn", [1, np.exp(0.3j)], ids=["real", "complex"])
def test_modes_come_back_to_six_digits(tmp_path, turn):
    sent = modes()
    sent = modes(shapes=sent.shapes * turn)
    got = read_uff(write_uff(tmp_path / "a.uff", sent)).modes()
    np.testing.assert_allclose(got.frequencies, sent.frequencies, rtol=5e-6)
    np.testing.assert_allclose(got.loss_factors, sent.loss_factors, rtol=1e-5)
    np.testing.assert_allclose(got.at((Dof(3, "x"), Dof(3, "z"), Dof(7, "y"))), sent.shapes * [1, -1, 1], rtol=5e-6)
    np.testing.assert_allclose(got.loss_interval, sent.loss_interval)
    np.testing.assert_allclose(got.frequency_interval, sent.frequency_interval)
    assert {k: pytest.approx(v) for k, v in sent.positions.items()} == got.positions


@pytest.mark.parametrize("quantity", ["receptance", "mobility", "accelerance"])
@pytest.mark.parametrize("spacing", ["even", "uneven"])
def test_frfs_come_back_to_eleven_digits(tmp_path, quantity, spacing):
    rng = np.random.default_rng(0)
    x = np.arange(50.0) * 0.25 if spacing == "even" else np.arange(50.0) ** 1.2
    values = rng.standard_normal((2, 2, 50)) + 1j * rng.standard_normal((2, 2, 50))
    values[1, 0] = np.nan
    sent = FRF(
        frequency=x,
        values=values,
        outputs=[(1, "x"), (2, "-y")],
        inputs=[(1, "x"), (5, "rz")],
        quantity=quantity,
        coherence=np.where(np.isnan(values), np.nan, 0.9).real,
    )
    got = read_uff(write_uff(tmp_path / "a.uff", sent)).frf()
    np.testing.assert_allclose(got.values, sent.values, rtol=1e-10)
    np.testing.assert_allclose(got.frequency, sent.frequency, rtol=5e-6)
    assert (got.outputs, got.inputs, got.quantity) == (sent.outputs, sent.inputs, sent.quantity)
    assert got.warnings == ()
    np.testing.assert_allclose(got.coherence, sent.coherence)


def test_modes_and_frfs_in_one_file(tmp_path):
    frf = FRF(frequency=[1.0, 2.0], values=[[[1j, 2]]], outputs=[(3, "x")], inputs=[(3, "x")], quantity="mobility")
    file = read_uff(write_uff(tmp_path / "a.uff", modes(), frf, title="my test"))
    assert file.title == "my test"
    np.testing.assert_array_equal(file.frf().values, frf.values)
    assert file.frf().positions == file.modes().positions


@pytest.mark.parametrize("values", [np.arange(20) * (1 - 3j), np.arange(20.0)], ids=["complex", "real"])
def test_binary_files(tmp_path, values):
    path = tmp_path / "a.uff"  # added one by one: overwriting, pyuff loses the header of a binary set
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)  # pyuff leaves files open there
        pyuff.UFF(str(path)).write_sets(
            [function(binary=1, data=values), function(rsp_node=9, data=2 * values)], mode="add"
        )
        gc.collect()
    frf = read_uff(path).frf()
    np.testing.assert_array_equal(frf.values[0, 0], values)
    np.testing.assert_allclose(frf.values[1, 0], 2 * values)


# units


@pytest.mark.parametrize(
    ("labels", "extra", "factor"),
    [
        (("mm/s^2", "N"), (), 1e-3),
        (("g", "lbf"), (), 9.80665 / 4.4482216152605),
        (("m/s²", "kN"), (), 1e-3),
        (("NONE", "NONE"), (units(1000.0, 1.0),), 1e-3),  # mm: data set 164 says how many file units make one of SI
        (("NONE", "NONE"), (units(1000.0, 1000.0),), 1.0),  # mm and mN
        (("m/s^2/kN", "NONE"), (), 1e-3),
        (("g/N", "NONE"), (units(39.37, 0.2248),), 9.80665),  # a label goes before the units of the file
    ],
)
def test_accelerance_becomes_si(tmp_path, labels, extra, factor):
    data = function(ordinate_axis_units_lab=labels[0], orddenom_axis_units_lab=labels[1])
    frf = read_uff(raw(tmp_path / "a.uff", *extra, data)).frf()
    np.testing.assert_allclose(frf.values[0, 0], data["data"] * factor, rtol=1e-6)


def test_the_quantity_is_taken_from_the_label_or_from_the_user(tmp_path):
    data = function(ordinate_spec_data_type=0, orddenom_spec_data_type=0)
    with pytest.raises(ReadError, match="--quantity accelerance"):
        read_uff(raw(tmp_path / "a.uff", data)).frf()
    assert read_uff(tmp_path / "a.uff").frf(quantity="mobility").quantity == "mobility"
    labelled = raw(tmp_path / "b.uff", data | {"ordinate_axis_units_lab": "um/N"})
    frf = read_uff(labelled).frf()
    assert frf.quantity == "receptance"
    np.testing.assert_allclose(frf.values[0, 0], data["data"] * 1e-6)
    with pytest.raises(ReadError, match="not a force \\(type 12\\)"):
        read_uff(raw(tmp_path / "c.uff", function(orddenom_spec_data_type=12))).frf()


@pytest.mark.parametrize("kind", [9, 13])
def test_reaction_and_excitation_are_forces(tmp_path, kind):
    frf = read_uff(raw(tmp_path / "a.uff", function(orddenom_spec_data_type=kind))).frf()
    np.testing.assert_allclose(frf.values[0, 0], function()["data"])


@pytest.mark.parametrize("word", ["NaN", "Infinity"])
def test_a_line_at_0_hz_without_a_number_is_left_out_of_all_frfs(tmp_path, word):
    path = raw(tmp_path / "a.uff", function(), function(rsp_node=5, data=function()["data"] + 7))
    text = path.read_text()
    path.write_text(text.replace("7.00000000000e+00   0.00000000000e+00", f"{word:>17}{word:>20}", 1))
    frf = read_uff(path).frf()
    np.testing.assert_allclose(frf.frequency, np.arange(1.0, 20))
    np.testing.assert_allclose(frf.values[:, 0], [function()["data"][1:], function()["data"][1:] + 7])
    assert any("the line at 0 Hz" in words for words in frf.warnings)
    path.write_text(text.replace("8.00000000000e+00   2.00000000000e+00", f"{word:>17}{word:>20}", 1))
    with pytest.raises(ReadError, match="NaN or infinite"):
        read_uff(path)


def test_a_test_written_with_the_other_sign_of_time_is_turned_for_the_comparison(tmp_path, synthetic):
    frf, _ = synthetic(((60.0, 0.01), (180.0, 0.005)), last=300.0, outputs=2)
    sets = [
        function(x=frf.frequency, data=values.conj(), rsp_node=k, ref_node=1, ref_dir=3)
        for k, values in enumerate(frf.values[:, 0], 1)
    ]
    found = read_test(raw(tmp_path / "a.uff", *sets))
    np.testing.assert_allclose(found.modes.frequencies, [60, 180], rtol=1e-5)
    np.testing.assert_allclose(found.frf.values, frf.values[:, :, 1:], rtol=1e-5, atol=1e-9)
    assert any("their conjugates are taken" in words for words in found.notes)


def test_frfs_beside_shapes_are_turned_too(tmp_path, synthetic):
    """FRAC of such a file was 0.003 for 1."""
    frf, _ = synthetic(((60.0, 0.01), (180.0, 0.005)), last=300.0, outputs=2)
    modes = identify_modes(frf).modes
    for name, values in (("right", frf.values), ("turned", frf.values.conj())):
        found = read_test(write_uff(tmp_path / f"{name}.uff", modes, replace(frf, values=values)))
        assert not found.identified
        np.testing.assert_allclose(found.frf.values, frf.values, rtol=1e-5, atol=1e-9)
        assert any("their conjugates are taken" in words for words in found.notes) == (name == "turned")


def test_the_decay_of_a_window_is_written_and_read(tmp_path, synthetic):
    frf, _ = synthetic(((60.0, 0.01), (180.0, 0.005)), last=300.0, outputs=2)
    file = write_uff(tmp_path / "a.uff", replace(frf, window_decay=1.25))
    assert read_uff(file).frf().window_decay == 1.25
    assert read_test(file).modes.loss_factors == pytest.approx(
        identify_modes(replace(frf, window_decay=1.25)).modes.loss_factors, rel=1e-6
    )
    assert read_uff(write_uff(tmp_path / "b.uff", frf)).frf().window_decay == 0


def test_positions_in_the_units_of_the_file(tmp_path):
    path = raw(tmp_path / "a.uff", units(1000.0), nodes(), shape())
    assert read_uff(path).modes().positions[1] == pytest.approx((1e-3, 2e-3, 3e-3))
    with pytest.raises(InputError, match="leave out length_unit"):
        read_uff(path, length_unit="mm")
    path = raw(tmp_path / "far.uff", units(1.0), nodes(), shape())
    assert "or correct data set 164" in read_uff(path).warnings[0]
    path = raw(tmp_path / "b.uff", nodes(), shape())
    assert read_uff(path, length_unit="mm").positions[2] == pytest.approx((0.1, 0.2, 0.3))
    notes = " ".join(read_uff(path).warnings)
    assert "metres are assumed" in notes
    assert 'are they in mm? Then give length_unit="mm"' in notes


# geometry


def test_coordinate_systems(tmp_path):
    """Point 1 moves in a system turned by 90 degrees: its x is the file's y. The format gives its place in the part."""
    system = {
        "type": 2420,
        "Part_UID": 1,
        "Part_Name": "part",
        "CS_sys_labels": [4],
        "CS_types": [0],
        "CS_colors": [1],
        "CS_names": ["turned"],
        "CS_matrices": [np.array([*SYSTEM, [10.0, 0, 0]])],
        "nodes": 1,
    }
    four = np.array([4, 0])
    path = raw(tmp_path / "a.uff", units(), system, nodes(def_cs=four, disp_cs=four), shape(), function(rsp_dir=1))
    file = read_uff(path)
    assert file.positions[1] == pytest.approx((1.0, 2.0, 3.0))
    assert any("name the export system 4" in note for note in file.warnings)
    assert file.positions[2] == pytest.approx((100, 200, 300))
    assert file.modes().at((Dof(1, "y"), Dof(2, "x"))) == pytest.approx(np.array([[1.0, 0.5]]))
    assert file.frf().outputs == (Dof(1, "y"),)
    slanted = system | {"CS_matrices": [np.array([[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1], [0, 0, 0.0]])]}
    with pytest.raises(ReadError, match="turned against the axes"):
        read_uff(raw(tmp_path / "b.uff", units(), slanted, nodes(disp_cs=four), function(rsp_dir=1))).frf()
    with pytest.raises(ReadError, match="cylindrical"):
        read_uff(raw(tmp_path / "c.uff", units(), system | {"CS_types": [1]}, nodes(disp_cs=four)))


def test_lines_to_draw(tmp_path):
    trace = {
        "type": 82,
        "trace_num": 1,
        "n_nodes": 5,
        "color": 1,
        "id": "outline",
        "nodes": np.array([1, 2, 3, 0, 7, 8]),
    }
    path = raw(tmp_path / "a.uff", trace)
    assert read_uff(path).lines == ((1, 2), (2, 3), (7, 8))


def test_elements_give_lines_too(tmp_path):
    path = tmp_path / "a.uff"
    path.write_text(
        "    -1\n  2412\n         1        41         1         1         1         3\n         5         6         9"
        "\n    -1\n"
    )
    assert read_uff(path).lines == ((5, 6), (6, 9), (9, 5))


def test_damping_of_modes(tmp_path):
    hysteretic = shape(modal_damp_vis=0.0, modal_damp_his=0.03)
    assert read_uff(raw(tmp_path / "a.uff", hysteretic)).modes().loss_factors[0] == pytest.approx(0.03)
    eig = 2 * np.pi * 12 * (-0.01 + 1j * np.sqrt(1 - 0.01**2))
    complex_mode = shape(
        analysis_type=3, eig=eig, r1=np.array([1.0, 0.5j]), r2=np.zeros(2, complex), r3=np.zeros(2, complex)
    )
    found = read_uff(raw(tmp_path / "b.uff", complex_mode)).modes()
    assert found.frequencies[0] == pytest.approx(12, rel=1e-5)
    assert found.loss_factors[0] == pytest.approx(0.02, rel=1e-5)
    np.testing.assert_allclose(found.shapes[0], [1, 0.5j])


# what cannot be read


def test_functions_that_do_not_stand_together(tmp_path):
    cases = {
        "split the file, or convert": (function(), function(rsp_node=5, ordinate_spec_data_type=8)),
        "lines are not those of the first": (function(), function(rsp_node=5, x=np.arange(20.0) + 1)),
    }
    for match, sets in cases.items():
        with pytest.raises(ReadError, match=match):
            read_uff(raw(tmp_path / "a.uff", *sets)).frf()


def test_the_same_pair_twice_and_points_without_numbers(tmp_path):
    frf = read_uff(raw(tmp_path / "a.uff", function(), function(data=np.zeros(20)))).frf()
    assert frf.values[0, 0, 1] == 1 + 2j
    assert any("appears twice; the first is taken" in word for word in frf.warnings)
    nameless = function(rsp_node=0, rsp_dir=0)
    frf = read_uff(raw(tmp_path / "b.uff", nameless, nameless)).frf()
    assert [d.point for d in frf.outputs] == [1, 2]
    assert any("numbered in their order" in word for word in frf.warnings)


def test_modes_that_cannot_be_used(tmp_path):
    for match, sets in {
        "no mode shape": (function(),),
        "different points": (shape(), shape(node_nums=[1, 3])),
        "nothing moves": (shape(r1=np.zeros(2)),),
    }.items():
        with pytest.raises(ReadError, match=match):
            read_uff(raw(tmp_path / "a.uff", *sets)).modes()
    with pytest.raises(ReadError, match="analysis type 5, which is not a mode"):
        read_uff(raw(tmp_path / "a.uff", shape(analysis_type=5, freq_step_n=1)))


def test_files_that_are_none(tmp_path):
    path = tmp_path / "a.uff"
    with pytest.raises(ReadError, match="no such file"):
        read_uff(path)
    for text in (b"", b"some words\n", bytes(range(256)) * 4):
        path.write_bytes(text)
        with pytest.raises(ReadError, match="not a universal file"):
            read_uff(path)


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7, 0.9, 0.99])
def test_files_cut_short(tmp_path, share):
    whole = raw(tmp_path / "a.uff", units(), nodes(), shape(), function(), function(rsp_node=5)).read_bytes()
    path = tmp_path / "cut.uff"
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ReadError, match="cut short|damaged|no universal"):
        read_uff(path)


def test_a_file_that_ends_in_blanks_and_a_mark_of_old_systems(tmp_path):
    path = raw(tmp_path / "a.uff", function())
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n") + b"  \r\n\x1a")
    assert read_uff(path).frf().values.shape == (1, 1, 20)


def test_damaged_data_sets(tmp_path):
    text = raw(tmp_path / "a.uff", function()).read_text()
    path = tmp_path / "b.uff"
    lines = text.splitlines(keepends=True)
    for changed, match in (
        (
            [
                *lines[:14],
                "  words where numbers should stand                                              \n",
                *lines[15:],
            ],
            "damaged or of a variant",
        ),
        ([*lines[:14], *lines[16:]], "16 values where its header announces 20"),
    ):
        path.write_text("".join(changed))
        with pytest.raises(ReadError, match=match):
            read_uff(path)
    path.write_text(text.replace("   1.00000000000e+00", "                 nan"))
    with pytest.raises(ReadError, match="it has NaN"):
        read_uff(path)
    with pytest.raises(ReadError, match="must be between 1e-12 and 1e\\+12"):
        read_uff(raw(path, units(0.0)))
    one = raw(path, shape()).read_text()
    path.write_text(one.replace(f"{2:>10}{2:>10}{8:>10}{2:>10}{3:>10}", f"{2:>10}{1:>10}{8:>10}{2:>10}{1:>10}"))
    with pytest.raises(ReadError, match="values in x, y, z|damaged"):
        read_uff(path)


def test_what_cannot_be_written(tmp_path):
    with pytest.raises(InputError, match="nothing to write"):
        write_uff(tmp_path / "a.uff")
    with pytest.raises(InputError, match="state the direction"):
        write_uff(tmp_path / "a.uff", modes(dofs=[(3, "x"), (3, "rx"), (7, "")]))
    with pytest.raises(InputError, match="no folder"):
        write_uff(tmp_path / "none" / "a.uff", modes())
    assert list(tmp_path.iterdir()) == []


def test_mode_sets_that_do_not_fit():
    with pytest.raises(InputError, match=r"shapes need \(2, 3\)"):
        modes(shapes=np.ones((2, 2)))
    with pytest.raises(InputError, match="the modes have NaN"):
        modes(loss_factors=np.array([np.nan, 1]))
    with pytest.raises(InputError, match=r"not known at 9\+x; they are at 3\+x"):
        modes().at((Dof(9, "x"),))


def changed(tmp_path, change, contents):
    path = write_uff(tmp_path / "a.uff", *contents)
    path.write_text(change(path.read_text()))
    return path


@pytest.fixture
def measured():
    rng = np.random.default_rng(2)
    positions = {1: (0.0, 0.0, 0.0), 2: (0.5, 0.25, 0.0), 3: (1.0, 0.0, 0.125)}
    shapes = rng.standard_normal((2, 9)) + 0j
    dofs = tuple((k, d) for k in (1, 2, 3) for d in "xyz")
    modes = ModeSet(
        frequencies=np.array([100.0, 250.0]),
        loss_factors=np.array([0.01, 0.02]),
        shapes=shapes,
        dofs=dofs,
        positions=positions,
    )
    frf = FRF(
        frequency=np.arange(1.0, 21.0),
        values=rng.standard_normal((1, 1, 20)) + 1j,
        outputs=((2, "z"),),
        inputs=((1, "z"),),
        quantity="accelerance",
        positions=positions,
    )
    return modes, frf


def lines_of_points(text):
    """Index of the first line of data set 2411's points, and all lines."""
    lines = text.splitlines(keepends=True)
    return next(i for i, line in enumerate(lines) if line.strip() == "2411") + 1, lines


def without_a_line(text):
    at, lines = lines_of_points(text)
    return "".join(lines[: at + 2] + lines[at + 3 :])


def point_twice(text):
    at, lines = lines_of_points(text)
    moved = lines[at + 1].replace("0.0", "7.0", 1)
    return "".join([*lines[: at + 2], lines[at], moved, *lines[at + 2 :]])


def infinite_point(text):
    at, lines = lines_of_points(text)
    word = lines[at + 3].split()[0]
    return "".join([*lines[: at + 3], lines[at + 3].replace(word, "inf".rjust(len(word)), 1), *lines[at + 4 :]])


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (without_a_line, "damaged|cannot be read|whole numbers"),
        (point_twice, "appears twice, at two places"),
        (infinite_point, "not finite|NaN or infinite|cannot be read"),
    ],
)
def test_damaged_points_are_refused(tmp_path, measured, change, match):
    with pytest.raises(ReadError, match=match):
        read_uff(changed(tmp_path, change, measured[:1]))


def test_a_function_with_more_values_than_announced_is_refused(tmp_path, measured):
    def line_twice(text):
        lines = text.splitlines(keepends=True)
        at = next(i for i, line in enumerate(lines) if line.strip() == "58") + 12
        return "".join([*lines[:at], lines[at], *lines[at:]])

    with pytest.raises(ReadError, match="values where its header announces 20"):
        read_uff(changed(tmp_path, line_twice, measured[1:]))


def test_rigid_modes_are_left_out_with_a_note_and_negative_frequencies_refused(tmp_path, measured):
    path = changed(tmp_path, lambda text: text.replace("1.00000e+02", "0.00000e+00"), measured[:1])
    file = read_uff(path)
    np.testing.assert_allclose(file.modes().frequencies, [250.0])
    assert any("1 mode shapes at 0 Hz" in note for note in file.warnings)
    with pytest.raises(ReadError, match="negative frequency"):
        read_uff(changed(tmp_path, lambda text: text.replace("1.00000e+02", "-1.0000e+02"), measured[:1]))


def test_reading_prints_nothing(tmp_path, capsys):
    """pyuff prints the groups of nodes (data set 2467) that it reads, which would break what commands print."""
    path = tmp_path / "groups.uff"
    group = [f"{1:10d}" + 6 * f"{0:10d}" + f"{1:10d}", "Left_Side", f"{7:10d}{1:10d}{0:10d}{0:10d}"]
    points = f"{1:10d}{0:10d}{0:10d}{8:10d}{0.1:13.5E}{0:13.5E}{0:13.5E}"
    path.write_text("\n".join(["    -1", "    15", points, "    -1", "    -1", "  2467", *group, "    -1", ""]))
    assert len(read_uff(path).positions) == 1
    assert capsys.readouterr() == ("", "")
