"""Dataclasses of arrays as trees for NetCDF, and back, from what their fields declare."""

import json
import types
from collections.abc import Collection, Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np

from faying import checks, netcdf
from faying.errors import InputError, ReadError
from faying.misuse import checked_call, shortened
from faying.netcdf import Attribute, Group, Variable
from faying.style import Summary
from faying.typing import Array
from faying.units import load_text, show

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import DataTree

Kind = TypeVar("Kind")
KEY = "variable"
GROUP = "group"
MAX_ARRAYS = 10  # that a summary has a line for
RESULT_FILE = "result.nc"  # in the folder of a run
RECORD = "faying_record"  # attribute of a file: what it holds
PRELOAD = "preload"  # numbers that belong to the labels of loads


@dataclass(frozen=True, kw_only=True)
class ShownAs:
    """Where a quantity of a result is shown.

    Args:
        column: Its head in modes.csv, for a quantity of modes; "" for none.
        chapter: Of the report, in which its table and its figure stand; "" for neither. A terminal has the table.
        title, line, below: Heading of the table, the line above it in a terminal, what the report says below it.
        form: Of a number in the table.
        caption: Of the figure against preload; "" for none.
    """

    column: str = ""
    chapter: str = ""
    title: str = ""
    line: str = ""
    below: str = ""
    form: str = ".4g"
    caption: str = ""


@dataclass(frozen=True, kw_only=True)
class RecordedQuantity:
    """What a field that holds an array declares: name in the file, dimensions, SI unit, long name, kind of number.

    gaps: whether NaN may stand in it, for what was not predicted; group: of the file, its root where empty; shown:
    where tables and figures have it.
    """

    name: str
    dims: tuple[str, ...]
    unit: str
    long_name: str
    dtype: str
    gaps: bool = False
    group: str = ""
    shown: ShownAs = field(default_factory=ShownAs)

    @property
    def unit_text(self) -> str:
        """The unit as heads of columns have it."""
        return "-" if self.unit == "1" else self.unit


def variable(
    dims: str,
    unit: str,
    long_name: str,
    path: str = "",
    *,
    dtype: str = "f8",
    gaps: bool = False,
    shown: ShownAs | str = "",
    default: Any = MISSING,
) -> Any:
    """Declare a field of a dataclass as an array with named dimensions; writer, reader, JSON and tables follow.

    dims: names of the dimensions, with blanks between; path: group and name in the file, "modes/frequency"; the name is
    that of the field in "modes/", and the group is the root without a stroke; shown: a text is the column of `ShownAs`;
    the rest as in `RecordedQuantity`.
    """
    group, _, name = path.rpartition("/")
    declared = RecordedQuantity(
        name=name,
        dims=tuple(dims.split()),
        unit=unit,
        long_name=long_name,
        dtype=dtype,
        gaps=gaps,
        group=group,
        shown=ShownAs(column=shown) if isinstance(shown, str) else shown,
    )
    return field(metadata={KEY: declared}, **({} if default is MISSING else {"default": default}))


def optional(dims: str, unit: str, long_name: str, path: str = "", **more: Any) -> Any:
    """Declare a `variable` that may be None, as where a study asks for less."""
    return variable(dims, unit, long_name, path, default=None, **more)


def group(prefix: str) -> Any:
    """Declare a field that is a dataclass of `Arrays`, or None: a group of quantities that a study may ask for.

    A file, JSON and tables have its arrays as if they stood in its owner. prefix: of their names in JSON, and of its
    texts in a file.
    """
    return field(default=None, metadata={GROUP: prefix})


class Arrays(Summary):
    """What a dataclass of declared arrays does: they are checked and frozen. Two are equal part by part."""

    def __post_init__(self) -> None:
        for name, meta in declared(type(self)).items():
            if getattr(self, name) is None:
                continue
            value = array_of(name, getattr(self, name), meta)
            if not np.all(np.isfinite(value) | (meta.gaps and np.isnan(value))):
                raise InputError(f"NaN in {name}; this is a fault of the input or of Faying, please report it")
            value.setflags(write=False)
            object.__setattr__(self, name, value)

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and same(self, other)

    __hash__ = None  # type: ignore[assignment]

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and its arrays with their dimensions and units."""
        there = [(name, meta) for name, meta in declared(type(self)).items() if getattr(self, name) is not None]
        rows = {name: f"({', '.join(meta.dims)}) [{meta.unit}]" for name, meta in there[:MAX_ARRAYS]}
        return type(self).__name__, rows


class Recorded(Arrays):
    """Declared arrays that are saved, loaded and handed to xarray.

    KIND: what messages call it, which the file says as well; COMMAND: what writes one.
    """

    KIND: ClassVar[str] = "record"
    COMMAND: ClassVar[str] = ""

    def labels(self) -> dict[str, Any]:
        """Labels of the dimensions of its arrays, by the name of the dimension."""
        return {}

    def tree(self) -> Group:
        """Return it as a tree of named arrays, as a file holds it."""
        group = to_group(self)
        coordinates = {
            name: Variable(dims=(name,), values=np.asarray(one, object if isinstance(one, tuple | list) else None))
            for name, one in self.labels().items()
        }
        attributes = {"Conventions": "CF-1.11", RECORD: self.KIND, **group.attributes}
        return with_preload(replace(group, variables={**coordinates, **group.variables}, attributes=attributes))

    @classmethod
    def of_tree(cls, tree: Group) -> Self:
        """Return what a tree was made of. Raises ReadError that names what it lacks."""
        return from_group(cls, tree)

    def refuse_strays(self) -> None:
        """Raise ReadError where a number of it points to what it does not hold."""

    @checked_call
    def save(self, path: str | Path) -> Path:
        """Write everything as NetCDF-4 that xarray opens; the file appears complete or not at all.

        Args:
            path: The file, ending in .nc, in a folder that exists.

        Returns:
            The path.

        Raises:
            InputError: The file cannot be written.
        """
        if not Path(path).name:
            raise InputError(f'path = {shortened(path)} is not a file; give its name, such as "{self.KIND}.nc"')
        return netcdf.write(Path(path), self.tree())

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read what `save` wrote; it equals what was written.

        Args:
            path: The file.

        Returns:
            What the file holds.

        Raises:
            ReadError: The file is missing or damaged, holds something else, or lacks a variable, which is named.
        """
        return cls.of_file(path, read_tree(path, cls.KIND, cls.COMMAND))

    @classmethod
    def of_file(cls, path: str | Path, tree: Group) -> Self:
        """Return what a file holds, whose tree is read already. Raises ReadError as `load`."""
        command = f"; write one with: {cls.COMMAND}" if cls.COMMAND else ""
        found = tree.attributes.get(RECORD, cls.KIND)
        if found != cls.KIND:
            raise ReadError(f"{path} has a {found}, not a {cls.KIND}; read it with faying.load")
        try:
            made = cls.of_tree(tree)
            made.refuse_strays()
            return made
        except (ReadError, InputError, TypeError, KeyError, ValueError, AttributeError, IndexError) as fault:
            raise ReadError(f"{path}: no {cls.KIND} of Faying, or damaged ({fault}){command}") from None

    def to_xarray(self) -> "DataTree":
        """Return the arrays as an xarray.DataTree, as `xarray.open_datatree` reads them from the file."""
        import tempfile

        import xarray

        with tempfile.TemporaryDirectory() as folder:
            tree = xarray.open_datatree(self.save(Path(folder) / "record.nc"), engine="h5netcdf")
            with tree:
                return tree.load()

    @checked_call
    def to_dataframe(self, group: str) -> "DataFrame":
        """Return a group of the tree as a pandas.DataFrame.

        Args:
            group: Name of the group, such as "modes".

        Returns:
            One row for each combination of labels, those variables as columns whose dimensions are among those of the
            first one. Units are in `attrs["units"]`, by column.

        Raises:
            InputError: There is no such group; the text lists the groups.
        """
        found = {name: one.variables for name, one in self.tree().groups.items() if one.variables}
        if not isinstance(group, str) or group not in found:
            raise InputError(f"group = {shortened(group)}; the groups are {', '.join(map(repr, found))}")
        dims = next(one.dims for name, one in found[group].items() if name != PRELOAD)
        columns = {name: one.unit for name, one in found[group].items() if one.dims and set(one.dims) <= set(dims)}
        columns = {name: columns[name] for name in sorted(columns, key=lambda name: name != PRELOAD)}
        data = self.to_xarray()[group].to_dataset()[list(columns)]
        table = data.to_dataframe(dim_order=dims)[list(columns)]
        table.attrs["units"] = columns
        return table


def array_of(name: str, given: Any, meta: RecordedQuantity) -> Any:
    """What a field holds as an array. Raises InputError where it is none, or has other dimensions."""
    try:
        value = np.asarray(given, dtype=meta.dtype)
    except (TypeError, ValueError):
        value = None
    if value is None or value.ndim != len(meta.dims):
        raise InputError(f"{name} = {shortened(given)}; give an array of numbers ({', '.join(meta.dims)})")
    return value


def declared(kind: Any) -> dict[str, RecordedQuantity]:
    """What the array fields of a dataclass declare, by the name of the field."""
    return {f.name: f.metadata[KEY] for f in fields(kind) if KEY in f.metadata}


def quantities(value: Any) -> Iterator[tuple[str, RecordedQuantity, Any]]:
    """Name, declaration and values of the array fields that are there, those of its groups with their prefix."""
    for f in fields(value):
        item = getattr(value, f.name)
        if item is not None and KEY in f.metadata:
            yield f.name, f.metadata[KEY], item
        elif item is not None and GROUP in f.metadata:
            yield from ((f"{f.metadata[GROUP]}_{name}", meta, array) for name, meta, array in quantities(item))


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
        name: {"unit": meta.unit, "values": listed(array)}
        for name, meta, array in quantities(value)
        if not set(without) & set(meta.dims)
    }


def to_group(value: Any) -> Group:
    """Turn a dataclass into a tree: arrays to variables, dataclasses to groups, all else to attributes."""
    variables: dict[str, dict[str, Variable]] = {"": {}}
    attributes: dict[str, Attribute] = {}
    groups: dict[str, Group] = {}
    for f in fields(value):
        item = getattr(value, f.name)
        meta: RecordedQuantity | None = f.metadata.get(KEY)
        if item is None:
            continue
        if meta is not None:
            array = np.asarray(item)
            into = variables.setdefault(meta.group, {})
            into[meta.name or f.name] = Variable(dims=meta.dims, values=array, unit=meta.unit, long_name=meta.long_name)
        elif isinstance(item, np.ndarray):
            dims = tuple(f"{f.name}_{k}" for k in range(item.ndim))
            variables[""][f.name] = Variable(dims=dims, values=item)
        elif _some_of(np.ndarray, item):
            for k, part in enumerate(item):
                dims = tuple(f"{f.name}_{k}_{j}" for j in range(part.ndim))
                variables[""][f"{f.name}.{k}"] = Variable(dims=dims, values=part)
        elif GROUP in f.metadata:
            of_group = to_group(item)
            variables[""] |= of_group.variables
            attributes |= {f"{f.metadata[GROUP]}_{name}": one for name, one in of_group.attributes.items()}
            for name, own in of_group.groups.items():
                variables[name] = {**variables.get(name, {}), **own.variables}
        elif is_dataclass(item):
            groups[f.name] = to_group(item)
        elif _some_of(Recorded, item):
            groups |= {f"{f.name}.{k}": to_group(part) for k, part in enumerate(item)}
        elif isinstance(item, str | int | float) and not isinstance(item, bool):
            attributes[f.name] = item if item != "" else " "  # an empty attribute is none
        else:
            attributes[f.name] = json.dumps(item, default=_jsonable, ensure_ascii=False)
    root = variables.pop("")
    for name, inside in variables.items():
        inner = groups.get(name, Group())
        groups[name] = replace(inner, variables={**inside, **inner.variables})
    return Group(variables=root, attributes=attributes, groups=groups)


def with_preload(tree: Group) -> Group:
    """A tree whose loads have labels, with the preloads of the root as a coordinate of each group with loads."""
    preload = tree.variables.get(PRELOAD)
    if preload is None or preload.dims != ("load",):
        return tree

    def lend(group: Group) -> Group:
        groups = {name: lend(inner) for name, inner in group.groups.items()}
        if not any("load" in one.dims for one in group.variables.values()):
            return replace(group, groups=groups)
        variables = {**group.variables, PRELOAD: group.variables.get(PRELOAD, preload)}
        return Group(variables=variables, attributes={**group.attributes, "coordinates": PRELOAD}, groups=groups)

    return lend(tree)


def load_texts(loads: Array) -> tuple[str, ...]:
    """Loads [N] in words, each different from the others: "8 kN"; "no preload" where there is none."""
    for digits in range(4, 17):
        words = tuple(show(float(load), "N", digits=digits) if load else load_text(load) for load in loads)
        if len(set(words)) == len(words):
            return words
    return tuple(repr(float(load)) for load in loads)


def read_tree(path: str | Path, kind: str = "file", command: str = "") -> Group:
    """Read the tree of a file; kind: what it should hold. Raises ReadError where it is missing or no NetCDF-4 file."""
    file = checks.path(path, "path")
    hint = f"; write one with: {command}" if command else ""
    if not file.is_file():
        raise ReadError(f"{file}: no such file{hint}")
    try:
        return netcdf.read(file)
    except ReadError as fault:
        raise ReadError(f"{file}: no {kind} of Faying, or damaged ({fault}){hint}") from None


def _some_of(kind: type, item: Any) -> bool:
    """Whether it is a tuple of one or more of a kind."""
    return isinstance(item, tuple) and bool(item) and all(isinstance(part, kind) for part in item)


def _jsonable(item: Any) -> Any:
    if is_dataclass(item):
        return {f.name: getattr(item, f.name) for f in fields(item)}
    if isinstance(item, np.generic):
        return item.item()
    if isinstance(item, Mapping):
        return dict(item)
    raise TypeError(f"{type(item).__name__} has no place in a file")


def from_group(kind: type[Kind], group: Group) -> Kind:
    """Return the dataclass that a tree was made of."""
    given: dict[str, Any] = {}
    hints = get_type_hints(kind)
    for f in fields(cast(Any, kind)):
        meta: RecordedQuantity | None = f.metadata.get(KEY)
        name, hint = f.name, _without_none(hints[f.name])
        inner = group.groups.get(meta.group, Group()) if meta is not None and meta.group else group
        if meta is not None and (meta.name or name) in inner.variables:
            given[name] = inner.variables[meta.name or name].values.astype(meta.dtype)
        elif GROUP in f.metadata:
            given[name] = _group_of(cast(Any, hint), f.metadata[GROUP], group)
        elif meta is None and name in group.variables and name not in group.attributes:  # else labels of its name
            values = group.variables[name].values
            truth = "bool" in str(hint) and values.dtype.kind == "i"  # written as small integers
            given[name] = values.astype(bool) if truth else values
        elif f"{name}.0" in group.variables:
            count = sum(key.startswith(f"{name}.") for key in group.variables)
            given[name] = tuple(group.variables[f"{name}.{k}"].values for k in range(count))
        elif f"{name}.0" in group.groups:
            count = sum(key.startswith(f"{name}.") for key in group.groups)
            kind_of_part: Any = get_args(hint)[0]
            given[name] = tuple(from_group(kind_of_part, group.groups[f"{name}.{k}"]) for k in range(count))
        elif name in group.groups and is_dataclass(hint):
            given[name] = from_group(cast(Any, hint), group.groups[name])
        elif name in group.attributes:
            value = group.attributes[name]
            if hint is str:
                given[name] = "" if value == " " else str(value)
            elif hint in (int, float):
                given[name] = hint(value)
            else:
                given[name] = _rebuilt(hint, json.loads(str(value)))
        elif f.default is MISSING and f.default_factory is MISSING:
            if hint is hints[name]:
                where = f" in its group {meta.group!r}" if meta is not None and meta.group else ""
                raise ReadError(f"it lacks {meta.name or name if meta is not None else name!r}{where}")
            given[name] = None
    return kind(**given)


def _group_of(kind: Any, prefix: str, owner: Group) -> Any:
    """A group of quantities from the tree of its owner; None where that has nothing of it."""
    found = declared(kind)
    if not any((one.name or name) in owner.groups.get(one.group, Group()).variables for name, one in found.items()):
        return None
    own = {
        name.removeprefix(f"{prefix}_"): one for name, one in owner.attributes.items() if name.startswith(f"{prefix}_")
    }
    return from_group(kind, replace(owner, attributes=own))


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
        return {int(key) if inner[0] is int else key: _rebuilt(inner[1], part) for key, part in value.items()}
    return float(value) if hint is float else value


def same(first: Any, second: Any) -> bool:
    """Whether two values are equal, arrays and dataclasses compared part by part; NaN equals NaN."""
    if isinstance(first, np.ndarray) or isinstance(second, np.ndarray):
        a, b = np.asarray(first), np.asarray(second)
        return bool(np.array_equal(a, b, equal_nan=a.dtype.kind in "fc" and b.dtype.kind in "fc"))
    if is_dataclass(first) and not isinstance(first, type):
        return type(first) is type(second) and all(
            same(getattr(first, f.name), getattr(second, f.name)) for f in fields(first)
        )
    if isinstance(first, Mapping) and isinstance(second, Mapping):
        return first.keys() == second.keys() and all(same(first[key], second[key]) for key in first)
    if isinstance(first, tuple) and isinstance(second, tuple):
        return len(first) == len(second) and all(same(a, b) for a, b in zip(first, second, strict=True))
    return bool(first == second) or (first is not None and first != first and second != second)
