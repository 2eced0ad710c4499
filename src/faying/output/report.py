"""One self-contained HTML file from a result: tables, figures, flags, sources."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from faying import __version__
from faying.export import universal
from faying.files import together, write_text
from faying.misuse import checked_call
from faying.notes import FIRST_NOTES, TITLES, by_severity, grave, grouped
from faying.output import answer, page, report_measured
from faying.output.figures import narrowing
from faying.output.scene import of_result, pages, to_text
from faying.output.scene.text import packed_backbones, packed_curves
from faying.output.sections import ReportSection, sections
from faying.result import Result, backbone, interval_figure, vibration
from faying.result import figure as structure
from faying.result import response_figure as response
from faying.result.backbone import ROUNDING, Backbone, label
from faying.result.fields import RESULT_FILE, declared
from faying.result.response_figure import words
from faying.style import WIDE, drawing, new_figure, uncollected
from faying.units import in_mm


def html(result: Result, pictures: dict[str, str] | None = None) -> str:
    """Return the report as HTML text with its figures inside; pictures: those that are drawn already, as HTML."""
    if pictures is None:
        made = figures(result).items()
        pictures = {name: page.picture(name.removeprefix(TEST), figure, caption(name)) for name, figure in made}
    chapters = _chapters(result, pictures)
    body = [
        f"<header><h1>{escape(result.title)}</h1>",
        f'<p class="soft">{escape(_made_by(result))}</p></header><main>',
        *_answer(result, pictures),
        '<nav aria-label="Contents"><ul class="contents">',
        *(f'<li><a href="#{anchor(title)}">{title}</a></li>' for title, _ in chapters),
        "</ul></nav>",
    ]
    for title, parts in chapters:
        body += [f'<h2 id="{anchor(title)}">{title}</h2>', *parts]
    run = "\n".join([pages.inline(), *(pages.added(name) for name in ("charts.js", "report.js"))])
    return page.document(result.title, "".join([*body, "</main>"]), run)


def anchor(title: str) -> str:
    """Where a chapter is linked to."""
    return title.lower().replace(" ", "-")


def _chapters(result: Result, pictures: dict[str, str]) -> list[tuple[str, list[str]]]:
    """The chapters that a result has, in their order, each with its parts."""
    every = sections(result)
    out = {}
    for title, names in CHAPTERS.items():
        parts = _view(result) if title == "Structure" else []
        for one in names:
            if isinstance(one, ReportFigure):
                parts += _figure(one.name, pictures, one.mark)
            elif one in CURVES:
                parts += CURVES[one](result)
            else:
                parts += _tables([section for section in every if section.name == one], result, pictures)
        out[title] = parts
    placed = {"answer", *(one for names in CHAPTERS.values() for one in names)}
    for section in every:  # the others have a place, too
        if section.name not in placed:
            chapter = section.chapter or "More"
            out[chapter] = [*out.get(chapter, []), *_table(section), *_figure(section.name, pictures)]
    assumed = [note for note in grouped(result.notes) if note.severity == "remark"]
    out["Assumptions"] = [_list([note.text for note in assumed])] if assumed else []
    out["Notes"] = _notes(result)
    out["Inputs"] = [*_contact(result), "<h3>Sources</h3>", _list(result.sources), *_provenance(result)]
    return [(title, parts) for title, parts in out.items() if parts]


def _list(texts: Sequence[str]) -> str:
    return f"<ul>{''.join(f'<li>{escape(text)}</li>' for text in texts)}</ul>"


def _answer(result: Result, pictures: dict[str, str]) -> list[str]:
    """What a reader looks for: the modes with their intervals, how the test lies, and what to know first."""
    first = [section for section in sections(result) if section.name == "answer"]
    out = [f'<h2>Answer</h2><p class="lead">{escape(answer.lead(result))}</p>']
    tables = [page.table(section.rows, section.name) for section in first]
    out += ['<div class="pair">', *tables, *_figure(INTERVALS.name, pictures), "</div>"] if first else []
    return out + [f"<p>{page.typeset(escape(section.below))}</p>" for section in first] + _first_notes(result)


def _made_by(result: Result) -> str:
    date, version = result.provenance.date, result.provenance.versions.get("faying", __version__)
    when = f", {date.replace('T', ' ').replace('+00:00', ' UTC')}" if date else ""
    return f"{result.unknowns:,} unknowns, factorised by {result.solver}; Faying {version}{when}."


def _figure(name: str, pictures: dict[str, str], kind: str = "") -> list[str]:
    """A figure with its caption, where the result has it."""
    if name not in pictures:
        return []
    given = f' class="{kind}"' if kind else ""
    return [f"<figure{given}>{pictures[name]}<figcaption>{caption(name)}</figcaption></figure>"]


def _view(result: Result) -> list[str]:
    """The structure to look at, and its data; pictures stand in for it on paper and without scripts."""
    why = "Without JavaScript the structure does not move; the pictures below replace it."
    return [
        f'<p id="why" class="soft"><noscript>{why}</noscript></p><div id="stage"></div>',
        pages.data(to_text(of_result(result)), "scene"),
        f'<p class="soft">{MAPS}</p>',
    ]


def _first_notes(result: Result) -> list[str]:
    """What a reader must know beyond the answer: at most three notes, the gravest first."""
    every = grave(result.notes)
    out = [f'<p class="flag">{escape(note.text)}</p>' for note in every[:FIRST_NOTES]]
    more = len(every) - FIRST_NOTES
    if more > 0:
        out.append(f'<p class="soft">{more} more are under <a href="#notes">Notes</a>.</p>')
    return out


def _notes(result: Result) -> list[str]:
    """What may be wrong and what limits the result, but for what stands first."""
    out = []
    for kind, some in by_severity(result.notes, grave(result.notes)[:FIRST_NOTES]).items():
        if kind != "remark":
            title = TITLES[kind][:1].upper() + TITLES[kind][1:]
            out += [f"<h3>{title}</h3>", _list([note.text for note in some])]
    return out


def _table(section: ReportSection) -> list[str]:
    below = [f"<p>{page.typeset(escape(section.below))}</p>"] if section.below else []
    title = page.typeset(escape(section.title))
    return [f"<h3>{title}</h3>", page.table(section.rows, section.name, section.keys), *below]


def _tables(every: Sequence[ReportSection], result: Result, pictures: dict[str, str]) -> list[str]:
    out = []
    for section in every:
        if section.name == "hammer" and result.hammer is not None:
            of_test = {name.removeprefix(TEST): text for name, text in pictures.items() if name.startswith(TEST)}
            out.append(report_measured.section(result.hammer, of_test, moving=True))
        else:
            out += _table(section)
    return out


def _response(result: Result) -> list[str]:
    if result.response is None:
        return []
    return ["<h3>Frequency response</h3>", page.curves("response", response_curves(result))]


def _backbones(result: Result) -> list[str]:
    if not result.backbones:
        return []
    head = f"<h3>Frequency and damping of mode {result.backbones[0].mode} over amplitude</h3>"
    return [head, page.curves("backbones", backbone_curves(result.backbones))]


def _provenance(result: Result) -> list[str]:
    """The study's text, the files that it names with their hashes, versions and the date."""
    p = result.provenance
    if not p.study and not p.versions:
        return []
    facts = {"made": p.date} | {f"version of {name}": version for name, version in p.versions.items()}
    files = [["file", "SHA-256"], *([name, digest] for name, digest in p.files.items())]
    return [
        f"<h3>Where this comes from</h3>{page.facts(facts)}",
        page.table(files, "files") if p.files else "",
        f"<details open><summary>The study</summary><pre>{escape(p.study)}</pre></details>" if p.study else "",
    ]


def _contact(result: Result) -> list[str]:
    """Surface and law of every joint; joints that share both have one section."""
    shared: dict[str, list[str]] = {}
    for name, surface, law in zip(result.joints, result.surfaces, result.laws, strict=True):
        text = f"<h4>Surface</h4>{page.facts(surface)}<h4>Contact law</h4>{page.facts(law)}"
        shared.setdefault(text, []).append(name)
    return [f"<h3>Contact of {escape(', '.join(names))}</h3>{text}" for text, names in shared.items()]


CURVES = {"response": _response, "backbones": _backbones}
MAPS = (
    "Maps on joints: the value at a corner is the mean of the values at the points around it, weighted by area; peaks "
    "narrower than an element are flattened, and the table of joints has the greatest value at any point. Motion is "
    "relative to the greatest of the mode."
)
SHAPES = (
    "Mode shapes at the last preload, drawn at one scale; colour is the motion over the greatest of the mode. "
    "Names: what most of the motion is, in slices across the longest side, or the part that moves most and its axis."
)
TEST = "test_"  # the figures of the hammer test begin with it


@dataclass(frozen=True, kw_only=True)
class ReportFigure:
    """A figure of the report: what draws it, its caption, which results have it, and what the page marks it as."""

    name: str
    draw: Callable[[Result], Any]
    caption: str
    applies: Callable[[Result], bool] = lambda result: True
    mark: str = ""


def _on_axes(draw: Callable[[Any, Result], Any]) -> Callable[[Result], Any]:
    def drawn(result: Result) -> Any:
        fig = new_figure(WIDE, 3.2)
        draw(fig.add_subplot(), result)
        return fig

    return drawing(drawn)


INTERVALS = ReportFigure(
    name="intervals",
    draw=interval_figure.intervals,
    caption="Left: best estimate and 5 to 95 % of each frequency at the last preload about the value as modelled, "
    "and the test where there is one. Right: what makes the interval, in shares of its variance.",
    applies=lambda result: result.interval is not None,
)
# chapter -> what stands in it, in order: names of tables and of curves that zoom, and the figures; the quantities that
# declare a chapter come after them
CHAPTERS: Mapping[str, tuple[str | ReportFigure, ...]] = {
    "Structure": (
        ReportFigure(name="modes", mark="static", draw=structure.mode_shapes, caption=SHAPES),
        "parts",
        "bolts",
        "bolting",
    ),
    "Joints": (
        "joints",
        ReportFigure(
            name="pressure",
            draw=lambda result: structure.faces(result, "pressure"),
            caption="Pressure where the faces of each joint touch, at the first and the last preload. Grey: open; "
            "the line is the edge of contact.",
            applies=lambda result: bool(result.joints),
        ),
        ReportFigure(
            name="slip",
            draw=lambda result: structure.faces(result, "slip"),
            caption="Tangential displacement of the second face against the first while the bolts are tightened. Grey: "
            "open.",
            applies=lambda result: bool((result.slip > 0).any()),
        ),
        ReportFigure(
            name="law",
            draw=_on_axes(structure.law_curves),
            caption="Stiffness per area over the pressures that the joints reach at the last preload.",
            applies=lambda result: bool(result.joints),
        ),
        "surfaces",
        "conductance",
    ),
    "Modes": (
        "modes",
        ReportFigure(
            name="frequencies",
            draw=structure.frequencies,
            caption="Frequency of each mode against preload. Band: 5 to 95 % of all that is not known, where the study "
            "asks for intervals, else the range that the law states. Dotted, where it is near: faces bonded.",
            applies=lambda result: bool(result.joints),
        ),
        "damping",
        ReportFigure(
            name="damping",
            draw=interval_figure.damping_levels,
            caption="Damping ratio of each mode at levels of acceleration, at the last preload: slip in the joints "
            "and the damping at rest.",
            applies=lambda result: result.levels is not None,
        ),
        "laws",
        "beyond",
        ReportFigure(
            name="mac",
            draw=response.macs,
            caption="MAC of the modes at the first preload (rows) with those at another: modes that change "
            "places or mix.",
            applies=lambda result: len(result.loads) > 1,
        ),
        "response",
        ReportFigure(
            name="response",
            mark="of-response",
            draw=response.responses,
            caption="Accelerance at every preload, at the points and along the directions of the study.",
            applies=lambda result: result.response is not None,
        ),
        "backbones",
        ReportFigure(
            name="backbones",
            mark="of-backbones",
            draw=lambda result: backbone.figure(result.backbones),
            caption="Frequency and damping ratio against amplitude, with the static cycle as circles.",
            applies=lambda result: bool(result.backbones),
        ),
        "backbone",
        "backbone measured",
        "backbone bounds",
        "modal forces",
    ),
    "Vibration": (
        "vibration",
        ReportFigure(
            name="vibration",
            draw=lambda result: result.vibrations[-1].plot()[0].figure,
            caption="Left: acceleration of the points along the input, 5 to 95 %, and the input, dashed. Right: "
            "damping ratio of the modes that are shaken most over their level; dots: the level that they reach.",
            applies=lambda result: bool(result.vibrations),
        ),
        ReportFigure(
            name="life",
            draw=lambda result: vibration.life_figure(result.vibrations),
            caption="Life of the bolt that fails first against preload, 5 to 95 %.",
            applies=lambda result: vibration.has_life(result.vibrations),
        ),
    ),
    "Intervals": (
        "shares",
        "narrowing",
        ReportFigure(
            name="narrowing",
            draw=narrowing.narrowing,
            caption="How much narrower the intervals would get if one thing were known better: bar, the median mode; "
            "dots, each mode.",
            applies=lambda result: result.interval is not None,
        ),
        "ranges",
        "waves",
    ),
    "Test": (
        "score",
        "comparison",
        ReportFigure(
            name="comparison",
            draw=_on_axes(structure.comparison),
            caption="Difference of computed and published frequencies from the test. Bars: 5 to 95 %.",
            applies=lambda result: result.comparison is not None,
        ),
        "hammer",
    ),
}
FIGURES = {one.name: one for one in (INTERVALS, *sum(CHAPTERS.values(), ())) if isinstance(one, ReportFigure)}


def caption(name: str) -> str:
    """What a figure shows, in words, for those who do not see it."""
    if name.startswith(TEST):
        return report_measured.CAPTIONS[name.removeprefix(TEST)]
    return FIGURES[name].caption if name in FIGURES else declared(Result)[name].shown.caption


def figures(result: Result) -> dict[str, Any]:
    """Return every figure of the report by name."""
    out = {name: figure.draw(result) for name, figure in FIGURES.items() if figure.applies(result)}
    if len(result.loads) > 1:
        out |= {name: structure.quantity(result, name) for name, one in result.shown().items() if one.shown.caption}
    if result.hammer is not None:
        out |= {TEST + name: figure for name, figure in report_measured.figures(result.hammer).items()}
    return out


def write(result: Result, folder: Path, *, drawn: bool = True) -> list[Path]:
    """Write result.nc, modes.csv, the figures as SVG (mode shapes as PNG) and report.html into a folder that exists.

    With a hammer test: comparison.csv, and its figures with test_ before their names. drawn: whether there are figures.
    """
    made = [result.save(folder / RESULT_FILE), result.to_csv(folder / "modes.csv")]
    if result.hammer is not None:
        made.append(write_text(folder / "comparison.csv", result.hammer.csv_text()))
    pictures = {}
    with uncollected():
        for name, figure in figures(result).items() if drawn else ():
            kind = name.removeprefix(TEST)
            file = folder / f"{name}.{'png' if kind in page.BITMAPS else 'svg'}"
            file, pictures[name] = page.saved(kind, figure, file, caption(name))
            made.append(file)
    made.append(write_text(folder / "report.html", html(result, pictures)))
    return made


@checked_call
def write_report(result: Result, folder: str | Path, *, uff: bool = False) -> list[Path]:
    """Write what `faying run` writes: the result, its tables as CSV, its figures, and a report as one page.

    Args:
        result: Result of a run.
        folder: Where the files go; it is made where it does not exist.
        uff: Whether to write modes and frequency responses as universal files, too.

    Returns:
        The files, which appear together or not at all.

    Raises:
        InputError: The folder cannot be used, or a response has no direction that universal files know.
    """
    with together(Path(folder), "give another folder", [RESULT_FILE]) as hidden:
        files = [*write(result, hidden), *(universal.write(result, hidden) if uff else [])]
    return [Path(folder) / file.name for file in files]


MAX_PAIRS = 12  # of output and input
POINTS = 200  # of a backbone
AROUND = 1.05  # room beside measured points, as a factor of the acceleration


def response_curves(result: Result) -> list[dict[str, Any]]:
    """Accelerance of the first pairs of output and input at every preload, for curves in a page."""
    found = result.response
    assert found is not None
    loads = list(result.load_names)
    accelerance = -((2 * np.pi * found.frequencies) ** 2)[None, :, None, None] * found.values
    return [
        packed_curves(
            f"{words(*found.outputs[o])} / {words(*found.inputs[i])}",
            "|accelerance| [m/s²/N]",
            found.frequencies,
            dict(zip(loads, accelerance[:, :, o, i], strict=True)),
        )
        for o, i in list(np.ndindex(*found.values.shape[2:]))[:MAX_PAIRS]
    ]


def backbone_curves(curves: Sequence[Backbone]) -> dict[str, Any]:
    """Curves of one mode for a page: on one grid of accelerations, none beyond its own end."""
    low = max(curve.acceleration[0] for curve in curves)
    grid = np.geomspace(low, max(curve.acceleration[-1] for curve in curves), POINTS)
    measured, marked = curves[0].measured, ""
    if measured is not None:
        ends = measured.acceleration.min() / AROUND, measured.acceleration.max() * AROUND
        grid = np.unique(np.concatenate([grid, measured.acceleration, ends]))
    found = {}
    for curve in curves:
        inside = (grid >= low) & (grid <= curve.acceleration[-1] * (1 + 1e-9))
        frequency, damping = np.full((2, len(grid)), np.nan)
        frequency[inside], damping[inside] = curve.at_acceleration(grid[inside])
        damping[damping < ROUNDING * curve.damping.max()] = np.nan  # nothing slips yet
        found[label(curve, curves)] = (frequency, 100 * damping)
    if measured is not None:
        place = np.searchsorted(grid, measured.acceleration)
        frequency, damping = np.full((2, len(grid)), np.nan)
        frequency[place], damping[place] = measured.frequency, 100 * measured.damping
        marked = f"measured ({measured.source})"
        found[marked] = (frequency, damping)
    return packed_backbones(f"acceleration at {in_mm(curves[0].at)} [m/s²]", grid, found, marked)
