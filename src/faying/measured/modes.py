"""A set of modes as a test knows them: frequencies, loss factors, shapes at a few degrees of freedom."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from faying.errors import InputError
from faying.measured.frf import Dof, Position, dofs
from faying.typing import Array, Complex, Index


@dataclass(frozen=True, kw_only=True)
class ModeSet:
    """Modes at the degrees of freedom of a test.

    frequencies [Hz] (m,), undamped: |pole| / 2 pi; loss_factors [-] (m,): twice the damping ratio; shapes (m, d), complex, of
    any scale; dofs (d,): (point, direction); positions: point -> x, y, z [m]; frequency_interval, loss_interval (m, 2): 95 %
    intervals, or None; found_in (m,): at how many orders a mode was found, or None; notes (m,): what a reader should know
    of each mode; lines: pairs of points to join in a drawing. Raises InputError where shapes do not fit.
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

    def __post_init__(self) -> None:
        object.__setattr__(self, "dofs", dofs(self.dofs))
        count = len(self.frequencies)
        if self.shapes.shape != (count, len(self.dofs)) or len(self.loss_factors) != count:
            raise InputError(
                f"{count} frequencies, {len(self.loss_factors)} loss factors and shapes of {self.shapes.shape} at "
                f"{len(self.dofs)} degrees of freedom do not fit; shapes need ({count}, {len(self.dofs)})"
            )
        if not all(np.all(np.isfinite(a)) for a in (self.frequencies, self.loss_factors, self.shapes)):
            raise InputError("the modes hold NaN; leave such modes or degrees of freedom out")
        if not self.notes:
            object.__setattr__(self, "notes", ((),) * count)

    def at(self, wanted: tuple[Dof, ...]) -> Complex:
        """Shapes at some of the degrees of freedom, in their order (m, d). InputError where one is not held."""
        missing = [str(d) for d in wanted if d not in self.dofs]
        if missing:
            raise InputError(
                f"the modes are not known at {', '.join(missing)}; they are at {', '.join(map(str, self.dofs))}"
            )
        return self.shapes[:, [self.dofs.index(d) for d in wanted]]

    def directed(self, direction: str) -> Self:
        """The same modes, with this direction where the test states none."""
        return replace(self, dofs=tuple(d if d.direction else Dof(d.point, direction) for d in self.dofs))

    def turned_real(self) -> Array:
        """Shapes with their phase turned so that as much as can be is real, and that real part (m, d)."""
        phase = np.angle(np.sum(self.shapes**2, axis=1)) / 2
        return np.asarray((self.shapes * np.exp(-1j * phase)[:, None]).real)
