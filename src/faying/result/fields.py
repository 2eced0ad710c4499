"""Dataclasses of arrays as trees for NetCDF, and back, from what their fields declare."""

import json
import types
from collections.abc import Collection, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np

from faying import netcdf
from faying.errors import InputError, ReadError
from faying.netcdf import Attribute, Group, Variable

Whole = TypeVar("Whole")
KEY = "variable"


@dataclass(frozen=True, kw_only=True)
class Declared:
    """What a field that holds an array declares: name in the file, dimensions, SI unit, long name, kind of number.

    gaps: whether NaN may stand in it, for what was not predicted.
    """

    name: str
    dims: tuple[str, ...]
    unit: str
    long_name: str
    dtype: str
    gaps: bool = False


def variable(
    *dims: str,
    unit: str,
    long_name: str,
    dtype: str = "f8",
    name: str = "",
    gaps: bool = False,
    default: Any = MISSING,
) -> Any:
    """Declare a field of a dataclass as an array with named dimensions; writer, reader, JSON and tables follow."""
    declared = Declared(name=name, dims=dims, unit=unit, long_name=long_name, dtype=dtype, gaps=gaps)
    return field(metadata={KEY: declared}, **({} if default is MISSING else {"default": default}))


class Recorded:
    """What a dataclass of declared arrays does: they are checked and frozen, and two of them are equal part by part."""

    def __post_init__(self) -> None:
        for name, meta in declared(type(self)).items():
            if getattr(self, name) is None:
                continue
            value = np.asarray(getattr(self, name), dtype=meta.dtype)
            if not np.all(np.isfinite(value) | (meta.gaps and np.isnan(value))):
                raise InputError(f"NaN in {name}; this is a fault of the input or of Faying, please report it")
            value.setflags(write=False)
            object.__setattr__(self, name, value)

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and same(self, other)

    __hash__ = None  # type: ignore[assignment]


def declared(kind: Any) -> dict[str, Declared]:
    """What the array fields of a dataclass declare, by the name of the field."""
    return {f.name: f.metadata[KEY] for f in fields(kind) if KEY in f.metadata}


def listed(values: Any) -> Any:
    """Arrays as nested lists for JSON, None in place of NaN."""
    array = np.asarray(values)
    if array.dtype.kind != "f" or not np.isnan(array).any():
        return array.tolist()
    plain = array.astype(object)
    plain[np.isnan(array)] = None
    return plain.tolist()


def in_units(value: Any, *, without: Collection[str] = ()) -> dict[str, Any]:
    """Return the array fields of a dataclass for JSON, {name: {"unit", "values"}}.

    Left out are fields that are None and those with a dimension of `without`.
    """
    return {
        name: {"unit": meta.unit, "values": listed(getattr(value, name))}
        for name, meta in declared(type(value)).items()
        if getattr(value, name) is not None and not set(without) & set(meta.dims)
    }


def to_group(value: Any) -> Group:
    """Turn a dataclass into a tree: arrays to variables, dataclasses to groups, all else to attributes."""
    variables: dict[str, Variable] = {}
    attributes: dict[str, Attribute] = {}
    groups: dict[str, Group] = {}
    for f in fields(value):
        item = getattr(value, f.name)
        meta: Declared | None = f.metadata.get(KEY)
        if item is None:
            continue
        if meta is not None:
            array = np.asarray(item)
            variables[meta.name or f.name] = Variable(
                dims=meta.dims, values=array, unit=meta.unit, long_name=meta.long_name
            )
        elif isinstance(item, np.ndarray):
            dims = tuple(f"{f.name}_{k}" for k in range(item.ndim))
            variables[f.name] = Variable(dims=dims, values=item)
        elif _is_arrays(item):
            for k, part in enumerate(item):
                dims = tuple(f"{f.name}_{k}_{j}" for j in range(part.ndim))
                variables[f"{f.name}.{k}"] = Variable(dims=dims, values=part)
        elif is_dataclass(item):
            groups[f.name] = to_group(item)
        elif _is_recorded(item):
            groups |= {f"{f.name}.{k}": to_group(part) for k, part in enumerate(item)}
        elif isinstance(item, str | int | float) and not isinstance(item, bool):
            attributes[f.name] = item if item != "" else " "  # an empty attribute is none
        else:
            attributes[f.name] = json.dumps(item, default=_jsonable, ensure_ascii=False)
    return Group(variables=variables, attributes=attributes, groups=groups)


def write_whole(value: Any, path: str | Path, labels: Mapping[str, Any]) -> Path:
    """Write a dataclass as NetCDF-4 that xarray opens, with labels of its dimensions; whole or not at all."""
    group = to_group(value)
    coordinates = {
        name: Variable(dims=(name,), values=np.asarray(item, dtype=object if isinstance(item, tuple) else None))
        for name, item in labels.items()
    }
    attributes = {"Conventions": "CF-1.11", **group.attributes}
    whole = Group(variables={**coordinates, **group.variables}, attributes=attributes, groups=group.groups)
    return netcdf.write(Path(path), whole)


def read_whole(kind: type[Whole], path: str | Path, *, what: str, command: str) -> Whole:
    """Read what `write_whole` wrote. Raises ReadError, with the command that writes one, where it cannot be read."""
    file = Path(path)
    if not file.is_file():
        raise ReadError(f"{file}: no such file; write one with: {command}")
    try:
        return from_group(kind, netcdf.read(file))
    except (ReadError, TypeError, KeyError, ValueError, AttributeError) as fault:
        raise ReadError(f"{file}: no {what} of Faying, or damaged ({fault}); write one with: {command}") from None


def _is_arrays(item: Any) -> bool:
    return isinstance(item, tuple) and bool(item) and all(isinstance(part, np.ndarray) for part in item)


def _is_recorded(item: Any) -> bool:
    return isinstance(item, tuple) and bool(item) and all(isinstance(part, Recorded) for part in item)


def _jsonable(item: Any) -> Any:
    if is_dataclass(item):
        return {f.name: getattr(item, f.name) for f in fields(item)}
    if isinstance(item, np.generic):
        return item.item()
    if isinstance(item, Mapping):
        return dict(item)
    raise TypeError(f"{type(item).__name__} has no place in a file")


def from_group(kind: type[Whole], group: Group) -> Whole:
    """Return the dataclass that a tree was made of."""
    given: dict[str, Any] = {}
    hints = get_type_hints(kind)
    for f in fields(cast(Any, kind)):
        meta: Declared | None = f.metadata.get(KEY)
        name = meta.name or f.name if meta is not None else f.name
        hint = _without_none(hints[f.name])
        if name in group.variables and (meta is not None or name not in group.attributes):  # else labels of its name
            values = group.variables[name].values
            given[f.name] = values.astype(meta.dtype) if meta is not None else _as_hinted(values, hint)
        elif f"{f.name}.0" in group.variables:
            count = sum(key.startswith(f"{f.name}.") for key in group.variables)
            given[f.name] = tuple(group.variables[f"{f.name}.{k}"].values for k in range(count))
        elif f"{f.name}.0" in group.groups:
            count = sum(key.startswith(f"{f.name}.") for key in group.groups)
            kind_of_part = get_args(hint)[0]
            given[f.name] = tuple(from_group(kind_of_part, group.groups[f"{f.name}.{k}"]) for k in range(count))
        elif f.name in group.groups:
            given[f.name] = from_group(hint, group.groups[f.name])
        elif f.name in group.attributes:
            value = group.attributes[f.name]
            if hint is str:
                given[f.name] = "" if value == " " else str(value)
            elif hint in (int, float):
                given[f.name] = hint(value)
            else:
                given[f.name] = _rebuilt(hint, json.loads(str(value)))
        elif f.default is MISSING and f.default_factory is MISSING:
            given[f.name] = None
    return kind(**given)


def _as_hinted(values: Any, hint: Any) -> Any:
    """Truth values were written as small integers."""
    text = str(hint)
    return values.astype(bool) if "bool" in text and values.dtype.kind == "i" else values


def _without_none(hint: Any) -> Any:
    if get_origin(hint) in (Union, types.UnionType):
        rest = [part for part in get_args(hint) if part is not type(None)]
        return rest[0] if len(rest) == 1 else hint
    return hint


def _rebuilt(hint: Any, value: Any) -> Any:
    """A value from JSON in the types that the hint names."""
    hint = _without_none(hint)
    origin, inner = get_origin(hint), get_args(hint)
    if value is None:
        return None
    if is_dataclass(hint) and isinstance(hint, type):
        hints = get_type_hints(hint)
        return hint(**{name: _rebuilt(hints[name], part) for name, part in value.items()})
    if isinstance(hint, type) and issubclass(hint, tuple) and hasattr(hint, "_fields"):
        return hint(*value)
    if origin is tuple:
        kinds = [inner[0]] * len(value) if len(inner) == 2 and inner[1] is Ellipsis else inner
        return tuple(_rebuilt(kind, part) for kind, part in zip(kinds, value, strict=True))
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {_key(inner[0], key): _rebuilt(inner[1], part) for key, part in value.items()}
    return float(value) if hint is float else value


def _key(kind: Any, key: str) -> Any:
    return int(key) if kind is int else key


def same(first: Any, second: Any) -> bool:
    """Whether two values are equal, arrays and dataclasses compared part by part; NaN equals NaN."""
    if isinstance(first, np.ndarray) or isinstance(second, np.ndarray):
        a, b = np.asarray(first), np.asarray(second)
        return a.shape == b.shape and bool(
            np.array_equal(a, b, equal_nan=a.dtype.kind in "fc" and b.dtype.kind in "fc")
        )
    if is_dataclass(first) and not isinstance(first, type):
        return type(first) is type(second) and all(
            same(getattr(first, f.name), getattr(second, f.name)) for f in fields(first)
        )
    if isinstance(first, Mapping) and isinstance(second, Mapping):
        return first.keys() == second.keys() and all(same(first[key], second[key]) for key in first)
    if isinstance(first, tuple) and isinstance(second, tuple):
        return len(first) == len(second) and all(same(a, b) for a, b in zip(first, second, strict=True))
    return bool(first == second) or (first is not None and first != first and second != second)
