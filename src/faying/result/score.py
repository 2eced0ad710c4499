"""How well a result meets a test, beside what needs no model of the joint."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from faying.typing import Array, Mask

if TYPE_CHECKING:
    from faying.result.result import Result


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Score:
    """Measured frequencies and the guesses that they are compared with.

    Args:
        loads: [N] (l,).
        test: [Hz] (l, t), NaN where no mode was paired.
        guesses: [Hz] (l, t) by what they are called: "Faying", and others that need no joint model or no Faying.
        inside: whether the test lies within 5 to 95 % (l, t); None in a result without intervals.
    """

    loads: Array
    test: Array
    guesses: dict[str, Array]
    inside: Mask | None

    @classmethod
    def of(cls, result: "Result") -> "Score | None":
        """The score of a result; None where its study gives no test, or none of its modes is paired."""
        c = result.comparison
        if c is None or c.kind != "test" or not np.any(c.modes >= 0):
            return None
        paired = c.modes >= 0
        test = np.where(paired, c.frequencies, np.nan)
        rows = np.arange(len(result.loads))[:, None]
        modes = np.maximum(c.modes, 0)
        guesses = {"Faying": c.predicted}
        if len(test) > 1:
            none = np.full((1, test.shape[1]), np.nan)
            before, ratio = np.vstack([none, test[:-1]]), np.vstack([none, c.predicted[1:] / c.predicted[:-1]])
            guesses |= {"test at the load before": before, "that times Faying's ratio": before * ratio}
        if result.bonded is not None and result.free is not None:
            guesses |= {"faces bonded": result.bonded[modes], "faces apart": result.free[modes]}
        if c.published is not None:
            guesses[c.published_name] = c.published
        inside = None
        if result.interval is not None:
            low, high = result.interval.ends[:, rows, modes]
            inside = (low <= test) & (test <= high)
        return cls(loads=result.loads, test=test, guesses=guesses, inside=inside)

    def errors(self, name: str) -> Array:
        """Root of the mean square of the relative error at each load [-] (l,); NaN where there is none."""
        miss = (self.guesses[name] / self.test - 1) ** 2
        count = np.isfinite(miss).sum(axis=1)
        return np.where(count > 0, np.sqrt(np.nansum(miss, axis=1) / np.maximum(count, 1)), np.nan)

    @property
    def gain(self) -> float:
        """Error of the test carried to the last load by Faying's ratio, over that of the test left as it was [-].

        Below 1 the joint model adds something; the error of dimensions, which both share, does not count. NaN for one
        load.
        """
        if len(self.loads) < 2:
            return float("nan")
        return float(self.errors("that times Faying's ratio")[-1] / self.errors("test at the load before")[-1])

    @property
    def measured(self) -> int:
        """How many measured frequencies are paired."""
        return int(np.isfinite(self.test).sum())
