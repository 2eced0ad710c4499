"""A page for each contact law: what it declares, its equations on the theory pages, its curve on a scan."""

import csv
import re
from collections.abc import Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

import numpy as np
from sphinx.application import Sphinx
from sphinx.errors import SphinxError

from faying.contact.build import laws
from faying.contact.law import ContactLaw
from faying.style import new_figure, save
from faying_reference.rst import escape, table
from faying_reference.tables import Section, slug

DOCS = Path(__file__).parents[2]
THEORY = DOCS / "theory"
CURVES = THEORY / "laws-on-milled.csv"
PAGES = DOCS / "generated" / "laws"
MARK = re.compile(r"<!-- equations: (.+?) -->")
EXACT = "half-space"
UNITS = {"": "", "text": "", "file": "file", "table": "array"}


def equations() -> dict[str, Path]:
    """The theory page on which the equations of each law stand, by the name of the law."""
    return {
        name: path for path in sorted(THEORY.glob("*.md")) for name in MARK.findall(path.read_text(encoding="utf-8"))
    }


def curves() -> dict[str, dict[str, Any]]:
    """Columns of the laws on the example scan, by label: pressure [Pa], area, k_n [Pa/m], valid."""
    with CURVES.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    found: dict[str, dict[str, Any]] = {}
    for label in dict.fromkeys(row["law"] for row in rows):
        own = [row for row in rows if row["law"] == label]
        numbers = {
            name: np.array([float(row[name] or "nan") for row in own])
            for name in ("pressure [Pa]", "area [-]", "k_n [Pa/m]")
        }
        found[label] = {**numbers, "valid": np.array([row["valid"] == "true" for row in own])}
    return found


def labels(law: type[ContactLaw]) -> tuple[str, ...]:
    """The label of a law and those of its variants."""
    return (law.name, *law.variants)


def title(law: type[ContactLaw]) -> str:
    """The name of a law's class in words, and its label where that is another."""
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", law.__name__)
    same = words.lower().replace(" ", "") == law.name.lower().replace(" ", "").replace("-", "")
    return words if same else f"{words}: {law.name}"


def draw(law: type[ContactLaw], found: Mapping[str, Mapping[str, Any]], path: Path) -> None:
    """Draw area and stiffness of a law on the example scan; the others are grey, the half-space black."""
    fig = new_figure(8.4, 3.4)
    for ax, (name, label, scale) in zip(
        fig.subplots(1, 2),
        (("area [-]", "real area / nominal area", 1.0), ("k_n [Pa/m]", "normal stiffness k_n [MPa/um]", 1e-12)),
        strict=True,
    ):
        for other, one in found.items():
            if other not in labels(law) and other != EXACT:
                ax.plot(one["pressure [Pa]"] / 1e6, one[name] * scale, color="0.85", lw=1)
        exact = found[EXACT]
        ax.plot(exact["pressure [Pa]"] / 1e6, exact[name] * scale, "k", lw=1.5, label=EXACT)
        for i, own in enumerate(label_ for label_ in labels(law) if label_ in found and label_ != EXACT):
            one = found[own]
            p, values = one["pressure [Pa]"] / 1e6, one[name] * scale
            if np.isnan(values).all():
                continue
            ax.plot(p, values, ":", color=f"C{i}", lw=1.5)
            ax.plot(p, np.where(one["valid"], values, np.nan), color=f"C{i}", lw=2, label=own)
        ax.set(xscale="log", yscale="log", xlabel="nominal pressure [MPa]", ylabel=label)
        ax.grid(alpha=0.3)
        ax.legend(fontsize=8)
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.stat().st_mtime < max(CURVES.stat().st_mtime, Path(__file__).stat().st_mtime):
        save(fig, path)


def page(law: type[ContactLaw], found: Mapping[str, Mapping[str, Any]]) -> str:
    """The text of a law's page."""
    place = equations().get(law.name)
    if place is None:
        raise SphinxError(f"no theory page has the equations of {law.name}: <!-- equations: {law.name} -->")
    anchors = "\n".join(f"(law-{slug(label)})=" for label in labels(law))
    drawn = any(label in found for label in labels(law))
    parts = [
        anchors,
        f"# {title(law)}",
        f"```{{eval-rst}}\n.. law-facts:: {law.name}\n```",
        "## Equations",
        f"```{{include}} ../../theory/{place.name}\n:start-after: <!-- equations: {law.name} -->\n"
        ":end-before: <!-- end -->\n```",
        f"How they are read, and what was decided where the source leaves a choice: [](../../theory/{place.name}).",
        "## Parameters",
        f"```{{eval-rst}}\n.. law-parameters:: {law.name}\n```",
    ]
    if drawn:
        parts += [
            "## On the example scan",
            "The milled scan of the [T-specimen](../../t-specimen.md) (4 mm, Ra 0.8 um), 45 steel on 45 steel, both "
            "faces rough. Black: the contact solved on the scan. Grey: the other laws. Dotted: outside the validity "
            "range of the law.",
            f"![{law.name} on the example scan]({slug(law.name)}.svg)",
            f"```{{eval-rst}}\n.. law-ratios:: {law.name}\n```",
            "How the laws compare on other scans and on measured joints: [](../../which-law.md).",
        ]
    return "\n\n".join(parts) + "\n"


def write(_app: Sphinx) -> None:
    """Write the pages and figures that are new or changed."""
    found = curves()
    PAGES.mkdir(parents=True, exist_ok=True)
    kept = set()
    for law in laws().values():
        path = PAGES / f"{slug(law.name)}.md"
        kept |= {path, path.with_suffix(".svg")}
        text = page(law, found)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
        draw(law, found, path.with_suffix(".svg"))
    for path in set(PAGES.iterdir()) - kept:
        path.unlink()


def _law(name: str) -> type[ContactLaw]:
    return next(law for law in laws().values() if law.name == name)


class Facts(Section):
    """Where a law comes from, what it takes, where it holds."""

    required_arguments = 1
    final_argument_whitespace = True

    def lines(self) -> list[str]:
        """Return a table without a heading."""
        law = _law(self.arguments[0])
        rows = [
            ("In a study", ", ".join(f'``model = "{label.lower()}"``' for label in labels(law))),
            ("In Python", f":class:`~{law.__module__}.{law.__qualname__}`"),
            ("Takes", escape(law.takes())),
            ("Holds", escape(law.validity)),
            ("Source", _source(law.source)),
            *(
                (escape(label), "; ".join(f"``{key} = {value!r}``" for key, value in fixed.items()))
                for label, fixed in law.variants.items()
            ),
        ]
        return ["", *table((), rows, (20, 80))]


def _source(source: str) -> str:
    from pybtex.database import parse_file

    kind, _, name = source.partition(":")
    if kind not in ("doi", "isbn"):
        return escape(source)
    entries = parse_file(str(DOCS / "references.bib")).entries
    for key, entry in entries.items():
        if name.lower() in (entry.fields.get("doi", "").lower(), entry.fields.get("isbn", "")):
            return f":cite:t:`{key}`, {escape(source)}"
    raise SphinxError(f"references.bib has no entry for {source}")


class Parameters(Section):
    """The parameters of a law."""

    required_arguments = 1
    final_argument_whitespace = True

    def lines(self) -> list[str]:
        """Return a table."""
        law = _law(self.arguments[0])
        defaults = {
            f.name: f.default
            for f in fields(law)  # type: ignore[arg-type]
            if f.default is not MISSING and f.default is not None
        }
        rows = [
            (
                f"``{name}``",
                escape(one.meaning),
                escape(UNITS.get(one.unit, one.unit)),
                escape(one.allowed),
                f"``{defaults[name]}``" if name in defaults else "",
                escape(one.surface),
            )
            for name, one in law.entries().items()
        ]
        head = ("name", "meaning", "unit", "allowed", "default", "from the scan")
        return table(head, rows, (12, 34, 10, 20, 10, 14))


class Ratios(Section):
    """The stiffness of a law over that of the half-space on the example scan."""

    required_arguments = 1
    final_argument_whitespace = True

    def lines(self) -> list[str]:
        """Return a table, or a sentence where the law has no stiffness."""
        found, law = curves(), _law(self.arguments[0])
        exact = found[EXACT]
        places = [int(np.abs(exact["pressure [Pa]"] / p - 1).argmin()) for p in (1e5, 1e6, 1e7, 1e8)]
        rows = []
        for label in labels(law):
            k = found[label]["k_n [Pa/m]"]
            if np.isnan(k).all():
                return [f"{law.name} has no stiffness of its own.", ""]
            ratio = k / exact["k_n [Pa/m]"]
            rows.append((label, *("" if np.isnan(ratio[i]) else f"{ratio[i]:.2g}" for i in places)))
        head = ("k_n over that of the half-space, at", *(f"{exact['pressure [Pa]'][i] / 1e6:g} MPa" for i in places))
        return table(head, rows)
