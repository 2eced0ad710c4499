"""The result of a study: frozen arrays with names, units and flags, written as NetCDF, CSV or JSON."""

import csv
import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.files import write_atomically
from faying.measured.compare import ModalComparison
from faying.typing import Array, Complex, Index

UNITS = {
    "loads": "N",
    "frequencies": "Hz",
    "loss_factors": "1",
    "loss_error": "1",
    "tied": "Hz",
    "free": "Hz",
    "rigid": "Hz",
    "pressure": "Pa",
    "k_n": "Pa/m",
    "k_t": "Pa/m",
    "points": "m",
    "weights": "m2",
    "outline": "m",
    "shapes": "kg^-1/2",
    "bolt_forces": "N",
    "slipping": "1",
    "mac": "1",
}


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """A hammer test beside the study. frequencies, predicted, published [Hz], shape (load, mode); mode: index paired."""

    source: str
    frequencies: Array
    predicted: Array
    modes: Index
    published: Array | None = None
    published_name: str = "published"

    def sensitivity(self, values: Array, loads: Array) -> Array:
        """Change of frequency with preload, d f/d preload [Hz/N] (mode,), by a straight line through all loads."""
        if len(loads) < 2:
            return np.full(values.shape[1], np.nan)
        return np.asarray(np.polyfit(loads, values, 1)[0])


@dataclass(frozen=True, kw_only=True)
class Receptance:
    """Frequency response at one preload: values [m/N] (frequency, output, input) at frequencies [Hz].

    inputs, outputs: point [m] and direction of each; error: the largest of the residuals that were checked [-].
    """

    frequencies: Array
    values: Complex
    inputs: tuple[tuple[tuple[float, ...], tuple[float, ...]], ...]
    outputs: tuple[tuple[tuple[float, ...], tuple[float, ...]], ...]
    error: float


@dataclass(frozen=True, kw_only=True)
class Result:
    """What a study gives. l loads, m elastic modes, q points on the joints, n nodes of the outline.

    loads [N] (l,), preload of the first bolt; frequencies [Hz] and loss_factors [-] (l, m), elastic modes only, from
    complex modes; tied, free [Hz] (m,), the same modes with the faces grown together and apart; rigid [Hz] (6,), the
    largest of the rigid-body values over the loads; pressure [Pa], k_n, k_t [Pa/m] (l, q) at points [m] (q, 3) with
    weights [m2] (q,) of joint_of_point (q,); unknowns; outline [m] (n, 3), triangles (t, 3) and shapes
    (l, m, n, 3) of the mass-normalised real modes; bolt_forces [N] (l, b), what is left when all bolts are tight; slipping
    [-] (l, joints), share of a joint's area at the limit of friction; mac [-] (l, m, m), modal assurance criterion of
    the modes at the first load (rows) with those at each; response: frequency response per load, if asked for;
    comparison: with listed frequencies; hammer: with a test's modes and FRFs; damping: hysteretic or viscous; tightening: names of
    the bolts in the order in which they were pulled, empty where all at once; factor_memory [B]: what a factorisation took by its
    own estimate; sources, warnings: sentences for the reader.
    """

    title: str
    loads: Array
    frequencies: Array
    loss_factors: Array
    loss_error: Array
    tied: Array
    free: Array
    rigid: Array
    pressure: Array
    k_n: Array
    k_t: Array
    points: Array
    weights: Array
    joint_of_point: Index
    joints: tuple[str, ...]
    unknowns: int
    solver: str
    outline: Array
    triangles: Index
    shapes: Array
    bolts: tuple[str, ...]
    bolt_forces: Array
    slipping: Array
    mac: Array
    response: tuple[Receptance, ...] = ()
    surface: dict[str, Any] = field(default_factory=dict)
    law: dict[str, Any] = field(default_factory=dict)
    convergence: tuple[dict[str, float], ...] = ()
    comparison: Comparison | None = None
    factor_memory: float = 0.0
    sources: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    hammer: ModalComparison | None = None
    damping: str = "hysteretic"
    tightening: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in UNITS:
            value = getattr(self, name)
            if not np.all(np.isfinite(value)):
                raise InputError(
                    f"the study gave NaN in {name}; this is a fault of its input or of Faying, please report it"
                )
            value.setflags(write=False)

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers a reader wants, ready for JSON; maps and shapes are left to NetCDF."""
        names = ("loads", "frequencies", "loss_factors", "tied", "free", "rigid")
        out: dict[str, Any] = {
            "title": self.title,
            "unknowns": self.unknowns,
            "solver": self.solver,
            "factor_memory": {"unit": "B", "value": self.factor_memory},
        }
        out |= {name: {"unit": UNITS[name], "values": getattr(self, name).tolist()} for name in names}
        out["greatest_pressure"] = {"unit": "Pa", "values": self.pressure.max(axis=1).tolist()}
        out["open_share"] = {"unit": "1", "values": self.open_share().tolist()}
        out["bolt_forces"] = {"unit": "N", "bolts": list(self.bolts), "values": self.bolt_forces.tolist()}
        out |= {"damping": self.damping, "tightening": list(self.tightening)}
        out["slipping_share"] = {"unit": "1", "values": self.slipping.tolist()}
        out |= {"surface": self.surface, "law": self.law, "convergence": list(self.convergence)}
        if self.comparison is not None:
            c = self.comparison
            out["comparison"] = {
                "unit": "Hz",
                "source": c.source,
                "test": c.frequencies.tolist(),
                "predicted": c.predicted.tolist(),
                "error": ((c.predicted - c.frequencies) / c.frequencies).tolist(),
                "modes": c.modes.tolist(),
            }
            if c.published is not None:
                out["comparison"][c.published_name] = c.published.tolist()
        if self.hammer is not None:
            out["hammer_test"] = self.hammer.to_dict()
        return out | {"sources": list(self.sources), "warnings": list(self.warnings)}

    def open_share(self) -> Array:
        """Share of the joints' area that carries nothing [-] (l,)."""
        return np.asarray((self.pressure <= 0) @ self.weights / self.weights.sum())

    def to_netcdf(self, path: str | Path) -> Path:
        """Write everything as NetCDF-3 with units; the file appears whole or not at all."""
        from scipy.io import netcdf_file

        dims = {
            "loads": ("load",),
            "frequencies": ("load", "mode"),
            "loss_factors": ("load", "mode"),
            "loss_error": ("load", "mode"),
            "tied": ("mode",),
            "free": ("mode",),
            "rigid": ("rigid_motion",),
            "pressure": ("load", "point"),
            "k_n": ("load", "point"),
            "k_t": ("load", "point"),
            "points": ("point", "axis"),
            "weights": ("point",),
            "outline": ("node", "axis"),
            "shapes": ("load", "mode", "node", "axis"),
            "bolt_forces": ("load", "bolt"),
            "slipping": ("load", "joint"),
            "mac": ("load", "mode", "other_mode"),
        }

        def write(temporary: Path) -> None:
            with netcdf_file(temporary, "w", version=2) as nc:
                nc.title = self.title
                nc.sources = "\n".join(self.sources) or " "
                nc.warnings = "\n".join(self.warnings) or " "
                nc.solver, nc.unknowns, nc.factor_memory = self.solver, self.unknowns, self.factor_memory
                nc.joints = "\n".join(self.joints)
                nc.damping = self.damping
                for group in (self.surface, self.law):
                    for key, value in group.items():
                        setattr(
                            nc, key.replace(" ", "_"), value if isinstance(value, int | float) else str(value) or " "
                        )
                sizes: dict[str, int] = {}
                for name, names in dims.items():
                    sizes |= dict(zip(names, getattr(self, name).shape, strict=True))
                sizes |= {"triangle": len(self.triangles)}
                if self.response:
                    f, o, i = self.response[0].values.shape
                    sizes |= {"response_frequency": f, "output": o, "input": i}
                for name, size in sizes.items():
                    nc.createDimension(name, size)
                for name, names in dims.items():
                    kind = "f4" if name == "shapes" else "f8"
                    variable = nc.createVariable(name, kind, names)
                    variable[:] = getattr(self, name)
                    variable.units = UNITS[name]
                for name, values, names in (
                    ("joint_of_point", self.joint_of_point, ("point",)),
                    ("triangles", self.triangles, ("triangle", "axis")),
                ):
                    variable = nc.createVariable(name, "i4", names)
                    variable[:] = values
                    variable.units = "1"

                if self.response:
                    self._write_response(nc)

        return write_atomically(Path(path), write)

    def _write_response(self, nc: Any) -> None:
        first = self.response[0]
        parts = [
            ("response_frequencies", first.frequencies, ("response_frequency",), "Hz"),
            ("input_points", np.array([point for point, _ in first.inputs]), ("input", "axis"), "m"),
            ("input_directions", np.array([axis for _, axis in first.inputs]), ("input", "axis"), "1"),
            ("output_points", np.array([point for point, _ in first.outputs]), ("output", "axis"), "m"),
            ("output_directions", np.array([axis for _, axis in first.outputs]), ("output", "axis"), "1"),
            ("response_error", np.array([one.error for one in self.response]), ("load",), "1"),
        ]
        stacked = np.stack([one.values for one in self.response])
        names = ("load", "response_frequency", "output", "input")
        parts += [("receptance_real", stacked.real, names, "m/N"), ("receptance_imaginary", stacked.imag, names, "m/N")]
        for name, values, dims, unit in parts:
            variable = nc.createVariable(name, "f8", dims)
            variable[:] = values
            variable.units = unit

    def to_csv(self, path: str | Path) -> Path:
        """Write one row for each load and mode, units in the heading; the file appears whole or not at all."""
        return write_atomically(Path(path), lambda temporary: temporary.write_text(self.csv_text(), encoding="utf-8"))

    def csv_text(self) -> str:
        """Return the rows of to_csv as text."""
        out = io.StringIO()
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow(["preload [N]", "mode", "frequency [Hz]", "loss factor [-]", "free [Hz]", "tied [Hz]"])
        for i, load in enumerate(self.loads):
            for j in range(len(self.tied)):
                values = (self.frequencies[i, j], self.loss_factors[i, j], self.free[j], self.tied[j])
                rows.writerow([f"{load:.6g}", j + 1, *(f"{value:.8g}" for value in values)])
        return out.getvalue()
