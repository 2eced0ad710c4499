"""Read what Faying has saved, whatever it is."""

from pathlib import Path
from typing import Any, get_args

from faying.errors import ReadError
from faying.identify.assemblies import Assemblies
from faying.identify.identification import Identification
from faying.identify.prediction import Prediction
from faying.loads.record import LoadCases
from faying.misuse import checked_call
from faying.result.backbone import Backbone
from faying.result.fields import RECORD, RESULT_FILE, read_tree
from faying.result.result import Result
from faying.result.vibration import VibrationResponse

Saved = Result | Backbone | Prediction | Assemblies | Identification | LoadCases | VibrationResponse
KINDS: tuple[Any, ...] = get_args(Saved)


@checked_call
def load(path: str | Path) -> Saved:
    """Read a file that Faying has saved: a result, a backbone, a prediction, assemblies, an identification, and so on.

    Args:
        path: The file, or the folder of a run.

    Returns:
        What was saved, which the file says; it equals what was written.

    Raises:
        ReadError: The file is missing or damaged, is none of these, or lacks a variable, which is named.
    """
    path = Path(path)
    path = path / RESULT_FILE if path.is_dir() else path
    tree = read_tree(path)
    name = tree.attributes.get(RECORD)
    for kind in KINDS:
        if name == kind.KIND:
            found: Saved = kind.of_file(path, tree)
            return found
    known = ", ".join(kind.KIND for kind in KINDS)
    raise ReadError(f"{path} has nothing that faying.load reads, which is {known}; a sweep is read by xarray")
