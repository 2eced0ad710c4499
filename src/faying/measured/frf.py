"""Frequency response functions between degrees of freedom, and what turns one quantity into another."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Self

import numpy as np

from faying.errors import InputError
from faying.misuse import checked_call, shortened
from faying.style import Summary
from faying.text import listed
from faying.typing import Array, Complex, Mask

Position = tuple[float, float, float]

# how often the displacement is differentiated in time
QUANTITIES = {"receptance": 0, "mobility": 1, "accelerance": 2}
LARGEST = 1e18  # SI: beyond what any structure answers by any of the three quantities
UNITS = {"receptance": "m/N", "mobility": "m/(N*s)", "accelerance": "m/(N*s^2)"}
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
DIRECTIONS = ("x", "y", "z", "-x", "-y", "-z", "rx", "ry", "rz", "-rx", "-ry", "-rz", "")


class Dof(NamedTuple):
    """A degree of freedom of a test: the number of its point and one of DIRECTIONS ("" where none is stated)."""

    point: int
    direction: str

    def __str__(self) -> str:
        return f"{self.point}{self.direction if self.direction.startswith('-') else f'+{self.direction}'}"

    def split(self) -> tuple[int, str]:
        """Sign of the direction, and the direction without it."""
        return (-1, self.direction[1:]) if self.direction.startswith("-") else (1, self.direction)

    def axis(self) -> Array:
        """Unit vector of the direction (3,). InputError for rotations and where no direction is stated."""
        sign, name = self.split()
        if name not in AXES:
            raise InputError(
                f"point {self.point} has the direction {self.direction!r}, which is not a translation; give x, y or z, "
                'for example .directed("z"), or on the command line --direction z'
            )
        return sign * np.array(AXES[name])


def dofs(pairs: object) -> tuple[Dof, ...]:
    """Check (point, direction) pairs. InputError where a direction is none of DIRECTIONS or a pair appears twice."""
    out = []
    if not isinstance(pairs, Iterable) or isinstance(pairs, str | bytes | Mapping):
        raise InputError(f'{shortened(pairs)}; give pairs of a point and a direction, for example [(1, "z")]')
    for pair in pairs:
        if not isinstance(pair, tuple | list) or len(pair) != 2 or not isinstance(pair[1], str):
            raise InputError(f'{shortened(pair)} is not a pair of a point and a direction; give for example (1, "z")')
        point, direction = pair
        if direction not in DIRECTIONS:
            raise InputError(f"direction {direction!r} of point {point}: use one of {', '.join(map(repr, DIRECTIONS))}")
        if isinstance(point, bool) or not isinstance(point, int | np.integer):
            raise InputError(f"point {shortened(point)}: give its number, a whole one")
        out.append(Dof(int(point), direction))
    if len(set(out)) < len(out):
        twice = next(d for d in out if out.count(d) > 1)
        raise InputError(f"the degree of freedom {twice} appears twice; give each point and direction once")
    return tuple(out)


def without_static(frequency: Array, values: Complex, where: str) -> tuple[Mask, tuple[str, ...]]:
    """Which spectral lines to use of FRFs (n, f): not the one at 0 Hz where one is NaN or infinite there; and a note.

    Programs that divide by the frequency write no number at 0 Hz.
    """
    out = (frequency == 0) & ~np.isfinite(values).all(axis=0)
    return ~out, (f"{where}: the line at 0 Hz, which holds no number, is left out",) if out.any() else ()


@checked_call
@dataclass(frozen=True, kw_only=True, repr=False)
class FRF(Summary):
    """Frequency response functions from inputs to outputs.

    Args:
        frequency: of the spectral lines [Hz], shape (f,), rising from 0 or more.
        values: complex, in the SI unit of `quantity`, shape (o, i, f); NaN where a pair was not measured.
        outputs: degrees of freedom as (point, direction), (o,).
        inputs: the same of the forces (i,).
        quantity: "receptance" [m/N], "mobility" [m/(N s)] or "accelerance" [m/(N s2)].
        coherence: [-], shape (o, i, f), or None.
        positions: point -> x, y, z [m].
        window_decay: decay [1/s] of an exponential window that the records were multiplied by, which adds to the
            damping.
        source: the file.
        warnings: what a reader should know.

    Raises:
        InputError: where shapes do not fit, frequencies do not rise, or a function is NaN at some lines only.
    """

    frequency: Array
    values: Complex
    outputs: tuple[Dof, ...]
    inputs: tuple[Dof, ...]
    quantity: str
    coherence: Array | None = None
    positions: Mapping[int, Position] = field(default_factory=dict)
    window_decay: float = 0.0
    source: str = ""
    warnings: tuple[str, ...] = ()

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and size, band and places."""
        measured = int(np.isfinite(self.values).all(axis=2).sum())
        rows = {
            "pairs": f"{measured} of {len(self.outputs)} outputs x {len(self.inputs)} inputs",
            "outputs": listed(map(str, self.outputs), 8),
            "inputs": listed(map(str, self.inputs), 8),
            "lines": f"{self.frequency.size}, {self.frequency[0]:.6g} to {self.frequency[-1]:.6g} Hz",
            "coherence": "none" if self.coherence is None else "given",
            "source": self.source or "given in Python",
        }
        return f"FRF: {self.quantity}", rows

    def __post_init__(self) -> None:
        if self.quantity not in QUANTITIES:
            raise InputError(f"quantity {self.quantity!r}: use one of {', '.join(QUANTITIES)}")
        object.__setattr__(self, "outputs", dofs(self.outputs))
        object.__setattr__(self, "inputs", dofs(self.inputs))
        frequency, values = np.array(self.frequency, float), np.array(self.values, complex)
        shape = (len(self.outputs), len(self.inputs), frequency.size)
        if frequency.ndim != 1 or values.shape != shape:
            raise InputError(
                f"values have the shape {values.shape}; {len(self.outputs)} outputs, {len(self.inputs)} inputs and "
                f"{frequency.size} frequencies need {shape}"
            )
        if frequency.size < 2 or not np.all(np.diff(frequency) > 0) or not frequency[0] >= 0:
            raise InputError("the frequencies of an FRF must be two or more, not negative, and rise")
        measured = np.isfinite(values)
        if np.any(measured.any(axis=2) != measured.all(axis=2)) or not measured.any():
            raise InputError(
                "an FRF has NaN at some of its frequencies only; leave such spectral lines out, or the FRF"
            )
        if np.abs(values[measured]).max() > LARGEST:
            raise InputError(
                f"values up to {np.abs(values[measured]).max():.3g} {self.unit}; no structure answers so, look for a "
                "damaged number or a wrong unit"
            )
        if self.coherence is not None and np.shape(self.coherence) != shape:
            raise InputError(
                f"coherence has the shape {np.shape(self.coherence)}; it needs that of the values, {shape}"
            )
        for name, array in (("frequency", frequency), ("values", values)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def unit(self) -> str:
        """SI unit of the values."""
        return UNITS[self.quantity]

    @property
    def step(self) -> float:
        """Spacing of the spectral lines [Hz]. InputError where they are not evenly spaced."""
        gaps = np.diff(self.frequency)
        if np.ptp(gaps) > 1e-3 * gaps.mean():
            raise InputError(
                f"the spectral lines are {gaps.min():g} to {gaps.max():g} Hz apart; this needs evenly spaced lines"
            )
        return float(gaps.mean())

    @property
    def whole_step(self) -> float:
        """The same of lines that are all multiples of it. InputError where they are not."""
        step = self.step
        if abs(self.frequency[0] / step - round(self.frequency[0] / step)) > 1e-2:
            raise InputError(
                f"the first spectral line, {self.frequency[0]:g} Hz, is not a multiple of the spacing {step:g} Hz; "
                "interpolate the FRFs to lines at multiples of the spacing"
            )
        return step

    @property
    def measured(self) -> list[tuple[int, int]]:
        """Indices (output, input) of the pairs that were measured."""
        return [(int(o), int(i)) for o, i in np.argwhere(np.isfinite(self.values[:, :, 0]))]

    def rows(self) -> Complex:
        """Values of the measured pairs, one row each (n, f)."""
        return np.array([self.values[pair] for pair in self.measured])

    def to(self, quantity: str) -> Self:
        """The same functions as another quantity; the line at 0 Hz is left out where it would be divided by zero."""
        if quantity not in QUANTITIES:
            raise InputError(f"quantity {quantity!r}: use one of {', '.join(QUANTITIES)}")
        power = QUANTITIES[quantity] - QUANTITIES[self.quantity]
        frf = self.band(np.nextafter(0, 1), np.inf) if power < 0 and self.frequency[0] == 0 else self
        factor = (2j * np.pi * frf.frequency) ** power
        return replace(frf, values=frf.values * factor, quantity=quantity)

    def directed(self, direction: str) -> Self:
        """The same functions, with this direction where the test states none."""
        outputs, inputs = (
            tuple(d if d.direction else Dof(d.point, direction) for d in row) for row in (self.outputs, self.inputs)
        )
        return replace(self, outputs=outputs, inputs=inputs)

    def band(self, low: float, high: float) -> Self:
        """Only the spectral lines from low to high [Hz]. InputError where fewer than two are left."""
        keep = (self.frequency >= low) & (self.frequency <= high)
        if keep.sum() < 2:
            raise InputError(
                f"no two spectral lines between {low:g} and {high:g} Hz; the FRFs reach from {self.frequency[0]:g} to "
                f"{self.frequency[-1]:g} Hz"
            )
        coherence = None if self.coherence is None else self.coherence[:, :, keep]
        return replace(self, frequency=self.frequency[keep], values=self.values[:, :, keep], coherence=coherence)
