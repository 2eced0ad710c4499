"""Every figure of the product: nothing leaves it, nothing covers anything, and texts are what a journal prints."""

import ast
import re
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.legend import Legend
from matplotlib.text import Text

from faying.case.scatter import SCATTER
from faying.result import interval_figure
from faying.style import WIDE
from faying.typeset import name_of, typeset, unit
from tests.helpers.figures import FIGURES

SOURCE = Path(__file__).parents[2] / "src" / "faying"
MAKERS = {"new_figure", "new_panels", "axes_of", "axes_in_space"}
PIXEL = 1.0
# a key of a study or of a file, and what a keyboard has for a sign
RAW = (
    re.compile(r"\b[a-z]+\.[a-zA-Z_]+\b(?<!\.py)(?<!\.x3p)(?<!\.csv)"),
    re.compile(r"\w_\w"),
    re.compile(r"\bum\b|\buN\b|\bdeg\b|[Oo]hm"),
    re.compile(r"\b(?:mm|µm|nm|s|m|kg|N)\^?[23]\b"),
    re.compile(r"\^|\*|\[-\]|(?<=\d)%|\\"),
)
NAMES = ("flange_1", "JK_paper", "left_1", "my_scan.x3p", "face_1.csv", "ring_down", "ring_down.csv")  # of a user
FACES = ("low.top", "low.bottom", "low.left", "low.right", "high.top", "high.bottom", "high.left", "high.right")


@pytest.fixture(params=FIGURES, scope="module")
def drawn(request):
    """A figure, drawn once, with what measures it."""
    figure = FIGURES[request.param]()
    canvas = FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    renderer = canvas.get_renderer()
    yield figure, renderer, [(one, one.get_window_extent(renderer)) for one in texts(figure)]
    pyplot.close("all")


def texts(figure):
    """All texts that are seen: not those of hidden axes, and not the labels of ticks beyond the ends of an axis."""
    hidden = set()
    for axis in figure.findobj(Axis):  # those of a second scale, too
        shown = axis.axes.get_visible() and axis.axes.axison and axis.get_visible()
        low, high = sorted(axis.get_view_interval())
        room = 1e-6 * (high - low)
        for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
            inside = low - room <= tick.get_loc() <= high + room
            hidden |= {id(one) for one in (tick.label1, tick.label2) if not (shown and inside and one.get_visible())}
        hidden |= set() if shown else {id(axis.label), id(axis.offsetText)}
    hidden |= {id(one) for ax in figure.axes if not ax.get_visible() for one in ax.findobj(Text)}
    every = figure.findobj(lambda one: isinstance(one, Text) and one.get_text().strip() and one.get_visible())
    return [one for one in every if id(one) not in hidden]


def test_nothing_leaves_its_figure(drawn):
    figure, renderer, boxes = drawn
    width, height = figure.bbox.width, figure.bbox.height
    for one, box in boxes:
        inside = -PIXEL <= box.x0 and -PIXEL <= box.y0 and box.x1 <= width + PIXEL and box.y1 <= height + PIXEL
        assert inside, f"{one.get_text()!r} at {box.extents.round()} of {width:.0f} x {height:.0f}"
    box = figure.get_tightbbox(renderer)
    room = 3 * PIXEL / figure.dpi
    assert min(box.x0, box.y0) > -room
    assert box.x1 < figure.get_figwidth() + room
    assert box.y1 < figure.get_figheight() + room
    assert figure.get_figwidth() <= WIDE * 1.01


def test_no_text_covers_another(drawn):
    every = [(one, box) for one, box in drawn[2] if not one.get_rotation() % 90]
    for k, (one, box) in enumerate(every):
        for other, there in every[:k]:
            across = min(box.x1, there.x1) - max(box.x0, there.x0)
            up = min(box.y1, there.y1) - max(box.y0, there.y0)
            assert across <= 2 * PIXEL or up <= 2 * PIXEL, f"{one.get_text()!r} covers {other.get_text()!r}"


def test_no_legend_covers_a_curve(drawn):
    figure, renderer, _ = drawn
    legends = [one.get_window_extent(renderer) for one in figure.findobj(Legend) if one.get_visible()]
    for ax in figure.axes:
        if hasattr(ax, "get_zlim") or not ax.get_visible():
            continue
        for line in ax.get_lines():
            if line.get_transform() != ax.transData:
                continue
            seen = np.nan_to_num(ax.transData.transform(line.get_xydata()), nan=-1e9)
            for box in legends:
                under = (seen[:, 0] > box.x0) & (seen[:, 0] < box.x1) & (seen[:, 1] > box.y0) & (seen[:, 1] < box.y1)
                assert not under.any(), f"the legend covers {under.sum()} points of {line.get_label()!r}"


def test_texts_are_typeset_and_of_one_size(drawn):
    for one, _ in drawn[2]:
        text = one.get_text()
        assert 7.9 <= one.get_fontsize() <= 10.1, f"{text!r} has {one.get_fontsize()} points"
        bare = re.sub(r"\$.*?\$", "", text.replace(r"\$", ""))
        for name in (*NAMES, *FACES):
            bare = bare.replace(name, "")
        for raw in RAW:
            assert not raw.search(bare), f"{text!r} holds {raw.search(bare)[0]!r}"


def drawing_functions():
    """Functions that make a figure or axes, as module:function."""
    for path in sorted(SOURCE.rglob("*.py")):
        if path.name == "style.py":
            continue
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if any(maker in text for maker in MAKERS) else ():
            if isinstance(node, ast.FunctionDef) and node.name not in MAKERS:
                calls = [one.func for one in ast.walk(node) if isinstance(one, ast.Call)]
                if any(isinstance(one, ast.Name) and one.id in MAKERS for one in calls):
                    yield f"{path.relative_to(SOURCE).as_posix()}:{node.name}"


# functions that make a figure for one of the table: of the report, or before contacts are solved
PARTS = {
    "output/report.py:_on_axes",
    "output/report.py:drawn",
    "output/report_measured.py:figures",
    "contact/mates.py:compare_plot",
    "result/figure.py:_faces",
    "measured/figure.py:shapes_side_by_side",
}
OF_REPORT = ("result/figure.py", "result/interval_figure.py", "result/response_figure.py")


def test_no_function_that_draws_escapes():
    known = {key.split(",")[0] for key in FIGURES} | PARTS
    drawn_by_report = {key.split(":")[1] for key in FIGURES if key.startswith("output/report.py")}
    assert len(drawn_by_report) > 10
    for function in drawing_functions():
        module = function.split(":")[0]
        if module in OF_REPORT or module == "output/figures/narrowing.py":
            continue
        assert function in known, f"{function} draws; give it an entry in tests/helpers/figures.py"


def test_nothing_else_makes_figures():
    """Only the style makes figures, so that all of them have it."""
    allowed = {"style.py", "fe/figure.py"}
    for path in SOURCE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if path.relative_to(SOURCE).as_posix() not in allowed:
            assert "import pyplot" not in text, path
            assert "from matplotlib.figure import" not in text or "TYPE_CHECKING" in text, path


def test_the_style_of_a_user_stays():
    before = dict(matplotlib.rcParams)
    FIGURES["surface/figure.py:fit_plot"]()
    pyplot.close("all")
    assert dict(matplotlib.rcParams) == before


@pytest.mark.parametrize(
    ("raw", "seen"),
    [
        ("um", "µm"),
        ("MPa/um", "MPa/µm"),
        ("m/s2", "m/s²"),
        ("m/(N*s^2)", "m/(N·s²)"),
        ("um2", "µm²"),
        ("Ohm m^2", "Ω m²"),
        ("umbrella", "umbrella"),
    ],
)
def test_units_have_their_signs(raw, seen):
    assert unit(raw) == seen


def test_symbols_and_keys():
    assert typeset("normal stiffness k_n [MPa/um]") == r"normal stiffness $k_\mathrm{n}$ [MPa/µm]"
    assert typeset("k_t/k_n") == r"$k_\mathrm{t}$/$k_\mathrm{n}$"
    assert name_of("bolt.left.preload") == "preload, left"
    assert name_of("bolt.preload") == "preload"
    assert name_of("material.45 steel.E") == "Young's modulus, 45 steel"
    assert name_of("joint.flange.form.crown_along") == "crown along, flange"
    assert name_of("law.model") == "contact law"


def test_all_that_is_not_known_has_a_colour_of_its_own():
    assert set(interval_figure.SOURCES) == set(SCATTER)
    assert len(set(interval_figure.SOURCES.values())) == len(SCATTER)
