"""Modes of a structure whose joints have changed, from the modes and the factorisation of what it was."""

from dataclasses import replace
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.numerics.modes import Modes, lowest_modes
from faying.numerics.product import combined, product
from faying.numerics.shifted import Shifted
from faying.numerics.single import Single, factorise_exactly, factorise_roughly
from faying.numerics.solve import Factorisation, Factoriser
from faying.numerics.span import Span, chunks
from faying.typing import Array, Index

ROUNDS = 40  # enrichments of the basis
SLOWEST = 0.3  # decades that a round is taken to gain where it has gained less so far
START = 1e-2  # residual of modes, as `lowest_modes` takes it, that are to be refined
REFINED = 1e-9  # estimated relative error of the squared frequencies of refined modes
WATCHED = 4  # modes beyond those wanted that must have found their place above them
PLACED = 1e-2  # estimated relative error of their squared frequencies
MIN_OVERLAP = 0.9  # share of the changed unknowns that must have been looked at before
EVERYWHERE = 6  # vectors of no symmetry that each new stiffness begins with
SEED = 20261124
MIN_NEW_SHARE = 1e-10  # share of a new vector that must be new
NOWHERE = np.zeros(0, dtype=np.int64), np.zeros((0, 0))  # unknowns, and the rows of a basis there
NEIGHBOURS = 10  # modes that are taken to lie as near together as two that are found
DOUBT = 3.0  # times by which the energy of a residual may have grown against that by the diagonal since the last round


class ModalReanalysis:
    """Modes under one stiffness after another, without another factorisation.

    The basis is that of the modes, enriched by what the new modes leave in the new equations, sent through the old
    factorisation: few rounds where springs change by factors, more where they change by orders of magnitude. It is kept
    from one stiffness to the next, so that each further one asks for fewer.

    Args:
        modes: those of the stiffness before, rigid motions first.
        stiffness: [N/m] of these modes, sparse (n, n); rigid motions must be free of every stiffness to come.
        mass: [kg], sparse (n, n).
        rigid: how many of the modes are rigid motions.
        most: vectors (n,) that the basis keeps from one stiffness to the next; no limit where None.
    """

    def __init__(self, modes: Modes, stiffness: Any, mass: Any, *, rigid: int, most: int | None = None) -> None:
        self.span = Span(mass, stiffness, modes.shapes)
        self.modes = replace(modes, shapes=modes.shapes[:, :0].copy())  # they are in the basis
        self.rigid, self._most = rigid, most
        self._looked, self._random = NOWHERE[0], np.random.default_rng(SEED)
        self._changed: tuple[Any, Any, Index] | None = None  # of the last stiffness
        self._at = NOWHERE
        self.diagonal = stiffness.diagonal() + modes.shift * mass.diagonal()
        self._measure = self.measure(0)

    def adopt_factor(self, factor: Factorisation, stiffness: Any) -> None:
        """Go on with the factorisation of another stiffness [N/m] (n, n), shifted alike; the basis stays."""
        self.modes = replace(self.modes, factorisation=factor, factorised=stiffness)
        self.diagonal = stiffness.diagonal() + self.modes.shift * self.span.mass.diagonal()
        self._measure = self.measure(0)

    def measure(self, count: int) -> "Measure":
        """What measures so many residuals by the factorisation at hand."""
        return Measure(self.diagonal, self.modes.factorisation, count)

    def add(self, vectors: Array) -> None:
        """Take vectors (n, k) that are likely to be near modes to come, such as those of a stiffness between."""
        for some in chunks(*vectors.shape):
            self.span.add(vectors[:, some], least=MIN_NEW_SHARE)

    def under(
        self,
        stiffness: Any,
        count: int,
        *,
        tolerance: float = 1e-7,
        spare: int = 0,
        rounds: int = ROUNDS,
        shapes: bool = True,
    ) -> Modes:
        """Find the modes under a stiffness.

        Args:
            stiffness: [N/m], sparse (n, n).
            count: how many elastic modes are wanted, at most those that the modes before have.
            tolerance: of the estimated relative error of the squared frequencies.
            spare: further modes that are given as they come, to no tolerance.
            rounds: enrichments, those to come included at the rate of those done, beyond which it gives up.
            shapes: whether to give any; without them (n, 0).

        Returns:
            The rigid motions, `count` elastic modes and the spare ones, with the factorisation of the modes before.

        Raises:
            NotConverged: where the tolerance is not reached.
        """
        span = self.span
        first = None
        touched = self._change(stiffness)[1]
        # else they have been looked for already
        if len(touched) and np.isin(touched, self._looked).mean() < MIN_OVERLAP:
            self.look_everywhere(touched)
        targets = np.full(count + WATCHED, PLACED)
        targets[:count] = tolerance
        errors, converged = np.ones(len(targets)), np.zeros(len(targets))
        if self._measure.count != len(targets):
            self._measure = self.measure(len(targets))
        for done in range(rounds):
            values, inner = self.projected(stiffness)
            order = np.argsort(np.abs(values))
            wanted = order[self.rigid : self.rigid + len(targets)]
            squared, error = values[wanted], errors[: len(wanted)]
            target = targets[: len(wanted)].copy()
            # nearer to the last one wanted than their error they might have their place below it
            target[count:] = np.clip((squared[count:] / squared[count - 1] - 1) / NEIGHBOURS, tolerance, PLACED)
            sharper = _sharper(values[order[self.rigid :]], target)
            target *= sharper
            # what has converged only comes nearer as the basis grows, unless another mode comes down from above
            open_ = np.flatnonzero((error >= target) | (squared < converged[: len(wanted)] * (1 - error)))
            converged[open_] = squared[open_]
            error[open_], correction = self._error(stiffness, inner[:, wanted], squared, open_, target)
            excess = float((error / target).max())
            if excess < 1:
                stated = (error / sharper)[:count]
                found = self._found(values, inner, order[: self.rigid + count + spare], stated, shapes)
                self._keep(inner[:, order])
                return found
            first = first or excess
            if done + _rounds_left(excess, first, done) > rounds:
                break
            if not sum([span.add(some, least=MIN_NEW_SHARE) for some in correction]):
                break
        stays = (error / sharper)[:count].max()
        raise NotConverged(
            f"modes under changed springs: the estimated error stays at {stays:.1e} (tolerance {tolerance:.0e})"
        )

    def _error(
        self, stiffness: Any, mix: Array, squared: Array, which: Index, targets: Array
    ) -> tuple[Array, list[Array]]:
        """Estimated relative error of squared frequencies (k,), and what mends those that miss a target, few at a time.

        mix: coefficients (m, w) of the modes that are looked for, with their squared circular frequencies (w,) and
        targets (w,); which (k,): of them.
        """
        errors, correction = np.zeros(len(squared)), []
        for some in (which[part] for part in chunks(len(self.diagonal), len(which))):
            left = _left_over(stiffness, self.span.mass, combined(self.span.vectors, mix[:, some]), squared[some])
            size = np.abs(squared[some])
            errors[some] = self._measure.guessed(left, size, some)
            far = ~(errors[some] < targets[some])
            poor = some[far]
            if len(poor):
                left = left[:, far]  # the others' room is free before the solution takes its own
                errors[poor], solved = self._measure.solved(left, size[far], poor)
                correction.append(solved[:, errors[poor] > targets[poor] / 10])
        return errors[which], correction

    def projected(self, stiffness: Any) -> tuple[Array, Array]:
        """Squared circular frequencies (m,) and coefficients (m, m) of the modes of a stiffness in the basis."""
        from scipy.linalg import eigh

        change, touched = self._change(stiffness)
        at_joints = self._rows(touched)
        values, inner = eigh(self.span.small + at_joints.T @ (change @ at_joints))
        return np.asarray(values), np.asarray(inner)

    def _rows(self, touched: Index) -> Array:
        """The rows (k, m) of the basis at unknowns (k,): those of the last time, as far as they are the same."""
        vectors, (last, rows) = self.span.vectors, self._at
        if not np.array_equal(last, touched) or rows.shape[1] > vectors.shape[1]:
            rows = vectors[touched, :0]
        if rows.shape[1] < vectors.shape[1]:
            rows = np.concatenate([rows, vectors[touched, rows.shape[1] :]], axis=1)
            self._at = touched, rows
        return rows

    def _change(self, stiffness: Any) -> tuple[Any, Index]:
        """What a stiffness has beyond that of the basis: (k, k) on the unknowns that differ, and these (k,)."""
        before = self.span.stiffness
        if self._changed is None or self._changed[0] is not stiffness:
            if stiffness is before:  # the difference would take the room of both
                self._changed = stiffness, stiffness[:0, :0], NOWHERE[0]
            else:
                change = (stiffness - before).tocsr()
                change.eliminate_zeros()
                touched = np.flatnonzero(np.diff(change.indptr))
                self._changed = stiffness, change[touched][:, touched], touched
        return self._changed[1:]

    def look_everywhere(self, touched: Index = NOWHERE[0]) -> None:
        """Take new directions of all kinds into the basis, and what forces at the changed unknowns (k,) move.

        The residuals of modes of one symmetry have none of another: a mode that comes down from beyond the basis would
        be missed by all of them, and nothing would tell. Whoever goes to a stiffness far from those before asks again.
        What a change moves is a response to forces where it acts: a part that hangs on the changed springs alone is
        found by them, while in other directions all that is softer hides it.
        """
        mass, factor = self.span.mass, self.modes.factorisation
        found = self._random.standard_normal((mass.shape[0], EVERYWHERE))
        for _ in range(2):  # towards the low modes
            found = factor.solve(product(mass, found))
            found /= np.sqrt(np.einsum("ij,ij->j", found, product(mass, found)))
        self.span.add(found, least=MIN_NEW_SHARE)
        if len(touched):
            forces = np.zeros((mass.shape[0], min(EVERYWHERE, len(touched))))
            forces[touched] = self._random.standard_normal((len(touched), forces.shape[1]))
            moved = factor.solve(forces)
            self.span.add(moved / np.sqrt(np.einsum("ij,ij->j", moved, product(mass, moved))), least=MIN_NEW_SHARE)
            self._looked = touched

    def _found(self, values: Array, inner: Array, order: Index, error: Array, shapes: bool) -> Modes:
        return replace(
            self.modes,
            error=np.concatenate([np.zeros(self.rigid), error, np.full(len(order) - self.rigid - len(error), np.nan)]),
            frequencies=np.sqrt(np.abs(values[order])) / (2 * np.pi),
            shapes=combined(self.span.vectors, inner[:, order]) if shapes else self.modes.shapes[:, :0],
        )

    def _keep(self, inner: Array) -> None:
        """Where the basis holds too much, keep the lowest three quarters of what it may, as the last modes have it."""
        span = self.span
        if self._most is not None and span.vectors.shape[1] > self._most:
            span.turn(inner[:, : 3 * self._most // 4])
            self._looked, self._at = NOWHERE[0], NOWHERE


class Measure:
    """Measures residuals by their energy in the inverse of a factorised stiffness.

    That takes a solution. The energy in the inverse of the diagonal takes none and is some times less, and these times
    hardly change from round to round and from stiffness to stiffness: a mode that has found its place by it needs no
    solution.

    Args:
        diagonal: of the factorised matrix (n,).
        factor: its factorisation.
        count: residuals that are measured again and again, each known by its number.
    """

    def __init__(self, diagonal: Array, factor: Factorisation, count: int) -> None:
        self._diagonal, self._factor, self.count = diagonal, factor, count
        self._ratio = np.full(count, np.inf)  # of the energies of the last residual of each

    def guessed(self, left: Array, size: Array, which: Index) -> Array:
        """Energies over sizes (k,) of residuals (n, k), by the diagonal; which (k,): their numbers."""
        rough, most = self._rough(left, size), np.maximum(self._ratio[which], np.median(self._ratio))
        return np.asarray(DOUBT * np.multiply(most, rough, out=np.zeros_like(rough), where=rough > 0))

    def solved(self, left: Array, size: Array, which: Index) -> tuple[Array, Array]:
        """Energies over sizes (k,) of residuals (n, k), one or more, and the solutions (n, k)."""
        answer = self._factor.solve(left)
        found = np.abs(np.einsum("ij,ij->j", left, answer)) / size
        self._ratio[which] = found / self._rough(left, size)
        return found, answer

    def _rough(self, left: Array, size: Array) -> Array:
        return np.array([column @ (column / self._diagonal) for column in left.T]) / size


def _left_over(stiffness: Any, mass: Any, shapes: Array, squared: Array) -> Array:
    """Forces (n, m) that shapes (n, m) with squared circular frequencies (m,) leave out of balance."""
    shapes = np.ascontiguousarray(shapes)  # once for both products
    left, moved = product(stiffness, shapes), product(mass, shapes)
    moved *= squared
    left -= moved
    return np.asfortranarray(left)


def _sharper(squared: Array, targets: Array) -> Array:
    """What share of its target (k,) the energy of the residual of each mode may have, from all values (m,) in order.

    The energy is the relative error where the residual has nothing but modes far above. Of a neighbour at a relative
    distance g that the basis lacks it shows g times the error. Where one neighbour is found there may be others: where
    many parts are alike, more modes lie side by side than a block of the Lanczos iteration has vectors. Neighbours
    nearer than the target do no harm.
    """
    steps = np.diff(squared, prepend=-np.inf, append=np.inf)
    apart = np.minimum(steps[:-1], steps[1:])[: len(targets)] / np.abs(squared[: len(targets)])
    few = targets[: len(apart)]
    return np.where(NEIGHBOURS * apart < few, 1.0, np.minimum(NEIGHBOURS * apart, 1.0))


def _rounds_left(excess: float, first: float, done: int) -> float:
    """How many more enrichments an error that is so many times its target asks for, at the rate of those done."""
    if done < 2:
        return 1.0
    return float(np.log10(excess) / max(np.log10(first / excess) / done, SLOWEST))


def refined_modes(
    stiffness: Any,
    mass: Any,
    count: int,
    *,
    rigid: Array,
    shift_frequency: float,
    solver: str | Factoriser | None = None,
    spare: int = 0,
) -> Modes:
    """Find the lowest modes by a factorisation in single precision, and refine them in double.

    Args:
        stiffness: [N/m], sparse (n, n).
        mass: [kg], sparse (n, n).
        count: how many modes, rigid motions included.
        rigid: the motions (n, r) that nothing resists.
        shift_frequency: [Hz], as `lowest_modes` takes it.
        solver: name of the factorisation, or what factorises part by part; those that have no single precision, or
            where that is too coarse, give modes in double precision.
        spare: how many of the highest modes may be as they come, to no tolerance.

    Returns:
        Modes as exact as those of `lowest_modes`, with a factorisation that may be in single precision.

    Raises:
        InputError, NotConverged: as `lowest_modes` does.
    """
    shift = (2 * np.pi * shift_frequency) ** 2
    matrix = Shifted(stiffness=stiffness.tocsr(), mass=mass.tocsr(), shift=shift)
    factor = factorise_roughly(matrix, rigid=rigid, solver=solver)
    wanted = count - rigid.shape[1] - spare
    if not (isinstance(factor, Single) and wanted > 0):
        return lowest_modes(stiffness, mass, count, shift_frequency=shift_frequency, factor=factor, rigid=rigid)
    near = near_factor(factor, stiffness, mass, count, rigid=rigid, shift_frequency=shift_frequency, spare=spare)
    try:
        return near.under(stiffness, wanted, tolerance=REFINED, spare=spare)
    except NotConverged:
        del factor, near  # before the next factorisation: one at a time in memory
    factor = factorise_exactly(matrix, solver)
    return lowest_modes(stiffness, mass, count, shift_frequency=shift_frequency, factor=factor, rigid=rigid)


def near_factor(
    factor: Factorisation,
    stiffness: Any,
    mass: Any,
    count: int,
    *,
    rigid: Array,
    shift_frequency: float,
    spare: int = 0,
    most: int | None = None,
) -> ModalReanalysis:
    """Find the lowest modes to a few digits by a factorisation at hand, as a basis for exact ones and those nearby.

    Args:
        factor: of `stiffness` and `mass` with this shift, in any precision.
        stiffness, mass, count, rigid, shift_frequency, spare: as `refined_modes` takes them.
        most: as `ModalReanalysis` takes it.

    Raises:
        InputError, NotConverged: as `lowest_modes` does.
    """
    # those beyond the last one wanted keep another from standing in its place while residuals are large
    unwatched = max(WATCHED - spare, 0)
    tolerance = np.concatenate([np.full(count, START), np.full(unwatched, np.inf)])
    modes = lowest_modes(
        stiffness,
        mass,
        len(tolerance),
        shift_frequency=shift_frequency,
        factor=factor,
        rigid=rigid,
        tolerance=tolerance,
    )
    return ModalReanalysis(modes, stiffness, mass, rigid=rigid.shape[1], most=most)


def nearby_modes(
    modes: Modes,
    stiffness: Any,
    mass: Any,
    *,
    rigid: int,
    count: int,
    tolerance: float = 1e-7,
    more: Array | None = None,
) -> tuple[Array, Array]:
    """Find the modes under one other stiffness.

    Args:
        modes: those of the stiffness before, rigid motions first.
        stiffness: [N/m] after, sparse (n, n); rigid motions must still be free of it.
        mass: [kg], sparse (n, n).
        rigid: how many of the modes are rigid motions.
        count: how many elastic modes are wanted, at most those that `modes` has.
        tolerance: of the estimated relative error of the squared frequencies.
        more: vectors (n, k) that are likely to be near the new modes.

    Returns:
        Frequencies [Hz] (count,) and shapes (n, count), mass-normalised.

    Raises:
        NotConverged: where the tolerance is not reached.
    """
    near = ModalReanalysis(modes, stiffness, mass, rigid=rigid)
    if more is not None and more.shape[1]:
        near.add(more)
    found = near.under(stiffness, count, tolerance=tolerance)
    return found.frequencies[rigid:], found.shapes[:, rigid:]
