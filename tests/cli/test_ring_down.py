"""faying ring-down: points of a free decay, from records and FRFs, and what it refuses."""

import json
import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.cli import main
from faying.measured.ring_down import MeasuredBackbone
from tests.measured.test_uff import function, raw

EXAMPLE = Path(__file__).parents[2] / "examples" / "ring-down"
RATE, HZ, RATIO = 4096.0, 100.0, 0.003
BAND = ("--band", "70 Hz:130 Hz")


def call(capsys, *args):
    with pytest.raises(SystemExit) as stop:
        main(["ring-down", *map(str, args)])
    return stop.value.code, capsys.readouterr()


@pytest.fixture
def record(tmp_path):
    """Two seconds of a linear mode's decay in mm."""
    t = np.arange(int(2 * RATE)) / RATE
    x = 3e-3 * np.exp(-RATIO * 2 * np.pi * HZ * t) * np.cos(2 * np.pi * HZ * t)
    rows = [f"{a:.9g},{1e3 * b:.9g}" for a, b in zip(t, x, strict=True)]
    file = tmp_path / "decay.csv"
    file.write_text("\n".join(["time [s],displacement [mm]", *rows]), encoding="utf-8")
    return file


def test_a_decay_becomes_points_that_a_backbone_takes(record, capsys, tmp_path):
    out, plot = tmp_path / "points.csv", tmp_path / "points.svg"
    code, said = call(capsys, record, *BAND, "--out", out, "--plot", plot, "--json")
    assert not code, said.err
    found = json.loads(said.out)
    assert found["frequency"]["unit"] == "Hz"
    points = MeasuredBackbone.read(out)
    assert points.frequency == pytest.approx(HZ, rel=1e-6)
    assert points.damping == pytest.approx(RATIO, rel=1e-3)
    time = np.array(found["time"]["values"])
    assert points.acceleration == pytest.approx(
        3e-3 * (2 * np.pi * HZ) ** 2 * np.exp(-RATIO * 2 * np.pi * HZ * time), rel=1e-3
    )
    assert plot.stat().st_size > 1000


def test_a_record_that_begins_before_the_hit_keeps_its_time(record, capsys, tmp_path):
    """--start is a time of the file, and so are the times that are printed."""
    early = tmp_path / "early.csv"
    head, *rows = record.read_text(encoding="utf-8").splitlines()
    parted = (row.split(",") for row in rows)
    early.write_text("\n".join([head, *(f"{float(t) - 0.5:.9g},{x}" for t, x in parted)]), encoding="utf-8")
    found = [
        json.loads(call(capsys, *args, *BAND, "--json")[1].out)
        for args in ((early, "--start", "0 s"), (record, "--start", "0.5 s"))
    ]
    first, second = (np.array(one["time"]["values"]) for one in found)
    assert first == pytest.approx(second - 0.5, abs=1e-6)
    assert found[0]["acceleration"]["values"] == pytest.approx(found[1]["acceleration"]["values"], rel=1e-5)


def test_the_number_of_an_frf_is_its_place_in_the_file(capsys, tmp_path):
    """Outputs 1 and 2 by input 1, then by input 2: the second FRF was the first output's by input 2."""
    lines = np.arange(0, 200, 0.25)
    speeds = 2 * np.pi * np.array([[90.0, 105.0], [95.0, 110.0]])[:, :, None]
    values = 1 / (speeds**2 - (2 * np.pi * lines) ** 2 + 0.008j * speeds * 2 * np.pi * lines)
    pairs = [(1, "z"), (2, "z")]
    whole = faying.FRF(frequency=lines, values=values, outputs=pairs, inputs=pairs, quantity="receptance")
    each = [
        replace(whole, values=values[o : o + 1, i : i + 1], outputs=pairs[o : o + 1], inputs=pairs[i : i + 1])
        for o, i in ((0, 0), (1, 0), (0, 1), (1, 1))
    ]
    file = faying.write_uff(tmp_path / "hits.uff", *each)
    for number, frequency in enumerate((90, 95, 105, 110), start=1):
        band = ["--band", f"{frequency - 15} Hz:{frequency + 15} Hz"]
        code, said = call(capsys, file, *band, "--impulse", "1 N s", "--function", number, "--json")
        assert not code, said.err
        assert json.loads(said.out)["frequency"]["values"][0] == pytest.approx(frequency, rel=1e-3)
    twice = faying.write_uff(tmp_path / "twice.uff", *each[:2], each[0])
    code, said = call(capsys, twice, *BAND, "--impulse", "1 N s", "--function", 3)
    assert code
    assert "FRF 3 is of the points of FRF 1, which is the one that is read" in said.err
    code, said = call(capsys, file, *BAND, "--impulse", "1 N s")
    assert "has 4 FRFs; give one of them with --function (1: 1+z by 1+z, 2: 2+z by 1+z, 3: 1+z by 2+z" in said.err


def test_the_example_gives_back_what_it_was_made_of(capsys, tmp_path):
    """Noise of .02 m/s2: .01 Hz and 5 % of the damping at 2.4 m/s2, where the record ends."""
    made = runpy.run_path(str(EXAMPLE / "make_record.py"))
    code, said = call(
        capsys, EXAMPLE / "decay.csv", "--band", "80 Hz:120 Hz", "--cycles", "10", "--out", tmp_path / "points.csv"
    )
    assert not code, said.err
    points = MeasuredBackbone.read(tmp_path / "points.csv")
    assert points.acceleration[0] > 20
    assert points.frequency == pytest.approx(made["frequency"](points.acceleration), abs=0.02)
    assert points.damping == pytest.approx(made["damping"](points.acceleration), rel=0.08)


def test_a_record_may_begin_before_the_decay(record, capsys):
    code, said = call(capsys, record, *BAND, "--start", "0.5 s")
    assert not code
    assert float(said.out.splitlines()[1].split()[0]) > 0.5


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time [s],force [N]\n0,1\n1,2\n", "unknown; the known ones are time, displacement, velocity, acceleration"),
        ("time [s]\n0\n1\n", "give one of the columns displacement, velocity, acceleration"),
        ("time [s],velocity [m/s],displacement [m]\n0,1,1\n1,2,2\n", "give one of the columns"),
        ("time [s],velocity [m/s]\n0,1\n", "1 samples are too few for a record"),
        ("time [s],velocity [m/s]\n0,1\n1,1\n2.5,1\n3,2\n", "line 4: samples must follow each other evenly"),
        ("time [s],velocity [m/s]\n1,1\n0,1\n", "evenly"),
    ],
)
def test_a_file_that_is_no_record_is_said(text, words, tmp_path, capsys):
    (tmp_path / "record.csv").write_text(text, encoding="utf-8")
    code, said = call(capsys, tmp_path / "record.csv", *BAND)
    assert code == 1
    assert words in said.err


def test_what_an_frf_needs_is_said(record, capsys, tmp_path):
    code, said = call(capsys, record, *BAND, "--impulse", "1 N s")
    assert code == 1
    assert "a record in time has none" in said.err
    code, said = call(capsys, record, "--band", "70 Hz")
    assert code == 1
    assert "two frequencies" in said.err
    hit = raw(tmp_path / "hit.uff", function())
    code, said = call(capsys, hit, *BAND)
    assert code == 1
    assert '--impulse "0.3 N s"' in said.err
    code, said = call(capsys, raw(hit, function(func_type=1, abscissa_spec_data_type=17)), *BAND)
    assert code == 1
    assert "no FRF (function type 4) in it, only time response" in said.err
