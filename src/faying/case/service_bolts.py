"""What is known of each bolt that slip under its head and fatigue need."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying.bolt.bolt import Bolt, FittedBolt, fatigue_area
from faying.bolt.fatigue import FatigueCurve, rolled_after
from faying.joint.bolted import BoltedStructure
from faying.study.keys.bolt_sheet import BoltSheetChoice, choice_of, frictions_of
from faying.study.study import Study
from faying.typing import Array

NAN = float("nan")


@dataclass(frozen=True, kw_only=True)
class ServiceBolt:
    """A bolt in service; NaN and None stand for what is not known.

    Args:
        head_friction: Coefficient under its head [-].
        fatigue: Curve of its fatigue, of a thread rolled before heat treatment.
        yield_force: Its force at yield [N] where the thread is rolled after heat treatment and bears more the less it
            is pulled; None where it is not.
        guided_compliance: Transverse motion of its head over the force across it [m/N].
    """

    head_friction: float
    fatigue: FatigueCurve | None
    yield_force: float | None
    guided_compliance: float

    def slide_motion(self, force: float) -> float:
        """Transverse motion of the head [m] at which it slides under a bolt force [N]."""
        return self.head_friction * force * self.guided_compliance

    def curve(self, mean: float) -> FatigueCurve | None:
        """The curve of its fatigue at a mean force [N]."""
        if self.fatigue is None or self.yield_force is None:
            return self.fatigue
        return replace(self.fatigue, endurance=rolled_after(self.fatigue.endurance, mean / self.yield_force))

    def damage(self, amplitude: float, cycles: float, mean: float) -> float:
        """Damage [-] of cycles at an amplitude of stress [Pa] about a mean force [N]."""
        curve = self.curve(mean)
        return NAN if curve is None else curve.damage(np.array(amplitude), np.array(cycles))


def service_bolts(structure: BoltedStructure, study: Study | None = None) -> tuple[ServiceBolt, ...]:
    """The bolts of a structure; what a study says for the sheet of a bolt comes before its own friction."""
    out = []
    for fitted in structure.fitted_bolts:
        bolt, size, compliance = fitted.bolt, None, NAN
        choice = BoltSheetChoice() if study is None else choice_of(study.bolt_sheets, bolt.name)
        if isinstance(bolt, Bolt):
            size = bolt.diameter if bolt.metric is None else bolt.metric.diameter
        if isinstance(fitted, FittedBolt):
            compliance = fitted.guided_compliance
        _, head = frictions_of(choice, bolt)
        friction = NAN if head is None else head
        curve, force = choice.fatigue_curve(size), None
        if curve is not None and choice.by_yield and bolt.fastener is not None:
            force = bolt.fastener.yield_stress * fatigue_area(fitted)
        made = ServiceBolt(head_friction=friction, fatigue=curve, yield_force=force, guided_compliance=compliance)
        out.append(made)
    return tuple(out)


def head_frictions(bolts: Sequence[ServiceBolt]) -> Array:
    """Coefficient under each head [-] (b,); NaN where it is not known."""
    return np.array([bolt.head_friction for bolt in bolts])
