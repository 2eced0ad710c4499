"""Data sets of universal files: -1, a number, data, -1."""

import re
from collections.abc import Sequence

from faying.errors import ReadError

MERGED = re.compile(r" {4}-1[^\d\s.,eEdD+-]")  # a mark with something else in place of the end of the line
MAX_LINES = {"151": (7, "a header"), "164": (3, "units")}  # of data sets that all have the same
NUMBERS = (15, 18, 55, 56, 58, 82, 151, 164, 780, 781, 1858, 2411, 2412, 2414, 2420, 2429, 2430, 2432, 2435, 2452, 2467)


def _begins(line: str) -> bool:
    """Whether a line is the number of a data set that is known, as it stands after its mark: in six columns."""
    return len(line.rstrip()) == 6 and line.strip().isdigit() and int(line) in NUMBERS


def check_data_sets(lines: Sequence[str], where: str) -> None:
    """Raise ReadError unless all lines of a universal file stand in data sets: -1, a number, data, -1.

    A mark that is missing, or is there twice, would hide the data sets on both sides of it.
    """
    inside, begun = False, False
    data_set, left = "", 0  # a data set whose number of lines is known, and how many it may still have
    for number, line in enumerate(lines, 1):
        text = line.strip(" \t\r\n\x00\x1a")
        if text == "-1" and not begun:
            inside, begun = not inside, not inside
        elif begun:
            begun, data_set = False, text
            left = MAX_LINES.get(text, (0, ""))[0]
            if not re.match(r"\s*\d{1,6}b?(?:\s|$)", text) or not line[:6].strip().isdigit():  # in six columns
                raise ReadError(
                    f"{where}, line {number}: {text[:40]!r} is not the number of a data set, which follows on -1; is "
                    "the file damaged, or a line -1 too much or too few?"
                )
        elif inside and data_set in MAX_LINES and left == 0:
            most, what = MAX_LINES[data_set]
            raise ReadError(
                f"{where}, line {number}: {text[:40]!r} is one line too many for {what} (data set {data_set}), "
                f"which has {most}; are marks of the next data set missing?"
            )
        elif inside and (MERGED.match(line) or _begins(line)):
            raise ReadError(
                f"{where}, line {number}: {text[:40]!r} is inside a data set and looks like the beginning of "
                "another; is a line -1 missing or damaged before it?"
            )
        elif inside and data_set in MAX_LINES:
            left -= 1
        elif text and not inside:
            raise ReadError(
                f"{where}, line {number}: {text[:40]!r} is between two data sets; is a line -1 missing before it?"
            )
