"""What contact remembers: its numbers below the greatest pressure that it has carried, over those of first loading."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np

from faying.contact.response import Response
from faying.typing import Array

STEP = 2.0  # factor from one pressure of the table to the next
DEEPEST = 10  # steps below the greatest pressure that are tabulated, a factor of 1000; the ratio stays constant below
Ratios = Mapping[str, Array]


@dataclass(frozen=True, kw_only=True, eq=False)
class Memory:
    """Ratios of what a law says after a greatest pressure P to what it says on first loading, at pressures p up to P.

    Between the entries of the table ln ratio is linear in ln p and in ln(P/p).

    Args:
        pressure: [Pa] (n,), each `STEP` times the one before.
        log_ratio: ln of the ratio of each quantity by its name (n, d): at p = pressure[i] after P = pressure[i]
            `STEP`^j.
    """

    pressure: Array
    log_ratio: Mapping[str, Array]

    @classmethod
    def of(cls, least: float, greatest: float, solve: Callable[[Array], Ratios]) -> Self:
        """Make the table of a law.

        Args:
            least, greatest: pressures [Pa] that the law covers.
            solve: takes pressures (n,) and returns by name ratios (n, n), at the first index after the second.
        """
        first, last = np.ceil(np.log2(least)), np.floor(np.log2(greatest))
        pressure = STEP ** np.arange(first, max(last, first + 1) + 1)
        n, out = len(pressure), {}
        for name, solved in solve(pressure).items():
            logs = np.zeros((n, DEEPEST + 1))
            for i, row in enumerate(solved):
                known = np.log(row[i : i + DEEPEST + 1])
                logs[i] = np.pad(known, (0, DEEPEST + 1 - len(known)), "edge")
            out[name] = logs
        return cls(pressure=pressure, log_ratio=out)

    def ratio(self, name: str, pressure: Array, greatest: Array) -> Array:
        """Ratio of a quantity [-] at pressures [Pa] after greatest ones [Pa], shapes that broadcast; 1 above these.

        Where nothing has been carried before, and at no pressure, it is 1.
        """
        p, most = np.broadcast_arrays(np.asarray(pressure, dtype=float), np.asarray(greatest, dtype=float))
        used = (p > 0) & (p <= most)
        logs, n = self.log_ratio[name], len(self.pressure)
        with np.errstate(divide="ignore", invalid="ignore"):
            x = np.where(used, np.log2(p / self.pressure[0]), 0.0)
            back = np.where(used, np.log2(most / p), 0.0)
        i = np.clip(x, 0, n - 1)
        j = np.clip(back, 0, DEEPEST)
        row, column = np.minimum(i.astype(int), n - 2), np.minimum(j.astype(int), DEEPEST - 1)
        a, b = i - row, j - column
        low = (1 - b) * logs[row, column] + b * logs[row, column + 1]
        high = (1 - b) * logs[row + 1, column] + b * logs[row + 1, column + 1]
        return np.where(used, np.exp((1 - a) * low + a * high), 1.0)

    def after(self, response: Response, greatest: Array) -> Mapping[str, Array]:
        """The quantities of a response on first loading, as they are after greatest pressures [Pa] of its shape.

        Below these the contact is elastic: the slope on loading is k_n, and nothing is lost in the normal direction.
        """
        p = response.pressure
        given = response.quantities()
        out = {name: given[name] * self.ratio(name, p, greatest) for name in self.log_ratio if name in given}
        used, stiffer = p < greatest, self.ratio("k_n", p, greatest)
        out |= {name: given[name] * stiffer for name in ("k_n_low", "k_n_high") if name in given}
        if "k_load" in given:
            out["k_load"] = np.where(used, out["k_n"], given["k_load"])
        if "loss_n" in given:
            out["loss_n"] = np.where(used, 0.0, given["loss_n"])
        return {name: np.asarray(value) for name, value in out.items()}
