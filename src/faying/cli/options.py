"""What several commands share."""

from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from faying import checks, units
from faying.errors import InputError
from faying.text import json_text


class NamedPath(click.Path):
    """A path whose names a file can have; others are faults before any work."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path."""
        try:
            checks.path(value, self.name)
        except InputError as fault:
            self.fail(str(fault), param, ctx)
        return super().convert(value, param, ctx)


PATH = NamedPath(path_type=Path)
FILE = NamedPath(dir_okay=False, path_type=Path)


def refuse_given(names: Collection[str], why: str) -> None:
    """Raise InputError where parameters of the command that have no effect were given; why: what they are for."""
    context = click.get_current_context()
    given = [
        parameter.opts[0]
        for parameter in context.command.params
        if parameter.name in names and context.get_parameter_source(parameter.name) is ParameterSource.COMMANDLINE
    ]
    if given:
        raise InputError(f"{', '.join(given)}: {why}; leave it out")


def show(
    as_json: bool,
    tree: Callable[[], dict[str, Any]],
    text: Callable[[], str],
    files: Sequence[Path],
    folder: Path | None = None,
    heading: str = "written to",
) -> None:
    """Print what a command found, as JSON or as text, and the files that it wrote: all of them in `folder`, or each."""
    if as_json:
        click.echo(json_text(tree() | {"files": [str(file) for file in files]}))
        return
    click.echo(text())
    if files and folder is not None:
        click.echo(f"\nwritten to {folder}: {', '.join(file.name for file in files)}")
    elif files:
        click.echo(f"\n{heading} {', '.join(map(str, files))}")


def quantity(value: Any, unit: str) -> dict[str, Any]:
    """A quantity as JSON shows it everywhere: its SI unit ("1" for plain numbers) and its value or values."""
    return {"unit": unit if unit not in ("", "text") else "1", "values": value}


def frequency_band(text: str) -> tuple[float, float]:
    """Turn the text of --band into two frequencies [Hz]; InputError that shows the form otherwise."""
    parts = text.split(":")
    if len(parts) != 2:
        raise InputError(f'--band "{text}": give two frequencies, for example "20 Hz:800 Hz"')
    low, high = (units.parse(part, "Hz", name="--band") for part in parts)
    return low, high
