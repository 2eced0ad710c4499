"""Trees of named arrays as NetCDF-4 files: the one writer and the one reader."""

import sys
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faying.apart import Died, apart
from faying.errors import ReadError
from faying.files import is_sealed, seal_of, write_atomically

Attribute = str | int | float
PARTS = ("_real", "_imaginary")  # NetCDF has no complex numbers: two variables stand for one


@dataclass(frozen=True, kw_only=True)
class Variable:
    """An array with the names of its dimensions, its unit and what it is. Text, integers, floats or complex numbers."""

    dims: tuple[str, ...]
    values: NDArray[Any]
    unit: str = ""
    long_name: str = ""


@dataclass(frozen=True, kw_only=True)
class Group:
    """Variables, attributes and groups by name. A group sees the dimensions of the groups around it."""

    variables: Mapping[str, Variable] = field(default_factory=dict)
    attributes: Mapping[str, Attribute] = field(default_factory=dict)
    groups: Mapping[str, "Group"] = field(default_factory=dict)


def write(path: Path, root: Group) -> Path:
    """Write a tree; the file appears complete or not at all.

    Args:
        path: the file, whose folder exists.
        root: what to write. Dimensions of one name have one size within a group and those in it.

    Returns:
        The path.

    Raises:
        InputError: the file cannot be written.
    """

    import h5netcdf

    buffer = BytesIO()  # HDF5 itself cannot be stopped tidily where a disk is full
    with h5netcdf.File(buffer, "w") as file:
        _fill(file, root, {})
    data = buffer.getvalue()
    return write_atomically(path, lambda temporary: temporary.write_bytes(data + seal_of(data)))


def _fill(target: Any, group: Group, known: Mapping[str, int]) -> None:
    import h5py

    sizes = dict(known)
    for name, variable in _plain(group.variables).items():
        for dim, size in zip(variable.dims, variable.values.shape, strict=True):
            if dim not in sizes:
                sizes[dim] = target.dimensions[dim] = size
            assert sizes[dim] == size, f"{name}: dimension {dim} has {sizes[dim]} and {size} entries"
        text = variable.values.dtype.kind in "OU"
        data = variable.values.astype(object) if text else variable.values
        kind = h5py.string_dtype() if text else data.dtype
        packed = {} if text or data.size < 1000 else {"compression": "gzip", "compression_opts": 1, "shuffle": True}
        made = target.create_variable(name, variable.dims, dtype=kind, data=data, **packed)
        if variable.unit:
            made.attrs["units"] = variable.unit
        if variable.long_name:
            made.attrs["long_name"] = variable.long_name
    for name, value in group.attributes.items():
        target.attrs[name] = value
    for name, inner in group.groups.items():
        _fill(target.create_group(name), inner, sizes)


def _plain(variables: Mapping[str, Variable]) -> dict[str, Variable]:
    """The variables with complex ones in two parts and truth values as small integers."""
    out = {}
    for name, v in variables.items():
        if np.iscomplexobj(v.values):
            for ending, values, part in zip(PARTS, (v.values.real, v.values.imag), ("real", "imaginary"), strict=True):
                long_name = f"{v.long_name}, {part} part" if v.long_name else ""
                out[name + ending] = Variable(dims=v.dims, values=values, unit=v.unit, long_name=long_name)
        elif v.values.dtype == bool:
            out[name] = Variable(dims=v.dims, values=v.values.astype(np.int8), unit=v.unit, long_name=v.long_name)
        else:
            out[name] = v
    return out


def read(path: Path) -> Group:
    """Read a tree of a NetCDF-4 file.

    What `write` wrote bears a checksum, which is compared before HDF5 sees the file. HDF5 may never return from a
    damaged file, so that a file without a checksum is read by a process of its own, which has `seconds_for` it.

    Raises:
        ReadError: the file is missing, damaged or no NetCDF-4 file.
    """
    if not path.is_file():
        raise ReadError(f"{path}: no such file")
    try:
        sealed = is_sealed(path)
    except OSError as fault:
        raise ReadError(f"{path} cannot be read ({fault.strerror or fault})") from None
    if sealed is False:
        raise ReadError(f"{path} is damaged: its checksum does not fit its bytes; copy it again, or make it anew")
    python = "python" in Path(sys.executable or "").name.lower()  # another program may have Python inside
    return _read_apart(path) if python and not sealed else read_here(path)


def seconds_for(size: int) -> float:
    """How long a file of so many bytes may take to read."""
    return 30.0 + size / 5e6


def _read_apart(path: Path) -> Group:
    """Read a file in a process of its own."""
    try:
        return apart(seconds_for(path.stat().st_size), read_here, path)
    except Died as fault:
        raise ReadError(f"{path} is damaged: HDF5 dies on it or does not return ({fault}); make it anew") from None
    except OSError:  # no process can be started here
        return read_here(path)


def read_here(path: Path) -> Group:
    """Read a tree in this process. Raises ReadError where the file is damaged or no NetCDF-4 file."""
    import h5netcdf

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with h5netcdf.File(path, "r") as file:
                return _taken(file)
    except (OSError, KeyError, ValueError, TypeError, AttributeError, RuntimeError, IndexError) as fault:
        raise ReadError(f"{path} is not a NetCDF-4 file, or is damaged ({type(fault).__name__}: {fault})") from None


def _taken(source: Any) -> Group:
    found: dict[str, Variable] = {}
    for name, variable in source.variables.items():
        values = np.asarray(variable[...])
        if values.dtype.kind in "OS":
            values = np.array([v.decode() if isinstance(v, bytes) else v for v in values.ravel()], dtype=object)
            values = values.reshape(variable.shape)
        attributes = dict(variable.attrs)
        found[name] = Variable(
            dims=tuple(variable.dimensions),
            values=values,
            unit=str(attributes.get("units", "")),
            long_name=str(attributes.get("long_name", "")),
        )
    for name in [n.removesuffix(PARTS[0]) for n in found if n.endswith(PARTS[0])]:
        real, imaginary = (found.pop(name + ending) for ending in PARTS)
        long_name = real.long_name.removesuffix(", real part")
        values = real.values + 1j * imaginary.values
        found[name] = Variable(dims=real.dims, values=values, unit=real.unit, long_name=long_name)
    attributes = {name: _scalar(value) for name, value in source.attrs.items() if not name.startswith("_")}
    groups = {name: _taken(inner) for name, inner in source.groups.items()}
    return Group(variables=found, attributes=attributes, groups=groups)


def _scalar(value: Any) -> Attribute:
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, np.ndarray | Sequence) and not isinstance(value, str):
        value = np.asarray(value).ravel()[0]
    out: Attribute = value.item() if isinstance(value, np.generic) else value
    return out
