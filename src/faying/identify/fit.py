"""What a test can tell before any sampling: least squares from many starts, and the combinations that it sees."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying.identify.sampling.emulator import Emulator
from faying.identify.sampling.points import sobol
from faying.result.fields import Recorded, variable
from faying.typing import Array, Index, Mask

STARTS = 16
SHOWN = 3  # combinations that are listed
PULL = 0.01  # of the prior on a least-squares fit, in sd of the prior over sd of the scatter: it only settles ties
REACH = 4.0  # a fit stays within so many spreads of the centre of a prior that has no ends
IDENTIFIED, UNIDENTIFIED = 0.5, 0.9  # posterior over prior sd
PART = 0.3  # least weight of a parameter that a combination is named after


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Fit(Recorded):
    """The least-squares fit: what the model can do at best, without discrepancy and hardly held by the priors.

    misfit: root mean square of ln test - ln model over the frequencies that count, of the model itself. The searches
    run on the surrogate, and the model is asked at the end of each; this is the best of them. NaN where it has no
    answer at any. agreeing: how many of the starts end as near to the test.
    """

    misfit: float
    starts: int
    agreeing: int
    values: Array = variable("model_parameter", "SI", "values of the parameters")
    frequencies: Array = variable("load mode", "Hz", "frequencies of the model there", gaps=True)


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Identifiability(Recorded):
    """Singular values and right vectors of the sensitivity, in units of the scatter and of the priors' sd.

    A combination with the singular value s has the posterior sd 1/sqrt(1 + s^2) of its prior sd, for a linear model.
    """

    names: tuple[str, ...]
    values: Array = variable("combination", "1", "singular values, greatest first")
    vectors: Array = variable("combination model_parameter", "1", "weights of the parameters, each over its prior's sd")

    @property
    def posterior_contraction(self) -> Array:
        """Posterior over prior sd of each combination, for a linear model."""
        return np.asarray(1 / np.sqrt(1 + self.values**2))

    def combination(self, k: int) -> str:
        """The parameters that make up a combination, greatest weight first: "0.94 E - 0.31 crown"."""
        weights = self.vectors[k]
        order = np.argsort(-np.abs(weights).round(6), kind="stable")  # no order by the last digits
        parts = [j for j in order if abs(weights[j]) >= PART or j == order[0]]
        sign = np.sign(weights[parts[0]])
        terms = [f"{'-' if sign * weights[j] < 0 else '+'} {abs(weights[j]):.2f} {self.names[j]}" for j in parts]
        return self.names[parts[0]] if len(parts) == 1 else " ".join(terms).removeprefix("+ ")

    @property
    def text(self) -> str:
        """What the test sees and what it does not, in a sentence or two."""
        seen = self._listed(np.flatnonzero(self.posterior_contraction < IDENTIFIED))
        unseen = self._listed(np.flatnonzero(self.posterior_contraction > UNIDENTIFIED)[::-1])
        first = f"The test identifies {seen}." if seen else "The test identifies none of the parameters."
        return f"{first} It does not identify {unseen}." if unseen else first

    def _listed(self, which: Index) -> str:
        rest = len(which) - SHOWN
        more = f"; and {rest} more combination{'s' * (rest > 1)}" if rest > 0 else ""
        return "; ".join(self.combination(int(k)) for k in which[:SHOWN]) + more


def least_squares_ends(emulator: Emulator, test: Array, used: Mask, scatter: Array, peak: Array, seed: int) -> Array:
    """The values (start, d) at which least squares end, from Sobol points of the priors and from one more point.

    Args:
        emulator: of the model, with the derivatives that the search follows.
        test: what was measured (load, column).
        used: which of it counts.
        scatter: relative sd of the test (column,).
        peak: the likeliest values (d,), the last start.
        seed: of the Sobol points.
    """
    from scipy.optimize import least_squares

    priors, logs = emulator.priors, np.log(np.where(used, test, 1.0))[used]
    sd = np.broadcast_to(scatter, used.shape)[used]
    reach = [-1.0 if p.kind == "uniform" else -REACH for p in priors]
    low, high = (
        np.array([float(p.standardised(end)) for p, end in zip(priors, ends, strict=True)])
        for ends in zip(*(p.support for p in priors), strict=True)
    )
    low, high = np.maximum(low, reach), np.minimum(high, np.negative(reach))

    def values(x: Array) -> Array:
        return np.array([[float(p.from_standard(v)) for p, v in zip(priors, x, strict=True)]])

    def residual(x: Array) -> Array:
        return np.concatenate([(emulator.predict(values(x))[0][0][used] - logs) / sd, PULL * x])

    def slope(x: Array) -> Array:
        return np.concatenate([emulator.gradient(values(x))[0][used] / sd[:, None], PULL * np.eye(len(x))])

    points = sobol(len(priors), STARTS, seed)
    last = (np.array([float(p.standardised(v)) for p, v in zip(priors, peak, strict=True)]) - low) / (high - low)
    starts = low + (high - low) * np.clip(np.vstack([points, last]), 0.02, 0.98)
    ends = [least_squares(residual, x, jac=slope, bounds=(low, high), max_nfev=50).x for x in starts]
    return np.concatenate([values(x) for x in ends])


def identifiability(
    emulator: Emulator, at: Array, used: Mask, noise: tuple[Array, Array], names: tuple[str, ...]
) -> Identifiability:
    """Singular values of the sensitivity at values (d,), with scatter, surrogate error and offsets as noise.

    Args:
        emulator: of the model.
        at: values of the parameters.
        used: what counts of what was measured (load, column).
        noise: relative sd of the scatter and of the offsets, (column,) each.
        names: of the parameters.
    """
    scatter, discrepancy = (np.broadcast_to(values, used.shape[1:]) for values in noise)
    spread = np.array([p.sd_standardised for p in emulator.priors])
    slopes = emulator.gradient(at[None, :])[0] * spread
    error = emulator.predict(at[None, :])[1][0]
    rows = []
    for mode in np.flatnonzero(used.any(axis=0)):
        here = used[:, mode]
        cov = np.diag(scatter[mode] ** 2 + error[here, mode] ** 2) + discrepancy[mode] ** 2
        rows.append(np.linalg.solve(np.linalg.cholesky(cov), slopes[here, mode]))
    _, values, vectors = np.linalg.svd(np.concatenate(rows), full_matrices=True)
    padded = np.zeros(len(names))
    padded[: len(values)] = values
    return Identifiability(names=names, values=padded, vectors=vectors)
