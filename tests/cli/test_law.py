"""The command `faying law`."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

import faying
from faying import CATALOGUE, JK, ContactPair, InputError, Material
from faying.cli.scan.law import command

SPECIMEN = ["--D", "2.39", "--G", "1.53e-10 m", "--scan-area", "16 mm^2", "--material", "45 steel"]
LAW = JK(D=2.39, G=1.53e-10, scan_area=16e-6, pair=ContactPair("45 steel", "45 steel"))


def run(*words: str) -> str:
    return CliRunner().invoke(command, words, catch_exceptions=False, standalone_mode=False).output


def test_table_holds_the_law() -> None:
    out = run(*SPECIMEN, "--pressure", "1 MPa:4 MPa:3")
    assert "doi:10.3390/fractalfract8100611" in out
    rows = [[float(v) for v in line.split()] for line in out.splitlines()[-4:-1]]
    expected = LAW.at_pressure([1e6, 2e6, 4e6])
    assert [row[0] for row in rows] == pytest.approx([1, 2, 4], rel=1e-3)
    assert [row[2] for row in rows] == pytest.approx((expected.k_n * 1e-12).tolist(), rel=1e-3)
    assert "outside the validity range" not in out
    assert out.splitlines()[-1] == "note: its loss rests on an assumed elastic-plastic load index, alpha = 0.2"


def test_json_agrees_with_the_library() -> None:
    out = json.loads(run(*SPECIMEN, "--pressure", "1 MPa:4 MPa:3", "--json"))
    expected = LAW.at_pressure(out["pressure"]["values"])
    assert out["pressure"]["values"] == pytest.approx([1e6, 2e6, 4e6], rel=1e-12)
    for name, value in expected.quantities().items():
        assert out[name]["values"] == pytest.approx(value.tolist(), rel=1e-9)
    assert out["valid"] == [True, True, True]
    assert out["parameters"]["G"] == {"values": 1.53e-10, "unit": "m"}


def test_options_reach_the_law() -> None:
    out = json.loads(
        run(
            *SPECIMEN,
            "--set",
            "closure=printed",
            "--set",
            "shear_stress=1 MPa",
            "--hardness",
            "1 GPa",
            "--against",
            "same",
            "--pressure",
            "2 MPa",
            "--json",
        )
    )
    steel = CATALOGUE["45 steel"]
    hard = replace(steel, hardness=1e9)
    law = LAW.with_(closure="printed", shear_stress=1e6, pair=ContactPair(hard, hard))
    assert out["k_t"]["values"] == pytest.approx([float(law.at_pressure(2e6).k_t)], rel=1e-9)


@pytest.mark.parametrize(
    ("given", "changes"),
    [
        (("--hardness", "3 GPa"), {"hardness": 3e9}),
        (("--yield-strength", "1 GPa"), {"hardness": None, "yield_strength": 1e9}),
    ],
)
def test_a_hardness_that_is_given_is_that_of_every_law(given, changes) -> None:
    """The Brinell hardness of the catalogue stayed, and the laws that take it did not move."""
    scan = Path(__file__).parents[2] / "examples" / "t-specimen" / "milled.x3p"
    of_scan = ("--scan", str(scan), "--model", "cmy", "--material", "45 steel", "--pressure", "2 MPa", "--json")
    hard = replace(CATALOGUE["45 steel"], brinell=None, vickers=None, **changes)
    law = faying.Mates(faying.read_scan(scan), materials=ContactPair(hard, hard)).law("cmy")
    found = json.loads(run(*of_scan, *given))["k_n"]["values"]
    assert found == pytest.approx([float(law.at_pressure(2e6).k_n)], rel=1e-9)
    assert found != pytest.approx(json.loads(run(*of_scan))["k_n"]["values"], rel=0.01)


def test_material_without_catalogue() -> None:
    words = [
        "--D",
        "2.39",
        "--G",
        "1.53e-10 m",
        "--scan-area",
        "16 mm^2",
        "--E",
        "200 GPa",
        "--nu",
        "0.3",
        "--yield-strength",
        "355 MPa",
        "--pressure",
        "2 MPa",
        "--json",
    ]
    bare = Material(name="given", E=200e9, nu=0.3, yield_strength=355e6)
    same = LAW.with_(pair=ContactPair(bare, bare))
    assert json.loads(run(*words))["k_n"]["values"] == pytest.approx([float(same.at_pressure(2e6).k_n)], rel=1e-9)


def test_a_law_that_was_measured_needs_no_material() -> None:
    """approach = C p^m, k_n = p^(1 - m)/(C m): 2 MPa/um at 1 MPa."""
    found = json.loads(
        run("--model", "power-law", "--set", "C=1e-9", "--set", "m=0.5", "--pressure", "1 MPa", "--json")
    )
    assert found["k_n"]["values"] == pytest.approx([2e12])
    with pytest.raises(InputError, match="no material"):
        run("--model", "power-law", "--set", "C=1e-9", "--set", "m=0.5", "--conductance")


def test_rows_outside_the_validity_range_carry_a_star_and_the_reason() -> None:
    out = run(*SPECIMEN, "--pressure", "1 MPa:40 MPa:4")
    assert [line.endswith("*") for line in out.split("\n\n")[3].splitlines()[1:]] == [False, False, True, True]
    assert "stiffness of the bulk" in out


def test_csv_and_figure(tmp_path: Path) -> None:
    table, figure = tmp_path / "law.csv", tmp_path / "law.svg"
    run(*SPECIMEN, "--csv", str(table), "--plot", str(figure))
    comment, *lines = table.read_text().splitlines()
    assert comment.startswith("# JK")
    rows = list(csv.DictReader(lines))
    assert len(rows) == 19
    assert float(rows[0]["k_n [Pa/m]"]) == pytest.approx(float(LAW.at_pressure(1e5).k_n), rel=1e-9)
    assert rows[0]["valid"] == "true"
    assert "nominal pressure [MPa]" in figure.read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--model", "nothing"], "no contact law 'nothing'; the known ones are"),
        (["--D", "2.39", "--material", "45 steel"], r"JK needs G .*, m\) and scan_area"),
        ([*SPECIMEN[:6]], "no material: give --material"),
        ([*SPECIMEN, "--material", "cheese"], "no material 'cheese' in the catalogue"),
        ([*SPECIMEN, "--against", "cheese"], "no material 'cheese'"),
        ([*SPECIMEN, "--set", "colour=red"], "has no parameter 'colour'"),
        ([*SPECIMEN, "--set", "cutoff"], "is not NAME=VALUE"),
        ([*SPECIMEN, "--G", "1e-10"], "has no unit"),
        ([*SPECIMEN, "--D", "3.2"], "between 2 and 3"),
        ([*SPECIMEN, "--pressure", "1 MPa:2 MPa:3:4"], "write FROM:TO"),
        ([*SPECIMEN, "--pressure", "2 MPa:1 MPa"], "below the second"),
        ([*SPECIMEN, "--pressure", "1 MPa:2 MPa:1"], "whole number from 2 to"),
        ([*SPECIMEN, "--pressure", "1:2"], "has no unit"),
        ([*SPECIMEN, "--pressure", "1 GPa"], "more than JK covers"),
        ([*SPECIMEN, "--plot", "law.xyz"], "figures can be written as"),
    ],
)
def test_faults_are_told(words: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        run(*words)


def test_a_law_on_a_scan_shows_what_the_surface_says(tmp_path: Path) -> None:
    """D and G with the intervals that `faying surface` prints, and its remarks."""
    from faying import fit_fractal, read_scan
    from faying.setup import template
    from faying.units import show

    template.surface(tmp_path / "s.x3p")
    fit = fit_fractal(read_scan(tmp_path / "s.x3p"))
    said = run("--scan", str(tmp_path / "s.x3p"), "--material", "45 steel", "--model", "jk")
    low, high = fit.D_interval
    assert f"{fit.D:.3f}  {low:.3f} .. {high:.3f}  {show(fit.G, 'm', digits=3)}  " in said
    assert "do not belong together" in " ".join(said.split())


ROUGH = ("--model", "cmy", "--set", "h_rms=1.2 um", "--set", "mean_slope=0.15", "--pressure", "1 MPa:10 MPa:2")


def test_conductance_goes_with_the_stiffness(tmp_path: Path) -> None:
    """h = 2 k_n/(E* (1/K + 1/K)): of steel on itself, K k_n/E*."""
    words = (*ROUGH, "--material", "S355", "--against", "same", "--conductance")
    tree = json.loads(run(*words, "--json"))
    K = CATALOGUE["S355"].conductivity or 0.0
    expected = [K * k / tree["E_star"]["values"] for k in tree["k_n"]["values"]]
    assert tree["h"]["values"] == pytest.approx(expected, rel=1e-12)
    assert tree["h"]["unit"] == "W/(m^2*K)"
    text = run(*words, "--csv", str(tmp_path / "h.csv"))
    assert "h in W/(m2 K): clean metal in vacuum" in text
    assert f"{expected[0]:.4g}" in text
    head, first = (tmp_path / "h.csv").read_text().splitlines()[1:3]
    assert float(first.split(",")[head.split(",").index("h [W/(m^2*K)]")]) == pytest.approx(expected[0])
    # JK has a stiffness as well, and its own pair
    rough = ("--D", "2.39", "--G", "1.53e-10 m", "--scan-area", "16 mm^2", "--pressure", "1 MPa:4 MPa:3")
    jk = json.loads(run(*rough, *words[-5:], "--friction", "0.2", "--json"))
    assert jk["h"]["values"] == pytest.approx([K * k / jk["E_star"]["values"] for k in jk["k_n"]["values"]])


def test_conductance_of_several_laws_of_a_scan(tmp_path: Path) -> None:
    from faying.setup import template

    template.surface(tmp_path / "s.x3p")
    words = (
        "--scan",
        str(tmp_path / "s.x3p"),
        "--models",
        "cmy,mikic",
        "--pressure",
        "1 MPa:10 MPa:2",
        "--conductance",
    )
    steel = ("--material", "45 steel", "--against", "same", "--conductivity", "50 W/(m K)")
    tree = json.loads(run(*words, *steel, "--json"))
    for law in tree["laws"].values():
        ratio = [h / k for h, k in zip(law["h"]["values"], law["k_n"]["values"], strict=True)]
        assert ratio == pytest.approx([50 * 2 * (1 - 0.3**2) / 200e9] * 2)
    text = run(*words, *steel, "--csv", str(tmp_path / "h.csv"))
    assert "h [W/(m2 K)], clean metal in vacuum" in text
    assert ",h [W/(m^2*K)],valid" in (tmp_path / "h.csv").read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--material", "45 steel", "--against", "same"), "'45 steel' has none: give conductivity"),
        (
            ("--material", "S355", "--against", "rigid"),
            'the rigid plane does not: name the material of the other face, for example against "',
        ),
        (("--material", "S355", "--against", "same", "--conductivity", "5 W"), "--conductivity"),
    ],
)
def test_conductance_without_conductors_is_an_error(words: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        run(*ROUGH, *words, "--conductance")
