"""What a study may say: each key of each table with its unit, range, choices, default and one sentence.

Readers, messages, the JSON schema, the page's form and the reference follow from these declarations.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from faying.contact.parameter import FILE, TEXT, Parameter
from faying.study.declaration import values
from faying.study.declaration.values import MOST

REQUIRED: Any = object()
NAME = "NAME"  # stands for the names that a user gives
NUMERAL = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
QUANTITY = {"$ref": "#/$defs/quantity"}
NUMBER = {"$ref": "#/$defs/number"}
WORDS = {"type": "string"}
WHOLE = {"type": "integer", "minimum": 1, "maximum": MOST}

Schema = Mapping[str, Any]
Read = Callable[[Any, str], Any]


@dataclass(frozen=True, kw_only=True)
class Key:
    """One key that is not a table.

    Args:
        says: what it means, one sentence.
        kind: what is written there, in words.
        schema: what is written there, as a JSON schema.
        read: converts what is written, and raises InputError; None where the reader of the table converts it, since
            that depends on other keys.
        default: its value where it is left out, in SI units; REQUIRED where it cannot be left out.
        unit: SI unit of a quantity.
        allowed: range or choices, in words.
        is_file: whether it names a file.
        examples: returns values among those that are often taken, or all that a list outside of the study holds.
    """

    says: str
    kind: str
    schema: Schema
    read: Read | None = None
    default: Any = None
    unit: str = ""
    allowed: str = ""
    is_file: bool = False
    examples: Callable[[], Iterable[str]] = tuple

    @property
    def default_text(self) -> str:
        """The default as a study writes it; "" where there is none."""
        return "" if self.default is REQUIRED else _written(self.default, self.unit)


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


def listed(item: Schema, least: int, most: int | None = None) -> dict[str, Any]:
    """The schema of a list of so many items."""
    return {"type": "array", "items": item, "minItems": least} | ({} if most is None else {"maxItems": most})


def one_or_more(item: Schema) -> dict[str, Any]:
    """The schema of one item, or a list of them."""
    return {"anyOf": [item, listed(item, 1)]}


def quantity(unit: str, says: str, default: Any = None, *, positive: bool = True) -> Key:
    """A number with its unit."""
    return Key(
        says=says,
        kind=f"quantity [{unit}]",
        schema=QUANTITY,
        read=lambda value, name: values.quantity(value, unit, name, positive=positive),
        default=default,
        unit=unit,
        allowed="positive" if positive and default != 0 else "",
    )


def text(
    says: str, default: Any = None, choices: tuple[str, ...] = (), *, examples: Callable[[], Iterable[str]] = tuple
) -> Key:
    """Text, one of some choices where they are given."""
    return Key(
        says=says,
        kind="text",
        schema={"enum": list(choices)} if len(choices) > 1 else WORDS,
        read=lambda value, name: values.text(value, name, choices),
        default=default,
        allowed=" or ".join(f'"{word}"' for word in choices),
        examples=examples,
    )


def number(says: str, default: Any = None) -> Key:
    """A plain number."""
    return Key(says=says, kind="number", schema=NUMBER, read=values.number, default=default)


def within(least: float, greatest: float, says: str, default: Any = None) -> Key:
    """A plain number from the least to the greatest."""
    return Key(
        says=says,
        kind="number",
        schema=NUMBER,
        read=lambda value, name: values.within(value, name, least, greatest),
        default=default,
        allowed=f"{least:g} to {greatest:g}",
    )


def count(says: str, default: Any = None, *, most: int = MOST) -> Key:
    """A whole number from 1."""
    return Key(
        says=says,
        kind="whole number",
        schema=WHOLE | {"maximum": most},
        read=lambda value, name: values.whole_number(value, name, most),
        default=default,
        allowed=f"1 to {most:,}",
    )


def truth(says: str, default: bool = False) -> Key:
    """True or false."""
    return Key(says=says, kind="true or false", schema={"type": "boolean"}, read=values.truth, default=default)


def file(says: str, default: Any = None) -> Key:
    """The name of a file."""
    return Key(says=says, kind="file", schema=WORDS, default=default, is_file=True)


def point(says: str, default: Any = None) -> Key:
    """Three lengths."""
    kind = 'three lengths, for example ["0 mm", "10 mm", "0 mm"]'
    return Key(says=says, kind=kind, schema=listed(QUANTITY, 3, 3), read=values.point, default=default, unit="m")


def direction(says: str, default: Any = None) -> Key:
    """Three numbers that are not all 0."""
    kind = "three numbers, for example [1, 0, 0]"
    return Key(says=says, kind=kind, schema=listed({"type": "number"}, 3, 3), read=values.direction, default=default)


def length_unit(says: str) -> Key:
    """The name of a unit of length, such as "mm"."""
    return Key(says=says, kind="text", schema=WORDS, read=values.length_unit, examples=lambda: ("mm", "um", "m"))


def own(
    kind: str,
    schema: Schema,
    says: str,
    default: Any = None,
    *,
    read: Read | None = None,
    unit: str = "",
    allowed: str = "",
    examples: Callable[[], Iterable[str]] = tuple,
) -> Key:
    """A key with a form of its own; read: None where the reader of its table converts it."""
    return Key(
        says=says, kind=kind, schema=schema, read=read, default=default, unit=unit, allowed=allowed, examples=examples
    )


def of_parameter(parameter: Parameter, default: Any = None) -> Key:
    """A key with the unit, range, choices and words of a parameter of a law or a form."""
    unit = parameter.unit if parameter.is_number else ""
    if parameter.unit == FILE:
        return file(parameter.meaning, default)
    choices = list(parameter.choices)
    if parameter.unit == TEXT:
        schema: Schema = {"enum": choices} if len(choices) > 1 else WORDS
    elif parameter.is_switch:
        schema = {"anyOf": [{"type": "boolean"}, NUMBER]}
    else:
        schema = QUANTITY if unit else NUMBER
    return Key(
        says=parameter.meaning,
        kind=f"quantity [{unit}]" if unit else "number" if parameter.is_number else TEXT,
        schema=schema,
        read=parameter.read,
        default=default,
        unit=unit,
        allowed=parameter.allowed,
    )


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
