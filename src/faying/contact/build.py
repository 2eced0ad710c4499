"""The one place where a contact law is found by name and made, for run, law, sweep, attach and Python."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache
from typing import ClassVar, final

from faying.checks import instance
from faying.contact.inputs import RoughSurface
from faying.contact.law import ContactLaw, found_in
from faying.contact.parameter import FRACTAL
from faying.errors import InputError, shown
from faying.materials import ContactPair


@final
@dataclass(frozen=True, kw_only=True)
class LawKind:
    """A law as a user names it: its label, its class, and the parameters that a variant fixes."""

    label: str
    law: type[ContactLaw]
    fixed: Mapping[str, object] = field(default_factory=dict)

    def missing(self, given: Collection[str], surface: RoughSurface | None) -> tuple[str, ...]:
        """The entries that neither `given` nor the surface nor the variant supplies."""
        known = {*given, *self.fixed, *(surface.supplies(self.law.parameters) if surface is not None else ())}
        return tuple(name for name in self.law.required() if name not in known)

    def takes(self, numbers: Collection[str], given: Collection[str]) -> bool:
        """Whether it takes any of these numbers from a surface, where these entries are given."""
        open_ = [p for name, p in self.law.parameters.items() if name not in given and name not in self.fixed]
        return any(parameter.surface in numbers for parameter in open_)

    def describe_missing(self, names: Collection[str], *, with_scan: bool) -> str:
        """Say what is missing and where it can come from; with_scan: whether a scan is there already."""
        entries = self.law.entries()
        notes = []
        for name in names:
            unit = entries[name].unit if entries[name].is_number else ""
            notes.append(f"{name} ({', '.join(filter(None, (entries[name].meaning, unit)))})")
        text = f"{self.label} needs {' and '.join(notes)}; give {'it' if len(notes) == 1 else 'them'}"
        sources = {entries[name].surface for name in names}
        if "" in sources or with_scan:
            return text
        kind = RoughSurface.needed_for(sources)
        return text + (
            ", or a surface with D, G and scan_area, or a scan" if kind == "fractal" else ", or a surface with a scan"
        )


@cache
def laws() -> Mapping[str, type[ContactLaw]]:
    """Return every contact law by the name of its class, in alphabetical order, found among the files."""
    return found_in("faying.contact.models", ContactLaw)


AUTO = "auto"
NAMED = "give the parameters of the law by name, for example {'alpha': 0.3}"


class _Auto(ContactLaw):
    """Stands among the laws for the choice that `faying.contact.auto` makes; never made itself."""

    name = AUTO
    source = "a choice among the laws of the scan"
    validity = "that of the law that is taken"
    parameters: ClassVar = {"D": FRACTAL["D"], "G": FRACTAL["G"], "scan_area": FRACTAL["scan_area"]}

    @classmethod
    def required(cls) -> tuple[str, ...]:
        return tuple(cls.parameters)


@cache
def kinds() -> Mapping[str, LawKind]:
    """Return every law and every variant of one by its label."""
    out: dict[str, LawKind] = {}
    for law in laws().values():
        out[law.name] = LawKind(label=law.name, law=law)
        for label, fixed in law.variants.items():
            out[label] = LawKind(label=label, law=law, fixed=fixed)
    out[AUTO] = LawKind(label=AUTO, law=_Auto)  # type: ignore[type-abstract]
    return out


def _plain(name: str) -> str:
    return name.strip().lower().replace("-", "").replace("_", "").replace(" ", "")


def find(name: str) -> LawKind:
    """Return the law called `name`, by label ("gw-ke") or class, in any case, with or without hyphens.

    Raises InputError that lists the known labels, the nearest first.
    """
    if not isinstance(name, str):
        raise InputError(f'contact law = {shown(name)}; give its name as text, for example "jk"')
    known = {_plain(label): kind for label, kind in kinds().items()}
    known |= {_plain(key): kinds()[law.name] for key, law in laws().items() if _plain(key) not in known}
    kind = known.get(_plain(name))
    if kind is None:
        near = get_close_matches(_plain(name), known, n=1)
        hint = f"; did you mean {known[near[0]].label}?" if near else ""
        quoted = repr(name) if len(name) <= 60 else shown(name)
        raise InputError(
            f"no contact law {quoted}{hint}; the known ones are {', '.join(sorted(kinds(), key=str.lower))}"
        )
    return kind


def build(
    name: str | LawKind, given: Mapping[str, object], surface: RoughSurface | None, pair: ContactPair
) -> ContactLaw:
    """Make a contact law.

    Args:
        name: label or class of the law in any spelling, or its kind; "auto" is for `faying.contact.auto.pick`.
        given: values of its entries in SI units; they count before what the surface supplies.
        surface: the rough surface; None where there is none.
        pair: the materials that meet.

    Returns:
        The law.

    Raises:
        InputError: unknown names and entries, missing inputs (with where they can come from), values out of range.
    """
    kind = name if isinstance(name, LawKind) else find(name)
    instance(given, Mapping, "given", NAMED)
    instance(surface, RoughSurface | None, "surface", "give a RoughSurface, or None")
    instance(pair, ContactPair, "pair", 'give the two materials that meet, ContactPair("45 steel", "45 steel")')
    check_entries(kind, given)
    missing = kind.missing(given, surface)
    if missing:
        text = kind.describe_missing(missing, with_scan=surface is not None and surface.scan is not None)
        raise InputError(f"{text}; {surface.unfitted}" if surface is not None and surface.unfitted else text)
    supplied = surface.supplies(kind.law.parameters) if surface is not None else {}
    if kind.law.plastic_summits and surface is not None:
        pair = surface.indented(pair)
    return kind.law.from_entries({**supplied, **kind.fixed, **given}, pair)


def check_entries(kind: LawKind, given: Collection[str]) -> None:
    """Raise InputError for entries that a law does not have, or that its variant fixes."""
    known = kind.law.entries()
    for name in given:
        if name in kind.fixed:
            raise InputError(
                f'{name} is for model = "{kind.law.name.lower()}"; "{kind.label.lower()}" has the {name} '
                f"{kind.fixed[name]}"
            )
        if name not in known:
            near = get_close_matches(name, known, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise InputError(f"{kind.label} has no parameter {name!r}{hint}; it has {', '.join(known)}")
