"""Sheets of the bolts of a study: every number from its printed inputs, what is missing, keys, page and command."""

import json
import tomllib
from dataclasses import replace
from html import escape
from math import pi, sqrt, tan

import numpy as np
import pytest

import faying
from faying import units
from faying.answer.run import run
from faying.case.case import Case
from faying.case.scatter import DEFAULT_WAY, preload_scatter
from faying.case.service_bolts import service_bolts
from faying.cli.main import main
from faying.sheet import page as shown
from faying.sheet.bolt_loads import AtPreload, BoltLoad
from faying.sheet.bolt_sheet import bolt_sheet
from faying.study import Study
from faying.study.keys.bolt_sheet import choice_of
from tests.helpers.studies import write

BOLT = {"diameter": "8 mm", "material": "45 steel", "grade": "8.8", "preload": ["2 kN", "6 kN"]}
SAID = {
    "tightening_factor": 1.6,
    "thread_friction": 0.10,
    "head_friction": 0.14,
    "slip_friction": 0.2,
    "axial": ["-0.5 kN", "2 kN"],
    "introduction": 0.5,
    "transverse": "200 N",
    "clamp": "300 N",
    "thermal_loss": "150 N",
    "embedding": "2 um",
}
# of every row, from the values of its inputs in SI units, written apart from the product
HAND = {
    "A_req": lambda v: v["F_V"] * (1 + v["s"]) / v["S_p"],
    "alpha_A": lambda v: (1 + v["s"]) / (1 - v["s"]),
    "F_KQ": lambda v: v["F_Q"] / v["mu_T"],
    "F_Kreq": lambda v: max(v["F_KQ"], v["F_KP"]),
    "Phi": lambda v: v["n"] / (1 + v["delta_S"] / v["delta_P"]),
    "Phi_c": lambda v: v["n"] / (1 + v["delta_S"] / v["delta_Pc"]),
    "F_Z": lambda v: v["f_Z"] / (v["delta_S"] + v["delta_P"]),
    "F_Zlaw": lambda v: v["f_law"] / (v["delta_S"] + v["delta_P"]),
    "F_Zd": lambda v: v["f_Zd"] / (v["delta_S"] + v["delta_P"]),
    "dF_th": lambda v: v["F_th"],
    "F_Mmin": lambda v: v["F_V"] - v["s"] * v["F_V"],
    "F_SAu": lambda v: v["Phi"] * v["F_Au"] + v["dF_u"],
    "F_SAo": lambda v: v["dF_o"] + v["Phi"] * v["F_Ao"],
    "F_SAM": lambda v: v["dF_M"] + v["Phi"] * v["F_Ao"],
    "F_Mreq": lambda v: v["F_Kreq"] + v["F_Ao"] - v["Phi"] * v["F_Ao"] + v["dF_P"] + v["F_Zd"] + v["F_thd"],
    "F_Mmax": lambda v: v["alpha_A"] * v["F_Mmin"],
    "M_G": lambda v: v["F_Mmax"] * (0.16 * v["P"] + 0.58 * v["d_2"] * v["mu_G"]),
    "sigma_redM": lambda v: mises(v["F_Mmax"] / (pi * v["d_0"] ** 2 / 4), 12 * v["M_G"] / (pi * v["d_0"] ** 3)),
    "F_Smax": lambda v: v["F_Mmax"] + v["F_SAM"] + v["F_thg"],
    "sigma_redB": lambda v: mises(v["F_Smax"] / (pi * v["d_0"] ** 2 / 4), 8 * v["M_G"] / (pi * v["d_0"] ** 3)),
    "sigma_ASV": lambda v: (127.5 / (v["d"] * 1e3) + 38.25) * 1e6,
    "sigma_a": lambda v: (v["F_SAo"] - v["F_SAu"]) / 2 / v["A_S"] + v["sigma_b"],
    "p_M": lambda v: v["F_Mmax"] / v["A_p"],
    "p_B": lambda v: v["F_Smax"] / v["A_p"],
    "F_nut": lambda v: v["F_Mmax"],
    "F_Vmin": lambda v: v["F_Mmin"] - v["F_Zd"] - v["F_thd"],
    "F_PA": lambda v: v["F_Ao"] - v["Phi"] * v["F_Ao"] + v["dF_P"],
    "F_KRmin": lambda v: v["F_Vmin"] - v["F_PA"],
    "F_KQs": lambda v: v["F_KQ"],
    "tau_Q": lambda v: v["F_Q"] / v["A_S"],
    "M_A": lambda v: v["F_V"] * (0.16 * v["P"] + 0.58 * v["d_2"] * v["mu_G"] + v["D_Km"] * v["mu_K"] / 2),
}


def mises(tension, shear):
    return sqrt(tension**2 + 3 * shear**2)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sheet")
    write(folder / "study.toml")

    def study(bolt=BOLT, **changes):
        data = tomllib.loads((folder / "study.toml").read_text())
        data["geometry"]["size"] = "12 mm"
        data["geometry"].pop("face_size", None)
        data["bolt"][0] |= bolt
        data["modes"]["count"] = 2
        return Study.from_dict(data | changes, folder=folder)

    return study


@pytest.fixture(scope="module")
def full(made):
    return bolt_sheet(made(bolt_sheet=SAID))


@pytest.fixture(scope="module")
def bare(made):
    return bolt_sheet(made())


def test_every_number_follows_from_its_printed_inputs(full):
    (sheet,) = json.loads(json.dumps(full.to_dict(), allow_nan=False))["bolts"]
    computed = 0
    for row in sheet["rows"]:
        values = {one["symbol"]: one["values"] for one in row["inputs"]}
        symbol, value = row["quantity"]["symbol"], row["quantity"]["values"]
        if None in values.values():
            assert value is None, symbol
            assert row["verdict"] == "not known", symbol
            assert row["missing"], symbol
            continue
        assert value == pytest.approx(HAND[symbol](values), rel=1e-9), symbol
        computed += 1
        limit = row["limit"] and row["limit"]["values"]
        if limit:
            assert row["utilisation"] == pytest.approx(value / limit, rel=1e-12), symbol
            assert row["verdict"] == ("exceeded" if value > limit else "ok"), symbol
    assert computed == len(sheet["rows"]) - 2  # no scan: neither guide value nor law predicts an embedding


def test_every_number_follows_from_the_digits_that_the_page_prints(full):
    """Four digits of each input give the printed value to 0.5 %; limits and inputs are those of the rows they name."""

    def read(quantity):
        text = shown.value_of(quantity)
        return units.parse(text, quantity.unit) if quantity.unit not in ("", "1") else float(text)

    (sheet,) = full.sheets
    rows = {row.result.symbol: row for row in sheet.rows}
    page = shown.html(full)
    for symbol, row in rows.items():
        if row.result.value is None:
            continue
        values = {one.symbol: read(one) for one in row.inputs}
        assert read(row.result) == pytest.approx(HAND[symbol](values), rel=5e-3), symbol
        assert escape(f"{row.result.symbol}: {row.result.name}") in page
        for one in (*row.inputs, *([] if row.limit is None else [row.limit])):
            assert escape(f"{one.symbol} = {shown.value_of(one)}") in page
            if one.symbol in rows:
                assert one.value == rows[one.symbol].result.value
        if row.limit is not None:
            assert row.utilisation == pytest.approx(read(row.result) / read(row.limit), rel=1e-3), symbol
    limits = {row.limit.symbol: row.limit.value for row in sheet.rows if row.limit is not None}
    assert set(limits) - set(rows) == {"A_S", "R_p09", "R_p", "p_G", "F_p", "tau_BS"} & set(limits)
    assert limits["tau_BS"] == pytest.approx(0.6 * 800e6)
    assert limits["F_p"] == pytest.approx(580e6 * limits["A_S"])


def test_inputs_are_those_of_study_and_structure(made, full):
    """Thread, strengths and seats by hand; compliances are those of a run at the same preload."""
    (sheet,) = full.sheets
    known = {one.symbol: one.value for row in sheet.rows for one in row.inputs} | {
        row.limit.symbol: row.limit.value for row in sheet.rows if row.limit is not None
    }
    d, P = 8e-3, 1.25e-3
    assert known["d_2"] == pytest.approx(d - 0.64952 * P)
    assert known["d_0"] == pytest.approx(d - 0.938195 * P)
    assert known["A_S"] == pytest.approx(pi / 4 * (d - 0.938195 * P) ** 2, rel=1e-9)
    assert (known["R_p"], known["S_p"], known["R_p09"]) == (640e6, 580e6, 576e6)
    assert known["s"] == pytest.approx(0.6 / 2.6)
    assert (known["F_V"], known["F_Au"], known["F_Ao"], known["F_Q"], known["F_KP"]) == (6e3, -500, 2e3, 200, 300)
    assert (known["mu_G"], known["mu_K"], known["mu_T"], known["n"], known["F_th"]) == (0.10, 0.14, 0.2, 0.5, 150)
    assert known["D_Km"] == pytest.approx(12.5e-3, rel=0.03)  # the seats of the example: 9 and 16 mm
    numbers = run(made()).bolt_numbers
    assert known["delta_S"] == pytest.approx(numbers.compliance[-1, 0], rel=1e-9)
    assert known["delta_P"] == pytest.approx(numbers.member_compliance[-1, 0], rel=1e-6)
    assert known["A_p"] == pytest.approx(6e3 / numbers.seat_pressure[-1, 0], rel=1e-6)


def test_what_is_not_said_is_not_known(bare):
    (sheet,) = bare.sheets
    for symbol, missing in (
        ("F_Mreq", "bolt_sheet.axial"),
        ("sigma_a", "bolt_sheet.axial"),
        ("F_KQ", "bolt_sheet.transverse"),
        ("F_Z", "a scan of each joint"),
        ("F_Vmin", "bolt_sheet.embedding, or a scan of each joint"),
        ("dF_th", "bolt_sheet.thermal_loss"),
    ):
        row = sheet.row(symbol)
        assert row.verdict == "not known"
        assert missing in row.missing
    assert sheet.row("sigma_redM").verdict == "ok"
    (scatter,) = sheet.row("alpha_A").inputs
    assert DEFAULT_WAY in scatter.name
    assert sheet.row("alpha_A").result.value == pytest.approx(1.28 / 0.72)
    with pytest.raises(faying.InputError, match="no row 'x'; give one of A_req, alpha_A"):
        sheet.row("x")


def test_text_and_page_hold_every_row(full, bare):
    for found in (full, bare):
        said, page = shown.terminal(found), shown.html(found)
        for row in found.sheets[0].rows:
            assert f"{row.result.symbol}: " in said
            assert all(word in said for word in (*row.result.name.split(), *shown.value_of(row.result).split()))
            assert row.step in page
        assert page.count("<section") == 1
        assert "bolt_sheet.axial" in shown.terminal(bare)
    assert "bolt, M8x1.25 8.8" in repr(full)


def test_units_read_well(full):
    (sheet,) = full.sheets
    assert shown.value_of(sheet.row("A_req").result).endswith(" mm^2")
    delta = next(one for one in sheet.row("Phi").inputs if one.symbol == "delta_S")
    assert shown.value_of(delta) == f"{1e9 * delta.value:.4g} um/kN"
    assert shown.value_of(sheet.row("M_A").result).endswith(" N m")
    assert shown.value_of(None) == "-"


def test_a_tapped_part_strips_by_its_shear_strength():
    from faying.sheet.steps import engagement

    d, P, tau, R = 8e-3, 1.25e-3, 200e6, 800e6
    area, d_2 = pi / 4 * (d - 0.938195 * P) ** 2, d - 0.64952 * P
    printed = R * area / (0.897 * tau * pi * d * (0.5 + (d - d_2) * tan(pi / 6) / P))
    assert engagement(R_m=R, A_S=area, tau_B=tau, d=d, d_2=d_2, P=P) == pytest.approx(printed)


def test_the_preload_is_chosen(made):
    (small,) = bolt_sheet(made(bolt_sheet=SAID), "2 kN").sheets
    assert small.row("F_Mmin").inputs[0].value == pytest.approx(2e3)
    assert small.row("F_Mreq").verdict == "exceeded"  # embedding of 2 um costs most of it
    with pytest.raises(faying.InputError, match="preload = 5 kN: the study has no such preload; it has 2 kN, 6 kN"):
        bolt_sheet(made(), "5 kN")


def test_scatter_follows_the_way_of_tightening(made):
    hydraulic = made(bolt_sheet={"tightening": "hydraulic"})
    assert preload_scatter(hydraulic, "bolt", choice_of(hydraulic.bolt_sheets, "bolt"))[0] == 0.23
    uncertain = made(
        bolt=BOLT | {"preload": "6 kN"}, uncertain={"preload": {"tightening": "yield or angle controlled"}}
    )
    choice = choice_of(uncertain.bolt_sheets, "bolt")
    assert preload_scatter(uncertain, "bolt", choice)[0] == pytest.approx(0.12, rel=1e-3)


@pytest.mark.parametrize(
    ("lines", "half"),
    [
        ({"bolt": {"preload": "6 kN +- 0.3 kN"}}, 0.1),
        ({"bolt": {"factor": "1 +- 0.03"}}, 0.06),
        ({"bolt": {"bolt": {"factor": "1 +- 0.02"}}}, 0.04),
        ({"material": {"E": "200 GPa +- 5 GPa"}}, 0.28),
    ],
)
def test_scatter_of_the_sheet_is_that_of_every_interval(made, lines, half):
    """Two standard deviations of the force, by a line on it or on a factor; else by default."""
    study = made(bolt=BOLT | {"preload": "6 kN"}, uncertain=lines)
    choice = choice_of(study.bolt_sheets, "bolt")
    assert preload_scatter(study, "bolt", choice)[0] == pytest.approx(half, rel=2e-3)


def test_a_bolt_has_its_own_table(made):
    study = made(bolt_sheet=[{"bolt": "bolt", "axial": "1 kN"}, {"clamp": "2 kN"}])
    assert choice_of(study.bolt_sheets, "bolt").axial == (0.0, 1e3)
    assert choice_of(study.bolt_sheets, "another").clamp == 2e3
    assert choice_of(made().bolt_sheets, "bolt").axial is None


@pytest.mark.parametrize(
    ("table", "text"),
    [
        ({"bolt": "left"}, '"left" is not a bolt; give one of "bolt"'),
        ({"tightening": "by hand"}, "is not a way of tightening"),
        ({"tightening": "feel", "tightening_factor": 2.0}, "both tightening and tightening_factor"),
        ({"tightening_factor": 0.5}, "should be a plain number from 1 to 10"),
        ({"axial": ["2 kN", "1 kN"]}, "the second load must be the greater"),
        ({"axial": ["1 kN"]}, "the least and the greatest"),
        ({"transverse": "-1 N"}, "should be 0 or more"),
        ({"thread_friction": 0.0}, "should be a plain number from 0.02 to 0.8"),
        ({"rolled": "never"}, "rolled"),
        ({"curve": {"knee": 1e6}}, "curve.endurance is missing"),
        ({"curve": {"endurance": 40}}, "unit"),
        ({"curve": {"endurance": "40 MPa"}, "fatigue": "iec"}, "both fatigue and curve"),
        ([{"axial": "1 kN"}, {"clamp": "1 kN"}], "two tables name no bolt"),
    ],
)
def test_faults_of_the_table(made, table, text):
    with pytest.raises(faying.InputError, match=text):
        made(bolt_sheet=table)


def test_a_curve_of_its_own_has_the_slope_of_haibach_below(made):
    study = made(bolt_sheet={"curve": {"endurance": "40 MPa", "knee": 1e6, "slope": 5}})
    (bolt,) = service_bolts(Case.of(study).structure, study)
    # 1e6 cycles at the knee; at half of the endurance 2^(2*5 - 1) times as many
    assert bolt.damage(40e6, 1e6, mean=0.0) == pytest.approx(1, rel=1e-12)
    assert bolt.damage(20e6, 1e6, mean=5e3) == pytest.approx(2.0**-9, rel=1e-12)
    assert bolt.damage(80e6, 1e6, mean=5e3) == pytest.approx(2.0**5, rel=1e-12)


@pytest.mark.parametrize(
    ("table", "limit", "origin"),
    [
        ({"curve": {"endurance": "4 MPa", "knee": 1e6, "slope": 5}}, 4e6, "as given"),
        # half of category 36, bolts of 30 mm and less as they are
        ({"fatigue": "iec"}, 18e6, "IEC 61400-6"),
        ({}, 0.85 * (150 / 8 + 45) * 1e6, "rolled before"),
    ],
)
def test_the_alternating_stress_is_held_against_the_curve_of_the_sheet(made, table, limit, origin):
    (sheet,) = bolt_sheet(made(bolt_sheet=SAID | table)).sheets
    row = sheet.row("sigma_a")
    assert row.limit.value == pytest.approx(limit, rel=1e-12)
    assert origin in row.limit.name
    assert row.verdict == ("ok" if row.result.value <= limit else "exceeded")


@pytest.mark.slow
def test_damage_of_the_sheet_has_that_of_vibration_in_its_time(made):
    """What a run finds at the same preload, 95 %, of those vibrations that say how long; and no row without."""
    noise = {
        "name": "noise",
        "psd": [["20 Hz", "0.001 N^2/Hz"], ["20 kHz", "0.001 N^2/Hz"]],
        "point": ["40 mm", "15 mm", "15 mm"],
    }
    timed = noise | {"duration": "1 h"}
    swept = {"name": "sweep", "sine": [["20 Hz", "0.05 N"], ["20 kHz", "0.05 N"]], "point": ["40 mm", "15 mm", "15 mm"]}
    study = made(bolt_sheet=SAID, vibration=[timed, swept])
    found = run(study).vibrations
    for preload, response in zip(("2 kN", "6 kN"), found[::2], strict=True):
        row = bolt_sheet(study, preload).sheets[0].row("D")
        assert response.damage[2, 0] > 0
        assert row.result.value == pytest.approx(response.damage[2, 0], rel=1e-6)
        assert "'noise'" in row.inputs[1].name
        assert "'sweep'" not in row.inputs[1].name
    with pytest.raises(faying.InputError, match="no row 'D'"):
        bolt_sheet(made(bolt_sheet=SAID, vibration=[noise])).sheets[0].row("D")


def test_a_thread_rolled_after_heat_treatment_has_one_endurance_in_sheet_and_service(made):
    """The sheet's own step at the same mean force, and at yield that of a thread rolled before."""
    study = made(bolt_sheet=SAID | {"rolled": "after"})
    (bolt,) = service_bolts(Case.of(study).structure, study)
    (sheet,) = bolt_sheet(study).sheets
    (row,) = [row for row in sheet.rows if row.result.symbol == "sigma_ASG"]
    given = {one.symbol: one.value for one in row.inputs}
    assert bolt.curve(given["F_Sm"]).endurance == pytest.approx(row.result.value, rel=1e-12)
    assert bolt.curve(given["R_p"] * given["A_S"]).endurance == pytest.approx(given["sigma_ASV"], rel=1e-12)
    assert bolt.curve(0.0).endurance == pytest.approx(2 * given["sigma_ASV"], rel=1e-12)
    with pytest.raises(faying.InputError, match='bolt "bolt" has none; give it grade'):
        made(bolt={}, bolt_sheet={"rolled": "after"})
    made(bolt={}, bolt_sheet={"rolled": "after", "fatigue": "iec"})


def test_friction_of_the_bolt_counts_where_the_sheet_says_none(made):
    from faying.sheet.bolt_sheet import _tightening

    rubbing = BOLT | {"thread_friction": 0.09, "head_friction": 0.11}
    study = made(bolt=rubbing)
    found = {q.symbol: q.value for q in _tightening(study, study.bolts[0], choice_of(study.bolt_sheets, "bolt"), 1e3)}
    assert (found["mu_G"], found["mu_K"]) == (0.09, 0.11)
    study = made(bolt=rubbing, bolt_sheet={"thread_friction": 0.2})
    found = {q.symbol: q.value for q in _tightening(study, study.bolts[0], choice_of(study.bolt_sheets, "bolt"), 1e3)}
    assert (found["mu_G"], found["mu_K"]) == (0.2, 0.11)


def test_the_command_writes_text_page_and_json(made, tmp_path, capsys):
    write(tmp_path / "study.toml")
    text = (tmp_path / "study.toml").read_text()
    bolt = 'diameter = "8 mm"\nmaterial = "45 steel"\ngrade = "8.8"\n'
    text = text.replace('preload = ["2 kN", "6 kN"]', f'{bolt}preload = "6 kN"').replace("count = 6", "count = 2")
    (tmp_path / "study.toml").write_text(text + '\n[bolt_sheet]\naxial = "2 kN"\n')
    with pytest.raises(SystemExit) as end:
        main(["bolts", str(tmp_path / "study.toml"), "--html", str(tmp_path / "sheet.html"), "--json"])
    assert end.value.code in (0, None)
    out = json.loads(capsys.readouterr().out)
    assert out["files"] == [str(tmp_path / "sheet.html")]
    (sheet,) = out["bolts"]
    assert np.isclose(next(r for r in sheet["rows"] if r["quantity"]["symbol"] == "F_PA")["inputs"][1]["values"], 2e3)
    assert "M8x1.25 8.8" in (tmp_path / "sheet.html").read_text()


PULL = {
    "name": "pull",
    "force": [{"face": "upper.seat", "force": ["150 N", "0 N", "900 N"]}],
    "temperature": {"bolt": "15 K"},
}
OTHER = {"name": "press", "force": [{"face": "upper.seat", "force": ["0 N", "0 N", "-400 N"]}]}
ICY = {"name": "icy", "temperature": {"bolt": "-25 K"}}
HELD = {"face": {"part": "lower", "normal": "-z", "all": True}}


def cases_at(made, preload, loads):
    """The load cases at a preload [N] of the one bolt."""
    bolt = BOLT | {"preload": f"{preload!r} N"}
    return faying.load_cases(made(bolt=bolt, support=[HELD], load=loads), modes=False)


def test_loads_of_the_sheet_are_those_of_a_case(made):
    """Working load, load across, share and loss by heat are those that the case has; all rows follow from them."""
    study = made(bolt_sheet={"load": ["pull", "press", "icy"]}, support=[HELD], load=[PULL, OTHER, ICY])
    (sheet,) = bolt_sheet(study).sheets
    bare = {key: value for key, value in PULL.items() if key != "temperature"}
    warm = {"name": "warm", "temperature": PULL["temperature"]}
    loads = [PULL, OTHER, bare | {"name": "cold"}, warm, ICY]

    def at(preload):
        found = cases_at(made, preload, loads)
        return found, dict(zip(found.cases, found.bolt_force[:, 0] - found.bolt_preload[0], strict=True))

    _, change = at(6e3)
    found, at_least = at(sheet.row("F_Mmin").result.value)  # no embedding is known
    _, at_greatest = at(sheet.row("F_Mmax").result.value)
    values = {one.symbol: one.value for row in sheet.rows for one in row.inputs}
    assert (values["F_Au"], values["F_Ao"]) == pytest.approx((-400, 900), rel=1e-6)
    assert values["F_Q"] == pytest.approx(150, rel=1e-4)  # what holds the upper part along the joint
    assert values["F_Q"] == pytest.approx(found.transverse_load[found.index("cold"), 0], rel=1e-4)
    assert values["F_thg"] == pytest.approx(at_greatest["icy"], rel=1e-6)  # of a bolt that shrinks
    assert values["F_thg"] > 100
    assert values["F_th"] == pytest.approx(-at_least["warm"], rel=1e-6)
    assert values["F_th"] > 100
    # heat and force act on a joint that hardens: the share of the force depends on both by a little
    assert sheet.row("Phi").result.value * 900 == pytest.approx(change["pull"] - change["warm"], rel=1e-6)
    assert sheet.row("Phi").result.value * 900 == pytest.approx(change["cold"], rel=0.05)
    for row in sheet.rows:
        given = {one.symbol: one.value for one in row.inputs}
        if None not in given.values():
            assert row.result.value == pytest.approx(HAND[row.result.symbol](given), rel=1e-9)
    assert "of load 'pull' and 'press' and 'icy'" in sheet.row("F_Smax").inputs[2].name
    least, most = (sheet.row(symbol).result.value for symbol in ("F_SAu", "F_SAo"))
    assert most == pytest.approx(at_least["pull"] - at_least["warm"], rel=1e-6)
    assert least < -1  # of the case that presses
    assert sheet.row("F_SAM").result.value == pytest.approx(at_greatest["pull"] - at_greatest["warm"], rel=1e-6)
    area = values["A_S"]
    modulus = pi / 32 * sqrt(4 * area / pi) ** 3  # of a round section that is as large
    moments = [found.bolt_moment[found.index(name), 0] for name in ("cold", "press")]
    bent = sum(moments) / modulus / 2
    assert bent > 0.1e6
    assert values["sigma_b"] == pytest.approx(bent, rel=0.05)  # heat that acts beside hardens the joint, as above


@pytest.mark.slow
def test_a_case_may_have_the_name_that_the_sheet_gives_to_heat_alone(made):
    """The case that the study calls so stays what it is; that of the temperatures has another name."""
    named = {"name": "heat of pull", "force": OTHER["force"]}
    given = {"support": [HELD], "bolt_sheet": {"load": ["pull"]}}
    alone, beside = (bolt_sheet(made(load=loads, **given)).sheets[0] for loads in ([PULL], [PULL, named]))
    both = bolt_sheet(made(load=[PULL, named], **(given | {"bolt_sheet": {"load": ["pull", "heat of pull"]}}))).sheets[
        0
    ]
    inputs = [
        {one.symbol: one.value for row in sheet.rows for one in row.inputs if one.value is not None}
        for sheet in (alone, beside, both)
    ]
    assert inputs[0]["F_th"] > 100
    assert inputs[1] == pytest.approx(inputs[0], rel=1e-6)
    assert inputs[2]["F_th"] == pytest.approx(inputs[0]["F_th"], rel=1e-6)
    assert inputs[2]["F_Au"] == pytest.approx(-400, rel=1e-6)


@pytest.mark.slow
def test_another_case_never_takes_stress_from_a_bolt(made):
    """A moment bends the joint open and pulls the bolt, at no working load along it; the sheet counts its force."""
    bend = {"name": "bend", "force": [{"face": "upper.seat", "moment": ["0 N*m", "12 N*m", "0 N*m"]}]}
    bare = {key: value for key, value in PULL.items() if key != "temperature"}
    loads = {"support": [HELD], "load": [bare, bend]}
    both, one, other = (
        bolt_sheet(made(bolt_sheet={"load": names}, **loads)).sheets[0]
        for names in (["pull", "bend"], ["pull"], ["bend"])
    )
    change = {
        symbol: found.bolt_force[:, 0] - found.bolt_preload[0]
        for symbol, preload in (("F_SAo", "F_Mmin"), ("F_SAM", "F_Mmax"))
        for found in [cases_at(made, both.row(preload).result.value, [bare, bend])]
    }
    for sheet, rows in ((both, [0, 1]), (one, [0]), (other, [1])):
        for symbol, found in change.items():
            assert sheet.row(symbol).result.value == pytest.approx(max(*found[rows], 0.0), rel=1e-4)
        assert both.row("F_Smax").result.value >= sheet.row("F_Smax").result.value * (1 - 1e-9)


def test_embedding_counts_before_the_load_cases_of_the_least_preload(made):
    bare = {key: value for key, value in PULL.items() if key != "temperature"}
    given = {"load": "pull", "embedding": "8 um"}
    (sheet,) = bolt_sheet(made(bolt_sheet=given, support=[HELD], load=[bare])).sheets
    least = sheet.row("F_Vmin").result.value
    assert least < 0.9 * sheet.row("F_Mmin").result.value
    found = cases_at(made, least, [bare])
    change, taken = found.bolt_force[0, 0] - least, found.working_load[0, 0] - (found.bolt_force[0, 0] - least)
    assert sheet.row("F_SAo").result.value == pytest.approx(change, rel=1e-6)
    assert sheet.row("F_KRmin").result.value == pytest.approx(least - taken, rel=1e-6)


@pytest.mark.parametrize(
    ("table", "text"),
    [
        ({"load": "lift"}, r'bolt_sheet\[1\].load = "lift" is not a \[\[load\]\]; give one of "pull"'),
        ({"load": "pull", "axial": "1 kN"}, "has both load and axial, which the load gives"),
        ({"load": 3}, "should be the name of a load, or of several"),
    ],
)
def test_faults_of_a_load_in_the_table(made, table, text):
    with pytest.raises(faying.InputError, match=text):
        made(bolt_sheet=table, support=[HELD], load=[PULL])


def test_a_load_factor_below_0_is_explained_and_taken_as_it_is(made, monkeypatch):
    """A load that relieves the joint round a bolt may take force from the bolt as well, where parts bend."""
    found = AtPreload(
        axial=(0.0, 400.0),
        transverse=0.0,
        additional=(-4.0, 0.0),
        taken=404.0,
        introduction=-0.05,
        thermal_loss=None,
        thermal_gain=0.0,
        bending=0.0,
        damage=0.2,
    )
    monkeypatch.setattr(
        "faying.sheet.bolt_sheet.bolt_loads",
        lambda *_: {0: BoltLoad(least=replace(found, damage=0.3), mean=found, greatest=None)},
    )
    sheets = bolt_sheet(made())
    (sheet,) = sheets.sheets
    assert (sheet.row("D").result.value, sheet.row("D").verdict) == (0.3, "ok")
    share = sheet.row("Phi").result.value
    assert share == pytest.approx(HAND["Phi"]({one.symbol: one.value for one in sheet.row("Phi").inputs}), rel=1e-12)
    assert share < 0
    assert sheet.row("F_SAu").result.value == pytest.approx(-4.0)
    assert sheet.row("F_PA").result.value == pytest.approx(404.0)
    (factor,) = [one.name for one in sheet.row("Phi").inputs if one.symbol == "n"]
    assert "below 0: where this load relieves the joint round the bolt, the bolt loses force too" in factor
    assert "below 0: where this load" in shown.terminal(sheets)
