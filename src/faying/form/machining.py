"""How wavy faces are: from a W parameter, a flatness tolerance, or the process that made them."""

from dataclasses import dataclass
from math import pi, sqrt
from typing import final

from faying.form.waviness import Waviness

GAUSSIAN = sqrt(pi / 2)  # Wq over Wa of normal heights
# Of a flatness tolerance, two thirds are long waves (the mean of `faying.form.form.random_depth`). Waves take the
# last third with six times their rms, the range of 99.7 % of normal heights. A convention.
RMS_OF_FLATNESS = 1 / 18


@final
@dataclass(frozen=True, kw_only=True)
class Process:
    """Waviness that a process leaves on faces.

    least, greatest: range of Wa [m]; source: where it comes from; measured: whether both ends are measured, or one of
    them is a convention.
    """

    least: float
    greatest: float
    source: str
    measured: bool

    @property
    def Wa(self) -> float:
        """Value in the middle of the range, by its logarithm [m]."""
        return sqrt(self.least * self.greatest)


# Waves of height h from crest to trough have Wa = h/pi where they are sines.
PROCESSES = {
    "milled": Process(
        least=1.4e-6 / pi,
        greatest=6.0e-6 / pi,
        source="high-speed face milling: waves 1.4 to 6.0 um high, 1.6 to 5.2 mm long (handbook value on the terms of "
        "the recommendation SEV RS 3951-73, stanotex.ru/volnistost-poverhnosti)",
        measured=True,
    ),
    "turned": Process(
        least=1.4e-6 / pi,
        greatest=6.0e-6 / pi,
        source="convention: as milled",
        measured=False,
    ),
    "ground": Process(
        least=0.15e-6,
        greatest=0.6e-6,
        source="convention: a third of milled",
        measured=False,
    ),
    "lapped": Process(
        least=0.05e-6,
        greatest=0.59e-6 / GAUSSIAN,
        source="greatest: rms 0.59 um over a lapped face of 1050 x 130 mm, form included (doi:10.3390/s25175270); "
        "least: convention",
        measured=False,
    ),
}

# Both faces of a bolted lap of 120 x 25 mm, measured each 0.5 mm: the gap less all polynomials of degree up to 4,
# which are crown, twist and longer form, has an rms of 0.98 um (less degree 2: 3.4 um). Porter and Brake 2023,
# doi:10.1016/j.ymssp.2023.110210.
ASSUMED_GAP = 1.0e-6
ASSUMED = Waviness(Wq=ASSUMED_GAP / sqrt(2), origin="assumed")
