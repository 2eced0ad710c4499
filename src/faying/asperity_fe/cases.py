"""Many asperities at once: a table of cases in parallel processes, and their results as NetCDF."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Literal

import numpy as np

from faying.asperity_fe.drive import AsperityResult, solve_asperity
from faying.errors import FayingError, InputError
from faying.files import write_atomically
from faying.materials import Material


@dataclass(frozen=True, kw_only=True)
class AsperityCase:
    """Arguments of `solve_asperity`, to be solved later or elsewhere."""

    R: float
    h_a: float
    cap: Material
    substrate: Material
    displacement: tuple[float, ...] | None = None
    force: tuple[float, ...] | None = None
    layer: Material | None = None
    layer_thickness: float = 0.0
    hardening: float = 0.0
    foot: Literal["bonded", "sliding"] = "bonded"
    elements: int = 40
    steps: int | None = None
    domain: float | None = None
    solver: str | None = None

    def solve(self) -> AsperityResult:
        """Solve this case."""
        return solve_asperity(**{f.name: getattr(self, f.name) for f in fields(self)})


def _solved(case: AsperityCase) -> AsperityResult | FayingError:
    """Solve in a worker; an error travels back as a value, so that the other cases go on."""
    try:
        return case.solve()
    except FayingError as fault:
        return fault


def solve_cases(
    cases: Sequence[AsperityCase], *, processes: int | None = None, progress: Callable[[int], None] | None = None
) -> list[AsperityResult | FayingError]:
    """Solve cases in parallel processes and return results in the order of the cases.

    processes: as many as there are cores where not given; each uses one thread. progress: called with the number of
    cases done. A case that fails gives its error in place of a result.
    """
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from multiprocessing import get_context

    if not cases:
        raise InputError("no cases were given; the table needs at least one row")
    count = min(processes or os.cpu_count() or 1, len(cases))
    if count < 1:
        raise InputError(f"processes = {processes}; at least 1 is needed")
    if count == 1:
        alone: list[AsperityResult | FayingError] = []
        for number, case in enumerate(cases):
            alone.append(_solved(case))
            if progress is not None:
                progress(number + 1)
        return alone
    # "spawn": the children start clean and so take the thread limits, which libraries read when they are loaded
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    before = {name: os.environ.get(name) for name in names}
    os.environ.update(dict.fromkeys(names, "1"))
    try:
        with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
            futures = [pool.submit(_solved, case) for case in cases]
            for number, _ in enumerate(as_completed(futures)):
                if progress is not None:
                    progress(number + 1)
            return [future.result() for future in futures]
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def write_netcdf(
    path: str | Path, cases: Sequence[AsperityCase], results: Sequence[AsperityResult | FayingError]
) -> Path:
    """Write inputs, histories and final values of cases as NetCDF-3; histories are filled up with NaN.

    Failed cases keep the steps that they did, with their message in `message`. Raises InputError where the file
    cannot be written; it appears whole or not at all.
    """
    from scipy.io import netcdf_file

    found = [r if isinstance(r, AsperityResult) else getattr(r, "result", None) for r in results]
    messages = ["" if isinstance(r, AsperityResult) else str(r) for r in results]
    longest = max([len(r.history.force) for r in found if r is not None], default=1)
    width = max([len(m) for m in messages] + [1])

    def write(temporary: Path) -> None:
        with netcdf_file(temporary, "w", version=2) as nc:
            nc.title = "Single asperities pressed by a smooth rigid plane, axisymmetric finite elements"
            for name, size in (("case", len(cases)), ("step", longest), ("bound", 2), ("letter", width)):
                nc.createDimension(name, size)
            inputs = {
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
            for name, (unit, values) in inputs.items():
                variable = nc.createVariable(name, "f8", ("case",))
                variable[:] = np.array(values, float)
                variable.units = unit
            for name, unit in (("displacement", "m"), ("force", "N"), ("area", "m2"), ("pressure", "Pa")):
                variable = nc.createVariable(name, "f8", ("case", "step"))
                block = np.full((len(cases), longest), np.nan)
                for row, result in zip(block, found, strict=True):
                    if result is not None:
                        values = getattr(result.history, name)
                        row[: len(values)] = values
                variable[:] = block
                variable.units = unit
            variable = nc.createVariable("area_bounds", "f8", ("case", "step", "bound"))
            bounds = np.full((len(cases), longest, 2), np.nan)
            for rows, result in zip(bounds, found, strict=True):
                if result is not None:
                    rows[: len(result.history.force)] = result.history.area_bounds
            variable[:] = bounds
            variable.units = "m2"
            variable = nc.createVariable("message", "c", ("case", "letter"))
            variable[:] = np.array([list(m.ljust(width)) for m in messages], "S1")

    return write_atomically(Path(path), write)
