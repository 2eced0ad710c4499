"""A number that scatters: what a study writes as "200 GPa +- 4 GPa" or "0.1 to 0.6", and its quantiles."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cached_property
from math import exp, inf, isfinite, log, nextafter, sqrt
from typing import Any, Literal, Self, final

import numpy as np

from faying import units
from faying.checks import plain, real, text
from faying.errors import InputError, shown
from faying.typing import Array

FACTOR_SCORE = 1.6448536269514722  # standard normal score of 95 %: a factor spans 5 to 95 %
MOST_SD_LN, MOST_FACTOR = 10.0, 1e6  # of a lognormal: beyond, it spans what no number has
UNSEEN = 6.0  # standard deviations from which a cut is not worth a word
SIGN = r"\+-|\+/-|±"
_RANGE = re.compile(r"([+-]?[0-9.].*?) to ([+-]?[0-9.].*)")
_PLUS_MINUS = re.compile(rf"([+-]?[0-9.].*?) ?(?:{SIGN}) ?(.*)")
# what a table of each distribution needs, and what it may hold besides
_KEYS = {
    "normal": (("mean", "sd"), ("low", "high")),
    "lognormal": (("median",), ("sd_ln", "factor", "low", "high")),
    "uniform": (("low", "high"), ()),
}


@final
@dataclass(frozen=True, kw_only=True)
class Distribution:
    """One distribution, cut at `low` and `high` and renormalised in between.

    Args:
        kind: "normal", "lognormal" or "uniform".
        centre: the mean; the median of a lognormal; the middle of a uniform one. Before it is cut.
        spread: the standard deviation; that of ln x for a lognormal; half the width of a uniform one. Before it is cut.
        low, high: where the density is cut.

    Raises:
        InputError: an unknown kind, a spread that is not positive, a lognormal whose median is not positive, nothing
            left between `low` and `high`.
    """

    kind: str
    centre: float
    spread: float
    low: float = -inf
    high: float = inf

    def __post_init__(self) -> None:
        if not isinstance(self.kind, str) or self.kind not in _KEYS:
            raise InputError(f"distribution {shown(self.kind)}; allowed are {', '.join(_KEYS)}")
        for name in ("centre", "spread", "low", "high"):
            object.__setattr__(self, name, real(getattr(self, name), f"{self.kind} distribution: {name}"))
        if not isfinite(self.centre):
            raise InputError(f"{self.kind} distribution: centre = {self.centre}; it must be finite")
        if not (isfinite(self.spread) and self.spread > 0):
            raise InputError(f"{self.kind} distribution: spread = {self.spread:g}; it must be positive")
        if self.kind == "lognormal" and self.centre <= 0:
            raise InputError(f"lognormal distribution: median = {self.centre:g}; it must be positive")
        if not self.low < self.high:
            raise InputError(f"{self.kind} distribution: low = {self.low:g}, high = {self.high:g}; low must be less")
        first, last = self._scores
        if not first < last or self._log_mass(first, last) < log(1e-300):
            raise InputError(
                f"{self.kind} distribution about {self.centre:g} has no probability between {self.low:g} and "
                f"{self.high:g}; move the limits or widen it"
            )

    # -- the one scale on which all three are simple

    def standardised(self, x: Any) -> Any:
        """The scale (x - centre)/spread of values `x`, any shape; of ln x for a lognormal."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            if self.kind == "lognormal":
                return (np.log(np.maximum(x, 0.0)) - log(self.centre)) / self.spread
            return (np.asarray(x, dtype=float) - self.centre) / self.spread

    def from_standard(self, z: Any) -> Array:
        """The values at (x - centre)/spread = z, any shape; held within the support."""
        shifted = np.asarray(z, dtype=float) * self.spread
        whole = self.centre * np.exp(shifted) if self.kind == "lognormal" else self.centre + shifted
        return np.clip(whole, *self.support)

    @cached_property
    def _scores(self) -> tuple[float, float]:
        """Where the density begins and ends on that scale."""
        first, last = float(self.standardised(self.low)), float(self.standardised(self.high))
        return (max(first, -1.0), min(last, 1.0)) if self.kind == "uniform" else (first, last)

    def _log_mass(self, first: Any, last: Any) -> Any:
        """ln of the probability between two scores, before cutting."""
        with np.errstate(divide="ignore", invalid="ignore"):
            if self.kind == "uniform":
                return np.log(np.maximum(np.minimum(last, 1.0) - np.maximum(first, -1.0), 0.0) / 2)
            from scipy.special import log_ndtr

            mirrored = np.asarray(first) > 0  # the smaller of the two tails, for its digits
            low, high = np.where(mirrored, -np.asarray(last), first), np.where(mirrored, -np.asarray(first), last)
            upper = log_ndtr(high)
            share = np.exp(np.where(upper > -inf, np.minimum(log_ndtr(low) - upper, 0.0), 0.0))
            return upper + np.log(np.maximum(1 - share, 0.0))

    def _at_shares(self, below: Array, above: Array) -> Array:
        """The values with shares of probability below and above them, given as their logarithms."""
        first, last = self._scores
        if self.kind == "uniform":
            width = last - first
            return self.from_standard(
                np.where(below < above, first + width * np.exp(below), last - width * np.exp(above))
            )
        from scipy.special import log_ndtr, ndtri_exp

        lower = np.logaddexp(above + log_ndtr(first), below + log_ndtr(last))
        upper = np.logaddexp(above + log_ndtr(-first), below + log_ndtr(-last))
        return self.from_standard(np.where(lower < upper, ndtri_exp(lower), -ndtri_exp(upper)))

    @property
    def _is_cut(self) -> bool:
        return self._scores != (-inf, inf)

    @property
    def sd_standardised(self) -> float:
        """The standard deviation on that scale; 1 but for what is uniform or cut."""
        if self.kind == "lognormal":
            return Distribution(kind="normal", centre=0, spread=1, low=self._scores[0], high=self._scores[1]).sd
        return self.sd / self.spread

    # -- what it is

    @property
    def support(self) -> tuple[float, float]:
        """Where the density begins and ends."""
        if self.kind == "uniform":
            return max(self.low, self.centre - self.spread), min(self.high, self.centre + self.spread)
        return (max(self.low, 0.0), self.high) if self.kind == "lognormal" else (self.low, self.high)

    @property
    def median(self) -> float:
        """The median."""
        return float(self.quantile(np.array(0.5)))

    @property
    def mean(self) -> float:
        """The mean."""
        return self._moments()[0]

    @property
    def sd(self) -> float:
        """The standard deviation."""
        return self._moments()[1]

    def _moments(self) -> tuple[float, float]:
        """Mean and standard deviation, of what is left after cutting."""
        if self.kind == "uniform":
            least, greatest = self.support
            return (least + greatest) / 2, (greatest - least) / sqrt(12)
        first, last = self._scores
        if self.kind == "normal":
            if not self._is_cut:
                return self.centre, self.spread
            from scipy.stats import truncnorm

            mean, variance = truncnorm.stats(first, last, moments="mv")
            return self.centre + self.spread * float(mean), self.spread * sqrt(float(variance))
        s, whole = self.spread, self._log_mass(first, last)
        # E x^k = median^k exp(k^2 s^2/2) P(first - k s < z < last - k s)/P(first < z < last)
        raw = [k * k * s * s / 2 + self._log_mass(first - k * s, last - k * s) - whole for k in (1, 2)]
        return self.centre * exp(raw[0]), self.centre * exp(raw[0]) * sqrt(max(np.expm1(raw[1] - 2 * raw[0]), 0.0))

    def quantile(self, u: Array) -> Array:
        """The values below which shares `u` of the probability lie.

        Args:
            u: shares from 0 to 1, any shape.
        """
        u = np.asarray(u, dtype=float)
        with np.errstate(divide="ignore"):
            return self._at_shares(np.log(u), np.log1p(-u))

    def from_score(self, score: Array) -> Array:
        """The values whose probability is that of standard normal scores, exact in both tails; any shape."""
        score = np.asarray(score, dtype=float)
        if not self._is_cut:
            return self.from_standard(score)
        from scipy.special import log_ndtr

        return self._at_shares(log_ndtr(score), log_ndtr(-score))

    def score(self, x: Array) -> Array:
        """Standard normal scores of the probability of values `x`, any shape: the inverse of `from_score`."""
        z = np.asarray(self.standardised(x), dtype=float)
        if not self._is_cut:
            return z
        from scipy.special import ndtri_exp

        first, last = self._scores
        z = np.clip(z, first, last)
        below, above = (self._log_mass(*ends) - self._log_mass(first, last) for ends in ((first, z), (z, last)))
        out: Array = np.where(below < above, ndtri_exp(np.minimum(below, 0)), -ndtri_exp(np.minimum(above, 0)))
        return out

    def log_density(self, x: Array) -> Array:
        """ln of the density at values `x`, any shape; -inf outside the support."""
        x = np.asarray(x, dtype=float)
        least, greatest = self.support
        inside = (x >= least) & (x <= greatest)
        whole = self._log_mass(*self._scores)
        if self.kind == "uniform":
            return np.where(inside, -log(2 * self.spread) - whole, -inf)
        with np.errstate(all="ignore"):
            z = self.standardised(x)
            density = -(z**2) / 2 - log(self.spread * sqrt(2 * np.pi)) - whole
            density = density - np.log(x) if self.kind == "lognormal" else density
        return np.where(inside & np.isfinite(density), density, -inf)

    def within(
        self, least: float, greatest: float, ends: Literal["()", "[)", "(]", "[]"] = "[]"
    ) -> tuple["Distribution", float]:
        """Cut to an allowed range.

        Args:
            least, greatest: the allowed range.
            ends: which ends belong to it.

        Returns:
            The distribution within the range, and the share of probability that was cut.

        Raises:
            InputError: more than half of the probability lies outside.
        """
        lowest = nextafter(least, inf) if ends[0] == "(" and least > -inf else least
        highest = nextafter(greatest, -inf) if ends[1] == ")" and greatest < inf else greatest
        first, last = self._scores
        # the parts outside, each by itself: 1 less the part inside would lose small shares
        edges = (float(self.standardised(lowest)), float(self.standardised(highest)))
        outside = (self._log_mass(first, min(edges[0], last)), self._log_mass(max(edges[1], first), last))
        whole = self._log_mass(first, last)
        share = min(sum(exp(part - whole) for part in outside), 1.0)
        if share > 0.5:
            raise InputError(
                f"{self.text('')} is for {share:.0%} outside the allowed {least:g} to {greatest:g} (SI units); at "
                "most half may be cut, so that another centre or spread is needed"
            )
        support = self.support
        needless = self.kind == "lognormal" and least <= 0
        low = lowest if lowest > support[0] and not needless else self.low
        high = highest if highest < support[1] else self.high
        return replace(self, low=low, high=high), share

    # -- for people

    def text(self, unit: str) -> str:
        """The distribution in words, "200 GPa +- 4 GPa (normal)"; `unit` is the SI unit of x."""
        least, greatest = self.support
        if self.kind == "uniform":
            return f"{_show(least, unit)} to {_show(greatest, unit)} (uniform)"
        if self.kind == "normal":
            out = f"{_show(self.centre, unit)} +- {_show(self.spread, unit)} (normal"
        else:
            out = f"{_show(self.centre, unit)}, sd of ln {self.spread:.3g} (lognormal"
        first, last = self._scores
        cuts = [f"above {_show(self.low, unit)}"] if first > -UNSEEN else []
        cuts += [f"below {_show(self.high, unit)}"] if last < UNSEEN else []
        return ", ".join([out, " and ".join(cuts)] if cuts else [out]) + ")"

    @classmethod
    def read(cls, value: object, unit: str, name: str = "value") -> Self:
        """Read what a study says.

        Args:
            value: "0.1 to 0.6" (uniform), "200 GPa +- 4 GPa" or "200 GPa +- 2 %" (normal, with that standard
                deviation), or a table with `distribution` and what that one takes: mean and sd; median and sd_ln or
                factor (5 to 95 % lie within median/factor to median*factor); low and high. low and high of a normal or
                lognormal distribution cut it.
            unit: the SI unit; "" for a plain number.
            name: what the error calls it.

        Raises:
            InputError: it is none of these; the text shows the forms.
        """
        text(unit, "unit")
        text(name, "name")
        try:
            if isinstance(value, Mapping):
                return cls(**_of_table(value, unit, name))
            return cls(**_of_text(value, unit, name))
        except InputError as fault:
            message = str(fault)
            raise InputError(message if message.startswith(name) else f"{name}: {message}") from None


def uncertain_text(value: object) -> bool:
    """Whether something is text in one of the two short forms, "0.1 to 0.6" or "200 GPa +- 4 GPa"."""
    found = isinstance(value, str) and (_matched(_PLUS_MINUS, value) or _matched(_RANGE, value))
    return bool(found)


def _matched(form: re.Pattern[str], value: str) -> re.Match[str] | None:
    """The parts of a text in a form, however many blanks it has."""
    return form.fullmatch(" ".join(value.split()))


def _show(value: float, unit: str) -> str:
    return units.show(value, unit) if unit else f"{value:.4g}"


def _forms(unit: str) -> str:
    """The short forms for a unit."""
    example = units.EXAMPLES.get(unit, f"1 {unit}") if unit else "0.3"
    number, _, word = example.partition(" ")
    ends = f"{example} to {1.5 * float(number):.3g} {word}" if word else "0.1 to 0.6"
    return f'write for example "{example} +- 5 %" (normal) or "{ends}" (uniform)'


def _number(value: object, unit: str, name: str) -> float:
    """One quantity in SI, or one plain number."""
    return units.parse(value, unit, name=name) if unit else plain(value, name)


def _of_text(value: object, unit: str, name: str) -> dict[str, Any]:
    if isinstance(value, str):
        try:
            if found := _matched(_PLUS_MINUS, value):
                centre = _number(found.group(1), unit, name)
                return {"kind": "normal", "centre": centre, "spread": _sd(found.group(2), centre, unit, name)}
            if found := _matched(_RANGE, value):
                low, high = (_number(part, unit, name) for part in found.groups())
                return _uniform(low, high, name)
        except InputError as fault:
            plain = str(fault).partition("; write")[0].removeprefix(f"{name} = ").removeprefix(f"{name}: ")
            raise InputError(f'{name} = "{value}": {plain}; {_forms(unit)}') from None
    given = f'"{value}"' if isinstance(value, str) else shown(value)
    raise InputError(f"{name} = {given} is not a distribution; {_forms(unit)}, or a table with `distribution`")


def _sd(value: object, centre: float, unit: str, name: str) -> float:
    """A standard deviation: a quantity, or per cent of the centre."""
    found = units.NUMBER.fullmatch(value) if isinstance(value, str) else None
    if found and found.group(2) == "%":
        if centre == 0:
            raise InputError(f"{name}: the standard deviation is {value} of 0; give it as a quantity")
        out = float(found.group(1)) / 100 * abs(centre)
    else:
        out = _number(value, unit, name)
    if out <= 0:
        raise InputError(f"{name}: the standard deviation {value} must be positive")
    return out


def _uniform(low: float, high: float, name: str) -> dict[str, Any]:
    if not low < high:
        raise InputError(f"{name}: the first end of a range must be less than the second")
    return {"kind": "uniform", "centre": (low + high) / 2, "spread": (high - low) / 2, "low": low, "high": high}


def _of_table(table: Mapping[str, Any], unit: str, name: str) -> dict[str, Any]:
    kind = table.get("distribution")
    if kind not in _KEYS:
        given = "has no `distribution`" if kind is None else f"has distribution = {shown(kind)}"
        raise InputError(f"{name} {given}; allowed are {', '.join(_KEYS)}, {_example('normal', unit)}")
    needed, optional = _KEYS[kind]
    for key in table:
        if key not in ("distribution", *needed, *optional):
            near = get_close_matches(str(key), (*needed, *optional), n=1)
            hint = f"did you mean {near[0]}?" if near else f"a {kind} one takes {', '.join((*needed, *optional))}"
            raise InputError(f"{name}.{key} is not a key of a {kind} distribution; {hint}")
    missing = [key for key in needed if key not in table]
    if missing:
        raise InputError(f"{name}.{missing[0]} is missing; {_example(kind, unit)}")
    value = {
        key: _number(table[key], unit, f"{name}.{key}") for key in ("mean", "median", "low", "high") if key in table
    }
    if kind == "uniform":
        return _uniform(value["low"], value["high"], name)
    cut: dict[str, Any] = {key: value[key] for key in ("low", "high") if key in value}
    if kind == "normal":
        spread = _sd(table["sd"], value["mean"], unit, f"{name}.sd")
        return {"kind": kind, "centre": value["mean"], "spread": spread, **cut}
    if ("sd_ln" in table) == ("factor" in table):
        raise InputError(f"{name} needs one of sd_ln and factor; {_example(kind, unit)}")
    if "factor" in table:
        factor = _number(table["factor"], "", f"{name}.factor")
        if not 1 < factor <= MOST_FACTOR:
            raise InputError(
                f"{name}.factor = {factor:g}; it must be greater than 1, and {MOST_FACTOR:g} at most: 5 to 95 % lie "
                "within it"
            )
        return {"kind": kind, "centre": value["median"], "spread": log(factor) / FACTOR_SCORE, **cut}
    spread = _number(table["sd_ln"], "", f"{name}.sd_ln")
    if not 0 < spread <= MOST_SD_LN:
        raise InputError(f"{name}.sd_ln = {spread:g}; it must be positive, {MOST_SD_LN:g} at most, for example 0.2")
    return {"kind": kind, "centre": value["median"], "spread": spread, **cut}


def _example(kind: str, unit: str) -> str:
    example = f'"{units.EXAMPLES.get(unit, f"1 {unit}")}"' if unit else "0.3"
    rest = {"normal": f'mean = {example}, sd = "5 %"', "lognormal": f"median = {example}, factor = 2"}
    ends = _forms(unit).rpartition(' or "')[2].partition('"')[0].split(" to ")
    low, high = (f'"{end}"' if unit else end for end in ends)
    return f'for example {{distribution = "{kind}", {rest.get(kind, f"low = {low}, high = {high}")}}}'
