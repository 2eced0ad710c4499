"""Tables of study keys, result variables, estimators, programs, laws and materials, from what the code declares."""

import ast
import inspect
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

import faying
from faying.contact.build import kinds
from faying.contact.parameter import Parameter
from faying.decks.programs import CONDENSED, SOLVERS
from faying.file_kinds import KINDS, Use
from faying.loads.record import LoadCases, LoadIntervals
from faying.materials import CATALOGUE
from faying.measured.compare import ModalComparison
from faying.measured.model import FullResponse
from faying.result.backbone import Backbone, QuasiStaticCheck
from faying.result.bolts import BoltNumbers
from faying.result.fields import declared
from faying.result.groups import Alternatives, BondedAboveRange, Levels, WaveDraws
from faying.result.interval import Interval
from faying.result.result import Result
from faying.result.run_record import MeasuredComparison, Receptance
from faying.study.keys.varied import rooms
from faying.surface.estimators.table import ESTIMATORS
from faying.units import EXAMPLES
from faying_reference.docstrings import rendered
from faying_reference.rst import escape, heading, table
from faying_reference.study_keys import Key, keys

GROUPS = {
    "result.nc": Result,
    "interval, in Python": Interval,
    "levels, in Python": Levels,
    "waves, in Python": WaveDraws,
    "above_range, in Python": BondedAboveRange,
    "alternatives, in Python": Alternatives,
    "response": Receptance,
    "comparison": MeasuredComparison,
    "hammer": ModalComparison,
    "full response": FullResponse,
    "bolt_numbers": BoltNumbers,
    "A backbone": Backbone,
    "witness of a backbone": QuasiStaticCheck,
    "Load cases": LoadCases,
    "intervals of load cases": LoadIntervals,
}


class Section(SphinxDirective):
    """A directive whose content is made as text."""

    def lines(self) -> list[str]:
        """Return the text."""
        raise NotImplementedError

    def run(self) -> list[nodes.Node]:
        """Return the sections."""
        return self.parse_text_to_nodes("\n".join(self.lines()), allow_section_headings=True)


class StudyKeys(Section):
    """Every key of a study, a section for each table."""

    def lines(self) -> list[str]:
        """Return the sections."""
        places: dict[str, list[Key]] = {}
        tables: dict[str, Key] = {}
        for key in keys():
            places.setdefault(key.table, []).append(key)
            if key.kind in ("table", "list of tables"):
                tables[key.path] = key
        out: list[str] = []
        for place, found in places.items():
            many = place in tables and tables[place].kind == "list of tables"
            title = "Top level" if not place else f"[[{place}]]" if many else f"[{place}]"
            out += [f".. _table-{place or 'top'}:", "", *heading(title)]
            if place in tables:
                out += [escape(tables[place].meaning), ""]
            out += _keys([key for key in found if not key.model])
            for model in dict.fromkeys(key.model for key in found if key.model):
                named = [key for key in found if key.model == model]
                out += [f'With ``model = "{model.lower()}"`` also:', "", *_keys(named)]
        return out


def _keys(found: list[Key]) -> list[str]:
    head = ("key", "value", "default", "meaning")
    rows = [
        (
            f"``{key.name}``",
            escape(f"{key.kind}, {key.allowed}" if key.allowed else key.kind) + _example(key),
            f"``{key.default}``" if key.default and key.default != "required" else key.default,
            escape(key.meaning),
        )
        for key in found
    ]
    return table(head, rows, (18, 30, 14, 38))


def _example(key: Key) -> str:
    unit = key.kind[len("quantity [") : -1]
    return f', such as ``"{EXAMPLES[unit]}"``' if unit in EXAMPLES else ""


class Axes(Section):
    """What a sweep varies, and what may scatter."""

    def lines(self) -> list[str]:
        """Return two tables."""
        axes = []
        for room, found in rooms().items():
            for name, key in found.numbers.items() if room != "law" else ():
                middle = ".NAME" if found.named == "always" else ""
                axes.append(_axis(f"{room}{middle}.{name}", key.value))
        axes.append(_axis("law.counterbody", rooms()["law"].numbers["counterbody"].value))
        head = ("name", "value", "meaning")
        return [
            *table(head, axes, (26, 30, 44)),
            "Besides ``law.NAME`` for every number that the study's law takes (:doc:`../theory/laws`), and",
            "``law.model``. A bolt, a joint or a part is named in the middle: ``bolt.NAME.preload``.",
            "",
        ]


def _axis(name: str, one: Parameter) -> tuple[str, str, str]:
    kind = f"quantity [{one.unit}]" if one.is_number and one.unit else "number" if one.is_number else one.unit
    return f"``{name}``", escape(f"{kind}, {one.allowed}" if one.allowed else kind), escape(one.meaning)


class ResultVariables(Section):
    """Every variable of a result and of a backbone."""

    def lines(self) -> list[str]:
        """Return the sections."""
        out: list[str] = []
        for name, kind in GROUPS.items():
            out += [*heading(name), *rendered((inspect.getdoc(kind) or "").splitlines()), ""]
            rows = [
                (
                    f"``{meta.name or field}``" + (f" (in Python ``{field}``)" if meta.name else ""),
                    escape(meta.group),
                    escape(", ".join(meta.dims)),
                    escape(meta.unit),
                    escape(meta.long_name) + ("; NaN where not known" if meta.gaps else ""),
                )
                for field, meta in declared(kind).items()
            ]
            if rows:
                out += table(("variable", "group", "dimensions", "unit", "meaning"), rows, (22, 10, 20, 10, 38))
            others = [f.name for f in fields(kind) if f.name not in declared(kind) and not f.name.startswith("_")]
            if others:
                out += ["Besides: " + ", ".join(f"``{other}``" for other in others) + ".", ""]
        return out


class Estimators(Section):
    """The estimators of D and G."""

    def lines(self) -> list[str]:
        """Return a table."""
        rows = [(f"``{one.name}``", escape(one.needs), escape(one.bias)) for one in ESTIMATORS.values()]
        return table(("name", "needs", "known bias"), rows, (16, 34, 50))


class Programs(Section):
    """What is read from other programs, and written for them."""

    def lines(self) -> list[str]:
        """Return a table."""
        head = ("program", "meshes read", "matrices read", "joints: attach --to", "one 6 x 6: condense --to")
        rows = [
            (
                f"``{name}``",
                _suffixes(name, "mesh"),
                _suffixes(name, "matrices"),
                "yes" if name in SOLVERS else "",
                "yes" if name in CONDENSED else "",
            )
            for name in dict.fromkeys([*SOLVERS, *(kind.reader for kind in KINDS if kind.reader)])
        ]
        return table(head, rows)


def _suffixes(reader: str, use: Use) -> str:
    """Endings of the files that a module of `faying.decks` reads for a use."""
    return ", ".join(
        suffix for kind in KINDS if kind.reader == reader and use in kind.serves for suffix in kind.suffixes
    )


class Catalogue(Section):
    """The materials that need not be written."""

    def lines(self) -> list[str]:
        """Return a table."""
        head = ("material", "E [GPa]", "nu", "density [kg/m3]", "yield strength [MPa]", "hardness [MPa]", "source")
        rows = [
            (
                escape(name),
                f"{one.E / 1e9:g}",
                f"{one.nu:g}",
                f"{one.density:g}" if one.density else "",
                f"{one.yield_strength / 1e6:g}" if one.yield_strength else "",
                f"{one.hardness / 1e6:g}" if one.hardness else "",
                escape(one.source),
            )
            for name, one in CATALOGUE.items()
        ]
        return table(head, rows)


class LawTable(Section):
    """The contact laws with what they take, each linked to its page."""

    def lines(self) -> list[str]:
        """Return a table."""
        rows = [
            (
                f":ref:`{kind.label} <law-{slug(kind.label)}>`",
                f"``{kind.label.lower()}``",
                escape(kind.law.takes()),
                escape(kind.law.validity),
            )
            for kind in kinds().values()
            if kind.label != "auto"
        ]
        return table(("law", "model =", "takes", "holds"), rows, (16, 16, 16, 52))


def slug(label: str) -> str:
    """A label as the name of a page."""
    return label.lower().replace(" ", "-")


class Notes(Section):
    """The codes of notes, and how their sentences read."""

    def lines(self) -> list[str]:
        """Return a table."""
        rows = [(f"``{code}``", " / ".join(escape(text) for text in texts)) for code, texts in note_codes().items()]
        return table(("code", "sentence (… stands for names and numbers)"), rows, (22, 78))


def note_codes() -> dict[str, list[str]]:
    """Every code of a note that the sources make, with its sentences as far as they are written there."""
    found: dict[str, list[str]] = {}
    for path in sorted(Path(faying.__file__).parent.rglob("*.py")):
        for code, text in _notes(ast.parse(path.read_text(encoding="utf-8"))):
            texts = found.setdefault(code, [])
            if text and text not in texts:
                texts.append(text)
    return dict(sorted(found.items()))


def _notes(tree: ast.AST) -> Iterator[tuple[str, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")) == "Note":
            given: dict[str | None, Any] = {one.arg: one.value for one in node.keywords}
            for one in ast.walk(given["code"]) if "code" in given else ():
                if isinstance(one, ast.Constant):
                    yield str(one.value), _sentence(given.get("text"))


def _sentence(node: ast.AST | None) -> str:
    if isinstance(node, ast.Constant):
        return str(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(str(part.value) if isinstance(part, ast.Constant) else "…" for part in node.values)
    if isinstance(node, ast.BinOp):
        return _sentence(node.left) + _sentence(node.right)
    return "…"
