"""[law]: which contact law, and its parameters as the law declares them."""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields, replace
from difflib import get_close_matches
from typing import Literal

from faying.contact.auto import Choice, pick
from faying.contact.build import AUTO, LawKind, build, check_entries, find, kinds, laws
from faying.contact.inputs import RoughSurface
from faying.contact.mates import Mates
from faying.contact.parameter import TABLE
from faying.materials import CATALOGUE, RIGID, ContactPair, Material
from faying.study.declaration.declared import WORDS, Inner, Key, Put
from faying.study.declaration.reader import Table
from faying.study.declaration.values import text
from faying.study.keys.surface import Surface

# D, G and area of a surface are written under [surface], where a scan would give them
OF_SURFACE = ("D", "G", "scan_area")


@dataclass(frozen=True, kw_only=True)
class LawChoice:
    """The contact law of joints: its label, the values of its entries in SI units, what the rough face presses on."""

    model: str = AUTO
    counterbody: Literal["part", "rigid"] = "part"
    given: Mapping[str, object] = field(default_factory=dict)
    # with a fault of their own, or misspelt
    misspelt_keys: frozenset[str] = field(default=frozenset(), repr=False, compare=False)

    @classmethod
    def of(cls, table: Table) -> "LawChoice":
        """Read one [law] table."""
        kind = table.get("model")
        counterbody = table.get("counterbody")
        if kind is None and "model" in table.data:
            table.data.clear()  # nothing is said of keys of a law that is not known
            return cls.unknown()
        kind = kind or find(cls.model)
        given = {}
        for name, parameter in kind.law.entries().items():
            if name in OF_SURFACE and name in table.data:
                table.faults.add(f"{table.where}.{name} is not a key of the law; D, G and scan_area go under [surface]")
                table.data.pop(name)
            elif name in kind.fixed and name in table.data:
                table.made(lambda name=name: check_entries(kind, [name]))  # type: ignore[misc]
                table.data.pop(name)
            elif (value := table.parameter(name, parameter)) is not None:
                given[name] = value
        moved = _note_misplaced(table, kind)
        entries = kind.law.entries()
        misspelt_keys = {name for name in entries if name in table.data and name not in given}
        misspelt_keys.update(*(get_close_matches(key, entries, n=1) for key in table.data if not table.known(key)))
        # keys of another law: it may be meant, which needs no surface
        choice = cls(
            model=kind.label,
            counterbody=counterbody,
            given=given,
            misspelt_keys=frozenset(entries if moved else misspelt_keys),
        )
        if not choice.missing:
            steel = CATALOGUE["45 steel"]  # faults of a law that needs no surface show at once, whatever the material
            table.made(lambda: build(kind, given, None, ContactPair(steel, steel)))
        return choice

    @classmethod
    def unknown(cls) -> "LawChoice":
        """Stands for a law whose fault is noted already, so that nothing more is said of it."""
        return cls(misspelt_keys=frozenset(find(cls.model).law.entries()))

    @property
    def kind(self) -> LawKind:
        """The law with its declarations."""
        return find(self.model)

    @property
    def missing(self) -> tuple[str, ...]:
        """Entries that are not given here, so that a surface must supply them."""
        return self.kind.missing(self.given, None)

    @property
    def needs_surface(self) -> bool:
        """Whether the law takes some of its inputs from [surface]."""
        return bool(self.missing)

    def fault_without(self, surface: str) -> str:
        """What is wrong where this law finds "no" surface, one of "fractal" numbers, or a "scan"; "" where it is
        fine."""
        entries = self.kind.law.entries()
        rank = ("nothing", "fractal", "moments", "scan")
        there = {"no": 0, "fractal": 1, "scan": 3}[surface]
        wanted = {name: rank.index(RoughSurface.needed_for([entries[name].surface])) for name in self.missing}
        short = [name for name in self.missing if not entries[name].surface or wanted[name] > there]
        short = [name for name in short if name not in self.misspelt_keys]
        if surface == "no" and set(short) & {*OF_SURFACE, "scan"}:
            return f'[surface] is missing; model = "{self.model.lower()}" takes its inputs from a surface there'
        return self.kind.describe_missing(short, with_scan=surface == "scan") if short else ""

    def make(self, surface: Surface, rough: Material, other: Material) -> Choice:
        """Return the law between the rough material and the other one, and why it. Raises InputError as `pick`."""
        pair = self.pair(rough, other)
        if surface.faces is None:
            return pick(self.kind, self.given, None, pair)
        return Mates(surface.faces, materials=pair).choose(self.kind, self.given)

    def pair(self, rough: Material, other: Material) -> ContactPair:
        """Return the materials that meet in the law: a rigid counterbody in place of the other one where asked for."""
        return ContactPair(rough, RIGID if self.counterbody == "rigid" else other)


def _note_misplaced(table: Table, kind: LawKind) -> bool:
    """Note keys that are entries of other laws, each with the laws that have it; whether there were some."""
    found = False
    for key in [key for key in table.data if not table.known(key)]:
        owners = [law.name for law in laws().values() if key in law.entries()]
        if owners:
            names = " or ".join(f'"{name.lower()}"' for name in owners)
            table.faults.add(f'{table.where}.{key} is for model = {names}, not "{kind.label.lower()}"')
            table.data.pop(key)
            found = True
    return found


def in_law(name: str) -> Put:
    """Puts a value in an entry of a law."""
    return lambda law, value: replace(law, given={**law.given, name: value})


def _of_laws() -> dict[str, dict[str, Key]]:
    """What [law] takes with each law, with the defaults that the law has."""
    out = {}
    for law in laws().values():
        defaults = {one.name: one.default for one in fields(law) if one.default is not MISSING}  # type: ignore[arg-type]
        entries = {name: one for name, one in law.entries().items() if name not in OF_SURFACE and one.unit != TABLE}
        out[law.name] = {name: Key.of_parameter(one, defaults.get(name)) for name, one in entries.items()}
    return out


LAW = Inner(
    says="The contact law of all joints without a law of their own.",
    keys={
        "model": Key(
            "text",
            WORDS,
            'Label of the law; "auto" where left out, which solves the contact on the scan or takes the nearest law.',
            read=lambda value, name: find(text(value, name)),
            examples=lambda: sorted(label.lower() for label in kinds()),
        ),
        "counterbody": Key.text(
            "The other body is the part that is there, or rigid.", "part", ("part", "rigid")
        ).varying(),
    },
    models=_of_laws,
)
