"""Checks of what a user gives: every fault is an InputError that says what was given, what is allowed, what to do."""

from collections.abc import Collection
from difflib import get_close_matches
from math import inf, isfinite
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypeVar

from faying.errors import InputError, shown
from faying.units import EXAMPLES, parse

__all__ = ["choice", "flag", "instance", "number", "path", "plain", "real", "several", "shown", "text", "whole"]

Kind = TypeVar("Kind")
LONGEST_NAME = 240  # bytes of the name of a file: file systems hold 255, and what is being written has a longer name


def real(value: object, name: str, unit: str = "") -> float:
    """Return a number as a float, NaN and infinity included.

    Args:
        value: a number in the SI unit `unit`, or text with a unit where there is one.
        name: what the error calls it.
        unit: its SI unit; "" for a plain number.

    Raises:
        InputError: for anything else, True and False included.
    """
    if isinstance(value, str) and unit:
        return parse(value, unit, name=name)
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InputError(f"{name} = {shown(value)}; give {_example(unit)}")
    try:
        return float(value)
    except OverflowError:
        raise InputError(f"{name} = {shown(value)}; give {_example(unit)}, within the range of a float") from None


def number(
    value: object,
    name: str,
    unit: str = "",
    *,
    least: float = -inf,
    greatest: float = inf,
    ends: Literal["()", "[)", "(]", "[]"] = "()",
) -> float:
    """Return a finite number as a float.

    Args:
        value, name, unit: as of `real`.
        least, greatest: the allowed range; `ends` tells which ends belong to it.

    Raises:
        InputError: as `real`, and for a number out of range.
    """
    out = real(value, name, unit)
    low = out >= least if ends[0] == "[" else out > least
    high = out <= greatest if ends[1] == "]" else out < greatest
    if not (isfinite(out) and low and high):
        allowed = _range(least, greatest, ends)
        given = f'"{value}"' if isinstance(value, str) else f"{out:.12g}{f' {unit}' if unit else ''}"
        raise InputError(f"{name} = {given}; it must be {allowed}")
    return out


def plain(value: object, name: str, or_words: str = "", *, as_text: bool = True) -> float:
    """Return a plain finite number as a float.

    Args:
        value: the number.
        name: what the error calls it.
        or_words: what else is allowed, as the error says it after the example.
        as_text: whether it may be written as text.

    Raises:
        InputError: for anything else, True and False included.
    """
    kinds = int | float | str if as_text else int | float
    try:
        out = float(value) if isinstance(value, kinds) and not isinstance(value, bool) else inf
    except (ValueError, OverflowError):
        out = inf
    if not isfinite(out):
        raise InputError(f"{name} = {shown(value)} should be a plain finite number, for example 0.3{or_words}")
    return out


def several(
    value: object, name: str, count: int, unit: str = "", *, alike: bool = False, **allowed: Any
) -> tuple[float, ...]:
    """Return so many finite numbers of a list, a tuple or an array as floats.

    Args:
        value: the numbers, each as of `real`.
        name, unit: as of `real`.
        count: how many.
        alike: whether one number stands for all.
        allowed: the range of each, as of `number`.

    Raises:
        InputError: for another count, and as `number`.
    """
    listed = isinstance(value, list | tuple) or getattr(value, "ndim", 0) == 1
    given: list[Any] = list(value) if listed else [value] * count if alike else []  # type: ignore[call-overload]
    if len(given) != count:
        words = f"{count} numbers{f' in {unit}' if unit else ''}{', or one for all' if alike else ''}"
        raise InputError(f"{name} = {shown(value)}; give {words}")
    return tuple(number(one, name, unit, **allowed) for one in given)


def _example(unit: str) -> str:
    if not unit:
        return "a plain number"
    return f'a number in {unit}, or text with a unit, for example "{EXAMPLES.get(unit, f"1 {unit}")}"'


def _range(least: float, greatest: float, ends: str) -> str:
    if least == 0 and greatest == inf:
        return "positive and finite" if ends[0] == "(" else "0 or more, and finite"
    if least > -inf and greatest < inf and ends == "()":
        return f"between {least:g} and {greatest:g}"
    low = f"{'at least' if ends[0] == '[' else 'above'} {least:g}" if least > -inf else ""
    high = f"{'at most' if ends[1] == ']' else 'below'} {greatest:g}" if greatest < inf else ""
    return " and ".join(filter(None, (low, high))) or "finite"


def whole(value: object, name: str, *, least: float = -inf, greatest: float = inf) -> int:
    """Return a whole number within a range, ends included; InputError for anything else, True and False included."""
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise InputError(f"{name} = {shown(value)}; give a whole number, {_range(least, greatest, '[]')}")
    out = int(value)
    if not least <= out <= greatest:
        raise InputError(f"{name} = {shown(out)}; it must be a whole number, {_range(least, greatest, '[]')}")
    return out


def flag(value: object, name: str) -> bool:
    """Return True or False; InputError for anything else."""
    if not isinstance(value, bool):
        raise InputError(f"{name} = {shown(value)}; give True or False")
    return value


def text(value: object, name: str) -> str:
    """Return text; InputError for anything else."""
    if not isinstance(value, str):
        raise InputError(f"{name} = {shown(value)}; give text")
    return value


def path(value: object, name: str) -> Path:
    """Return the path of a file or folder; InputError for what is neither text nor a path, or no file can be called."""
    if not isinstance(value, str | PathLike) or isinstance(value, bytes):
        raise InputError(f"{name} = {shown(value)}; give the name of a file as text, or a Path")
    if not str(value).strip() or "\0" in str(value):
        raise InputError(f"{name} = {shown(value)}: the name is empty or has a zero byte; give the path of a file")
    if any(len(part.encode(errors="surrogateescape")) > LONGEST_NAME for part in Path(value).parts):
        raise InputError(f"{name}: a name of more than {LONGEST_NAME} bytes; give a shorter one")
    return Path(value)


def choice(value: object, name: str, allowed: Collection[str]) -> str:
    """Return one of the allowed words; InputError that lists them, with the nearest."""
    if isinstance(value, str) and value in allowed:
        return value
    near = get_close_matches(value, allowed, n=1) if isinstance(value, str) else []
    hint = f'; did you mean "{near[0]}"?' if near else ""
    words = ", ".join(f'"{word}"' for word in allowed)
    raise InputError(f"{name} = {shown(value)}; allowed: {words}{hint}")


def instance(value: Kind, kind: Any, name: str, remedy: str) -> Kind:
    """Return an object of a class, or of one of several; InputError with the remedy for anything else."""
    if not isinstance(value, kind):
        raise InputError(f"{name}: {shown(value)}; {remedy}")
    return value
