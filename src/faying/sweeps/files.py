"""What a sweep keeps on disk while it runs, and the NetCDF file it ends in."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from faying import netcdf
from faying.files import load_arrays
from faying.netcdf import Variable
from faying.reduction.reduced import ReducedModel
from faying.study.part_folder import PartFile
from faying.sweeps.axes import Axis, Grid
from faying.typing import Array

OF_MODES = ("frequencies", "loss_factors")  # columns with a value for each mode
ABOVE_RANGE = 0.1  # share of the contact above the end of the law from which a point is noted


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """A finished sweep over a grid of shape g.

    axes; frequencies [Hz], loss_factors [-] (*g, modes); estimate [-], greatest_pressure [Pa], open_share and
    above_range_share [-] (*g): NaN where a point has no answer, for the reason in `reasons` (text -> number of points).
    estimate: relative change of the frequencies when the last part of the basis is left out, far above their error;
    basis: sizes of the bases for equilibrium and vibration; found: points that an interrupted sweep had left; path: the
    NetCDF file.
    """

    title: str
    axes: tuple[Axis, ...]
    frequencies: Array
    loss_factors: Array
    estimate: Array
    greatest_pressure: Array
    open_share: Array
    above_range_share: Array
    reasons: dict[str, int]
    tolerance: float
    unknowns: int
    basis: tuple[int, int]
    path: Path
    found: int = 0

    def unchanged_by(self) -> list[str]:
        """Keys of the axes along which no answer changes by more than the tolerance."""
        answers = [getattr(self, name) for name in (*OF_MODES, "greatest_pressure")]
        return [
            axis.key
            for k, axis in enumerate(self.axes)
            if len(axis.values) > 1
            and all(np.allclose(a, a.take([0], axis=k), rtol=self.tolerance, atol=0, equal_nan=True) for a in answers)
        ]

    def to_dict(self) -> dict[str, Any]:
        """Return a summary ready for JSON; the values themselves are in the file."""
        answered = np.isfinite(self.estimate) & np.isfinite(self.frequencies[..., 0])
        first = self.frequencies[answered]
        span = (first.min(axis=0).tolist(), first.max(axis=0).tolist()) if len(first) else ([], [])
        return {
            "title": self.title,
            "unknowns": self.unknowns,
            "points": int(self.estimate.size),
            "answered": int(answered.sum()),
            "axes": [{"key": a.key, "unit": a.unit or "1", "values": list(a.values)} for a in self.axes],
            "frequency_range": {"unit": "Hz", "lowest": span[0], "highest": span[1]},
            "largest_estimate": float(self.estimate[answered].max()) if np.any(answered) else None,
            "tolerance": self.tolerance,
            "basis": {"equilibrium": self.basis[0], "vibration": self.basis[1]},
            "without_answer": self.reasons,
            "unchanged_by": self.unchanged_by(),
            "found": self.found,
            "beyond_law": int(np.count_nonzero(self.above_range_share > ABOVE_RANGE)),
            "file": str(self.path),
        }


class SweepStore(PartFile):
    """The folder OUT.part beside the output: the reduced model and every chunk that is done."""

    COLUMNS: ClassVar[tuple[str, ...]] = (*OF_MODES, "estimate", "greatest_pressure", "open_share", "above_range_share")

    def __init__(self, out: Path, fingerprint: str, size: int, count: int) -> None:
        super().__init__(out, fingerprint, what="sweep")
        self.out = out
        self.rows: dict[str, Array] = {
            name: np.full((size, count) if name in OF_MODES else size, np.nan) for name in self.COLUMNS
        }
        self.reasons = np.full(size, "", dtype=object)
        self.done = np.zeros(size, dtype=bool)
        self._take_up()

    def _take_up(self) -> None:
        assert self.folder is not None
        chunks = sorted(self.folder.glob("chunk-*.npz"))
        for file in chunks:
            rows = load_arrays(file)
            if rows is None or not {"indices", "reasons", *self.COLUMNS} <= rows.keys():
                file.unlink()  # damaged: its points are evaluated again
                continue
            self._take(rows.pop("indices"), rows)
        self.found = int(self.done.sum())
        self.number = 1 + max((int(file.stem.rpartition("-")[2]) for file in chunks), default=-1)

    def _take(self, indices: Any, rows: dict[str, Array]) -> None:
        for name in self.COLUMNS:
            self.rows[name][indices] = rows[name]
        self.reasons[indices] = rows["reasons"]
        self.done[indices] = True

    def keep(self, indices: Sequence[int], rows: dict[str, Array]) -> None:
        """Note rows and write them, whole or not at all."""
        self._take(np.asarray(indices), rows)
        self.keep_arrays(f"chunk-{self.number:06d}", {"indices": np.asarray(indices), **rows})
        self.number += 1

    def keep_model(self, model: ReducedModel) -> None:
        """Write the reduced model."""
        self.keep_arrays("model", model.arrays())

    def model(self) -> ReducedModel | None:
        """Return the reduced model that an interrupted sweep left, if it came that far."""
        return kept_model(self.arrays("model"))

    def written(self, grid: Grid, *, title: str, tolerance: float, unknowns: int, model: ReducedModel) -> Sweep:
        """Write the NetCDF file and remove what was kept on the way."""
        shaped = {name: self.rows[name].reshape(*grid.shape, *self.rows[name].shape[1:]) for name in self.COLUMNS}
        texts, counts = np.unique(self.reasons[self.reasons != ""].astype(str), return_counts=True)
        done = Sweep(
            title=title,
            axes=grid.axes,
            reasons=dict(zip(texts.tolist(), counts.tolist(), strict=True)),
            tolerance=tolerance,
            unknowns=unknowns,
            basis=(len(model.static_stiffness), len(model.dynamic_mass)),
            path=self.out,
            found=self.found,
            **shaped,
        )
        _netcdf(done)
        self.finish()
        return done


def kept_model(data: Mapping[str, Array] | None) -> ReducedModel | None:
    """The reduced model of what was kept; None where that is missing or damaged."""
    try:
        return None if data is None else ReducedModel.from_arrays(data)
    except KeyError:
        return None


UNITS = {"frequencies": "Hz", "greatest_pressure": "Pa"}


def _netcdf(sweep: Sweep) -> Path:
    """Write the file: one dimension for each axis, called after its key."""
    names = tuple(axis.key.replace(".", "_") for axis in sweep.axes)
    modes = np.arange(1, sweep.frequencies.shape[-1] + 1)
    variables = {"mode": Variable(dims=("mode",), values=modes, long_name="elastic mode")}
    for name, axis in zip(names, sweep.axes, strict=True):
        values = np.array(axis.values, dtype=float if axis.numeric else object)
        variables[name] = Variable(dims=(name,), values=values, unit=axis.unit or "1", long_name=axis.key)
    for column in SweepStore.COLUMNS:
        dims = (*names, "mode") if column in OF_MODES else names
        variables[column] = Variable(dims=dims, values=getattr(sweep, column), unit=UNITS.get(column, "1"))
    attributes: dict[str, str | int | float] = {
        "title": sweep.title or " ",
        "tolerance": sweep.tolerance,
        "unknowns": sweep.unknowns,
        "without_answer": "\n".join(f"{n} points: {text}" for text, n in sweep.reasons.items()) or " ",
    }
    return netcdf.write(sweep.path, netcdf.Group(variables=variables, attributes=attributes))
