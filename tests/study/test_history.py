"""Studies whose preloads fall, and joints that carried the greatest preload before."""

import json
from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.cli.run import text
from faying.study import Study
from tests.helpers.studies import write

KE = """[law]
model = "gw"
asperity = "KogutEtsion"
density = "2e10 1/m^2"
radius = "20 um"
sigma = "0.5 um"
"""
BACK = ["4 kN", "9 kN", "4 kN"]


def study(folder, preload, state="", levels="[]"):
    """The study of `faying init` at these preloads, under summits that yield."""
    path = folder / "study.toml"
    write(path, force=True, flat=False)
    text = path.read_text(encoding="utf-8").replace("levels = []", f"levels = {levels}")
    text = text.replace('joint" = "8 mm"', 'joint" = "4 mm"').replace('size = "16 mm"', 'size = "8 mm"')
    text = text[: text.index("[surface]")] + KE + text[text.index("[[joint]]") :]
    text = text.replace('["2 kN", "6 kN"]', json.dumps(preload))
    text = text.replace("[[joint]]\n", "[[joint]]\ntangential = 0.6\n" + f'state = "{state}"\n' * bool(state), 1)
    path.write_text(text.replace("count = ", "count = 3 # "), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def back(tmp_path_factory):
    return study(tmp_path_factory.mktemp("back"), BACK)


@pytest.fixture(scope="module")
def result(back):
    return faying.run(back)


def test_a_preload_that_falls_comes_after_the_greatest(back, result, tmp_path):
    """Names each once in tables, files and xarray; the interval moves with the frequency."""
    assert Study.read(back).load_names == ("4 kN", "9 kN", "4 kN after 9 kN")
    assert result.load_names == ("4 kN", "9 kN", "4 kN after 9 kN")
    assert list(result.carried) == [0, 0, 9e3]
    up, _, down = result.frequencies
    assert np.all(down > up)
    again = faying.load(result.save(tmp_path / "r.nc"))
    assert again == result
    assert float(again.to_xarray()["modes"].frequency.sel(load="4 kN after 9 kN")[0]) == pytest.approx(down[0])
    best, low, high = result.interval.best, result.interval.low, result.interval.high
    assert best[2] / best[0] == pytest.approx(down / up, rel=2e-3)
    assert np.all((low[2] < best[2]) & (best[2] < high[2]))


def test_tables_name_loads_in_kilonewtons(result):
    """Without a history as they always have; the labels of files keep their prefix."""
    small = replace(result, loads=np.array([500.0, 9e3, 4e3]), carried=None)
    assert small.load_names == ("0.5 kN", "9 kN", "4 kN")
    assert small.labels()["load"] == ("500 N", "9 kN", "4 kN")


@pytest.mark.slow
def test_both_engines_print_one_history(tmp_path):
    back = study(tmp_path, BACK, levels='["1 m/s^2"]')
    direct, again = (faying.run(back, engine=engine) for engine in ("direct", "reanalysis"))
    assert direct.frequencies == pytest.approx(again.frequencies, rel=1e-8)
    assert direct.levels.damping == pytest.approx(again.levels.damping, rel=1e-2)


@pytest.mark.slow
def test_rising_preloads_are_what_they_are_without_a_history(result, tmp_path):
    alone = faying.run(study(tmp_path, BACK[:2]))
    assert result.frequencies[:2] == pytest.approx(alone.frequencies, rel=1e-8)
    assert alone.carried is None


@pytest.mark.slow
def test_settled_joints_are_those_that_came_back(result, tmp_path):
    """Before the greatest preload of the study they are as after it; at it they are on first loading."""
    settled = faying.run(study(tmp_path, BACK[:2], "settled"))
    assert settled.settled
    assert settled.load_names == ("4 kN", "9 kN")
    assert settled.frequencies[0] == pytest.approx(result.frequencies[2], rel=1e-7)
    assert settled.frequencies[1] == pytest.approx(result.frequencies[1], rel=1e-8)
    assert settled.bolt_numbers is not None
    assert settled.bolt_numbers.embedding[0].ravel()[0] == 0  # what lasts has been left
    assert not result.settled


def test_the_answer_names_a_preload_that_fell_and_says_how_joints_are_loaded(result):
    out = text(result)
    assert "4 kN after 9 kN" in out
    assert "loss in the joints, first loading" in " ".join(out.split())


def test_load_cases_and_sheets_take_the_state_that_is_asked_for(back):
    up = faying.bolt_sheet(back, "4 kN")
    with pytest.raises(faying.InputError, match="may be '4 kN' or '4 kN after 9 kN'"):
        faying.bolt_sheet(back, 4000)
    down = faying.bolt_sheet(back, "4 kN after 9 kN")
    assert up.load == down.load == 4e3
    assert up.to_dict() != down.to_dict()


def test_what_knows_first_loading_alone_says_so(back):
    with pytest.raises(faying.InputError, match="joints on first loading"):
        faying.predict(back)


def test_joints_of_one_structure_share_a_state(tmp_path):
    """The preload twice in a row, a state that does not exist, and two joints that differ."""
    with pytest.raises(faying.InputError, match="two in a row are the same"):
        Study.read(study(tmp_path, ["4 kN", "4 kN"]))
    with pytest.raises(faying.InputError, match="state"):
        Study.read(study(tmp_path, BACK, "loose"))


HELD = """[geometry.face]
"lower.bottom" = { part = "lower", number = 3 }
[[support]]
face = "lower.bottom"
"""


@pytest.fixture(scope="module")
def slipping(tmp_path_factory):
    """Joints that slip while the bolt is tightened, at one or more preloads, as modelled."""
    folder = tmp_path_factory.mktemp("slipping")

    def at(*preloads, engine="reanalysis"):
        path = study(folder, list(preloads))
        text = path.read_text(encoding="utf-8").replace('joint" = "4 mm"', 'joint" = "8 mm"')
        text = text.replace("[[joint]]\n", "[[joint]]\nfriction = 0.2\n", 1).replace('size = "8 mm"', 'size = "16 mm"')
        text = text.replace("[modes]\n", HELD + "[modes]\nintervals = false\n")
        path.write_text(text, encoding="utf-8")
        return faying.run(path, engine=engine)

    return at


@pytest.mark.parametrize("engine", ["reanalysis", "direct"])
def test_a_preload_with_friction_does_not_hang_on_those_that_were_solved_before_it(slipping, engine):
    """Each is reached from faces without shear; 8 kN after 4 kN had 1.2e-4 of its frequency less than alone."""
    alone, among = slipping("8 kN"), slipping("2 kN", "4 kN", "8 kN", engine=engine)
    assert alone.slipping[-1, 0] > 0.05
    assert among.frequencies[-1] == pytest.approx(alone.frequencies[-1], rel=1e-7)
    assert among.slip[-1] == pytest.approx(alone.slip[-1], rel=1e-4, abs=1e-12)


def test_a_falling_preload_keeps_the_shear_of_the_greatest_before_it_and_no_other(slipping):
    first, short, long = slipping("8 kN"), slipping("12 kN", "8 kN"), slipping("8 kN", "12 kN", "8 kN")
    assert long.frequencies[-1] == pytest.approx(short.frequencies[-1], rel=1e-7)
    assert long.slip[-1] == pytest.approx(short.slip[-1], rel=1e-4, abs=1e-12)
    assert np.abs(short.slip[-1] - first.slip[-1]).max() > 0.01 * first.slip[-1].max()
