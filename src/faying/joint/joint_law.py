"""A contact law laid on a joint: pressure from approach, and stiffness and loss at every point from its pressure."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np

from faying.contact.law import ContactLaw
from faying.contact.response import Response
from faying.errors import InputError
from faying.joint.pressure_curve import PressureCurve, UnloadingCurve, fade
from faying.joint.springs import Motion, Springs
from faying.typing import Array

MAX_INVERTED = 200  # pressures that take no longer to invert than a table to make
TABLE_PRESSURES = 2000  # steps of 1 % of a pressure over nine decades: k between them is right to 1e-5
MIN_PRESSURE = 1.0  # Pa: below it a joint carries nothing that matters, and p(approach) goes on as a power
MIN_SHARE = 0.01  # of a joint's stiffness, worth at most half of that in a frequency: less is not said


@dataclass(frozen=True, kw_only=True)
class LawTable:
    """What a law and a choice of k_t give over pressure, asked once: `JointLaw` reads between the pressures.

    Args:
        model, tangential, nu, end: as in `JointLaw`.
    """

    model: ContactLaw
    tangential: Literal["law", "mindlin"] | float | None
    nu: float
    end: Literal["low", "high"] | None

    @property
    def least_pressure(self) -> float:
        """Below it the joint carries nothing that matters [Pa]: p(approach) and the stiffness go on as powers."""
        return max(MIN_PRESSURE, 1.001 * self.model.least_pressure)

    @cached_property
    def pressures(self) -> Array:
        """From the least to where the law ends [Pa]."""
        p = np.geomspace(self.least_pressure, self.model.greatest_pressure, TABLE_PRESSURES)
        p[-1] = min(p[-1], self.model.greatest_pressure)
        return np.asarray(p)

    @cached_property
    def response(self) -> Response:
        """What the law says there."""
        return self.model.at_pressure(self.pressures)

    @cached_property
    def quantities(self) -> frozenset[str]:
        """The quantities that the law defines."""
        return frozenset(self.response.quantities())

    @cached_property
    def stiffness(self) -> tuple[Array, Array]:
        """k_n and k_t [Pa/m] there."""
        return self.stiffness_of(self.response)

    def stiffness_of(self, at: Response) -> tuple[Array, Array]:
        """k_n and k_t [Pa/m] where the law has been asked."""
        if at.k_n is None:
            raise InputError(f"{self.model.name} defines no normal stiffness; choose another law for the joint")
        factor: Array | float = 1.0
        if self.end is not None:
            limit = at.k_n_low if self.end == "low" else at.k_n_high
            if limit is None:
                raise InputError(f"{self.model.name} states no range of its stiffness")
            factor = limit / np.where(at.k_n > 0, at.k_n, 1.0)
        k_n = factor * at.k_n
        if isinstance(self.tangential, int | float):
            return k_n, k_n * self.tangential
        if self.tangential == "mindlin" or (self.tangential is None and at.k_t is None):
            return k_n, k_n * 2 * (1 - self.nu) / (2 - self.nu)
        if at.k_t is None:
            raise InputError(
                f'{self.model.name} defines no tangential stiffness; leave out tangential = "law", or set "mindlin" or '
                "a number, k_t/k_n"
            )
        return k_n, factor * at.k_t

    @cached_property
    def log_stiffness(self) -> tuple[Array, Array]:
        """Logarithms of k_n and k_t; a law may have no k_t at its least pressure."""
        k_n, k_t = (np.log(np.maximum(k, np.finfo(float).tiny)) for k in self.stiffness)
        return k_n, k_t

    @cached_property
    def log_pressures(self) -> Array:
        """Logarithms of the pressures."""
        return np.log(self.pressures)

    @cached_property
    def loss(self) -> tuple[Array, Array]:
        """Loss factors normal and tangential [-] there; 0 where the law predicts none."""
        nothing = np.zeros(len(self.pressures))
        n, t = (nothing if loss is None else loss for loss in (self.response.loss_n, self.response.loss_t))
        return n, t

    @cached_property
    def loading(self) -> Array:
        """Slope of pressure over approach on loading [Pa/m] there: k_load where the law has one, else k_n."""
        k = self.response.k_load
        return self.stiffness[0] if k is None else k

    @cached_property
    def fade(self) -> float:
        """Power of the pressure with which the stiffness goes on below the least pressure [-]."""
        return fade(self.pressures, self.loading)

    def curve(self, k: Array, what: str) -> PressureCurve:
        """Pressure over approach with stiffnesses k [Pa/m] at the pressures; what they are, in messages."""
        if np.any(k <= 0):
            raise InputError(f"{self.model.name}: no {what} at {self.pressures[np.argmax(k <= 0)]:.4g} Pa")
        return PressureCurve.of(self.pressures, k)

    def within(self, pressure: Array) -> Array:
        """Pressures [Pa] brought within the law; 0 stays 0."""
        return np.where(pressure > 0, np.clip(pressure, self.least_pressure, self.model.greatest_pressure), 0.0)

    def between(self, pressure: Array, values: Array) -> Array:
        """Values at the pressures of the table, read at others within it, linear in ln p; at 0, those of the first."""
        x = np.log(np.where(pressure > 0, pressure, self.least_pressure))
        return np.interp(x, self.log_pressures, values)


@dataclass(frozen=True, kw_only=True)
class JointLaw:
    """The law of one joint, with its pressure as a function of approach: w = integral of dp/k from 0 to p.

    k is the law's k_load where it has one (asperities that yield close more on loading than they spring back), else
    k_n. Below the least pressure k, k_n and k_t fall to 0 as a power of p, from 1/3 (one Hertzian spot) to 2/3, so that
    the faces do meet: a law that grows in proportion to pressure from nothing has its first touch infinitely far away,
    which no finite face has.

    Args:
        model: the contact law.
        tangential: "law" takes its k_t; "mindlin" takes k_t = k_n 2(1-nu)/(2-nu); a number is k_t/k_n itself [-],
            above 0 and at most 2; None takes k_t of the law where it defines one, else Mindlin's.
        nu: Poisson's ratio for Mindlin's ratio [-].
        scale: of both stiffnesses [-], 1 unless a study of sensitivity asks otherwise.
        end: "low" or "high" takes that end of the range of k_n that the law states, and moves k_t with it.
        reason: why this law was taken, where the user named none.
        mates: both faces and their materials in one line, for people.

    Raises:
        InputError: where the law gives no k_n, or no k_t and tangential = "law".
    """

    model: ContactLaw
    tangential: Literal["law", "mindlin"] | float | None = None
    nu: float = 0.3
    scale: float = 1.0
    end: Literal["low", "high"] | None = None
    reason: str = ""
    mates: str = ""
    _made: LawTable | None = field(default=None, repr=False, compare=False)  # by a law that differs in scale

    def scaled(self, factor: float) -> Self:
        """The same law with both stiffnesses times a factor [-]; what has been tabulated is used again."""
        return replace(self, scale=factor * self.scale, _made=self.table)

    @cached_property
    def table(self) -> LawTable:
        """What the law says, without the scale."""
        made = self._made
        mine = LawTable(model=self.model, tangential=self.tangential, nu=self.nu, end=self.end)
        return made if made is not None and made.model is self.model and made == mine else mine

    @property
    def assumes_mindlin(self) -> bool:
        """Whether the tangential stiffness is assumed from the normal one."""
        return self.tangential == "mindlin" or (self.tangential is None and "k_t" not in self.table.quantities)

    @property
    def predicts_loss(self) -> bool:
        """Whether the law gives any loss factor."""
        return bool({"loss_n", "loss_t"} & self.table.quantities)

    @property
    def has_range(self) -> bool:
        """Whether the law states a range of its stiffness."""
        return {"k_n_low", "k_n_high"} <= self.table.quantities

    @property
    def yields(self) -> bool:
        """Whether the law tells loading from unloading, so that something of its approach lasts."""
        return "k_load" in self.table.quantities

    @property
    def first_loading(self) -> "JointLaw":
        """The law of a joint that has carried nothing before."""
        return self

    def check(self) -> None:
        """Raise InputError where a joint cannot use the law: it has no stiffness."""
        self._curve  # noqa: B018  # names its own faults

    @property
    def least_pressure(self) -> float:
        """Below it the joint carries nothing that matters [Pa]: p(approach) and the stiffness go on as powers."""
        return self.table.least_pressure

    @cached_property
    def _curve(self) -> PressureCurve:
        """Pressure over approach on loading."""
        return self.table.curve(self.scale * self.table.loading, "stiffness on loading")

    @cached_property
    def elastic(self) -> PressureCurve | UnloadingCurve:
        """Pressure over approach by k_n alone: how a joint that was loaded before springs back and closes again.

        It is the curve of `pressure` unless the law has a k_load of its own.
        """
        return self._by_k_n

    @property
    def _by_k_n(self) -> PressureCurve:
        if not self.yields:
            return self._curve
        return self.table.curve(self.scale * self.table.stiffness[0], "normal stiffness")

    def answer(self, pressure: Array) -> Response:
        """What the law says at pressures [Pa]; beyond its ends, what it says there."""
        return self.model.at_pressure(self.table.within(pressure))

    def outside_validity(self, pressure: Array, area: Array) -> dict[str, float]:
        """Return the share of the joint's stiffness [-] that lies outside the law's validity range, for each reason.

        Not the share of its area: where faces part, pressure and stiffness fall to nothing over much of a joint, and so
        does what an error of the law there can change.

        Args:
            pressure: at each point [Pa].
            area: of each point [m^2].
        """
        stiffness = area * self.stiffness(pressure)[0]
        total = float(stiffness.sum())
        reasons = self.answer(pressure).reasons.items() if total > 0 else ()
        shares = {reason: float(stiffness @ mask) / total for reason, mask in reasons}
        return {reason: round(share, 6) for reason, share in shares.items() if share >= MIN_SHARE}

    def stiffness(self, pressure: Array, *, tabulated: bool = False) -> tuple[Array, Array]:
        """k_n and k_t [Pa/m] at pressures [Pa] of any shape.

        0 where the pressure is 0, constant beyond the end of the law. The law is asked for a few pressures; many, and
        those of an iteration (tabulated), are read from its table, which is right to 1e-5.
        """
        within = self.table.within(pressure)
        light = within > pressure
        fade = np.where(light, pressure / np.where(light, within, 1.0), within > 0) ** self.table.fade
        if tabulated or np.size(pressure) > MAX_INVERTED:
            found = [np.exp(self.table.between(within, k)) for k in self.table.log_stiffness]
        else:
            found = list(self.table.stiffness_of(self.model.at_pressure(within)))
        k_n, k_t = (self.scale * fade * k for k in found)
        return k_n, k_t

    def loss(self, pressure: Array) -> tuple[Array, Array]:
        """Loss factors normal and tangential [-]; 0, as far as an equation asks, where the law predicts none."""
        within = self.table.within(pressure)
        n, t = (np.where(within > 0, self.table.between(within, loss), 0.0) for loss in self.table.loss)
        return n, t

    def springs(self, interface: Motion, pressure: Array) -> Springs[Motion]:
        """Springs at pressures [Pa] (q,) at the points of an interface."""
        k_n, k_t = self.stiffness(pressure)
        loss_n, loss_t = self.loss(pressure)
        return Springs(interface=interface, pressure=pressure, k_n=k_n, k_t=k_t, loss_n=loss_n, loss_t=loss_t)

    def pressure(self, approach: Array) -> tuple[Array, Array]:
        """Pressure [Pa] and its slope, the stiffness [Pa/m], at approaches [m]; both 0 where the faces are apart.

        Beyond the end of the law the curve goes on as a power, so that an iteration may pass through; whoever keeps a
        result checks the pressure against `law.greatest_pressure`.
        """
        return self._curve.pressure(approach)

    def lasting_approach(self, pressure: Array) -> tuple[Array, Array] | None:
        """Bounds of the approach [m] that is left when pressures [Pa] are taken off; None where the law is elastic.

        It is the approach on loading, the integral of dp/k_load, less what springs back. The stiffness on the way back
        is at most k_n at the greatest pressure, from which it falls, and at least k_n at the same pressure on loading,
        when fewer asperities had been flattened. So what springs back lies between p/k_n and the integral of dp/k_n.
        """
        if not self.yields:
            return None
        p, k = self.table.pressures, self.scale * self.table.stiffness[0]
        closing = np.exp(self._curve.log_w)
        back = self.table.curve(k, "normal stiffness")
        bounds = closing - np.exp(back.log_w), closing - p / k
        within = self.table.within(pressure)
        least, greatest = (
            np.where(pressure > 0, self.table.between(within, np.maximum(bound, 0.0)), 0.0) for bound in bounds
        )
        return least, greatest

    def approach(self, pressure: float) -> float:
        """Closing [m] at one pressure [Pa] between the least and the greatest of the law."""
        return float(self._curve.approach(np.asarray(pressure)))


def all_predict_loss(laws: Sequence[JointLaw]) -> bool:
    """Whether all laws of a structure, one or more, give a loss factor: that of some of them is not that of a mode."""
    return bool(laws) and all(law.predicts_loss for law in laws)
