"""How far the preload of a bolt scatters with the way it is tightened."""

from dataclasses import dataclass
from typing import final

from faying.distribution import Distribution
from faying.errors import InputError


@final
@dataclass(frozen=True)
class Tightening:
    """Scatter of the preload about its mean, as published: +- `scatter` [-], the wider end where a range is given."""

    scatter: float
    source: str

    @property
    def distribution(self) -> Distribution:
        """Of the preload over its mean [-]: normal, the published range read as two standard deviations each way."""
        return Distribution(kind="normal", centre=1.0, spread=self.scatter / 2).within(0.0, float("inf"), "()")[0]


_VDI = "VDI 2230 (1986), as quoted in published tables of tightening factors"
_NASA = "NASA NSTS 08307, preload uncertainty"
_HANDBOOK = "Machinery's Handbook, accuracy of bolt preload application methods"
TIGHTENING = {
    "torque wrench, friction estimated": Tightening(0.28, _VDI),
    "torque wrench, friction tested": Tightening(0.23, _VDI),
    "yield or angle controlled": Tightening(0.12, _VDI),
    "hydraulic": Tightening(0.23, _VDI),
    "power driver": Tightening(0.43, _VDI),
    "torque, unlubricated": Tightening(0.35, _NASA),
    "torque, cadmium plated": Tightening(0.30, _NASA),
    "torque, lubricated": Tightening(0.25, _NASA),
    "hydraulic tensioner": Tightening(0.15, _NASA),
    "load washer": Tightening(0.10, _NASA),
    "elongation": Tightening(0.05, _NASA),
    "feel": Tightening(0.35, _HANDBOOK),
    "turn of nut": Tightening(0.15, _HANDBOOK),
    "yield sensing": Tightening(0.08, _HANDBOOK),
    "strain gauge": Tightening(0.01, _HANDBOOK),
}

DEFAULT_WAY = "torque wrench, friction estimated"  # of tightening, where nothing says it


def tightening(name: object, where: str) -> Tightening:
    """The way of tightening of a name. Raises InputError that lists those known."""
    if not isinstance(name, str) or name not in TIGHTENING:
        known = "; ".join(f'"{one}" (+-{way.scatter:.0%})' for one, way in TIGHTENING.items())
        raise InputError(f"{where} = {name!r} is not a way of tightening; the known ones are {known}")
    return TIGHTENING[name]
