"""What scatter makes of the frequencies of a study, drawn."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from faying.identify.prediction_figure import interval_axes
from faying.identify.prediction_record import PredictionRecord
from faying.misuse import checked_call

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Prediction(PredictionRecord):
    """A study under the scatter of its numbers.

    Args:
        title: Of the study.
        inputs: What scatters.
        seed: Of the samples.
        tolerance: Relative error of a frequency that the bases were made for.
        basis: Sizes of the bases for equilibrium and vibration.
        reasons: Why samples have no answer, and how many.
        discrepancy: Standard deviation of ln f that the samples lack: of each mode, and of parts that do not scatter.
        backbones: Of the first samples; None where they were not asked for.
        notes: What there is to say.
        frequencies_of_test, test_source: The test, where the study has one.
    """

    @checked_call
    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the 5 to 95 % of each frequency about its median, with the test where there is one.

        Args:
            ax: Matplotlib axes to draw into; new ones where None.

        Returns:
            The axes.

        Raises:
            InputError: It is not axes, or no sample has an answer.
        """
        return interval_axes(self, ax)
