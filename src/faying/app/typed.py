"""What can be said of a study's text while it is typed: faults of its form and of its keys, in milliseconds."""

from pathlib import Path
from typing import Any

from faying.errors import FayingError
from faying.setup.lines import key_of, line_of, line_of_fault, lines_of
from faying.study import Study
from faying.study.declaration.reader import StudyFaults
from faying.text import toml


def faults_of(text: str, folder: Path) -> list[dict[str, Any]]:
    """Return the faults of a text, each with its line where that is known; files are not opened, nothing is meshed.

    Args:
        text: of the study.
        folder: in which the files lie that it names.
    """
    try:
        data = toml(text)
    except ValueError as fault:
        return [_fault(f"the text is not TOML: {fault}", line_of_fault(fault, text))]
    lines = lines_of(text)
    try:
        Study.from_dict(data, folder=folder, text=text)
    except StudyFaults as faults:
        return [_fault(line, line_of(key_of(line, lines), lines)) for line in faults.lines]
    except FayingError as fault:
        return [_fault(str(fault), None)]
    return []


def _fault(text: str, line: int | None) -> dict[str, Any]:
    return {"level": "fault", "text": text, "line": line}
