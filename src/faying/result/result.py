"""The result of a study: what a run has found, drawn and written for other programs."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faying.errors import InputError
from faying.measured.model import ModelModes
from faying.misuse import checked_call, shortened
from faying.result.figure import frequency_axes
from faying.result.run_record import RunRecord
from faying.result.vtu import write_vtu

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Result(RunRecord):
    """What a study gives. Load [N] means the preload of the first bolt; modes are the elastic ones.

    Frequencies, loss factors and shapes are those of the complex modes; "bonded" are the frequencies with the faces
    of every joint bonded, "free" those with the faces apart. `surfaces` and `laws` hold, per joint, what the law
    was made from and its own numbers. low and high: the frequencies at the ends of the range of stiffness that the
    laws state, None where none states one. `interval`, `levels`, `waves`, `above_range` and `alternatives` are
    groups of what belongs together, each None where the study does not ask for it. `backbones` are the curves over
    amplitude that the study asks for, at the last preload; `vibrations` what it does in service, one after
    another at each preload. `carried` is the greatest preload that the joints carried before each, None where all
    are first loading; `settled` says that this was the greatest of the study.
    `tightening` names the bolts in the order in which they were pulled, and is empty where all were pulled at once.
    `parts`, `faces`, `joint_faces` (the two faces of each joint), `supports` and `masses` say what the structure is
    made of.
    """

    @checked_call
    def plot(self, modes: int = 6, ax: Any = None) -> "list[Axes]":
        """Draw the frequency of each mode against preload.

        5 to 95 % are bands; without intervals the range that the laws state. Frequencies of the test are hollow dots.

        Args:
            modes: How many modes, from the lowest.
            ax: As many matplotlib axes to draw into, in a list or an array; new ones where None.

        Returns:
            The axes, one for each mode.

        Raises:
            InputError: The number of modes or of axes does not fit.
        """
        if modes < 1:
            raise InputError(f"modes = {shortened(modes)}; give how many modes, 1 to {self.frequencies.shape[1]}")
        return frequency_axes(self, min(modes, self.frequencies.shape[1]), ax)

    @checked_call
    def save_vtu(self, path: str | Path) -> list[Path]:
        """Write files for ParaView: NAME.pvd, which is opened, and one .vtu for each preload.

        Each holds the outer surface with every mode shape, real and imaginary, and what touches of each joint with
        pressure, gap, slip, k_n and k_t in SI units, NaN elsewhere; part, face and joint of each triangle, from 0, -1
        where there is none; preload, frequencies and loss factors. ParaView's time is the preload [N].

        Args:
            path: NAME.pvd or NAME.vtu; a folder that is not there is made.

        Returns:
            The paths of all files, the .pvd first.

        Raises:
            InputError: the name ends in something else, or a file cannot be written.
        """
        return write_vtu(self, path)

    def show(self, *, height: int = 620) -> Any:
        """Show the structure in a notebook: moving modes, maps of the joints, faces to click, as `faying view` does.

        Args:
            height: of the view [pixels], 200 to 4000.

        Returns:
            What a notebook shows as the last line of a cell; its `save` writes it as a page.

        Raises:
            InputError: the height does not fit.
        """
        import faying

        return faying.view(self, height=height)


@checked_call
def read_model_modes(path: str | Path, *, load: float | None = None) -> ModelModes:
    """Read the modes of a result file for a comparison with a test.

    Args:
        path: result.nc of `faying run`.
        load: the preload [N]; the last where None.

    Returns:
        The elastic modes at that preload, with the frequency response that the file may hold.

    Raises:
        ReadError: the file is missing, damaged or no result of Faying.
        InputError: it has no such load.
    """
    return Result.load(path).modes_at(load, source=str(path))
