"""What a study may say: each key of each table with its unit, range, choices, default and one sentence.

Readers, messages, the JSON schema, the page's form and the reference follow from these declarations.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import partial
from math import inf
from typing import Any

from faying.contact.parameter import FILE, TEXT, Parameter
from faying.study.declaration import values
from faying.study.declaration.values import MAX_COUNT

REQUIRED: Any = object()
NAME = "NAME"  # stands for the names that a user gives
NUMERAL = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
QUANTITY = {"$ref": "#/$defs/quantity"}
NUMBER = {"$ref": "#/$defs/number"}
WORDS = {"type": "string"}
INTEGER = {"type": "integer", "minimum": 1, "maximum": MAX_COUNT}

Schema = Mapping[str, Any]
Read = Callable[[Any, str], Any]
Put = Callable[[Any, Any], Any]


@dataclass(frozen=True, kw_only=True)
class Varies:
    """That a number may vary in sweeps and scatter, while the mesh and the matrices of the parts stay.

    Args:
        put: returns the owner of the number (`study.keys.varied.rooms`) with a value in SI units put in; None puts it
            in the owner's field of that name.
        place: where the number stands in its table, with dots; "" under its own name.
        short: what [uncertain] may call it as well.
    """

    put: Put | None = None
    place: str = ""
    short: str = ""


@dataclass(frozen=True)
class Key:
    """One key that is not a table.

    Args:
        kind: what is written there, in words.
        schema: what is written there, as a JSON schema.
        says: what it means, one sentence.
        default: its value where it is left out, in SI units; REQUIRED where it cannot be left out.
        read: converts what is written, and raises InputError; None where the reader of the table converts it, since
            that depends on other keys.
        unit: SI unit of a quantity.
        allowed: range or choices, in words.
        is_file: whether it names a file.
        parameter: unit, range and choices of one value; None where what is written has more parts, or is not a value.
        varies: how it varies in sweeps and scatter; None where it cannot.
        examples: returns values among those that are often taken, or all that a list outside of the study holds.
    """

    kind: str
    schema: Schema
    says: str
    default: Any = None
    _: KW_ONLY
    read: Read | None = None
    unit: str = ""
    allowed: str = ""
    is_file: bool = False
    parameter: Parameter | None = None
    varies: Varies | None = None
    examples: Callable[[], Iterable[str]] = tuple

    @property
    def default_text(self) -> str:
        """The default as a study writes it; "" where there is none."""
        return "" if self.default is REQUIRED else _written(self.default, self.unit)

    @property
    def value(self) -> Parameter:
        """Unit, range and choices of one value."""
        if self.parameter is None:
            raise TypeError(f"a key that says {self.says!r} has no single value")
        return self.parameter

    def put(self, name: str) -> Put:
        """How a value is put in the owner of this number, whose field has the name where nothing else is declared."""
        own = None if self.varies is None else self.varies.put
        return own or (lambda owner, value: replace(owner, **{name: value}))

    def varying(self, put: Put | None = None, *, place: str = "", short: str = "") -> "Key":
        """The same key, whose number may vary; see `Varies`."""
        return replace(self, varies=Varies(put=put, place=place, short=short))

    @classmethod
    def quantity(
        cls,
        unit: str,
        says: str,
        default: Any = None,
        *,
        positive: bool = True,
        ends: tuple[float, float] | None = None,
    ) -> "Key":
        """A number with its unit, in the range that is given or else that numbers of this unit have."""
        own, ends = ends, ends or (values.RANGES.get(unit) if positive else None)
        return cls(
            f"quantity [{unit}]",
            QUANTITY,
            says,
            default,
            read=lambda value, name: values.quantity(value, unit, name, positive=positive, ends=own),
            unit=unit,
            allowed="positive" if positive and default != 0 else "",
            parameter=Parameter(unit, says, *ends, "[]") if ends else Parameter(unit, says, 0 if positive else -inf),
        )

    @classmethod
    def text(cls, says: str, default: Any = None, choices: tuple[str, ...] = (), **given: Any) -> "Key":
        """Text, one of some choices where they are given."""
        return cls(
            TEXT,
            _one_of(choices),
            says,
            default,
            read=partial(values.text, choices=choices),
            allowed=" or ".join(f'"{word}"' for word in choices),
            parameter=Parameter(TEXT, says, choices=choices),
            **given,
        )

    @classmethod
    def number(cls, says: str, default: Any = None) -> "Key":
        """A plain number."""
        return cls("number", NUMBER, says, default, read=values.number, parameter=Parameter("", says))

    @classmethod
    def within(cls, least: float, greatest: float, says: str, default: Any = None) -> "Key":
        """A plain number from the least to the greatest."""
        read = partial(values.within, least=least, greatest=greatest)
        parameter = Parameter("", says, least, greatest, "[]")
        allowed = f"{least:g} to {greatest:g}"
        return cls("number", NUMBER, says, default, read=read, allowed=allowed, parameter=parameter)

    @classmethod
    def count(cls, says: str, default: Any = None, *, most: int = MAX_COUNT) -> "Key":
        """A whole number from 1."""
        read = partial(values.whole_number, most=most)
        return cls("whole number", INTEGER | {"maximum": most}, says, default, read=read, allowed=f"1 to {most:,}")

    @classmethod
    def truth(cls, says: str, default: bool = False) -> "Key":
        """True or false."""
        return cls("true or false", {"type": "boolean"}, says, default, read=values.truth)

    @classmethod
    def file(cls, says: str, default: Any = None) -> "Key":
        """The name of a file."""
        return cls("file", WORDS, says, default, is_file=True)

    @classmethod
    def point(cls, says: str, default: Any = None) -> "Key":
        """Three lengths."""
        return cls.quantities(values.POINT, "m", 3, says, default)

    @classmethod
    def quantities(cls, form: str, unit: str, count: int, says: str, default: Any = None) -> "Key":
        """So many quantities in a list."""
        read = partial(values.quantities, form=form, unit=unit, count=count)
        return cls(form, listed(QUANTITY, count, count), says, default, read=read, unit=unit)

    @classmethod
    def direction(cls, says: str, default: Any = None) -> "Key":
        """Three numbers that are not all 0."""
        return cls(values.DIRECTION, listed({"type": "number"}, 3, 3), says, default, read=values.direction)

    @classmethod
    def length_unit(cls, says: str) -> "Key":
        """The name of a unit of length, such as "mm"."""
        return cls(TEXT, WORDS, says, read=values.length_unit, examples=lambda: ("mm", "um", "m"))

    @classmethod
    def of_parameter(cls, parameter: Parameter, default: Any = None) -> "Key":
        """A key with the unit, range, choices and words of a parameter of a law or a form."""
        unit = parameter.unit if parameter.is_number else ""
        if parameter.unit == FILE:
            return replace(cls.file(parameter.meaning, default), parameter=parameter)
        if parameter.unit == TEXT:
            schema = _one_of(parameter.choices)
        elif parameter.is_switch:
            schema = {"anyOf": [{"type": "boolean"}, NUMBER]}
        else:
            schema = QUANTITY if unit else NUMBER
        kind = f"quantity [{unit}]" if unit else "number" if parameter.is_number else TEXT
        more: dict[str, Any] = {"unit": unit, "allowed": parameter.allowed, "parameter": parameter}
        return cls(kind, schema, parameter.meaning, default, read=parameter.read, **more)


@dataclass(frozen=True, kw_only=True)
class Inner:
    """A table within a table.

    Args:
        says: what it is, one sentence.
        keys: what stands in it.
        many: whether it is a list of tables, [[...]].
        required: whether it cannot be left out.
        either: whether some of its keys take the place of others, so that the schema asks for none.
        models: returns the parameters that the table has with each law, by the label of the law.
        free: whether it takes keys that no declaration names.
    """

    says: str
    keys: "Declared" = field(default_factory=dict)
    many: bool = False
    required: bool = False
    either: bool = False
    models: Callable[[], Mapping[str, Mapping[str, Key]]] = dict
    free: bool = False


Declared = Mapping[str, Key | Inner]


def _written(value: Any, unit: str) -> str:
    if value is None or value in ("", (), [], {}):
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return "[" + ", ".join(_written(one, unit) for one in value) + "]"
    if isinstance(value, float | int):
        return f'"{value:g} {unit}"' if unit else f"{value:g}"
    return f'"{value}"'


def _one_of(choices: Sequence[str]) -> Schema:
    return {"enum": list(choices)} if len(choices) > 1 else WORDS


def listed(item: Schema, least: int, most: int | None = None) -> dict[str, Any]:
    """The schema of a list of so many items."""
    return {"type": "array", "items": item, "minItems": least} | ({} if most is None else {"maxItems": most})


def one_or_more(item: Schema) -> dict[str, Any]:
    """The schema of one item, or a list of them."""
    return {"anyOf": [item, listed(item, 1)]}


def key_of(declared: Declared, name: str) -> Key:
    """The declaration of a key that is not a table."""
    found = declared[name]
    if not isinstance(found, Key):
        raise TypeError(f"{name} is a table")
    return found


def inner_of(declared: Declared, name: str) -> Inner:
    """The declaration of a table."""
    found = declared[name]
    if not isinstance(found, Inner):
        raise TypeError(f"{name} is not a table")
    return found
