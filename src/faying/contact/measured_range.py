"""How far measured stiffness lies from a law, which the file of the law declares where it was compared."""

from dataclasses import dataclass
from math import log
from typing import final

from faying.distribution import FACTOR_SCORE, Distribution


@final
@dataclass(frozen=True, kw_only=True)
class MeasuredRange:
    """Measured stiffness over that of one law: lognormal, one factor either way about a median for each class of metal.

    Numbers come from benchmarks/law_range.py, of 42 values of 20 pairs of faces of four sources, which are in
    docs/theory/measured-over-laws.csv.

    Args:
        hard: median where both faces are of steel or harder [-].
        soft: median where a face is of a soft metal [-].
        factor: from the median to 95 % [-].
    """

    hard: float
    soft: float
    factor: float

    def of(self, *, soft: bool) -> Distribution:
        """The factor on the stiffness of a joint."""
        centre = self.soft if soft else self.hard
        return Distribution(kind="lognormal", centre=centre, spread=log(self.factor) / FACTOR_SCORE)


# of a law that is a measured curve: 5 to 95 % of pairs of faces of one source about their median
OF_CURVES = MeasuredRange(hard=1.0, soft=1.0, factor=3.2)
