"""What every contact law gives at a load."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from math import pi
from typing import Self

import numpy as np

from faying.typing import Array, Mask

# SI unit of every quantity, "" for plain numbers
UNITS = {
    "pressure": "Pa",
    "area": "",
    "k_n": "Pa/m",
    "k_t": "Pa/m",
    "loss_n": "",
    "loss_t": "",
    "energy_n": "J/m^2",
    "energy_t": "J/m^2",
    "k_load": "Pa/m",
    "k_n_low": "Pa/m",
    "k_n_high": "Pa/m",
}

# A loop of force over motion fills at most its box, 4 F x; a spring to its corner stores F x/2.
MOST_LOSS = 4 / pi
TOO_LOSSY = "loss factor above 4/pi, which no loop of force over motion has"


@dataclass(frozen=True, kw_only=True)
class Response:
    """What a contact law says at one load or many; all arrays share one shape, all quantities per nominal area.

    pressure [Pa]; area, real over nominal [-]; k_n, k_t normal and tangential stiffness [Pa/m]; loss_n, loss_t
    loss factors [-]; energy_n, energy_t strain energies [J/m2]; k_load [Pa/m], the slope of pressure over closing on
    first loading where it is not k_n, because asperities yield; k_n_low, k_n_high [Pa/m], the range of k_n where
    the law states one. A loss factor is the energy dissipated in a cycle over 2 pi times the greatest energy stored in
    it. A quantity that the model does not define is None.
    valid tells where the model is within its validity range; `reasons` names, per way of leaving it, where. A loss
    factor above 4/pi is such a way for every law.
    """

    pressure: Array
    area: Array | None = None
    k_n: Array | None = None
    k_t: Array | None = None
    loss_n: Array | None = None
    loss_t: Array | None = None
    energy_n: Array | None = None
    energy_t: Array | None = None
    k_load: Array | None = None
    k_n_low: Array | None = None
    k_n_high: Array | None = None
    reasons: Mapping[str, Mask] = field(default_factory=dict)

    def __post_init__(self) -> None:
        losses = [np.asarray(loss) for loss in (self.loss_n, self.loss_t) if loss is not None]
        if losses:
            beyond = np.any([loss > MOST_LOSS for loss in losses], axis=0)
            object.__setattr__(self, "reasons", {**self.reasons, TOO_LOSSY: np.asarray(beyond)})

    @property
    def valid(self) -> Mask:
        """True where none of `reasons` holds."""
        good = np.ones(np.shape(self.pressure), dtype=bool)
        for mask in self.reasons.values():
            good &= ~mask
        return good

    def quantities(self) -> dict[str, Array]:
        """Return the defined quantities by name, in the order of the fields."""
        return {f.name: v for f in fields(self) if isinstance(v := getattr(self, f.name), np.ndarray)}

    def reshaped(self, shape: tuple[int, ...]) -> Self:
        """Return the same response with every array in another shape."""
        arrays = {name: value.reshape(shape) for name, value in self.quantities().items()}
        reasons = {name: mask.reshape(shape) for name, mask in self.reasons.items()}
        return replace(self, **arrays, reasons=reasons)
