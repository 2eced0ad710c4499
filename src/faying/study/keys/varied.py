"""The numbers of a study that may vary in sweeps and scatter, gathered from the declarations of its keys."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal, final

from faying.contact.parameter import FILE, Parameter
from faying.errors import InputError
from faying.study.declaration.declared import Inner, Key, Put
from faying.study.keys.bolt import BOLT, BOLT_FACTORS
from faying.study.keys.joint import JOINT, JOINT_NUMBERS
from faying.study.keys.law import LAW, in_law
from faying.study.keys.material import MATERIAL, PART_FACTORS
from faying.study.keys.surface import SURFACE

MODEL = "law.model"


@final
@dataclass(frozen=True, kw_only=True)
class Room:
    """One table of the study and its numbers that may vary.

    Args:
        numbers: By name.
        named: Whether a key names one owner in its middle, as bolt.NAME.preload. Without it the key is for all owners.
    """

    numbers: Mapping[str, Key]
    named: Literal["never", "optional", "always"]


def _room(declared: Mapping[str, Key | Inner], named: Literal["never", "optional", "always"]) -> Room:
    found = {name: one for name, one in declared.items() if isinstance(one, Key) and one.varies is not None}
    return Room(numbers=found, named=named)


@cache
def rooms() -> Mapping[str, Room]:
    """All tables that have such numbers, in the order in which their scatter is read.

    A value is put in a Material, JointChoice, LawChoice or Surface, of a bolt in its forces [N] at all preloads, and of
    a part in its Material.
    """
    of_laws: dict[str, Key] = {}
    for keys in LAW.models().values():
        for name, key in keys.items():
            if key.value.unit != FILE:
                of_laws.setdefault(name, key.varying(in_law(name)))
    return {
        "material": _room(MATERIAL, "always"),
        "joint": _room({**JOINT, **JOINT_NUMBERS}, "optional"),
        "law": _room({**LAW.keys, **of_laws}, "never"),
        "surface": _room(SURFACE, "never"),
        "bolt": _room({**BOLT, **BOLT_FACTORS}, "optional"),
        "part": _room(PART_FACTORS, "always"),
    }


@final
@dataclass(frozen=True, kw_only=True)
class Varied:
    """One key of a sweep or of [uncertain], such as bolt.left.preload.

    Args:
        room, owner, name: Its table, whose number it is (None: of all in the table), and the number's name.
        parameter: Unit, range and choices of a value.
        place: Where the number stands in its table, with dots.
        put: Returns the owner with a value in SI units put in.
    """

    room: str
    owner: str | None
    name: str
    parameter: Parameter
    place: str
    put: Put

    @property
    def key(self) -> str:
        """The key in full."""
        return ".".join(filter(None, (self.room, self.owner, self.name)))

    @property
    def varies(self) -> str:
        """The name of what it changes: a factor on the preload of a bolt changes that."""
        return "preload" if (self.room, self.name) == ("bolt", "factor") else self.name

    @property
    def of_form(self) -> bool:
        """Whether it changes the form of faces, so that other points of a joint touch."""
        return self.room == "joint" and self.name.startswith("form.")

    @property
    def scatters(self) -> bool:
        """Whether a distribution of values is possible: of numbers that are not whole."""
        return self.parameter.is_number and not self.parameter.whole

    def check_owner(self, known: Mapping[str, Sequence[str]], where: str) -> None:
        """Raise InputError where the owner is none of the names that are known in its table."""
        names = known.get(self.room, ())
        if self.owner is not None and self.owner not in names:
            raise InputError(
                f"{where}: no {self.room} is called {self.owner!r}; the {self.room}s are {', '.join(names)}"
            )


@cache
def varied(key: str) -> Varied | None:
    """What a key names; None where no number of that name may vary."""
    room, _, rest = key.partition(".")
    found = rooms().get(room, Room(numbers={}, named="never"))
    for name, declared in found.numbers.items():
        owner = rest.removesuffix(f".{name}") if rest.endswith(f".{name}") else None
        if found.named == ("always" if owner is None else "never") or (owner is None and rest != name):
            continue
        place = declared.varies.place if declared.varies is not None else ""
        return Varied(
            room=room, owner=owner, name=name, parameter=declared.value, place=place or name, put=declared.put(name)
        )
    return None


def owners(joints: Iterable[str], bolts: Iterable[str], parts: Mapping[str, str]) -> dict[str, list[str]]:
    """Names that keys may have in their middle, by table; parts: the material of each part."""
    found = {"joint": list(joints), "bolt": list(bolts), "part": list(parts)}
    return found | {"material": sorted(set(parts.values()))}


def number_of(key: str) -> Varied:
    """The same for a key that is known to vary."""
    number = varied(key)
    if number is None:
        raise InputError(f"{key} cannot vary; what can: {words()}")
    return number


def short_keys() -> dict[str, str]:
    """The short keys of [uncertain], and what they stand for."""
    numbers = ((room, name, key.varies) for room, one in rooms().items() for name, key in one.numbers.items())
    return {varies.short: f"{room}.{name}" for room, name, varies in numbers if varies is not None and varies.short}


def words() -> str:
    """All keys of numbers that vary, for a message."""
    groups: dict[str, list[str]] = {}
    for room, found in rooms().items():
        for name in found.numbers if room != "law" else ("counterbody",):
            head, _, last = f"{room}{'.NAME' if found.named == 'always' else ''}.{name}".rpartition(".")
            groups.setdefault(head, []).append(last)
    of_one = " and ".join(f"{room}.NAME" for room, found in rooms().items() if found.named == "optional")
    texts = [f"{head}.{{{', '.join(names)}}}" if names[1:] else f"{head}.{names[0]}" for head, names in groups.items()]
    return f"{', '.join(texts)} ({of_one} for one of them), {MODEL}, law.NAME (a parameter of the law)"
