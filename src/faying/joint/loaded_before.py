"""The law of a joint whose points have carried more before: they unload and load again along curves of their own."""

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from faying.joint.joint_law import JointLaw
from faying.joint.pressure_curve import PressureCurve, UnloadingCurve
from faying.typing import Array

LEAST_SHARE = 1e-3  # of the greatest pressure: below it the stiffness falls as a power, as on first loading
CELLS = 32  # pressures of each curve, a factor of 1.25 apart: the approach between them is right to 1e-4


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadedBefore(JointLaw):
    """A joint's law whose points have carried `greatest` pressures [Pa] (q,): the order of points of its interface.

    serves: whether what presses a point harder is a load of service, under which it closes by k_n, and no preload,
    under which it goes on along first loading.

    Values at other numbers of points, from which an iteration sets out, are those of first loading.
    """

    greatest: Array
    serves: bool = False

    @property
    def first_loading(self) -> JointLaw:
        """The law of the joint before it has carried anything."""
        return JointLaw(**{f.name: getattr(self, f.name) for f in fields(JointLaw)})

    def lasting_approach(self, pressure: Array) -> tuple[Array, Array]:
        """Nothing: what is taken off comes back, since all that lasts was left by the greatest pressure."""
        return np.zeros_like(pressure), np.zeros_like(pressure)

    @cached_property
    def elastic(self) -> UnloadingCurve:
        """Pressure over approach at each point, on the way back and on from the greatest pressure."""
        used = self.greatest > self.least_pressure
        most = np.where(used, self.greatest, self.model.greatest_pressure)
        s = np.linspace(np.log(LEAST_SHARE), 0.0, CELLS)
        p = most[:, None] * np.exp(s)
        k = super().stiffness(p, tabulated=True)[0] * self._ratio("k_n", p, most[:, None])
        curve = PressureCurve.of(p, k, self.table.fade)
        first = self._by_k_n if self.serves else self._curve
        turn = np.where(used, first.approach(self.greatest), 0.0)
        parted = np.where(used, turn - np.exp(curve.log_w[:, -1]), 0.0)
        return UnloadingCurve(
            first=first, log_v=curve.log_w, log_p=curve.log_p, slope=curve.slope, parted=parted, turn=turn
        )

    def stiffness(self, pressure: Array, *, tabulated: bool = False) -> tuple[Array, Array]:
        """k_n and k_t [Pa/m] at pressures [Pa]; see `JointLaw`."""
        k_n, k_t = super().stiffness(pressure, tabulated=tabulated)
        if np.shape(pressure) != self.greatest.shape:
            return k_n, k_t
        as_n = "k_t" not in self.model.remembered().log_ratio or isinstance(self.tangential, int | float)
        factor = self._ratio("k_n", pressure, self.greatest)
        return k_n * factor, k_t * (factor if as_n else self._ratio("k_t", pressure, self.greatest))

    def _ratio(self, name: str, pressure: Array, greatest: Array) -> Array:
        """Of a stiffness to that on first loading, both pressures [Pa] brought within the law."""
        return self.model.remembered().ratio(name, self.table.within(pressure), self.table.within(greatest))

    def pressure(self, approach: Array) -> tuple[Array, Array]:
        """Pressure [Pa] and its slope [Pa/m] at approaches [m] (q,); see `JointLaw`."""
        return self.elastic.pressure(approach)


def loaded_before(law: JointLaw, greatest: Array) -> JointLaw:
    """The law of a joint whose points have carried greatest pressures [Pa] (q,).

    It is the law itself where that says nothing of unloading, or tells nothing from first loading.
    """
    if law.model.memory is None:
        return law
    own = {f.name: getattr(law, f.name) for f in fields(JointLaw)}
    return LoadedBefore(**own | {"_made": law.table}, greatest=greatest)


def in_service(law: JointLaw, pressure: Array) -> JointLaw:
    """The law of a joint under loads about a preload, under which its points bear pressures [Pa] (q,)."""
    before = law.greatest if isinstance(law, LoadedBefore) else 0.0
    found = loaded_before(law.first_loading, np.maximum(pressure, before))
    return replace(found, serves=True) if isinstance(found, LoadedBefore) else found
