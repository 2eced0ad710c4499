"""The report of a result made by hand: what it says of joints and laws."""

import re
from dataclasses import replace
from html import escape
from itertools import pairwise

import numpy as np

from faying.notes import Note
from faying.output import answer, report
from faying.output import page as page_parts
from faying.output.sections import sections
from faying.result import Result
from tests.helpers.figures import result as rich
from tests.helpers.results import small_result


def html(joints, laws):
    found = small_result(joints=joints, laws=tuple({"name": law, "source": f"doi:{law}"} for law in laws))
    return report.html(found, {"law": "<svg/>"})


def test_joints_of_one_law_share_a_section():
    page = html(("flange", "foot"), ("JK", "JK"))
    assert "<h3>Contact of flange, foot</h3>" in page
    assert page.count("<h4>Contact law</h4>") == 1


def test_joints_of_different_laws_have_each_its_own():
    page = html(("flange", "<foot>"), ("JK", "GW"))
    assert "<h3>Contact of flange</h3>" in page
    assert "<h3>Contact of &lt;foot&gt;</h3>" in page
    assert "doi:JK" in page
    assert "doi:GW" in page


def test_a_structure_without_rigid_motion_has_a_report():
    found = small_result(rigid=[])
    assert "Rigid-body values" not in report.html(found, {"law": "<svg/>"})


def test_without_figures_all_tables_are_written(tmp_path):
    """The same words, and no picture."""
    found = small_result()
    (tmp_path / "plain").mkdir()
    made = report.write(found, tmp_path)
    plain = report.write(found, tmp_path / "plain", drawn=False)
    assert {file.name for file in plain} == {"result.nc", "modes.csv", "report.html"}
    assert any(file.suffix == ".svg" for file in made)
    page, tables = ((file.parent / "report.html").read_text() for file in (made[0], plain[0]))
    assert "<figure" in page
    assert "<figure" not in tables
    assert re.findall(r"<td[^>]*>[^<]*", tables) == re.findall(r"<td[^>]*>[^<]*", page)


def test_names_of_any_kind_reach_files_and_figures(tmp_path):
    """Characters beyond ASCII, and what matplotlib and HTML would read as their own."""
    grid = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]]) * 1e-2
    q = np.ones((2, 6))
    places = {"points": np.concatenate([grid, grid + 1]), "weights": q[0], "joint_of_point": np.repeat([0, 1], 3)}
    names = (r"$\frac{1}{0$", "Fläche µ")
    found = small_result(
        title="Träger <b>&", joints=names, pressure=q, k_n=q, k_t=q, slip=0 * q, gap=0 * q[0], **places
    )
    made = report.write(found, tmp_path)
    assert Result.load(tmp_path / "result.nc") == found
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Träger &lt;b&gt;&amp;" in page
    assert "<b>" not in page
    assert {p.name for p in made} >= {"result.nc", "report.html", "pressure.svg"}


def test_chapters_stand_in_their_order_and_the_answer_is_first():
    page = html(("flange",), ("JK",))
    found = re.findall(r"<h2[^>]*>(.*?)</h2>", page)
    assert found[0] == "Answer"
    assert found == [one for one in ("Answer", *report.CHAPTERS, "Assumptions", "Notes", "Inputs") if one in found]
    for title in found[1:]:
        assert page.count(f'<a href="#{report.anchor(title)}">') >= 1
        assert page.count(f'id="{report.anchor(title)}"') == 1
    levels = [int(level) for level in re.findall(r"<h([1-6])", page)]
    assert levels[0] == 1
    assert all(b <= a + 1 for a, b in pairwise(levels))  # no level is passed over


def test_every_figure_that_is_drawn_is_shown_once():
    """Those of the list, and that of a quantity which declares table, figure and chapter."""
    force = np.array([[10.0, 20.0], [30.0, 45.0]])
    found = replace(rich(), dowels=("left", "right"), dowel_shear=np.resize(force, (len(rich().loads), 2)))
    drawn = report.figures(found)
    assert {"dowel_shear", "intervals", "pressure", "mac"} <= set(drawn)
    lines = drawn["dowel_shear"].axes[0].lines
    assert [line.get_ydata().tolist() for line in lines] == found.dowel_shear.T.tolist()
    names = [name for name in {**report.FIGURES, **drawn} if not name.startswith(report.TEST)]
    page = report.html(replace(found, hammer=None), {name: f"<i>figure-{name}</i>" for name in names})
    assert {name: page.count(f"<i>figure-{name}</i>") for name in names} == dict.fromkeys(names, 1)
    for section in sections(found):
        if section.name not in ("answer", "hammer"):
            assert page.count(f"<h3>{page_parts.typeset(escape(section.title))}</h3>") == 1, section.name


def test_columns_of_zeros_are_left_out_and_named():
    rows = [["mode", "scan", "k_n", "zero_only", "text"], ["1", "0", "0.0", "0", "-"], ["2", "4", "0%", "-0", "a"]]
    shown = page_parts.table(rows, keys=1)
    assert re.findall(r"<th [^>]*>(.*?)</th>", shown) == ["mode", "scan", "text"]
    assert "Zero in all rows: <i>k</i><sub>n</sub>, zero_only" in shown
    assert page_parts.without_zeros([["mode", "x"]])[1] == []


def test_a_wide_table_is_split_and_loses_nothing():
    rows = [[f"c{k}" for k in range(14)], [str(k + 1) for k in range(14)]]
    shown = page_parts.table(rows, keys=2)
    tables = re.findall(r"<table.*?</table>", shown)
    heads = [re.findall(r"<th [^>]*>(.*?)</th>", one) for one in tables]
    assert all(head[:2] == ["c0", "c1"] and len(head) <= page_parts.MAX_COLUMNS for head in heads)
    assert [cell for head in heads for cell in head[2:]] == rows[0][2:]
    assert [c for one in tables for c in re.findall(r"<td>(.*?)</td>", one)[2:]] == rows[1][2:]


def test_pictures_have_words_for_those_who_do_not_see_them():
    page = report.html(small_result())
    pictures = re.findall(r"<(?:svg|img)[^>]*>", page)
    assert len(pictures) >= 4
    for one in pictures:
        words = re.search(r'(?:alt|aria-label)="([^"]*)"', one)
        assert words
        assert len(words[1]) > 20


def test_the_answer_says_how_the_test_lies():
    assert "At 8 kN the lowest 3 elastic modes are from 110 to 610 Hz." in answer.lead(rich())
    # seven sources of 0.5 to 2 % each: exp(+-3.49 %)
    assert "The first is between 106.2 and 113.9 Hz (5 to 95 %)." in answer.lead(rich())
    assert "3 of 4 measured frequencies are within 5 to 95 %." in answer.lead(rich())  # 290 Hz lies above 269


def test_the_terminal_has_the_answer_on_one_screen():
    """Best estimates first; damping that is that at rest is one sentence; tables and further notes with --all."""
    from faying.cli.run import text

    found = rich()
    notes = tuple(Note(code="window", severity="limit", text=f"{k}: {'x ' * 90}") for k in range(9))
    many = replace(found, notes=notes)
    short, full = (text(many, everything=everything).splitlines() for everything in (False, True))
    assert len(short) <= 40
    assert max(map(len, short)) <= 80
    assert short[-1] == "faying run --all prints all tables and notes"
    row = next(line for line in short if line.startswith("   1"))
    best, interval, modelled = f"{found.interval.best[-1, 0]:.1f}", "106.2 .. 113.9", "110.00"
    assert row.index(best) < row.index(interval) < row.index(modelled)
    assert set(short[:-1]) <= set(full)
    assert any(line.startswith("damping ratio at") for line in full)


def test_damping_is_a_sentence_where_slip_adds_less_than_a_tenth_to_what_is_at_rest():
    found, slight = rich(), np.array([1e-5, 2e-5, 9e-5]) * np.ones((2, 3, 3))
    for factor, sentence in ((1.0, True), (1.2, False)):
        slip = factor * slight
        damping = {"damping": 1e-3 + slip, "low": 3e-4 + slip, "high": 3e-3 + slip}
        some = replace(found, levels=replace(found.levels, slip=slip, **damping))
        assert answer.damping_line(some).startswith("Damping at 1 m/s2: 0.031 .. 0.1 .. 0.3 %") == sentence
        assert any("damping" in head for head in answer.answer(some)[0]) != sentence


def test_a_table_of_many_modes_ends_at_a_mode_and_says_how_many_follow():
    """Wide tables stand in blocks, one below the other: each has the same modes."""
    from faying.cli.run import text

    f = np.arange(100.0, 140.0) + np.arange(14.0)[:, None]
    same = {"frequencies": f, "loss_factors": 0.02 + 0 * f, "loss_error": 0 * f, "free": f[0], "bonded": f[-1]}
    few = small_result(loads=1e3 * np.arange(1, 15), mac=np.stack([np.eye(40)] * 14), **same)
    lines = text(few, everything=False).splitlines()
    (more,) = [line for line in lines if line.endswith("more modes with --all")]
    shown = 40 - int(more.split()[0])
    blocks = [line for line in lines if line.split()[:1] == [str(shown)]]
    heads = [line for line in lines if line.startswith("mode ")]
    assert len(blocks) == len(heads) > 1
    assert not [line for line in lines if line.split()[:1] == [str(shown + 1)]]
