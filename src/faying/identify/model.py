"""What an identification asks of a model."""

from math import inf
from typing import Protocol

from faying.distribution import Distribution
from faying.progress import Report
from faying.typing import Array


class Model(Protocol):
    """A model with parameters that scatter, evaluated at many of their values.

    names, units, priors: of the d parameters, which are independent; units are SI, "" for plain numbers.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    priors: tuple[Distribution, ...]

    def frequencies(self, values: Array, report: Report | None = None, allowed: float = inf) -> tuple[Array, list[str]]:
        """The frequencies of the test's modes, and after them their loss factors where the test has these.

        Args:
            values: of the parameters (n, d), SI.
            report: told what is done, how much of it, and of how much.
            allowed: the model's own estimate of a frequency's relative error up to which it is good enough.

        Returns:
            Frequencies [Hz] (n, load, mode), or with loss factors [-] (n, load, twice as many), NaN where a sample has
            no answer or a mode of the test no partner; and for each sample the reason why it has no answer, "" where it
            has one.
        """
