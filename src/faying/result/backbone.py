"""The curve of frequency and damping of a mode against its amplitude, drawn."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from faying.misuse import checked_call
from faying.result.backbone_figure import backbone_axes
from faying.result.backbone_record import BackboneRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Backbone(BackboneRecord):
    """Frequency and damping of one mode against its amplitude.

    The amplitude is that of the fundamental harmonic at the point `at` along `direction`. damping is the joints' ratio
    to critical plus `rest_damping`; friction is that of each joint; mode counts elastic modes from 1; preload [N] is
    that of the first bolt. code and reason say why the curve ends. shape_at [kg^-1/2]: what the mode at rest moves
    at the point. laws: name of the contact law of each joint; measured_source: file of the measured points.
    """

    @checked_call
    def plot(self, ax: Any = None) -> "list[Axes]":
        """Draw frequency and damping against the acceleration, with what was measured and the static cycle.

        Args:
            ax: Two matplotlib axes to draw into, in a list or an array; new ones where None.

        Returns:
            The axes of frequency and of damping.

        Raises:
            InputError: The number of axes does not fit.
        """
        return backbone_axes(self, ax)
