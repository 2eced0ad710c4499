"""The modes of a case over its loads: their shapes, how alike they are, where they cross, which are those of a test."""

from collections.abc import Iterator, Sequence

import numpy as np

from faying.case.case import Case
from faying.case.solve import LoadedCase
from faying.measured.mac import Weighted
from faying.measured.pairing import Paired, changes, pair_over_loads
from faying.notes import Note
from faying.result import MeasuredComparison
from faying.typing import Array
from faying.units import load_text


def shapes_of(case: Case, states: Sequence[LoadedCase]) -> list[Array]:
    """Shapes (m, nodes, 3) at each load: those of the complex modes, for real modes that lie close mix."""
    mass = case.structure.dynamic_matrices[1]
    return [s.damped.real_shapes(mass).T.reshape(len(s.damped.frequencies), -1, 3) for s in states]


def macs(case: Case, states: Sequence[LoadedCase]) -> tuple[list[Array], Array]:
    """MAC, weighted by mass, of the modes of each load with those of the next (m, m), and with those of the first.

    The latter (load, m, m).
    """
    mass = case.structure.dynamic_matrices[1]
    first = before = Weighted.of(states[0].damped.shapes, mass)
    steps, with_first = [], [first.mac(first)]
    for state in states[1:]:
        here = Weighted.of(state.damped.shapes, mass)
        steps.append(here.mac(before))
        with_first.append(steps[0] if before is first else here.mac(first))
        before = here
    return steps, np.stack(with_first)


def encounters(states: Sequence[LoadedCase], steps: Sequence[Array]) -> Iterator[Note]:
    """Say which modes cross and which couple from one load to the next; steps: MAC from load to load."""
    for code, found in zip(("modes-cross", "modes-couple"), changes(steps), strict=True):
        for step in sorted({k for k, _, _ in found}):
            pairs = ", ".join(f"{i + 1} and {j + 1}" for k, i, j in found if k == step)
            before, after = (load_text(states[step + k].load) for k in (0, 1))
            text = f"modes {pairs} {code.removeprefix('modes-')} between {before} and {after} (MAC weighted by mass)"
            yield Note(code=code, load=states[step + 1].load, text=text)


def compared(
    case: Case, states: Sequence[LoadedCase], shapes: Sequence[Array], steps: Sequence[Array]
) -> tuple[MeasuredComparison | None, list[Note]]:
    """Pair the test's frequencies with the computed modes, followed over the loads; see `pair_frequencies`.

    shapes: (m, nodes, 3) at each load; steps: MAC from load to load.
    """
    test = case.study.test
    if test is None:
        return None, []
    measured = np.array(test.frequencies)
    here, axis = test.seen(case.structure.mesh.points)
    motion = [np.abs(found[:, here] @ axis).max(axis=1) for found in shapes]
    pairs = pair_over_loads(measured, [s.damped.frequencies for s in states], motion, steps, threshold=test.threshold)
    comparison = MeasuredComparison(
        source=test.source,
        frequencies=measured,
        predicted=pairs.predicted,
        modes=np.where(pairs.modes < 0, -1, pairs.tracks[:, pairs.modes]),
        published=None if test.published is None else np.array(test.published),
        published_name=test.published_name,
        kind=test.kind,
    )
    return comparison, list(_unmatched(pairs, measured, test.threshold))


def _unmatched(pairs: Paired, measured: Array, threshold: float) -> Iterator[Note]:
    """Say which modes of the test, and which visible ones of the model among them, have no partner."""
    found, frequencies, visibility = pairs.modes, pairs.frequencies, pairs.visibility
    lost = np.flatnonzero(found < 0)
    if len(lost):
        which = ", ".join(f"{k + 1} ({measured[0, k]:.1f} Hz)" for k in lost)
        text = (
            f"test mode {which}: no computed mode that moves at the points of the test is within 30 % of it; it is "
            "left out. Raise modes.count, or look whether the test has a mode of something else"
        )
        yield Note(code="test-modes", severity="limit", text=text)
    inside = (frequencies[0] > 0.97 * measured.min()) & (frequencies[0] < 1.03 * measured.max())
    rest = [k for k in np.flatnonzero(inside & (visibility.max(axis=0) >= threshold)) if k not in found]
    if rest:
        which = ", ".join(f"{k + 1} ({frequencies[0, k]:.1f} Hz)" for k in rest)
        text = f"computed mode {which} moves at the points of the test, which lists none for it"
        yield Note(code="model-modes", severity="limit", text=text)
