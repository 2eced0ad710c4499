"""How figures and printed summaries look: one style, units on the axes, files that appear complete or not at all."""

import gc
from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import wraps
from html import escape
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from faying.errors import InputError
from faying.files import make_folder, write_atomically
from faying.text import cut
from faying.typeset import unit as typeset_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

P = ParamSpec("P")
T = TypeVar("T")

COLUMN = 85 / 25.4  # inches: one column of a journal
WIDE = 176 / 25.4  # inches: both columns, the text of an A4 page, a slide
TALLEST = 9.3  # inches: what an A4 page has room for above a caption
SMALL, NORMAL, TITLE = 8.0, 8.5, 9.0  # points
# Okabe and Ito, without their yellow, which is too pale for lines on white
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c8c8c")
INK, SOFT = "#1c2733", "#6b7683"
_STYLE: Any = {
    "font.family": ["DejaVu Sans"],
    "font.size": NORMAL,
    "axes.titlesize": TITLE,
    "axes.labelsize": NORMAL,
    "axes.linewidth": 0.7,
    "axes.edgecolor": SOFT,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "figure.titlesize": TITLE,
    "figure.labelsize": NORMAL,
    "figure.dpi": 150,
    "grid.linewidth": 0.5,
    "image.cmap": "viridis",
    "legend.fontsize": SMALL,
    "legend.title_fontsize": SMALL,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "legend.columnspacing": 1.2,
    "lines.linewidth": 1.3,
    "lines.markersize": 4.0,
    "svg.hashsalt": "faying",
    "text.color": INK,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
}

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"))

RESOLUTION = 200  # dots per inch of what is not a line
SHADED = 130  # those of shaded areas within drawings of lines


def drawing(function: Callable[P, T]) -> Callable[P, T]:
    """Make a function draw in the style of Faying: type of 8 to 9 points, thin axes, no frame around legends."""

    @wraps(function)
    def styled(*args: P.args, **named: P.kwargs) -> T:
        from matplotlib import rc_context

        with rc_context(_STYLE):
            return function(*args, **named)

    return styled


def colour(k: int) -> str:
    """The k-th colour of a cycle that colour-blind readers can tell apart."""
    return COLOURS[k % len(COLOURS)]


def load_colours(count: int) -> list[Any]:
    """One colour for each load, dark for the least, on one scale."""
    from matplotlib import colormaps

    return [colormaps["viridis"](0.85 * k / max(count - 1, 1)) for k in range(count)]


def legend_above(ax: Any, columns: int = 3) -> None:
    """A legend over the axes, where it hides no curve; none where nothing has a label."""
    if ax.get_legend_handles_labels()[0]:
        place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.2}
        ax.legend(ncols=columns, **place)


def shared_legend(figure: Any, axes: Any, columns: int = 5, title: str | None = None) -> None:
    """One legend above all axes of a figure, each label once."""
    found: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    if found:
        figure.legend(list(found.values()), list(found), loc="outside upper center", ncols=columns, title=title)


def plain_numbers(axis: Any) -> None:
    """Numbers such as 0.1, 2 and 50 on a logarithmic axis; between the tens only where there are few tens."""
    from matplotlib.ticker import FuncFormatter

    low, high = axis.get_view_interval()
    shown = "123456789" if high < 5 * low else "25" if high < 60 * low else ""
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(FuncFormatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in shown else ""))


def headline(text: str, most: int = 60) -> str:
    """A title that a user gave, cut where it is long."""
    return plain(cut(text, most))


def percent(share: float) -> str:
    """A share as a whole number of percent."""
    return f"{100 * share:.0f} %"


def new_figure(width: float, height: float) -> Any:
    """Return an empty figure [inches] that needs no display."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def new_panels(columns: int, rows: int = 1, *, width: float = COLUMN, height: float = 2.7) -> Any:
    """Return a figure of rows x columns axes of this size [inches] each, which needs no display."""
    figure = new_figure(width * columns, height * rows)
    figure.subplots(rows, columns, squeeze=False)
    return figure


@drawing
def axes_of(given: Any, count: int, *, width: float = COLUMN, height: float = 2.7, columns: int = 2) -> "list[Axes]":
    """Return the `count` axes that a method `plot` draws into.

    Args:
        given: what the user handed over: None for a new figure, which a notebook or `matplotlib.pyplot.show` shows;
            one axes; or a list or array of axes.
        count: how many panels are drawn.
        width, height: size of a panel of a new figure [inches].
        columns: panels in a row of a new figure.

    Raises:
        InputError: it is not the right number of axes.
    """
    if given is None:
        from matplotlib import pyplot

        columns, rows = min(columns, count), -(-count // columns)
        figure = pyplot.figure(figsize=(width * columns, height * rows), layout="constrained")
        axes = list(figure.subplots(rows, columns, squeeze=False).flat)
        for unused in axes[count:]:
            unused.set_visible(False)
        return axes[:count]
    from matplotlib.axes import Axes

    axes = list(given.flat) if hasattr(given, "flat") else list(given) if isinstance(given, list | tuple) else [given]
    if len(axes) != count or not all(isinstance(ax, Axes) for ax in axes):
        what = "one matplotlib axes" if count == 1 else f"{count} matplotlib axes in a list or array"
        raise InputError(f"this plot draws into {what}; got {type(given).__name__}. Leave it out for a new figure")
    return axes


class Summary:
    """A class that prints itself in a dozen lines at most, and as a table in a notebook."""

    @abstractmethod
    def summary(self) -> tuple[str, Mapping[str, str]]:
        """Return a heading and what stands below it, by name: at most eleven lines of text with units."""

    def __repr__(self) -> str:
        """Return the heading and one line for each entry."""
        heading, rows = self.summary()
        width = max(map(len, rows), default=0)
        return "\n".join((heading, *(f"  {name:<{width}}  {text}" for name, text in rows.items())))

    def _repr_html_(self) -> str:
        """Return the summary as the table that a notebook shows."""
        heading, rows = self.summary()
        cells = (
            f'<tr><th style="text-align:left">{escape(name)}</th><td style="text-align:left">{escape(text)}</td></tr>'
            for name, text in rows.items()
        )
        return f"<table><caption><b>{escape(heading)}</b></caption><tbody>{''.join(cells)}</tbody></table>"


@contextmanager
def uncollected() -> Iterator[None]:
    """Leave Python's garbage collector off for the second that figures take.

    They are very many objects, nearly all of which stay: it would look through them, and through all that a run holds,
    again and again.
    """
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


@drawing
def drawn(figure: Any, kind: str) -> bytes:
    """Return a figure as what a file of the kind svg or png holds.

    It is drawn once: `savefig` draws a figure that lays itself out a second time, for the layout alone.
    """
    import numpy as np
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from PIL import Image

    buffer = BytesIO()
    figure.dpi = RESOLUTION if kind == "png" else SHADED
    canvas: Any = (FigureCanvasAgg if kind == "png" else FigureCanvasSVG)(figure)
    if kind == "png":
        canvas.draw()
        picture = Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])
        picture.quantize(256).save(buffer, "png", optimize=True, dpi=(RESOLUTION, RESOLUTION))
    else:
        canvas.print_svg(buffer, metadata={"Date": None})
    return buffer.getvalue()


def plain(text: str) -> str:
    """A name as it stands: without this, matplotlib reads what is between dollar signs as mathematics."""
    return text.replace("$", r"\$")


def prefixed(values: Any, unit: str) -> tuple[float, str]:
    """By what to divide SI values for the labels of an axis, and the unit with its prefix."""
    import numpy as np

    if not unit or any(mark in unit for mark in "^*23"):
        return 1.0, typeset_unit(unit)
    factor, prefix = next(((f, p) for f, p in _PREFIXES if np.abs(values).max() >= f * (1 - 1e-12)), _PREFIXES[-1])
    return factor, typeset_unit(prefix + unit)


def check_ending(path: Path) -> None:
    """Raise InputError unless figures can be written under this name."""
    kinds = new_figure(1, 1).canvas.get_supported_filetypes()
    if path.suffix[1:].lower() not in kinds:
        raise InputError(f"{path}: figures can be written as {', '.join(sorted(kinds))}; end the name in one of them")


def check_figure(path: str | Path) -> None:
    """Raise InputError, before anything is computed, for a figure that cannot be written."""
    file = Path(path)
    check_ending(file)
    if not file.parent.is_dir():
        raise InputError(f"no folder {file.parent} to write {file.name} in; make it first")


@drawing
def save(figure: Any, path: str | Path) -> Path:
    """Write a figure in the format of the ending of `path`; the file appears complete or not at all.

    A folder that is not there is made.

    Raises InputError for other endings and where the file cannot be written.
    """
    file = Path(path)
    check_ending(file)
    make_folder(file.parent, "give another place for the figure")
    kind = file.suffix[1:].lower()
    if kind in ("png", "svg"):
        return write_atomically(file, lambda temporary: temporary.write_bytes(drawn(figure, kind)))
    return write_atomically(file, lambda temporary: figure.savefig(temporary, format=kind, dpi=RESOLUTION))
