"""The tables of a result in the order in which report and terminal show them, each with its title."""

from collections.abc import Iterator
from dataclasses import dataclass

from faying.output import answer, table
from faying.output.table import Rows
from faying.result import Result
from faying.service.table import HELP, TABLES, heading
from faying.units import in_mm, load_text


@dataclass(frozen=True, kw_only=True)
class ReportSection:
    """One table of a result.

    Args:
        name: what code calls it.
        rows: the table.
        title: its heading in the report.
        line: what stands above it in a terminal; the title in small letters where left out.
        below: what the report says below it.
        keys: how many columns name a row; they are repeated where a table is split.
        chapter: of the report; "" where the list of its chapters names the table.
    """

    name: str
    rows: Rows
    title: str
    line: str = ""
    below: str = ""
    keys: int = 1
    chapter: str = ""

    @property
    def above(self) -> str:
        """The line above the table in a terminal."""
        return self.line or self.title[:1].lower() + self.title[1:]


def sections(result: Result) -> list[ReportSection]:
    """Return the tables that a result has."""
    every = (
        *_answer(result),
        *_modes(result),
        *_joints(result),
        *_backbones(result),
        *_vibrations(result),
        *_tests(result),
    )
    there = {section.chapter for section in every}
    others = dict.fromkeys(meta.shown.chapter for meta in result.shown().values() if meta.shown.chapter not in there)
    more = [section for chapter in others for section in _shown(result, chapter)]
    return [section for section in (*every, *more) if section.rows]


def _shown(result: Result, chapter: str) -> list[ReportSection]:
    """The tables of the quantities that declare this chapter."""
    return [
        ReportSection(
            name=name,
            rows=table.of_quantity(result, name),
            title=meta.shown.title,
            line=meta.shown.line,
            below=meta.shown.below,
            chapter=chapter,
        )
        for name, meta in result.shown(chapter).items()
    ]


def _last(result: Result) -> str:
    return f"at {result.load_names[-1]}"


def _answer(result: Result) -> tuple[ReportSection, ...]:
    """Each mode with its interval, and what makes it."""
    return (
        ReportSection(
            name="answer",
            rows=answer.answer(result),
            title=f"Modes {_last(result)}",
            below=f"{answer.limit(result)} The interval, 5 to 95 %, contains each cause that is listed below. Damping: "
            "low, median, high, at the stated acceleration of the point that moves most.",
        ),
        ReportSection(
            name="shares",
            rows=answer.shares(result),
            title=f"What makes the intervals {_last(result)}, in %",
            below="Width from 5 to 95 % over the frequency, and share of each thing that is not known in its square.",
        ),
        ReportSection(
            name="narrowing",
            rows=answer.narrowing(result),
            title="What would narrow the intervals",
            below="How much narrower an interval gets: the median mode, and the one that gains most.",
        ),
    )


JOINED = (
    "Loss factors come from complex modes with {} loss in the joints. Free: faces apart. Bonded: no gap and no slip in "
    "any joint. Joints: {}."
)


def _modes(result: Result) -> tuple[ReportSection, ...]:
    """The modes under the study's laws, and under what could stand in place of them."""
    rigid = f" Rigid-body values: up to {result.rigid.max():.1e} Hz." if len(result.rigid) else ""
    laws = f"Laws compared {_last(result)}"
    return (
        ReportSection(
            name="modes",
            rows=table.modes(result),
            title="Modes at every preload" if result.bolts else "Modes as modelled",
            below=f"{JOINED.format(result.damping, result.joint_state) if result.joints else ''}{rigid}",
        ),
        ReportSection(
            name="ranges", rows=table.ranges(result), title="Range of the frequencies, from that of the stiffness"
        ),
        ReportSection(
            name="damping",
            rows=table.damping(result),
            title=f"Damping ratio at levels of acceleration, {_last(result)}",
            line=f"damping ratio {_last(result)}, at accelerations where a mode moves most: low .. median .. high",
            below="Low, median and high, at the acceleration of the point that moves most: slip of the joints in one "
            "cycle of the mode, and the damping at rest. The change of the frequency is that at the highest level.",
        ),
        ReportSection(
            name="waves",
            rows=table.waves(result),
            title="Frequencies over the waves that machined faces have",
            line=f"frequencies with {table.waves_head(result)}: least .. median .. greatest",
            below=f"Least, median and greatest with {table.waves_head(result)}.",
        ),
        ReportSection(
            name="beyond",
            rows=table.above_range(result),
            title="Above the end of a law: stiffness constant, and bonded",
        ),
        ReportSection(
            name="laws",
            rows=table.laws(result),
            title=laws,
            line=f"l{laws[1:]}: where they end, shares of the joint above their end and outside their validity range, "
            "modes that differ most",
            below="Where each law ends, shares of the joints above that and outside its validity range, and the modes "
            "that differ most between the laws.",
        ),
    )


def _joints(result: Result) -> tuple[ReportSection, ...]:
    """Parts, joints and bolts."""
    order = ", ".join(result.tightening)
    return (
        ReportSection(
            name="surfaces",
            rows=table.fractals(result),
            title="D and G that the laws rest on",
            line="D and G of the scans that the laws rest on; the G of a law is that of both faces together",
            below="The G of a law is that of both faces together. D and G hold within the band; the notes say how far "
            "the scan bears them out.",
        ),
        ReportSection(name="parts", rows=table.parts(result), title="Masses"),
        ReportSection(name="joints", rows=table.joints(result), keys=2, title="Joints"),
        ReportSection(
            name="bolts",
            rows=table.bolts(result),
            keys=2,
            title="Bolts",
            line=f"bolts, tightened in the order {order}" if order else "bolts, all pulled at once",
            below=f"Tightened in the order {order}." if order else "All pulled at once.",
        ),
        *_shown(result, "Structure"),
        ReportSection(
            name="bolting",
            rows=table.bolting(result),
            keys=2,
            title="Bolts and what they clamp",
            line=table.bolting_head(result),
            below=table.EMBEDDING,
        ),
        ReportSection(
            name="modal forces",
            rows=table.modal_forces(result),
            title=f"Force in the bolts per motion where a mode moves most, {_last(result)}",
        ),
        ReportSection(
            name="conductance",
            rows=table.conductance(result),
            title="Conductance of the joints",
            line="conductance of the joints (clean metal in vacuum)",
            below=table.CLEAN,
        ),
    )


def _backbones(result: Result) -> Iterator[ReportSection]:
    """Curves of a mode over its amplitude, and what coarser computations would change."""
    for curve in result.backbones:
        what = f"mode {curve.mode} over amplitude, {curve.settings}"
        yield ReportSection(
            name="backbone",
            rows=table.backbone(curve),
            title=f"{what[0].upper()}{what[1:]}",
            line=f"{what}, at {in_mm(curve.at)}; at rest {curve.linear_frequency:.3f} Hz; ends: {curve.reason}",
            below=f"At {in_mm(curve.at)}; at rest {curve.linear_frequency:.3f} Hz. Ends: {curve.reason}.",
        )
        if curve.measured is not None:
            yield ReportSection(
                name="backbone measured",
                rows=table.backbone_measured(curve),
                title=f"Measured points against {what}",
                line=f"measured points of {curve.measured_source} against {what}",
                below=f"From {curve.measured_source}; a dozen at most, and what the curve has at their amplitude.",
            )
        yield ReportSection(
            name="backbone bounds",
            rows=table.backbone_bounds(curve),
            title=f"Error bounds of {what}",
            line=f"error bounds of {what}",
        )


def _vibrations(result: Result) -> Iterator[ReportSection]:
    """What the structure does in service: modes, points, bolts and joints under each excitation."""
    for one in result.vibrations:
        for title, rows in TABLES.items():
            yield ReportSection(
                name="vibration",
                rows=rows(one),
                title=f"{heading(one)[:1].upper()}{heading(one)[1:]}: {title}",
                below=HELP if one is result.vibrations[-1] and title == list(TABLES)[-1] else "",
            )


def _tests(result: Result) -> tuple[ReportSection, ...]:
    """What was measured, or published, to compare with the study."""
    c, hammer = result.comparison, result.hammer
    return (
        ReportSection(
            name="score",
            rows=answer.score(result),
            title="Error against the test, and of guesses that need no joint model",
            below=answer.score_line(result),
        ),
        ReportSection(
            name="comparison",
            rows=table.comparison(result),
            title=f"Comparison with the {c.reference if c else 'test'}",
            below=c.source if c else "",
        ),
        ReportSection(
            name="hammer",
            rows=table.hammer(result),
            title=f"Hammer test at {load_text(hammer.model.load)}" if hammer else "Hammer test",
        ),
    )
