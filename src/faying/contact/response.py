"""What every contact law gives at a load."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from math import pi, prod
from typing import Self

import numpy as np

from faying.errors import InputError, shown
from faying.style import Summary
from faying.typing import Array, Mask, Quantity
from faying.units import show

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
# what they are called in tables and on axes
MEANINGS = {
    "area": "real area / nominal area",
    "k_n": "normal stiffness k_n",
    "k_t": "tangential stiffness k_t",
    "k_load": "normal stiffness on loading k_load",
    "k_n_low": "lower end of the range of k_n",
    "k_n_high": "upper end of the range of k_n",
    "loss_n": "normal loss factor",
    "loss_t": "tangential loss factor",
}
STIFFNESS = 1e-12  # MPa/um

# A loop of force over motion fills at most its box, 4 F x; a spring to its corner stores F x/2.
MAX_LOSS = 4 / pi
TOO_LOSSY = "loss factor above 4/pi, which no loop of force over motion has"


@dataclass(frozen=True, kw_only=True, repr=False)
class Response(Summary):
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
    area: Quantity = None
    k_n: Quantity = None
    k_t: Quantity = None
    loss_n: Quantity = None
    loss_t: Quantity = None
    energy_n: Quantity = None
    energy_t: Quantity = None
    k_load: Quantity = None
    k_n_low: Quantity = None
    k_n_high: Quantity = None
    reasons: Mapping[str, Mask] = field(default_factory=dict)

    def __post_init__(self) -> None:
        losses = [np.asarray(loss) for loss in (self.loss_n, self.loss_t) if loss is not None]
        if losses:
            lossy = np.any([loss > MAX_LOSS for loss in losses], axis=0)
            object.__setattr__(self, "reasons", {**self.reasons, TOO_LOSSY: np.asarray(lossy)})

    @property
    def valid(self) -> Mask:
        """True where none of `reasons` holds."""
        good = np.ones(np.shape(self.pressure), dtype=bool)
        for mask in self.reasons.values():
            good &= ~mask
        return good

    def summary(self) -> tuple[str, dict[str, str]]:
        """Each quantity with its unit, as one value or as a range, and where the law is within its validity range."""
        pressure, valid = np.asarray(self.pressure), np.asarray(self.valid)
        count = pressure.size
        many = "" if count == 1 else f" of shape {pressure.shape}, from least to greatest"
        rows = {name: _shown(value, name) for name, value in self.quantities().items() if name != "pressure"}
        if count:
            inside = int(valid.sum())
            rows["valid"] = "yes" if inside == count else "no" if not inside else f"at {inside} of {count} pressures"
            why = [reason for reason, mask in self.reasons.items() if np.any(mask)]
            rows["valid"] += ": " * bool(why) + "; ".join(why)
        return f"Response at {_shown(pressure, 'pressure')}{many}", rows

    def quantities(self) -> dict[str, Array]:
        """Return the defined quantities by name, in the order of the fields."""
        return {f.name: v for f in fields(self) if isinstance(v := getattr(self, f.name), np.ndarray)}

    def reshaped(self, shape: tuple[int, ...]) -> Self:
        """Return the same response with every array in another shape."""
        sizes = shape if isinstance(shape, tuple | list) else (None,)
        if not all(isinstance(n, int) and not isinstance(n, bool) and n >= 0 for n in sizes):
            raise InputError(f"shape = {shown(shape)}; give a tuple of whole numbers")
        if prod(sizes) != np.size(self.pressure):
            raise InputError(f"shape = {shown(shape)} has not the {np.size(self.pressure)} values of this response")
        arrays = {name: value.reshape(shape) for name, value in self.quantities().items()}
        reasons = {name: mask.reshape(shape) for name, mask in self.reasons.items()}
        return replace(self, **arrays, reasons=reasons)


def _shown(value: Array, name: str) -> str:
    """The value of one quantity with its unit, or its least and its greatest."""
    known = np.asarray(value)[np.isfinite(value)]
    if not known.size:
        return "none"
    ends = [float(known.min()), float(known.max())]
    if UNITS[name] == "Pa/m":
        texts = [f"{end * 1e-12:.4g} MPa/um" for end in ends]
    else:
        texts = [show(end, UNITS[name]) if UNITS[name] else f"{end:.4g}" for end in ends]
    return texts[0] if np.size(value) == 1 or texts[0] == texts[1] else " to ".join(texts)


def label_and_scale(quantity: str) -> tuple[str, float]:
    """Text of an axis and factor from SI to what it shows. Raises InputError for an unknown quantity."""
    if not isinstance(quantity, str) or quantity not in MEANINGS:
        raise InputError(f"quantity = {shown(quantity)}; allowed: {', '.join(MEANINGS)}")
    stiff = UNITS[quantity] == "Pa/m"
    return MEANINGS[quantity] + (" [MPa/um]" if stiff else ""), STIFFNESS if stiff else 1.0
