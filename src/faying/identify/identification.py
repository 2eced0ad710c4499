"""What a test tells of the parameters of a model, drawn."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from faying.identify.identification_figure import identification_axes
from faying.identify.identification_record import IdentificationRecord
from faying.misuse import checked_call

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Identification(IdentificationRecord):
    """The posterior of a model's parameters, and what it predicts.

    names, units, priors: of the parameters; the last two are the relative sd of the test's scatter and of the model's
    discrepancy. log_evidence: ln of the probability density of the test's ln f under this model; a difference between
    two models on one test is the logarithm of their odds. laws: that were compared, where several were; the parameters
    are then those of the likeliest, and the predicted frequencies are drawn from all. evaluations: of the model;
    answered: those with an answer; calls: of the likelihood; rounds: how often the surrogate was drawn closer to the
    posterior.
    """

    @checked_call
    def plot(self, ax: Any = None) -> "list[Axes]":
        """Draw each parameter before and after the test, and frequencies and loss factors beside the test.

        Args:
            ax: Two matplotlib axes to draw into, three where loss factors were used; new ones where None.

        Returns:
            The axes.

        Raises:
            InputError: The number of axes does not fit.
        """
        return identification_axes(self, ax)
