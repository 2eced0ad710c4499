"""Modes of a structure whose joints have changed, from the modes and the factorisation of what it was."""

from dataclasses import replace
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.fe.by_parts import PartByPart
from faying.fe.modes import Modes, lowest_modes
from faying.fe.shifted import Shifted
from faying.fe.single import Single, factorise_roughly
from faying.fe.solve import factorise
from faying.fe.span import Span
from faying.typing import Array, Index

ROUNDS = 40  # enrichments of the basis
SLOWEST = 0.3  # decades that a round is taken to gain where it has gained less so far
REFINED = 1e-10  # estimated relative error of the squared frequencies of refined modes
WATCHED = 4  # modes beyond those wanted that must have found their place above them
PLACED = 1e-2  # estimated relative error of their squared frequencies
EVERYWHERE = 6  # vectors of no symmetry that each new stiffness begins with
SEED = 20261124
LEAST = 1e-10  # share of a new vector that must be new


class NearbyModes:
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
        self.modes, self.rigid, self._most = modes, rigid, most
        self._span = Span(mass, stiffness, modes.shapes)

    def add(self, vectors: Array) -> None:
        """Take vectors (n, k) that are likely to be near modes to come, such as those of a stiffness between."""
        size = np.sqrt(np.einsum("ij,ij->j", vectors, self._span.mass @ vectors))
        self._span.add(vectors / size, least=LEAST)

    def under(
        self, stiffness: Any, count: int, *, tolerance: float = 1e-7, spare: int = 0, rounds: int = ROUNDS
    ) -> Modes:
        """Find the modes under a stiffness.

        Args:
            stiffness: [N/m], sparse (n, n).
            count: how many elastic modes are wanted, at most those that the modes before have.
            tolerance: of the estimated relative error of the squared frequencies.
            spare: further modes that are given as they come, to no tolerance.
            rounds: enrichments, those to come included at the rate of those done, beyond which it gives up.

        Returns:
            The rigid motions, `count` elastic modes and the spare ones, with the factorisation of the modes before.

        Raises:
            NotConverged: where the tolerance is not reached.
        """
        from scipy.linalg import eigh

        span = self._span
        first = None
        # the very same matrix is not taken from itself: the difference would have room for both
        change = stiffness[:0] if stiffness is span.operators[0] else (stiffness - span.operators[0]).tocsr()
        change.eliminate_zeros()
        touched = np.flatnonzero(np.diff(change.indptr))
        change = change[touched][:, touched]
        if len(touched):  # else these are modes that have been looked for everywhere already
            self._look_everywhere()
        for done in range(rounds):
            at_joints = span.vectors[touched]
            forces = change @ at_joints
            values, inner = eigh(span.small[0] + at_joints.T @ forces)
            order = np.argsort(np.abs(values))
            wanted = order[self.rigid : self.rigid + count + WATCHED]
            squared, mix = values[wanted], inner[:, wanted]
            left = span.force @ mix - span.momentum @ (mix * squared)
            left[touched] += forces @ mix
            solved = self.modes.factorisation.solve(np.asfortranarray(left))
            error = np.abs(np.einsum("ij,ij->j", left, solved)) / np.abs(squared)
            targets = np.full(len(error), PLACED)
            targets[:count] = tolerance
            excess = float((error / targets).max())
            if excess < 1:
                found = self._found(values, inner, order[: self.rigid + count + spare], error[:count])
                self._keep(inner[:, order])
                return found
            first = first or excess
            if done + _rounds_left(excess, first, done) > rounds:
                break
            new = solved[:, error > targets / 10]
            new = new / np.sqrt(np.einsum("ij,ij->j", new, span.mass @ new))
            if not span.add(new, least=LEAST):
                break
        raise NotConverged(
            f"modes under changed springs: the estimated error stays at {error[:count].max():.1e} (tolerance "
            f"{tolerance:.0e})"
        )

    def _look_everywhere(self) -> None:
        """Take directions of all kinds into the basis.

        The residuals of modes of one symmetry have none of another: a mode that comes down from beyond the basis would
        be missed by all of them, and nothing would tell.
        """
        mass, factor = self._span.mass, self.modes.factorisation
        found = np.random.default_rng(SEED).standard_normal((mass.shape[0], EVERYWHERE))
        for _ in range(2):  # towards the low modes
            found = factor.solve(np.asfortranarray(mass @ found))
            found /= np.sqrt(np.einsum("ij,ij->j", found, mass @ found))
        self._span.add(found, least=LEAST)

    def _found(self, values: Array, inner: Array, order: Index, error: Array) -> Modes:
        return replace(
            self.modes,
            error=np.concatenate([np.zeros(self.rigid), error, np.full(len(order) - self.rigid - len(error), np.nan)]),
            frequencies=np.sqrt(np.abs(values[order])) / (2 * np.pi),
            shapes=self._span.vectors @ inner[:, order],
        )

    def _keep(self, inner: Array) -> None:
        """Where the basis holds too much, keep the lowest three quarters of what it may, as the last modes have it."""
        span = self._span
        if self._most is not None and span.vectors.shape[1] > self._most:
            self._span = Span(span.mass, span.operators[0], span.vectors @ inner[:, : 3 * self._most // 4])


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
    solver: str | PartByPart | None = None,
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

    Returns:
        Modes as exact as those of `lowest_modes`, with a factorisation that may be in single precision.

    Raises:
        InputError, NotConverged: as `lowest_modes` does.
    """
    shift = (2 * np.pi * shift_frequency) ** 2
    matrix = Shifted(stiffness=stiffness.tocsr(), mass=mass.tocsr(), shift=shift)
    factor = factorise_roughly(matrix, rigid=rigid, solver=solver)
    modes = lowest_modes(stiffness, mass, count, shift_frequency=shift_frequency, factor=factor)
    still = rigid.shape[1]
    if not isinstance(factor, Single) or count <= still:
        return modes
    try:
        return NearbyModes(modes, stiffness, mass, rigid=still).under(stiffness, count - still, tolerance=REFINED)
    except NotConverged:
        del factor, modes  # before the next factorisation: one at a time in memory
    if isinstance(solver, PartByPart):
        factor = solver.factorise(matrix, single=False)
    else:
        factor = factorise(matrix.whole(), solver)
    return lowest_modes(stiffness, mass, count, shift_frequency=shift_frequency, factor=factor)


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
    near = NearbyModes(modes, stiffness, mass, rigid=rigid)
    if more is not None and more.shape[1]:
        near.add(more)
    found = near.under(stiffness, count, tolerance=tolerance)
    return found.frequencies[rigid:], found.shapes[:, rigid:]
