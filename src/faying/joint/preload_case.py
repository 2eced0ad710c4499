"""One preload of a structure: the force that each bolt is tightened to, and in which order."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying.checks import number
from faying.errors import InputError
from faying.typing import Array
from faying.units import load_text

NO_SHANK = "bolts {} have no shank, so tightening others cannot change them; give diameter and material, or no order"
NO_MEMORY = (
    "joint {!r} has springs per node, which remember no pressure: leave springs out of it, or give preloads that rise"
)
SAME = 1e-3  # relative: messages and tables give a preload with four digits, and what they print is found again


@dataclass(frozen=True)
class PreloadCase:
    """The force of every bolt at one preload.

    Args:
        forces: Force [N] of each bolt (b,), above 0, in the order of the structure's bolts; none where it has no bolts.
        order: Indices of the bolts in the order of tightening, any of them more than once; None where all are pulled at
            once.
        after: Forces [N] (b,) of the preloads that the joints carried before and that count: those of which some force
            is greater than here. First loading without any.
        settled: Whether that is so of every preload of a study alike, so that names need not say it.
    """

    forces: tuple[float, ...]
    order: tuple[int, ...] | None = None
    after: tuple[tuple[float, ...], ...] = ()
    settled: bool = False

    @property
    def preload(self) -> float:
        """Force of the first bolt [N], by which results know the case; 0 without bolts."""
        return self.forces[0] if self.forces else 0.0

    @property
    def before(self) -> tuple["PreloadCase", ...]:
        """The preloads that the joints carried before, on first loading."""
        return tuple(PreloadCase(forces=forces, order=self.order) for forces in self.after)

    @property
    def carried(self) -> float:
        """Greatest force of the first bolt [N] that its joints carried before; 0 on first loading."""
        return max((forces[0] for forces in self.after), default=0.0)

    @property
    def name(self) -> str:
        """What messages call it: "12 kN", or "4 kN after 12 kN"."""
        return load_name(self.preload, 0.0 if self.settled else self.carried)


def load_name(load: float, carried: float) -> str:
    """What a preload [N] is called: "12 kN"; "4 kN after 12 kN" where its joints carried more before."""
    return f"{load_text(load)} after {load_text(carried)}" if carried else load_text(load)


def each_once(names: Iterable[str]) -> tuple[str, ...]:
    """Names, numbered where one comes again."""
    out: list[str] = []
    for name in names:
        again = sum(one == name or one.startswith(f"{name} (") for one in out)
        out.append(f"{name} ({again + 1})" if again else name)
    return tuple(out)


def with_history(cases: Sequence[PreloadCase]) -> tuple[PreloadCase, ...]:
    """The same preloads one after another: those that some force of an earlier one exceeds come after that one."""
    out: list[PreloadCase] = []
    for k, case in enumerate(cases):
        greater = [one.forces for one in cases[:k] if np.any(np.greater(one.forces, case.forces))]
        counts = [one for one in greater if not any(np.all(np.less(one, other)) for other in greater)]
        out.append(replace(case, after=tuple(dict.fromkeys(counts))))
    return tuple(out)


def after_greatest(cases: Sequence[PreloadCase]) -> tuple[PreloadCase, ...]:
    """The same preloads on joints that have carried the greatest force of each bolt before."""
    greatest = tuple(np.max([one.forces for one in cases], axis=0).tolist())
    return tuple(
        replace(case, after=(greatest,) * bool(np.any(np.greater(greatest, case.forces))), settled=True)
        for case in cases
    )


def preload_index(
    preloads: Sequence[float] | Array,
    wanted: float | str | None,
    *,
    names: Sequence[str] | None = None,
    name: str = "preload",
    of: str = "the study",
) -> int:
    """Return which of some preloads [N] is wanted, to a thousandth of it.

    wanted: a force [N], text with a unit, or one of `names`; the last one where None. name: what asks for it; of: what
    has them. Raises InputError where none is so near, and where several are.
    """
    names = names or [load_text(one) for one in preloads]
    if wanted is None:
        return len(preloads) - 1
    if isinstance(wanted, str) and names.count(wanted) == 1:
        return names.index(wanted)
    force = number(wanted, name, "N", least=0, ends="()" if np.all(preloads) else "[)")
    index = int(np.argmin(np.abs(np.asarray(preloads) - force))) if len(preloads) else -1
    if index < 0 or abs(preloads[index] - force) > SAME * force:
        known = ", ".join(names)
        raise InputError(f"{name} = {load_text(force)}: {of} has no such preload; it has {known or 'none'}")
    near = [one for one, load in zip(names, preloads, strict=True) if abs(load - preloads[index]) <= SAME * force / 10]
    if len(near) > 1:
        raise InputError(f"{name} = {load_text(force)} may be {' or '.join(map(repr, near))}; give one of these names")
    return index
