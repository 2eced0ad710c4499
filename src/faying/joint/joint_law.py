"""A contact law laid on a joint: pressure from approach, and stiffness and loss at every point from its pressure."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np

from faying.contact.law import ContactLaw
from faying.contact.response import Response
from faying.errors import InputError
from faying.joint.pressure_curve import ContactTable, PressureCurve, cells, equal_steps, fade
from faying.joint.springs import Motion, Springs
from faying.typing import Array, Index

DIRECT_PRESSURES = 200  # pressures that take no longer to invert than a table to make
MIN_PRESSURE = 1.0  # Pa: below it a joint carries nothing that matters, and p(approach) goes on as a power
MIN_SHARE = 0.01  # of a joint's stiffness, worth at most half of that in a frequency: less is not said


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
        few: pressures up to which a law is inverted exactly; more are read from the table between its points.

    Raises:
        InputError: where the law gives no k_n, or no k_t and tangential = "law".
    """

    model: ContactLaw
    tangential: Literal["law", "mindlin"] | float | None = None
    nu: float = 0.3
    scale: float = 1.0
    points: int = 2000
    end: Literal["low", "high"] | None = None
    reason: str = ""
    mates: str = ""
    few: int = DIRECT_PRESSURES
    _unscaled: "JointLaw | None" = field(default=None, repr=False, compare=False)  # the same law, with tables to share

    def scaled(self, factor: float) -> Self:
        """The same law with both stiffnesses times a factor [-]; what has been tabulated is used again."""
        return replace(self, scale=factor * self.scale, _unscaled=self)

    @cached_property
    def _defined(self) -> frozenset[str]:
        """The quantities that the law defines."""
        if self._unscaled is not None:
            return self._unscaled._defined
        return frozenset(self.model.at_pressure(self._grid[[-1]]).quantities())

    @property
    def assumes_mindlin(self) -> bool:
        """Whether the tangential stiffness is assumed from the normal one."""
        return self.tangential == "mindlin" or (self.tangential is None and "k_t" not in self._defined)

    @property
    def predicts_loss(self) -> bool:
        """Whether the law gives any loss factor."""
        return bool({"loss_n", "loss_t"} & self._defined)

    @property
    def has_range(self) -> bool:
        """Whether the law states a range of its stiffness."""
        return {"k_n_low", "k_n_high"} <= self._defined

    @property
    def yields(self) -> bool:
        """Whether the law tells loading from unloading, so that something of its approach lasts."""
        return "k_load" in self._defined

    def check(self) -> None:
        """Raise InputError where a joint cannot use the law: it has no stiffness."""
        self._samples, self._curve  # noqa: B018  # names their own faults

    @property
    def least_pressure(self) -> float:
        """Below it the joint carries nothing that matters [Pa]: p(approach) and the stiffness go on as powers."""
        return max(MIN_PRESSURE, 1.001 * self.model.least_pressure)

    @cached_property
    def _grid(self) -> Array:
        """Pressures [Pa] of the table, from the least to where the law ends."""
        if self._unscaled is not None:
            return self._unscaled._grid
        p = np.geomspace(self.least_pressure, self.model.greatest_pressure, self.points)
        p[-1] = min(p[-1], self.model.greatest_pressure)
        return np.asarray(p)

    @cached_property
    def _samples(self) -> tuple[Array, tuple[Array, Array], tuple[Array, Array]]:
        """ln pressure, logarithms of k_n and k_t, and the two loss factors, on the grid."""
        if self._unscaled is not None:
            more = np.log(self.scale / self._unscaled.scale)
            log_p, (log_n, log_t), losses = self._unscaled._samples
            return log_p, (log_n + more, log_t + more), losses
        k_n, k_t = self._ask(self._grid)
        with np.errstate(divide="ignore"):  # a law may have no tangential stiffness at its least pressure
            stiffness = np.log(k_n), np.log(k_t)
        return np.log(self._grid), stiffness, self._ask_loss(self._grid)

    @cached_property
    def _loading(self) -> Array:
        """Slope of pressure over approach on loading [Pa/m] on the grid."""
        if self._unscaled is not None:
            return self.scale / self._unscaled.scale * self._unscaled._loading
        slope = self.model.at_pressure(self._grid).k_load
        return np.exp(self._samples[1][0]) if slope is None else self.scale * slope

    @cached_property
    def _fade(self) -> float:
        """Power of the pressure with which the stiffness goes on below the least pressure [-]."""
        return fade(self._grid, self._loading)

    @cached_property
    def _curve(self) -> PressureCurve:
        """Pressure over approach on loading."""
        if self._unscaled is not None:
            return self._unscaled._curve.scaled(self.scale / self._unscaled.scale)
        p, k = self._grid, self._loading
        if np.any(k <= 0):
            raise InputError(f"{self.model.name}: no stiffness on loading at {p[np.argmax(k <= 0)]:.4g} Pa")
        return PressureCurve.of(p, k)

    @cached_property
    def elastic(self) -> PressureCurve:
        """Pressure over approach by k_n alone: how a joint that was loaded before springs back and closes again.

        It is the curve of `pressure` unless the law has a k_load of its own.
        """
        k_n = np.exp(self._samples[1][0])
        if np.any(k_n <= 0):
            raise InputError(f"{self.model.name}: no normal stiffness at {self._grid[np.argmax(k_n <= 0)]:.4g} Pa")
        return PressureCurve.of(self._grid, k_n)

    def _ask(self, pressure: Array) -> tuple[Array, Array]:
        answer = self.model.at_pressure(pressure)
        if answer.k_n is None:
            raise InputError(f"{self.model.name} defines no normal stiffness; choose another law for the joint")
        factor: Array | float = self.scale
        if self.end is not None:
            limit = answer.k_n_low if self.end == "low" else answer.k_n_high
            if limit is None:
                raise InputError(f"{self.model.name} states no range of its stiffness")
            factor = self.scale * limit / np.where(answer.k_n > 0, answer.k_n, 1.0)
        k_n = factor * answer.k_n
        if isinstance(self.tangential, int | float):
            return k_n, k_n * self.tangential
        if self.tangential == "mindlin" or (self.tangential is None and answer.k_t is None):
            return k_n, k_n * 2 * (1 - self.nu) / (2 - self.nu)
        if answer.k_t is None:
            raise InputError(
                f'{self.model.name} defines no tangential stiffness; leave out tangential = "law", or set "mindlin" or '
                "a number, k_t/k_n"
            )
        return k_n, factor * answer.k_t

    def answer(self, pressure: Array) -> Response:
        """What the law says at pressures [Pa]; beyond its ends, what it says there."""
        return self.model.at_pressure(self._within(pressure), exact=False if np.size(pressure) > self.few else None)

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

    def _within(self, pressure: Array) -> Array:
        """Pressures brought within the law; 0 stays 0."""
        return np.where(pressure > 0, np.clip(pressure, self.least_pressure, self.model.greatest_pressure), 0.0)

    def stiffness(self, pressure: Array) -> tuple[Array, Array]:
        """k_n and k_t [Pa/m] at pressures [Pa] of any shape.

        0 where the pressure is 0, constant beyond the end of the law.
        """
        within = self._within(pressure)
        if np.size(pressure) > self.few:
            between = self._between(within)
            k_n, k_t = (np.where(within > 0, np.exp(between(y)), 0.0) for y in self._samples[1])
        else:
            k_n, k_t = self._ask(within)
        raised = within > pressure
        if not np.any(raised):
            return k_n, k_t
        fade = np.where(raised, pressure / np.where(raised, within, 1.0), 1.0) ** self._fade
        return k_n * fade, k_t * fade

    def loss(self, pressure: Array) -> tuple[Array, Array]:
        """Loss factors normal and tangential [-]; 0, as far as an equation asks, where the law predicts none."""
        if not self.predicts_loss:
            return np.zeros(np.shape(pressure)), np.zeros(np.shape(pressure))
        within = self._within(pressure)
        if np.size(pressure) <= self.few:
            return self._ask_loss(within)
        between = self._between(within)
        n, t = (np.where(within > 0, between(y), 0.0) for y in self._samples[2])
        return n, t

    @cached_property
    def _index(self) -> tuple[Index, float]:
        """For `cells` of ln pressure on the grid."""
        return equal_steps(self._samples[0]) if self._unscaled is None else self._unscaled._index

    def _between(self, within: Array) -> Callable[[Array], Array]:
        """Interpolation of what is known on the grid, linear in ln pressure, at pressures within the law."""
        log_p = self._samples[0]
        x = np.clip(np.log(np.where(within > 0, within, 1.0)), log_p[0], log_p[-1])
        cell = cells(log_p, x, *self._index)
        low = log_p[cell]
        share = (x - low) / (log_p[cell + 1] - low)

        def at(values: Array) -> Array:
            return np.asarray((1 - share) * values[cell] + share * values[cell + 1])

        return at

    def springs(self, interface: Motion, pressure: Array) -> Springs[Motion]:
        """Springs at pressures [Pa] (q,) at the points of an interface."""
        k_n, k_t = self.stiffness(pressure)
        loss_n, loss_t = self.loss(pressure)
        return Springs(interface=interface, pressure=pressure, k_n=k_n, k_t=k_t, loss_n=loss_n, loss_t=loss_t)

    def _ask_loss(self, pressure: Array) -> tuple[Array, Array]:
        answer = self.model.at_pressure(pressure)
        nothing = np.zeros(np.shape(pressure))
        return (
            nothing if answer.loss_n is None else answer.loss_n,
            nothing if answer.loss_t is None else answer.loss_t,
        )

    def pressure(self, approach: Array) -> tuple[Array, Array]:
        """Pressure [Pa] and its slope, the stiffness [Pa/m], at approaches [m]; both 0 where the faces are apart.

        Beyond the end of the law the curve goes on as a power, so that an iteration may pass through; whoever keeps a
        result checks the pressure against `law.greatest_pressure`.
        """
        return self._curve.pressure(approach)

    def contact(self, approach: Array) -> tuple[Array, Array, Array]:
        """`pressure` [Pa] with its slope, and k_t of `stiffness` [Pa/m] there, at approaches [m], sooner than both."""
        if np.size(approach) <= self.few:
            p, k_n = self.pressure(approach)
            return p, k_n, self.stiffness(p)[1]
        table = self._table
        if table is None:
            p, k_n = self.pressure(approach)
            return p, k_n, self.stiffness(p)[1]
        factor = self.scale / self._first.scale
        shut = approach > 0
        closing = np.where(shut, approach, self._curve.end)
        log_p, steep, log_t = table.at(np.log(closing * factor))
        p = np.exp(log_p) * shut
        return p, p * steep / closing, np.exp(log_t) * (factor * shut)

    @property
    def _first(self) -> "JointLaw":
        """The law whose tables this one shares; itself where it shares none."""
        return self if self._unscaled is None else self._unscaled._first

    @cached_property
    def _table(self) -> ContactTable | None:
        """For `contact`; a law that is scaled takes it at approaches times its factor."""
        if self._unscaled is not None:
            return self._first._table
        return ContactTable.of(self._curve, self._samples[1][1], self._fade)

    def lasting_approach(self, pressure: Array) -> tuple[Array, Array] | None:
        """Bounds of the approach [m] that is left when pressures [Pa] are taken off; None where the law is elastic.

        It is the approach on loading, the integral of dp/k_load, less what springs back. The stiffness on the way back
        is at most k_n at the greatest pressure, from which it falls, and at least k_n at the same pressure on loading,
        when fewer asperities had been flattened. So what springs back lies between p/k_n and the integral of dp/k_n.
        """
        if not self.yields:
            return None
        p, k = self._grid, np.exp(self._samples[1][0])
        closing = np.exp(self._curve.log_w)
        bounds = closing - np.exp(self.elastic.log_w), closing - p / k
        x = np.log(np.where(pressure > 0, self._within(pressure), p[0]))
        least, greatest = (np.interp(x, np.log(p), np.maximum(bound, 0.0)) for bound in bounds)
        return np.where(pressure > 0, least, 0.0), np.where(pressure > 0, greatest, 0.0)

    def approach(self, pressure: float) -> float:
        """Closing [m] at one pressure [Pa] between the least and the greatest of the law."""
        return float(self._curve.approach(np.asarray(pressure)))
