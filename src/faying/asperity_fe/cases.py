"""Many asperities at once: a table of cases in parallel processes, and their results as NetCDF."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from faying import netcdf
from faying.apart import in_processes
from faying.asperity_fe.drive import AsperityCase
from faying.asperity_fe.result import AsperityResult
from faying.errors import FayingError, InputError
from faying.netcdf import Variable
from faying.typing import Array


def _solved(number: int, case: AsperityCase) -> tuple[int, AsperityResult | FayingError]:
    """Solve in a worker; an error travels back as a value, so that the other cases go on."""
    try:
        return number, case.solve()
    except FayingError as fault:
        return number, fault


def solve_cases(
    cases: Sequence[AsperityCase], *, processes: int | None = None, progress: Callable[[int], None] | None = None
) -> list[AsperityResult | FayingError]:
    """Solve cases in parallel processes and return results in the order of the cases.

    processes: as many as there are cores where not given; each uses one thread. progress: called with the number of
    cases done. A case that fails gives its error in place of a result.
    """
    from joblib import parallel_config

    if not cases:
        raise InputError("no cases were given; the table needs at least one row")
    count = min(processes or os.cpu_count() or 1, len(cases))
    if count < 1:
        raise InputError(f"processes = {processes}; at least 1 is needed")
    found: dict[int, AsperityResult | FayingError] = {}
    with parallel_config(backend="loky", inner_max_num_threads=1):
        for number, result in in_processes(_solved, list(enumerate(cases)), count):
            found[number] = result
            if progress is not None:
                progress(len(found))
    return [found[k] for k in range(len(cases))]


def write_netcdf(
    path: str | Path, cases: Sequence[AsperityCase], results: Sequence[AsperityResult | FayingError]
) -> Path:
    """Write inputs, histories and final values of cases as NetCDF-4; histories are filled up with NaN.

    Failed cases keep the steps that they did, with their message in `message`. Raises InputError where the file
    cannot be written; it appears complete or not at all.
    """
    found = [r if isinstance(r, AsperityResult) else getattr(r, "result", None) for r in results]
    messages = ["" if isinstance(r, AsperityResult) else str(r) for r in results]
    longest = max([len(r.history.force) for r in found if r is not None], default=1)
    variables = {
        name: Variable(dims=("case",), values=np.array(values, float), unit=unit)
        for name, (unit, values) in _inputs(cases, found).items()
    }
    for name, unit in (("displacement", "m"), ("force", "N"), ("area", "m2"), ("pressure", "Pa")):
        rows = _padded([None if r is None else getattr(r.history, name) for r in found], (longest,))
        variables[name] = Variable(dims=("case", "step"), values=rows, unit=unit)
    bounds = _padded([None if r is None else r.history.area_bounds for r in found], (longest, 2))
    variables["area_bounds"] = Variable(dims=("case", "step", "bound"), values=bounds, unit="m2")
    variables["message"] = Variable(dims=("case",), values=np.array(messages, dtype=object))
    title = "Single asperities pressed by a smooth rigid plane, axisymmetric finite elements"
    return netcdf.write(Path(path), netcdf.Group(variables=variables, attributes={"title": title}))


def _inputs(
    cases: Sequence[AsperityCase], found: Sequence[AsperityResult | None]
) -> dict[str, tuple[str, list[float]]]:
    """Unit and value of each case, by name."""
    return {
        "R": ("m", [c.R for c in cases]),
        "h_a": ("m", [c.h_a for c in cases]),
        "E_cap": ("Pa", [c.cap.E for c in cases]),
        "E_substrate": ("Pa", [c.substrate.E for c in cases]),
        "yield_cap": ("Pa", [c.cap.yield_strength or np.inf for c in cases]),
        "yield_substrate": ("Pa", [c.substrate.yield_strength or np.inf for c in cases]),
        "hardening": ("1", [c.hardening for c in cases]),
        "layer_thickness": ("m", [c.layer_thickness for c in cases]),
        "residual": ("m", [np.nan if r is None or r.residual is None else r.residual for r in found]),
    }


def _padded(rows: Sequence[Array | None], shape: tuple[int, ...]) -> Array:
    """Rows of different length in one array, filled up with NaN."""
    out = np.full((len(rows), *shape), np.nan)
    for block, values in zip(out, rows, strict=True):
        if values is not None:
            block[: len(values)] = values
    return out
