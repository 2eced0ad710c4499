"""What is printed fits a terminal of 80 columns."""

import random
from pathlib import Path

import pytest
from click.testing import CliRunner

import faying
from faying.cli.main import cli
from faying.cli.run import text as of_run
from faying.output import terminal
from faying.study import Study
from tests.helpers.examples import copied

EXAMPLES = Path(__file__).parents[2] / "examples"
ALIKE = ("measured-form.toml", "flat.toml", "laws.toml", "uncertain.toml", "laws-evidence.toml")  # print as others
STUDIES = sorted(path for path in EXAMPLES.glob("*/*.toml") if path.name not in ALIKE)


def wide(printed: str) -> list[str]:
    """Lines of more than 80 columns but paths, which are one word."""
    return [line for line in printed.splitlines() if len(line) > 80 and "/" not in line.strip().rpartition(" ")[2]]


def words(printed: str) -> list[str]:
    return sorted(printed.split())


def test_a_narrow_table_is_one_line_a_row():
    rows = [["mode", "12 kN [Hz]", "moves"], ["1", "414.80", "both, x"], ["10", "3265.41", "both, z"]]
    assert terminal.text(rows).splitlines() == [
        "mode  12 kN [Hz]    moves",
        "   1      414.80  both, x",
        "  10     3265.41  both, z",
    ]
    assert terminal.text(rows, left=(2,)).splitlines()[1] == "   1      414.80  both, x"
    assert terminal.text([]) == ""


def test_wide_heads_are_folded_before_columns_are_parted():
    heads = ["bolt", *(f"a long head number {k} [um/kN]" for k in range(5))]
    rows = [heads, ["left", *("0.955",) * 5], ["right", *("5.61",) * 5]]
    found = terminal.text(rows)
    assert not wide(found)
    assert "\n\n" not in found
    # no cell is lost, and each row is one line
    assert words(found) == sorted(word for row in rows for cell in row for word in cell.split())
    assert found.splitlines()[-1].split() == ["right", *("5.61",) * 5]


@pytest.mark.parametrize("seed", range(20))
def test_any_table_fits_and_keeps_every_word(seed):
    """Random tables: words of at most 20 letters; the columns of names are in each block."""
    draw = random.Random(seed)
    names = ["preload", "bolt"][: draw.choice((1, 2))]
    count = draw.randint(3, 14)

    def cell(most: int) -> str:
        return " ".join("x" * draw.randint(1, draw.choice((4, 12))) for _ in range(draw.randint(1, most)))

    heads = [*names, *(cell(4) for _ in range(count))]
    rows = [heads] + [[f"n{k}" for k in range(len(names))] + [cell(2) for _ in range(count)] for _ in range(3)]
    found = terminal.text(rows)
    assert max(map(len, found.splitlines())) <= 80
    blocks = found.count("\n\n") + 1
    body = [word for row in rows for cell in row[len(names) :] for word in cell.split()]
    kept = [word for row in rows for cell in row[: len(names)] for word in cell.split()]
    assert words(found) == sorted(body + kept * blocks)


def test_sentences_fold_and_lines_of_tables_do_not():
    note = "- joint, 8 to 15 kN: half-space is outside its validity range for 3 to 10% of the joint's stiffness"
    table = "  ".join(["a column"] * 12)
    found = terminal.folded(f"{note}\n{table}\nshort")
    first, second, *rest = found.split("\n")
    assert len(first) <= 80
    assert second.startswith("  ")
    assert " ".join([first, second.strip()]) == note
    assert rest == [table, "short"]


@pytest.mark.parametrize(
    "arguments",
    [
        ["check", "two-blocks/study.toml"],
        pytest.param(["check", "plates-and-bolts/flanges.toml"], marks=pytest.mark.slow),
        pytest.param(["bolts", "bracket/study.toml"], marks=pytest.mark.slow),
        pytest.param(["bolts", "solid-bolt/study.toml"], marks=pytest.mark.slow),
        ["law", "--D", "2.39", "--G", "1.53e-10 m", "--scan-area", "16 mm^2", "--material", "45 steel"],
        ["models"],
        ["surface", "t-specimen/milled.x3p"],
        ["faces", "t-specimen/t-specimen.step"],
        ["backbone", "two-blocks/study.toml", "--mode", "1", "--friction", "0.2", "--amplitude", "1 m/s^2:9 m/s^2"],
        ["predict", "two-blocks/uncertain.toml", "--samples", "16"],
    ],
    ids=lambda arguments: " ".join(arguments[:2]),
)
def test_commands_fit(arguments, tmp_path):
    """In seconds, but those that mesh and solve."""
    given = [str(EXAMPLES / one) if "/" in one and one.count("m/s") == 0 else one for one in arguments]
    out = {"backbone": "curve.nc", "predict": "prediction.nc"}.get(arguments[0])
    given += [] if out is None else ["--out", str(tmp_path / out)]
    found = CliRunner().invoke(cli, given)
    assert found.exit_code == 0, found.output
    assert found.stdout.strip()
    assert wide(found.stdout) == []


@pytest.mark.slow
@pytest.mark.parametrize("path", STUDIES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_the_run_of_every_example_fits(path, tmp_path):
    printed = of_run(faying.run(Study.read(copied(path, tmp_path / "examples"))))
    assert "modes at" in printed
    assert wide(printed) == []
