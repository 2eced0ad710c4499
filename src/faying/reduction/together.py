"""Bases for several variants of a structure at once: their corrections are solved and added in one block."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.errors import NotConverged
from faying.joint.equilibrium import PreloadState
from faying.joint.joint_law import JointLaw
from faying.reduction.reduce import FEW_STEPS, LEFT_OUT, STATIC_SHARE, Reduction, pressed
from faying.reduction.reduced import ReducedModel, Variant
from faying.typing import Array


@dataclass(frozen=True, kw_only=True)
class Gapped:
    """One variant: the law of each joint, force of each bolt [N] (b,), friction and gap [m] (q,) of each joint."""

    laws: Sequence[JointLaw]
    forces: Array
    friction: Sequence[float | None]
    gaps: Sequence[Array]

    def model(self, reduction: Reduction) -> ReducedModel:
        """The bases as they are, with the gaps of this variant; the reduction has them from then on."""
        reduction.model = reduction.model.with_gaps(self.gaps)
        return reduction.model


def train_together(reduction: Reduction, variants: Sequence[Gapped], tolerance: float) -> list[Array]:
    """Make the bases fit several variants, which costs less than one after the other.

    A factor is read once for the corrections of all, and each block of new directions is projected once.

    Args:
        reduction: the bases, which grow.
        variants: what they are made for.
        tolerance: relative error of a frequency.

    Returns:
        The coefficients of each equilibrium, from which like variants may start.

    Raises:
        NotConverged: a variant has no equilibrium, or its error does not fall.
    """
    found = _train_static(reduction, variants, STATIC_SHARE * tolerance)
    _train_dynamic(reduction, variants, found, 2 * tolerance)
    return [state.displacement for state in found]


def evaluate(reduction: Reduction, variant: Gapped, start: Array | None = None) -> Variant:
    """Modes of one variant in the bases as they are; start: coefficients of a like equilibrium."""
    return variant.model(reduction).evaluate(variant.laws, variant.forces, variant.friction, start)


def _train_static(reduction: Reduction, variants: Sequence[Gapped], tolerance: float) -> list[PreloadState]:
    """Grow the basis for equilibrium until every variant is right to `tolerance` in energy; their equilibria."""
    found: dict[int, PreloadState] = {}
    poor = list(range(len(variants)))
    for _ in range(FEW_STEPS):
        residuals = []
        for k in poor:
            one, start = variants[k], found[k].displacement if k in found else None
            found[k] = one.model(reduction).equilibrium_from(one.laws, one.forces, one.friction, start)
            residuals.append(reduction.static_residual(one.laws, one.forces, one.friction, found[k]))
        right = np.asfortranarray(np.stack(residuals, axis=1))
        answers = reduction.factor.solve(right)
        work = np.maximum(np.einsum("ij,ij->j", right, answers), 0.0)
        sizes = np.array([pressed(reduction.interfaces, variants[k].laws, found[k]) for k in poor])
        far = np.sqrt(work) / sizes >= tolerance
        poor = [k for k, is_far in zip(poor, far, strict=True) if is_far]
        if not poor:
            return [found[k] for k in range(len(variants))]
        reduction.static.add(answers[:, far])
        reduction.refresh()
    raise NotConverged(f"reduction: {FEW_STEPS} enrichments leave {len(poor)} equilibria wrong; raise the tolerance")


def _train_dynamic(
    reduction: Reduction, variants: Sequence[Gapped], found: Sequence[PreloadState], tolerance: float
) -> None:
    """Grow the basis for vibration until all modes of every variant are right; tolerance: of the eigenvalues."""
    poor: list[Any] = [np.arange(reduction.model.count)] * len(variants)
    for _ in range(FEW_STEPS):
        left = []
        for k, one in enumerate(variants):
            if len(poor[k]):
                one.model(reduction)
                left.append((k, *reduction.modal_parts(one.laws, found[k].pressures, poor[k])))
        right = np.asfortranarray(np.concatenate([part for _, parts, _ in left for part in parts], axis=1))
        answers = reduction.factor.solve(right)
        energy = np.einsum("ij,ij->j", right, answers)
        corrections, at = [], 0
        for k, parts, size in left:
            spans = [slice(at + i * len(size), at + (i + 1) * len(size)) for i in range(len(parts))]
            far = np.sum([energy[span] for span in spans], axis=0) / size > tolerance
            corrections += [answers[:, span][:, far] / np.sqrt(size[far]) for span in spans]
            poor[k] = poor[k][far]
            at += len(parts) * len(size)
        corrections = [correction for correction in corrections if correction.shape[1]]
        if not corrections:
            return
        if not reduction.dynamic.add(np.concatenate(corrections, axis=1), least=LEFT_OUT * tolerance):
            raise NotConverged("reduction: some modes stay wrong and nothing improves them")
        reduction.refresh()
    raise NotConverged(
        f"reduction: {FEW_STEPS} enrichments do not bring a mode to {tolerance:.0e}; ask for fewer modes"
    )
