"""The commands with their arguments and options, from click."""

import re

import click
from docutils import nodes
from sphinx.util.docutils import SphinxDirective

from faying.cli.main import COMMANDS, cli
from faying_reference.rst import escape, heading, indented


def commands() -> dict[str, click.Command]:
    """Every command by name."""
    context = click.Context(cli)
    return {name: found for name in COMMANDS if (found := cli.get_command(context, name)) is not None}


def _paragraphs(text: str) -> list[str]:
    r"""The help text; click keeps the lines of a paragraph that begins with \b."""
    out: list[str] = []
    for part in re.split(r"\n\s*\n", text.strip()):
        lines = [line.strip() for line in part.splitlines()]
        if lines and lines[0] == "\b":
            out += [".. code-block:: text", "", *indented(line.rstrip() for line in part.splitlines()[1:]), ""]
        else:
            out += [escape(" ".join(lines)), ""]
    return out


def _option(option: click.Option, context: click.Context) -> list[str]:
    record = option.get_help_record(context)
    names, text = record if record is not None else (", ".join(option.opts), "")
    words = names.split(" ", 1)
    joined = ", ".join(
        f"{name} {option.make_metavar(context)}" if not option.is_flag and option.nargs == 1 else name
        for name in option.opts
    )
    shown = joined if words else names
    return [f".. option:: {shown}", "", *indented([escape(" ".join(text.split()))]), ""]


class Commands(SphinxDirective):
    """Document every command."""

    def run(self) -> list[nodes.Node]:
        """Return a section for each."""
        lines: list[str] = []
        for name, command in commands().items():
            context = click.Context(command, info_name=f"faying {name}")
            usage = " ".join(command.collect_usage_pieces(context))
            lines += [f".. _command-{name}:", "", *heading(f"faying {name}"), COMMANDS[name][1], ""]
            lines += [".. code-block:: text", "", f"   faying {name} {usage}", ""]
            lines += _paragraphs(command.help or "")
            lines += [f".. program:: faying {name}", ""]
            for parameter in command.params:
                if isinstance(parameter, click.Option) and not parameter.hidden:
                    lines += _option(parameter, context)
        return self.parse_text_to_nodes("\n".join(lines), allow_section_headings=True)
