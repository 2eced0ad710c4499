"""Runs of a study with smaller and smaller elements, until the error of the mesh is below a tolerance."""

from collections.abc import Callable
from dataclasses import replace

from faying.case.mesh_error import size_for
from faying.checks import number
from faying.errors import InputError
from faying.notes import Note
from faying.result import Result
from faying.study.study import Study
from faying.units import parse

MAX_RUNS = 5  # of one study: each takes several times the one before
AT_ONCE = 0.5  # least ratio of two sizes: an estimate on a coarse mesh may be too large
MAX_SIZE_RATIO = 0.85  # greatest ratio of two sizes, so that each run gains something
RANGE = 1e-5, 0.1  # tolerances that make sense: below it rounding, above it no answer


def tolerance_of(value: str | float) -> float:
    """A tolerance [-] from a number or a text such as "0.2 %". Raises InputError outside `RANGE`."""
    if isinstance(value, str) and value.strip().endswith("%"):
        value = value.strip()[:-1].strip() + " %"
    found = parse(value, "", name="refine") if isinstance(value, str) else number(value, "refine")
    if not RANGE[0] <= found <= RANGE[1]:
        raise InputError(
            f'refine = {value!r}: the estimated error of a frequency to reach, from 0.001 % to 10 %; write "0.2 %"'
        )
    return found


def refined(study: Study, tolerance: float, run: Callable[[Study], Result]) -> Result:
    """The result on the first mesh whose error of every frequency is below the tolerance [-].

    Args:
        study: with a STEP file to mesh.
        tolerance: of the estimated relative error of each frequency.
        run: runs a study.

    Returns:
        The result, with a note that says the size of the elements, and whether the tolerance is reached.

    Raises:
        InputError: The study has a mesh that is ready.
    """
    if study.geometry.step is None:
        raise InputError(
            f"refine makes smaller elements, and {study.geometry.file.name} is a mesh that is ready; mesh finer in the "
            "program that it comes from, or give geometry.step"
        )
    study = replace(study, modes=replace(study.modes, intervals=True))
    for count in range(1, MAX_RUNS + 1):
        result = run(study)
        error = 0.0 if result.mesh_error is None else float(result.mesh_error.max())
        if error <= tolerance or count == MAX_RUNS:
            break
        study = _finer(study, min(max(size_for(1.0, error, tolerance), AT_ONCE), MAX_SIZE_RATIO))
    words = "is" if error <= tolerance else f"after {MAX_RUNS} meshes is still"
    text = (
        f"elements of {1e3 * study.geometry.size:.3g} mm, and {count} mesh{'es' * (count > 1)}, for --refine: the "
        f"estimated error of the mesh {words} {100 * error:.2g} % at most, where {100 * tolerance:.2g} % was asked"
    )
    fine = Note(code="mesh-refined", text=text)
    note = fine if error <= tolerance else Note(code="mesh-error", severity="limit", text=text)
    return replace(result, notes=(*result.notes, note))


def _finer(study: Study, ratio: float) -> Study:
    """The study with elements smaller by a ratio, those on named faces, too."""
    geometry = study.geometry
    sizes = {name: ratio * size for name, size in geometry.face_size.items()}
    return replace(study, geometry=replace(geometry, size=ratio * geometry.size, face_size=sizes))
