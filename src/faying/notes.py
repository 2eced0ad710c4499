"""What a reader of a result should know, as facts rather than sentences alone."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

Severity = Literal["wrong", "limit", "remark"]
TITLES: dict[Severity, str] = {
    "wrong": "what may be wrong",
    "limit": "what limits this result",
    "remark": "what was read and assumed",
}
INCOMPLETE = "interval-incomplete"  # the code of a note on what an interval lacks
NUMBER = re.compile(r"(?<![\w.])\d+(?:,\d{3})*(?:\.\d+)?(?:e[+-]?\d+)?(?![\w])")
MAX_NAMES = 3  # of joints in one note
FIRST_NOTES = 3  # that stand before the tables
SLIGHT = 0.05  # share of a joint below which a note comes after the others of its severity
OF_ALTERNATIVE = "alternative "  # begins what is said of a law that was not asked to answer
MAX_DIFFERENCES = 3  # numbers that may differ between notes that are said as one


@dataclass(frozen=True, kw_only=True)
class Note:
    """One note.

    Args:
        code: what kind of note it is, a word that never changes, such as "beyond-law".
        text: the sentence for people.
        severity: whether the result may be wrong, is limited, or is only described; the same for all notes of a code.
        joint: the joint that it is about; "" for the whole structure.
        load: the preload of the first bolt [N] at which it holds; None for all.
        share: the share of the joint that it concerns [-], of its area or of its stiffness as the text says; None where
            that means nothing.
    """

    code: str
    text: str
    severity: Severity = "remark"
    joint: str = ""
    load: float | None = None
    share: float | None = None

    def __str__(self) -> str:
        return self.text


def percent(share: float) -> str:
    """A share in words: "12%", and "less than 1%" where it would be none."""
    return "less than 1%" if 0 < share < 0.01 else f"{share:.0%}"


def grouped(notes: Iterable[Note]) -> tuple[Note, ...]:
    """Notes of one kind that differ in their joint and in a few numbers alone, as one with the least and the greatest.

    "flange, 4 kN: ... on 16% of the joint" and "flange, 12 kN: ... on 18% of the joint" become "flange, 4 to 12 kN: ...
    on 16 to 18% of the joint". A grouped note is in the place of the first, with the greatest share.
    """
    groups: dict[tuple[str, str], list[Note]] = {}
    for note in notes:
        groups.setdefault((note.code, NUMBER.sub("#", "".join(_around(note)))), []).append(note)
    return tuple(one for group in groups.values() for one in _as_one(group))


def by_severity(notes: Iterable[Note], leave_out: Iterable[Note] = ()) -> dict[Severity, tuple[Note, ...]]:
    """Grouped notes of each severity that occurs, the gravest first.

    What concerns little of a joint, and what concerns an alternative alone, comes last in its severity.

    leave_out: grouped notes that stand elsewhere.
    """
    every, shown = sorted(grouped(notes), key=_weight), set(leave_out)
    found = {kind: tuple(note for note in every if note.severity == kind and note not in shown) for kind in TITLES}
    return {kind: some for kind, some in found.items() if some}


def grave(notes: Iterable[Note]) -> tuple[Note, ...]:
    """Grouped notes that are more than remarks, the gravest first."""
    return tuple(note for kind, some in by_severity(notes).items() if kind != "remark" for note in some)


def _weight(note: Note) -> int:
    """0, 1 or 2: the more, the later."""
    if note.text.startswith(OF_ALTERNATIVE):
        return 2
    return int(note.share is not None and note.share < SLIGHT)


def _around(note: Note) -> tuple[str, str]:
    """What stands before and after the name of the joint that a note begins with; all after where it does not."""
    for separator in (": ", ", "):
        before, found, after = note.text.partition(note.joint + separator)
        if note.joint and found and (not before or before.endswith(": ")):
            return before, separator + after
    return "", note.text


def _as_one(group: Sequence[Note]) -> Sequence[Note]:
    distinct = list(dict.fromkeys(group))
    joints = list(dict.fromkeys(note.joint for note in distinct))
    rows = [[NUMBER.findall(part) for part in _around(note)] for note in distinct]
    numbers = [before + after for before, after in rows]
    differing = [k for k in range(len(numbers[0])) if len({row[k] for row in numbers}) > 1]
    if len(distinct) < 2 or len(differing) > MAX_DIFFERENCES:
        if len(joints) < 2:
            return distinct
        return [one for joint in joints for one in _as_one([note for note in distinct if note.joint == joint])]
    spans = iter(_span([row[k] for row in numbers]) for k in range(len(numbers[0])))
    before, after = (NUMBER.sub(lambda _: next(spans), part) for part in _around(distinct[0]))
    begins = len("".join(_around(distinct[0]))) < len(distinct[0].text)
    named = joint_names(joints) if begins else ""
    share = max((note.share for note in distinct if note.share is not None), default=None)
    text, joint = f"{before}{named}{after}", joints[0] if len(joints) == 1 else ""
    return [replace(distinct[0], text=text, joint=joint, load=None, share=share)]


def joint_names(names: Sequence[str]) -> str:
    """Names of joints in a sentence: three at most."""
    if len(names) > MAX_NAMES:
        return f"{', '.join(names[: MAX_NAMES - 1])} and {len(names) - MAX_NAMES + 1} more"
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def _span(words: Sequence[str]) -> str:
    ends = sorted(words, key=lambda word: float(word.replace(",", "")))
    return words[0] if len(set(words)) == 1 else f"{ends[0]} to {ends[-1]}"
