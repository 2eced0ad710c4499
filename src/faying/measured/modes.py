"""A set of modes as a test knows them: frequencies, loss factors, shapes at a few degrees of freedom."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from faying.errors import InputError
from faying.measured.frf import Dof, Position, dofs
from faying.style import Summary
from faying.typing import Array, Complex, Index


@dataclass(frozen=True, kw_only=True, repr=False)
class ModeSet(Summary):
    """Modes at the degrees of freedom of a test.

    Args:
        frequencies: undamped, |pole| / 2 pi [Hz], shape (m,), positive.
        loss_factors: twice the damping ratio [-] (m,).
        shapes: (m, d), complex, of any scale.
        dofs: (point, direction) of each column (d,).
        positions: point -> x, y, z [m].
        frequency_interval: 95 % intervals [Hz] (m, 2), or None.
        loss_interval: 95 % intervals [-] (m, 2), or None.
        found_in: at how many orders each mode was found (m,), or None.
        notes: what a reader should know of each mode (m,).
        lines: pairs of points to join in a drawing.
        source: the file.

    Raises:
        InputError: where shapes do not fit, or a value is not finite.
    """

    frequencies: Array
    loss_factors: Array
    shapes: Complex
    dofs: tuple[Dof, ...]
    positions: Mapping[int, Position] = field(default_factory=dict)
    frequency_interval: Array | None = None
    loss_interval: Array | None = None
    found_in: Index | None = None
    notes: tuple[tuple[str, ...], ...] = ()
    lines: tuple[tuple[int, int], ...] = ()
    source: str = ""

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and frequency and loss factor of the first modes."""
        count = len(self.frequencies)
        rows = {}
        for mode in range(min(9, count)):
            note = "; ".join(self.notes[mode]) if self.notes else ""
            loss = f"{self.frequencies[mode]:.2f} Hz, loss factor {self.loss_factors[mode]:.3g}"
            rows[f"mode {mode + 1}"] = loss + (f" ({note})" if note else "")
        if count > 9:
            rows["more"] = f"{count - 9}, in .frequencies"
        return f"{count} modes of a test at {len(self.dofs)} degrees of freedom", rows

    def __post_init__(self) -> None:
        object.__setattr__(self, "dofs", dofs(self.dofs))
        count = len(self.frequencies)
        if self.shapes.shape != (count, len(self.dofs)) or len(self.loss_factors) != count:
            raise InputError(
                f"{count} frequencies, {len(self.loss_factors)} loss factors and shapes of {self.shapes.shape} at "
                f"{len(self.dofs)} degrees of freedom do not fit; shapes need ({count}, {len(self.dofs)})"
            )
        if not all(np.all(np.isfinite(a)) for a in (self.frequencies, self.loss_factors, self.shapes)):
            raise InputError("the modes have NaN; leave such modes or degrees of freedom out")
        if not np.all(np.asarray(self.frequencies) > 0):
            raise InputError(
                f"frequencies of {np.min(self.frequencies):g} Hz and more; leave out modes at 0 Hz or below"
            )
        if not self.notes:
            object.__setattr__(self, "notes", ((),) * count)

    def at(self, wanted: tuple[Dof, ...]) -> Complex:
        """Shapes at some of the degrees of freedom, in their order (m, d). InputError where one is not known."""
        missing = [str(d) for d in wanted if d not in self.dofs]
        if missing:
            raise InputError(
                f"the modes are not known at {', '.join(missing)}; they are at {', '.join(map(str, self.dofs))}"
            )
        return self.shapes[:, [self.dofs.index(d) for d in wanted]]

    def directed(self, direction: str) -> Self:
        """The same modes, with this direction where the test states none."""
        return replace(self, dofs=tuple(d if d.direction else Dof(d.point, direction) for d in self.dofs))
