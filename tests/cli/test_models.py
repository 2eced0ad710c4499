"""The commands `faying models` and `faying law --scan`."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from faying import ContactPair, InputError, fit_fractal, read_scan
from faying.cli.scan.law import command as law
from faying.cli.scan.models import command as models
from faying.contact import JK, SurfaceInputs, laws
from faying.contact.inputs import OF_SCAN

SCAN = Path(__file__).parents[2] / "examples" / "t-specimen" / "milled.x3p"
STEEL = ["--material", "45 steel"]


def run(command: object, *words: str) -> str:
    return CliRunner().invoke(command, words, catch_exceptions=False, standalone_mode=False).output  # type: ignore[arg-type]


def test_models_lists_every_law_with_source_inputs_and_ranges() -> None:
    out = " ".join(run(models).split())
    for name, cls in laws().items():
        assert f"{name} (" in out
        assert cls.source in out
        given = [p for p in cls.entries().values() if p.surface not in OF_SCAN[1:]]
        assert all(p.meaning in out and p.allowed in out for p in given)
    assert "KogutEtsion (KE), doi:10.1115/1.1490373" in out


def test_models_knows_one_law_and_json() -> None:
    one = run(models, "persson")
    assert one.startswith("Persson")
    assert "JK" not in one
    tree = json.loads(run(models, "--json"))
    assert {e["class"] for e in tree["laws"]} == set(laws())
    jk = next(e for e in tree["laws"] if e["class"] == "JK")
    assert jk["parameters"]["D"]["needed"] is True
    assert jk["parameters"]["gamma"]["default"] == 1.5
    with pytest.raises(InputError, match="the known ones are"):
        run(models, "cube")


needs_scan = pytest.mark.skipif(not SCAN.exists(), reason="the synthetic scan of the example is not there")


@needs_scan
@pytest.mark.slow  # docs/which-law.md has the same command
def test_one_scan_all_models(tmp_path: Path) -> None:
    figure, table = tmp_path / "all.svg", tmp_path / "all.csv"
    out = run(
        law,
        "--scan",
        str(SCAN),
        *STEEL,
        "--all-models",
        "--pressure",
        "0.1 MPa:100 MPa:9",
        "--plot",
        str(figure),
        "--csv",
        str(table),
    )
    for name in (
        "JK",
        "MB",
        "WK",
        "YK",
        "ME",
        "JS",
        "Persson",
        "GW",
        "half-space",
        "GW-CEB",
        "GW-KE",
        "GW-ZMC",
        "GW-JG",
        "CMY",
        "Mikic",
    ):
        assert f"\n  {name} " in out
    assert out.count("max / min") == out.count("times that of the half-space") == 2
    assert "without a stiffness of their own: JS, MB, WK, YK" in out
    assert "<svg" in figure.read_text()
    rows = table.read_text().splitlines()
    assert len(rows) == 1 + 9 * 15
    assert rows[0].startswith("law,pressure [Pa],area [-],k_n [Pa/m]")


@needs_scan
def test_each_law_gets_its_inputs_from_the_same_scan() -> None:
    tree = json.loads(
        run(law, "--scan", str(SCAN), *STEEL, "--models", "jk,gw,persson", "--pressure", "1 MPa:2 MPa:2", "--json")
    )
    assert set(tree["laws"]) == {"JK", "GW", "Persson"}
    fit = fit_fractal(read_scan(SCAN))
    assert tree["surface"]["D"]["values"] == pytest.approx(fit.D)
    # twice the spectral density, that of two like faces, is a G greater by 2^(1/(2D - 4))
    assert tree["surface"]["G"]["values"] == pytest.approx(fit.G * 2 ** (1 / (2 * fit.D - 4)), rel=1e-9)
    pair = ContactPair("45 steel", "45 steel")
    jk = JK.from_surface(SurfaceInputs(**{name: q["values"] for name, q in tree["surface"].items()}), pair)
    assert tree["laws"]["JK"]["k_n"]["values"] == pytest.approx(jk.at_pressure([1e6, 2e6]).k_n.tolist(), rel=1e-9)
    values = np.array([tree["laws"][n]["k_n"]["values"] for n in ("JK", "GW", "Persson")])
    assert tree["largest over smallest"]["k_n"] == pytest.approx((values.max(0) / values.min(0)).tolist())


@needs_scan
def test_a_law_without_a_way_from_a_scan_says_so() -> None:
    with pytest.raises(InputError, match="Table needs file"):
        run(law, "--scan", str(SCAN), *STEEL, "--model", "tabulated-law")


@needs_scan
def test_one_law_of_a_scan_with_a_change() -> None:
    words = ["--scan", str(SCAN), *STEEL, "--model", "jk", "--pressure", "1 MPa", "--json"]
    plain, changed = (json.loads(run(law, *words, *more)) for more in ([], ["--set", "cutoff=0.001"]))
    assert plain["parameters"]["cutoff"]["values"] == 0.01
    assert changed["k_n"]["values"][0] > plain["k_n"]["values"][0]
    assert changed["parameters"]["D"] == plain["parameters"]["D"]


def test_faults_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="give --scan FILE and no --set"):
        run(law, *STEEL, "--all-models")
    with pytest.raises(InputError, match=r"none\.csv"):
        run(law, "--scan", str(tmp_path / "none.csv"), *STEEL)
