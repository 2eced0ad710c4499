"""The model's side: modes at its nodes from plain arrays or a result file, and FRFs by their superposition."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faying.errors import InputError, ReadError
from faying.measured.frf import QUANTITIES

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True)
class ModelModes:
    """Elastic modes of a model: frequencies [Hz] and loss_factors [-] (m,), shapes (m, n, 3) [kg^-1/2] at points [m] (n, 3)

    of its outline with triangles (t, 3) to draw; load [N]: the preload they belong to.
    """

    frequencies: Array
    loss_factors: Array
    shapes: Array
    points: Array
    triangles: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 3), dtype=np.int64))
    load: float = 0.0
    title: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        m, n = len(self.frequencies), len(self.points)
        if self.shapes.shape != (m, n, 3) or len(self.loss_factors) != m:
            raise InputError(
                f"shapes of {self.shapes.shape} for {m} frequencies at {n} points; they need ({m}, {n}, 3)"
            )

    def receptance(self, frequency: Array, outputs: tuple[Array, Array], inputs: tuple[Array, Array]) -> Complex:
        """Receptance [m/N] (o, i, f) by superposition of the elastic modes with hysteretic loss.

        outputs, inputs: nodes (k,) and directions (k, 3). H = sum phi_o phi_i / (w_r2 (1 + i eta_r) - w2) (Ewins, Modal
        Testing, 2nd ed. 2000, eq. (2.65)). Rigid motion and modes beyond the last are left out: far below the first mode
        and near the last, and between peaks, H is not to be trusted.
        """
        o, i = (np.einsum("mkx,kx->mk", self.shapes[:, nodes], axes) for nodes, axes in (outputs, inputs))
        square = (2 * np.pi * self.frequencies) ** 2 * (1 + 1j * self.loss_factors)
        w2 = (2 * np.pi * np.asarray(frequency)) ** 2
        return np.asarray(np.einsum("mo,mi,mf->oif", o, i, 1 / (square[:, None] - w2), optimize=True))

    def frf(
        self, frequency: Array, outputs: tuple[Array, Array], inputs: tuple[Array, Array], quantity: str
    ) -> Complex:
        """The same as another quantity (o, i, f)."""
        return (
            self.receptance(frequency, outputs, inputs) * (2j * np.pi * np.asarray(frequency)) ** QUANTITIES[quantity]
        )


def read_model_modes(path: str | Path, *, load: float | None = None) -> ModelModes:
    """Read the modes of a result file (result.nc of `faying run`) at a preload [N], by default the greatest.

    Raises ReadError where the file is no such result, InputError where it has no such load.
    """
    from scipy.io import netcdf_file

    file = Path(path)
    if not file.is_file():
        raise ReadError(f"{file}: no such file; write one with: faying run STUDY.toml")
    try:
        with netcdf_file(file, "r", mmap=False) as nc:
            data = {name: np.array(nc.variables[name][:], float)
                    for name in ("loads", "frequencies", "loss_factors", "outline", "shapes", "triangles")}  # fmt: skip
            title = nc.title.decode("utf-8", errors="replace") if isinstance(nc.title, bytes) else str(nc.title)
    except (TypeError, ValueError, KeyError, AttributeError, OSError, IndexError) as fault:
        raise ReadError(f"{file}: no result of Faying, or damaged ({type(fault).__name__}: {fault}); write one with: faying run "
                        "STUDY.toml") from None  # fmt: skip
    loads = data["loads"]
    index = len(loads) - 1 if load is None else int(np.argmin(np.abs(loads - load)))
    if load is not None and abs(loads[index] - load) > 1e-3 * abs(loads[index]):
        raise InputError(
            f"{file}: no preload of {load / 1e3:g} kN; it holds {', '.join(f'{v / 1e3:g} kN' for v in loads)}"
        )
    return ModelModes(
        frequencies=data["frequencies"][index],
        loss_factors=data["loss_factors"][index],
        shapes=data["shapes"][index],
        points=data["outline"],
        triangles=data["triangles"].astype(np.int64),
        load=float(loads[index]),
        title=title,
        source=str(file),
    )
