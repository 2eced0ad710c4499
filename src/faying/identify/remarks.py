"""What a reader of an identification should know."""

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from faying.distribution import Distribution
from faying.identify.fit import UNIDENTIFIED
from faying.identify.noise import DISCREPANCY, LOSS_DISCREPANCY, LOSS_SCATTER, SCATTER
from faying.notes import Note
from faying.typing import Array, Mask
from faying.units import show

END, PRESSED = 0.05, 0.25  # share of the prior at an end, and of the posterior that makes it worth a note
MIXED = 0.3  # correlation with the start of a stage above which the samples have not mixed
CLEARLY = 1.05  # ratio of two errors from which one is the greater as they are printed
SHOWN = 3  # reasons that are listed


def of_data(parameters: int, wanted: Mask, used: Mask, loads: Array, modes: int) -> Iterator[Note]:
    """What of the test the model has no partner for; more parameters than measured numbers.

    wanted, used: (load, column), frequencies of the `modes` and then loss factors.
    """
    lost = [
        f"{'loss factor of ' if j >= modes else ''}mode {j % modes + 1} at {show(loads[i], 'N')}"
        for i, j in zip(*np.nonzero(wanted & ~used), strict=True)
    ]
    if lost:
        text = f"Not used, since the model has no partner for them over most of the priors: {', '.join(lost)}."
        yield Note(code="test-modes", severity="limit", text=text)
    count, measured = int(used.sum()), "frequencies" if used.shape[1] == modes else "frequencies and loss factors"
    if parameters > count:
        yield Note(
            code="more-parameters-than-data",
            text=f"{parameters} parameters and {count} {measured}: some combinations of the parameters stay as "
            "uncertain as their priors make them. More preloads or modes, or fewer parameters, reduce that.",
        )


def of_answers(reasons: Sequence[str], where: str) -> list[Note]:
    """Samples without an answer, counted by reason."""
    failed = Counter(filter(None, reasons))
    if not failed:
        return []
    listed = [f"{reason} ({times})" for reason, times in failed.most_common(SHOWN)]
    rest = f", and {len(failed) - SHOWN} other reasons" if len(failed) > SHOWN else ""
    text = f"{failed.total()} of {len(reasons)} points {where} have no answer: {', '.join(listed)}{rest}."
    return [Note(code="no-answer", severity="wrong", text=text)]


def of_posterior(names: Sequence[str], priors: Sequence[Distribution], samples: Array) -> Iterator[Note]:
    """Parameters that the test does not tell, and those that press against an end of their prior."""
    for name, prior, values in zip(names, priors, samples.T, strict=True):
        of_noise = name in (SCATTER, DISCREPANCY, LOSS_SCATTER, LOSS_DISCREPANCY)
        # of ln x for a lognormal: pressed against its upper end, x itself scatters by more than before
        left = float(prior.standardised(values).std(ddof=1) / prior.sd_standardised)
        if left > UNIDENTIFIED and not of_noise:
            text = f"The test carries no information about {name}: its posterior sd is {left:.0%} of its prior's."
            yield Note(code="not-told", text=text)
        ends = prior.quantile(np.array([END, 1 - END]))
        for share, side in ((np.mean(values < ends[0]), "lower"), (np.mean(values > ends[1]), "upper")):
            if share > PRESSED and not (of_noise and side == "lower"):  # little noise is not a fault
                text = (
                    f"{name} presses against the {side} end of its prior: {share:.0%} of the posterior is in the "
                    f"outer {END:.0%} of it. The prior is too narrow, or the model lacks something."
                )
                yield Note(code="end-of-prior", text=text)


def of_sampling(correlation: float) -> list[Note]:
    """Samples that did not mix."""
    if correlation <= MIXED:
        return []
    text = (
        f"The samples moved little in one stage (correlation {correlation:.2f} with its start): there may be several "
        "separate solutions, whose weights are less certain than the intervals within each."
    )
    return [Note(code="not-mixed", severity="limit", text=text)]


def of_surrogate(missed: float, claimed: float, scatter: float, *, rough: bool) -> Iterator[Note]:
    """A surrogate that is worse than it says, or worse than the test."""
    if rough:
        text = (
            f"About the posterior the surrogate misses the model by {missed:.2%} rms, where its own error says "
            f"{claimed:.2%}: the intervals may be too narrow or in the wrong place. Narrower priors help."
        )
        yield Note(code="surrogate-rough", severity="limit", text=text)
    if claimed > CLEARLY * scatter:
        text = (
            f"The surrogate's error, {100 * claimed:.3g} %, is greater than that of the test, {100 * scatter:.3g} %: "
            "the intervals are wider than the test would allow. More evaluations or narrower priors help."
        )
        yield Note(code="surrogate-wide", severity="limit", text=text)
