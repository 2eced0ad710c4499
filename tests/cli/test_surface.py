import json

import numpy as np
import pytest

from faying import Profile, Scan
from faying.cli import main
from faying.surface.files.write import write_scan
from faying.surface.synthesize import spectral
from tests.helpers.imperfect import with_missing


@pytest.fixture
def rough():
    return with_missing(spectral((128, 160), spacing=2e-6, D=2.4, G=1e-9, seed=1), share=0.01)


@pytest.fixture
def file(rough, tmp_path):
    return str(write_scan(rough, tmp_path / "rough.x3p", precision="D"))


def run(*args):
    with pytest.raises(SystemExit) as stop:
        main(["surface", *args])
    return stop.value.code


def test_table_names_what_was_measured(file, capsys):
    assert run(file) == 0
    out = capsys.readouterr().out
    assert "160 x 128 points, 320 um x 256 um" in out
    assert "missing 205, spikes 0" in out
    for word in ("Sq ", "Sa ", "Sdq ", "implied Sq", "psd", "Yan-Komvopoulos"):
        assert word in out


def test_json_is_si_and_complete(file, rough, capsys):
    assert run(file, "--json", "--method", "all") == 0
    document = json.loads(capsys.readouterr().out)
    assert document["points"] == [128, 160]
    assert document["spacing"] == pytest.approx([2e-6, 2e-6])
    assert document["missing"] == rough.missing
    assert document["roughness"]["Rq"] == pytest.approx(np.nanstd(rough.heights), rel=0.3)
    estimators = ("psd", "structure")
    assert set(document["fits"]) == set(estimators)
    psd = document["fits"]["psd"]
    assert psd["D_interval"][0] < psd["D"] < psd["D_interval"][1]
    assert psd["G_interval"][0] < 1e-9 < psd["G_interval"][1]


def test_text_file_without_unit_shows_how_to_give_it(rough, tmp_path, capsys):
    path = str(write_scan(rough, tmp_path / "a.csv", xy_unit="mm", z_unit="um"))
    assert run(path) == 1
    assert "--xy-unit mm --z-unit um" in capsys.readouterr().err
    assert run(path, "--xy-unit", "mm", "--z-unit", "um") == 0


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda z: np.full_like(z, np.nan), "every point is missing"),
        (lambda z: np.full_like(z, 2e-6), "all heights are the same"),
        (lambda z: z * 1e9, "check the unit"),
        (lambda z: z[:4], "at least 16"),
        (lambda z: np.where(np.arange(z.shape[1]) % 3 > 0, np.nan, z), "at most half"),
    ],
)
def test_scans_that_cannot_be_analysed_end_in_a_sentence(rough, tmp_path, capsys, make, match):
    path = write_scan(Scan(heights=make(rough.heights), spacing=rough.spacing), tmp_path / "a.x3p", precision="D")
    assert run(str(path)) == 1
    err = capsys.readouterr().err
    assert match in err
    assert err.startswith("faying: ")
    assert "Traceback" not in err


@pytest.mark.parametrize("shape", [(32, 32), (40, 24), 40])
def test_small_scans_have_a_roughness_and_no_fractal_numbers(tmp_path, capsys, shape):
    """Of a cosine of 4 periods along x: amplitude / sqrt(2)."""
    n = shape if isinstance(shape, int) else shape[1]
    wave = 1e-6 * np.cos(2 * np.pi * 4 * np.arange(n) / n)
    heights = wave if isinstance(shape, int) else np.tile(wave, (shape[0], 1))
    made = Profile(heights=heights, spacing=1e-6) if heights.ndim == 1 else Scan(heights=heights, spacing=(1e-6, 1e-6))
    path = write_scan(made, tmp_path / "a.x3p", precision="D")
    assert run(str(path), "--degree", "0") == 0
    out = " ".join(capsys.readouterr().out.split())
    assert f"{'R' if heights.ndim == 1 else 'S'}q 707.1 nm" in out
    assert "psd: no D and G:" in out
    assert run(str(path), "--degree", "0", "--json") == 0
    document = json.loads(capsys.readouterr().out)
    assert document["roughness"]["Rq"] == pytest.approx(1e-6 / 2**0.5)
    assert list(document["fits"]["psd"]) == ["error"]


def test_damaged_file(file, capsys):
    with open(file, "r+b") as handle:
        handle.truncate(5000)
    assert run(file) == 1
    assert "damaged" in capsys.readouterr().err


@pytest.mark.parametrize("suffix", ["png", "pdf"])
def test_plot_is_written(file, tmp_path, suffix):
    target = tmp_path / f"a.{suffix}"
    assert run(file, "--method", "all", "--plot", str(target)) == 0
    assert target.stat().st_size > 10_000


def test_plot_of_unknown_kind(file, tmp_path, capsys):
    assert run(file, "--plot", str(tmp_path / "a.xyz")) == 1
    assert "figures can be written as" in capsys.readouterr().err


def test_a_line_scan(tmp_path, capsys):
    path = write_scan(spectral(2000, spacing=1e-6, D=2.4, G=1e-9, seed=1), tmp_path / "a.x3p")
    assert run(str(path), "--method", "all", "--plot", str(tmp_path / "a.png")) == 0
    out = capsys.readouterr().out
    assert "2000 points, 2 mm" in out
    assert "Rq " in out
    assert "G of the profile itself" in " ".join(out.split())
