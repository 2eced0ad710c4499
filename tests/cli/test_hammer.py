"""`faying test` and `faying compare`."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from faying import FRF, read_uff, write_uff
from faying.cli import main
from faying.measured.mapping import Transform
from faying.measured.model import ModelModes
from tests.helpers.results import small_result

ROOT = Path(__file__).parents[2]
FREQUENCIES = np.array([110.0, 240.0, 390.0, 620.0])
TURN = Transform(rotation=np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), shift=np.array([0.3, 0, -0.1]))


def model():
    rng = np.random.default_rng(2)
    points = rng.uniform(0, 1, (30, 3)) * [0.5, 0.2, 0.1]
    shapes = np.linalg.qr(rng.standard_normal((90, 4)))[0].T.reshape(4, 30, 3)
    return ModelModes(frequencies=FREQUENCIES, loss_factors=np.full(4, 0.01), shapes=shapes, points=points)


@pytest.fixture
def result(tmp_path):
    """A result of two loads, the frequencies of the first lower by a tenth."""
    m = model()
    return small_result(
        title="plate",
        frequencies=np.stack([0.9 * FREQUENCIES, FREQUENCIES]),
        loss_factors=np.full((2, 4), 0.01),
        loss_error=np.zeros((2, 4)),
        bonded=FREQUENCIES,
        free=FREQUENCIES,
        mac=np.ones((2, 4, 4)),
        outline=m.points,
        triangles=np.array([[0, 1, 2], [2, 3, 4]]),
        shapes=np.stack([m.shapes, m.shapes]),
    ).save(tmp_path / "result.nc")


@pytest.fixture
def test_file(tmp_path):
    """FRFs of eight points in a frame of their own, frequencies 2 % above the model's."""
    m = model()
    higher = ModelModes(**{**vars(m), "frequencies": 1.02 * FREQUENCIES})
    nodes = np.arange(8)
    axes = TURN.directions(np.eye(3))
    f = np.arange(0, 801.0)
    outputs = (np.repeat(nodes, 3), np.tile(axes, (8, 1)))
    values = higher.frf(f, outputs, (nodes[:1], axes[:1]), "accelerance")
    here = (m.points[nodes] - TURN.shift) @ TURN.rotation
    frf = FRF(
        frequency=f,
        values=values,
        outputs=[(k + 1, d) for k in range(8) for d in "xyz"],
        inputs=[(1, "x")],
        quantity="accelerance",
        positions={k + 1: tuple(p) for k, p in enumerate(here)},
    )
    return write_uff(tmp_path / "test.uff", frf)


@pytest.fixture
def frame(tmp_path):
    rows = [f"{k + 1}," + ",".join(f"{1e3 * v:.4f}" for v in p) for k, p in enumerate(model().points[:5])]
    path = tmp_path / "frame.csv"
    path.write_text("\n".join(["point,x [mm],y [mm],z [mm]", *rows]))
    return path


def run(*args):
    with pytest.raises(SystemExit) as stop:
        main([str(a) for a in args])
    return stop.value.code


def test_table_of_modes(test_file, capsys):
    assert run("test", test_file) == 0
    out, err = capsys.readouterr()
    found = [float(line.split()[1]) for line in out.splitlines()[1:5]]
    np.testing.assert_allclose(found, 1.02 * FREQUENCIES, atol=0.02)
    assert "\x1b" not in out + err
    assert "poles up to order 80" in err


def test_json_is_si_and_complete(test_file, capsys):
    assert run("test", test_file, "--json", "--band", "100 Hz:300 Hz") == 0
    document = json.loads(capsys.readouterr().out)
    np.testing.assert_allclose(document["frequencies"], 1.02 * FREQUENCIES[:2], rtol=2e-3)
    assert len(document["shapes"]["real"][0]) == 24
    for low_high, value in zip(document["loss_interval"], document["loss_factors"], strict=True):
        assert low_high[0] <= value <= low_high[1]


def test_modes_go_on_to_the_comparison(result, test_file, frame, tmp_path, capsys):
    assert run("test", test_file, "--out", tmp_path / "modes.uff") == 0
    capsys.readouterr()
    assert run("compare", result, tmp_path / "modes.uff", "--frame", frame, "--out", tmp_path / "out", "--json") == 0
    document = json.loads(capsys.readouterr().out)
    assert [(p["test"], p["model"]) for p in document["pairs"]] == [(k, k) for k in range(4)]
    np.testing.assert_allclose([p["frequency_difference"] for p in document["pairs"]], 1 / 1.02 - 1, atol=1e-4)
    np.testing.assert_allclose([p["mac"] for p in document["pairs"]], 1, atol=1e-3)
    assert document["model"]["preload"] == 8e3
    assert len(document["frac"]) == 24
    assert {Path(f).name for f in document["files"]} == {
        "comparison.csv",
        "mac.svg",
        "frf.svg",
        "shapes.png",
        "comparison.html",
    }
    page = (tmp_path / "out" / "comparison.html").read_text()
    assert page.count("<figure>") == 3
    assert "95 %" in page
    assert document["test"]["loss_interval"] is not None


def test_frfs_alone_are_identified_on_the_way(result, test_file, frame, capsys):
    assert run("compare", result, test_file, "--frame", frame, "--load", "2 kN") == 0
    out, err = capsys.readouterr()
    assert "modes are identified from its FRFs" in err
    assert "plate at 2 kN; 8 points" in out
    first = out.split("\n\n")[1]  # of the blocks of columns that the width has
    differences = [float(line.split()[4]) for line in first.splitlines() if re.match(r" +\d+ ", line)]
    np.testing.assert_allclose(differences, 100 * (0.9 / 1.02 - 1), atol=0.02)


@pytest.mark.parametrize(
    ("more", "match"),
    [
        ((), "give the frame"),
        (("--load", "5 kN"), "result.nc has no such preload; it has 2 kN, 8 kN"),
        (("--tolerance", "5"), "no unit"),
        (("--points", "absent.csv"), "cannot be read"),
    ],
)
def test_comparisons_that_fail(result, test_file, more, match, capsys):
    assert run("compare", result, test_file, *more) == 1
    assert match in capsys.readouterr().err


def test_a_frame_of_points_that_the_test_has_not(result, test_file, tmp_path, capsys):
    path = tmp_path / "frame.csv"
    path.write_text("point,x [m],y [m],z [m]\n77,0,0,0\n")
    assert run("compare", result, test_file, "--frame", path) == 1
    assert "no position of point 77" in capsys.readouterr().err


def test_positions_from_a_table(result, test_file, frame, tmp_path, capsys):
    """A test whose file has no positions, its points given in the frame of the model."""
    frf = read_uff(test_file).frf()
    bare = write_uff(tmp_path / "bare.uff", FRF(**{**vars(frf), "positions": {}, "warnings": ()}))
    assert run("compare", result, bare) == 1
    assert "--points points.csv" in capsys.readouterr().err
    assert run("compare", result, bare, "--points", frame) == 0
    assert "5 points of the test found a node" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("args", "code", "match"),
    [
        ((), 2, "Missing argument"),
        (("a.uff", "--quantity", "inertance"), 2, "Invalid value"),
        (("absent.uff",), 1, "no such file"),
        (("a.txt",), 1, "give --quantity"),
        (("a.uff", "b.uff"), 1, "give one universal file"),
        (("a.uff", "--band", "20 Hz"), 1, '"20 Hz:800 Hz"'),
    ],
)
def test_usage(args, code, match, capsys):
    assert run("test", *args) == code
    assert match in capsys.readouterr().err


def test_nothing_is_written_where_nothing_was_found(tmp_path, capsys):
    source = tmp_path / "a.csv"
    rng = np.random.default_rng(0)
    source.write_text("\n".join(f"{k},{a},{b}" for k, (a, b) in enumerate(rng.standard_normal((300, 2)))))
    out = tmp_path / "modes.uff"
    assert run("test", source, "--quantity", "mobility", "--stays", "36", "--out", out) == 1
    assert "loosen the rule" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [source]


def test_text_files_and_a_figure(measured_frfs, tmp_path, capsys):
    files = [measured_frfs / f"meas_point_{k}.txt" for k in (1, 2, 3)]
    plot = tmp_path / "a.png"
    assert (
        run("test", *files, "--quantity", "accelerance", "--frequency-step", "1 Hz", "--direction", "y", "--plot", plot)
        == 0
    )
    out = capsys.readouterr().out
    assert re.search(r"\n +6 +958\.5", out)
    assert "narrower than the 1 Hz between spectral lines" in out
    assert plot.stat().st_size > 20_000
    assert (
        run("test", *files, "--quantity", "accelerance", "--frequency-step", "1 Hz", "--plot", tmp_path / "a.xyz") == 1
    )


@pytest.fixture
def measured_frfs():
    folder = Path(os.environ.get("FAYING_DATA", ROOT / "../shared/data")) / "frf"
    if not folder.is_dir():
        pytest.skip(f"real FRFs are absent: {folder}; set FAYING_DATA")
    return folder


def test_the_libraries_are_loaded_only_when_needed():
    heavy = ("pyuff", "sdypy", "scipy")
    modules = "faying.cli.measured.test, faying.cli.scan.law_table"
    code = f"import sys, {modules}; sys.exit(any(m in sys.modules for m in {heavy}))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_frfs_in_the_other_sign_of_time_are_written_as_their_modes_are(tmp_path, capsys):
    """1/(w0^2 - w^2 - i eta w0^2), of exp(-i w t): the file has modes that decay and FRFs that lag."""
    f, f0, eta = np.arange(0.0, 201.0), 100.0, 0.02
    h = 1 / ((2 * np.pi) ** 2 * (f0**2 - f**2 - 1j * eta * f0**2))
    rows = [f"{a},{v.real!r},{v.imag!r}" for a, v in zip(f.tolist(), h.tolist(), strict=True)]
    (tmp_path / "a.csv").write_text("\n".join(["frequency [Hz],re [m/N],im [m/N]", *rows, ""]))
    assert (
        run("test", tmp_path / "a.csv", "--quantity", "receptance", "--direction", "z", "--out", tmp_path / "a.uff")
        == 0
    )
    assert "their conjugates are taken" in capsys.readouterr().err
    written = read_uff(tmp_path / "a.uff").frf()
    np.testing.assert_allclose(written.values[0, 0], h.conj()[np.isin(f, written.frequency)], rtol=1e-5)
