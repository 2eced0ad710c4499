"""Follows the mode of [backbone] in samples of a study, each in full, here or in other processes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Self

import numpy as np

from faying.backbones.backbone import curve_like, friction_of, median_of
from faying.backbones.result import measured_points
from faying.errors import InputError
from faying.identify.backbones import Backbones
from faying.identify.sampling.ensemble import Ensemble, by_reason
from faying.identify.sampling.evaluate import Reduced
from faying.joint.structure import Structure
from faying.microslip.epmc import PER_DECADE
from faying.numerics.follow import LIKE
from faying.result.backbone import Backbone
from faying.study.keys.backbone import BackboneChoice
from faying.study.study import Study
from faying.sweeps.parallel import Rows, rows_of
from faying.sweeps.variant_builder import VariantBuilder
from faying.typing import Array

MIN_BACKBONES = 8  # backbones


def choice_of(study: Study, samples: int, backbones: int) -> BackboneChoice:
    """The [backbone] of a study, of which so many of the samples get a curve.

    Raises InputError where the count does not fit, there is no [backbone], or it asks for several curves.
    """
    if not MIN_BACKBONES <= backbones <= samples:
        raise InputError(
            f"backbones = {backbones!r} should be a whole number from {MIN_BACKBONES} to that of the samples, "
            f"{samples:,}"
        )
    choice = study.backbone
    if choice is None:
        raise InputError(
            "backbones of samples need a [backbone] in the study, for example\n[backbone]\nmode = 1\n"
            'amplitude = ["0.1 m/s^2", "60 m/s^2"]\nfriction = 0.2'
        )
    if len(choice.friction) > 1 or choice.laws:
        raise InputError(
            "a sample has one backbone, under its own law: give [backbone] one friction and no law; [uncertain] has "
            "friction and law.model for what is not known"
        )
    return choice


def sliding(ensemble: Ensemble, choice: BackboneChoice, index: int) -> tuple[float, ...]:
    """Friction [-] of the sliders of each joint at a point: what is drawn, else that of [backbone], else the joint's.

    Raises InputError where a joint has none.
    """
    study, drawn = ensemble.point(index).study, ensemble.inputs.names
    joints = []
    for joint in study.joints:
        known = "joint.friction" in drawn or f"joint.{joint.name}.friction" in drawn
        joints.append(joint if known or not choice.friction else replace(joint, friction=choice.friction[0]))
    (found,) = friction_of(replace(study, joints=tuple(joints)), replace(choice, friction=()))
    return found


@dataclass(frozen=True, kw_only=True)
class Follower:
    """Follows one mode in samples, at their last load.

    Args:
        structure: Of the study; parts, laws and gaps of a sample are put into it.
        builder: Makes these; its design is the ensemble.
        choice: What is asked for, at a point that is the same in all samples.
        shape: Mode of the median at rest (unknowns,), after which that of a sample is known.
    """

    structure: Structure
    builder: VariantBuilder
    choice: BackboneChoice
    shape: Array

    @classmethod
    def of(cls, ensemble: Ensemble, choice: BackboneChoice, reduced: Reduced) -> Self:
        """Find the mode of the median, under the first law where several are drawn. Raises what `backbone` does."""
        trainer, store = reduced.trainer, reduced.store
        builder = replace(trainer.builder, design=ensemble)
        kept = store.rows("median", 0)
        if kept is None:
            reduced.report("mode of the backbones", 0, 0)
            shape, at = median_of(builder.case(trainer.structure, ensemble.middle), choice)
            kept = {"shape": shape, "at": np.array(at)}
            store.keep_rows("median", 0, kept)
        x, y, z = kept["at"].tolist()
        # what is assembled is not sent to other processes
        structure = replace(trainer.structure, assembled=None)
        return cls(structure=structure, builder=builder, choice=replace(choice, at=(x, y, z)), shape=kept["shape"])

    @property
    def ensemble(self) -> Ensemble:
        """The samples."""
        assert isinstance(self.builder.design, Ensemble)
        return self.builder.design

    @property
    def grid(self) -> Array:
        """Accelerations [m/s2], about those at which a curve has its own points: between them it is interpolated."""
        low, high = self.choice.amplitude
        steps = np.arange(max(int(np.ceil(PER_DECADE * np.log10(high / low) - 0.5)), 1))
        return np.append(low * 10 ** (steps / PER_DECADE), high)

    def curve(self, sample: int) -> Backbone:
        """The backbone of one sample, counted without those for training. Raises InputError and NotConverged."""
        ensemble = self.ensemble
        index = (ensemble.training + sample + 1) * ensemble.loads - 1
        friction = sliding(ensemble, self.choice, index)
        return curve_like(self.builder.case(self.structure, index), self.choice, friction, self.shape, least=LIKE)

    def rows(self, samples: Sequence[int]) -> Rows:
        """Frequency [Hz] and damping [-] of some samples on the grid, why each ends early, and why it has none."""
        nothing = {"frequencies": np.full(len(self.grid), np.nan), "damping": np.full(len(self.grid), np.nan)}
        return rows_of(samples, self._on_grid, {**nothing, "ends": ""})

    def _on_grid(self, sample: int) -> dict[str, Any]:
        curve = self.curve(sample)
        frequency, damping = np.full((2, len(self.grid)), np.nan)
        complete, last = curve.code == "amplitude", curve.acceleration[-1]
        inside = complete | (self.grid <= last)  # a complete curve may end some tenths of a percent before
        frequency[inside], damping[inside] = curve.at_acceleration(np.minimum(self.grid[inside], last))
        return {"frequencies": frequency, "damping": damping, "ends": "" if complete else curve.reason}

    def follow(self, count: int, reduced: Reduced) -> Backbones:
        """The backbones of the first samples; what is done is kept with what else the prediction keeps."""
        each = [[sample] for sample in range(count)]
        tell = partial(reduced.report, "backbones")
        found = reduced.store.all_rows("backbone", self.rows, each, reduced.jobs, tell)
        return Backbones(
            mode=self.choice.mode,
            preload=self.ensemble.study.loads[-1],
            at=np.array(self.choice.at),
            acceleration=self.grid,
            frequencies=found["frequencies"],
            damping=found["damping"],
            reasons=dict(by_reason(found["reasons"].tolist())),
            ends=dict(by_reason(found["ends"].tolist())),
            **measured_points(self.choice.measured),
        )
