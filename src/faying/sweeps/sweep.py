"""Many laws and preloads on one structure: reduced once, then evaluated in milliseconds each."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from faying.case.case import checked_laws, surfaces_of
from faying.errors import FayingError, InputError
from faying.joint.joint_law import all_predict_loss
from faying.misuse import checked_call
from faying.progress import Report, silent
from faying.reduction.reduced import ReducedModel
from faying.study.part_folder import fingerprint
from faying.study.study import Study
from faying.sweeps.axes import Axis, Grid
from faying.sweeps.files import OF_MODES, Sweep, SweepStore
from faying.sweeps.parallel import each, rows_of
from faying.sweeps.trainer import REFINED_ABOVE, Trainer
from faying.sweeps.variant_builder import VariantBuilder, contact_shares
from faying.typing import Array

CHUNK = 25  # evaluations between two writings to disk
MAX_LAWS = 100  # looked at before there is a mesh


def evaluate(model: ReducedModel, builder: VariantBuilder, indices: Sequence[int]) -> dict[str, Array]:
    """Evaluate some points; rows of what the sweep stores, NaN where a point has no answer, and `reasons`."""
    weights, unknown = np.concatenate(model.weights), np.full(model.count, np.nan)
    start: Array | None = None

    def answer(index: int) -> dict[str, Any]:
        nonlocal start
        before, start = start, None  # a point without an answer starts no other
        laws, forces, friction = builder.laws(index)
        found = builder.model_at(model, index).evaluate(laws, forces, friction, before)
        start = found.preload.displacement
        open_share, above_range = contact_shares(weights, laws, found.preload.pressures)
        return {
            "frequencies": found.frequencies,
            "loss_factors": found.loss_factors if all_predict_loss(laws) else unknown,
            "estimate": found.estimate.max(),
            "greatest_pressure": np.concatenate(found.preload.pressures).max(),
            "open_share": open_share,
            "above_range_share": above_range,
        }

    nothing = {name: unknown if name in OF_MODES else np.nan for name in SweepStore.COLUMNS}
    return rows_of(indices, answer, nothing)


@checked_call
def sweep(
    study: Study | str | Path,
    axes: Sequence[Axis],
    out: str | Path,
    *,
    tolerance: float = 4e-6,
    jobs: int = 1,
    report: Report | None = None,
) -> Sweep:
    """Evaluate a study at all combinations of the values of `axes` and write them to `out` (NetCDF).

    Finished points are saved next to `out` until the end: a sweep that was interrupted resumes where it stopped.

    Args:
        study: a Study or the path of its TOML file.
        axes: what varies, from `axis_of`.
        out: the file to write, ending in .nc.
        tolerance: relative error of a frequency that the bases are made for, 1e-10 to 1e-2.
        jobs: processes on this machine.
        report: called with a stage, the points done, and their number; 0 of 0 while the bases grow.

    Returns:
        The finished sweep.

    Raises:
        InputError: axes that do not fit the study, leftovers of another sweep.
    """
    study = Study.read_bolted(study, first_loading=True)
    report = report or silent
    _check(study, tolerance)
    report("surface", 0, 0)
    grid = Grid(study=study, surfaces=surfaces_of(study), axes=tuple(axes))
    _check_laws(grid)
    mark = fingerprint(study, tuple(axes), tolerance)
    with SweepStore(Path(out), mark, grid.size, study.modes.count) as store:
        report("mesh", 0, 0)
        trainer, model = Trainer.of(study, grid, tolerance, report), store.model()
        if model is None:
            model = trainer.model()
            store.keep_model(model)
        report("evaluations", store.found, grid.size)
        # within a chunk each point starts from the last; chunks are the same after an interruption, so the answers are
        path = grid.winding()
        chunks = [c for c in (path[i : i + CHUNK] for i in range(0, len(path), CHUNK)) if not store.done[c].all()]
        work = partial(evaluate, model, trainer.builder)
        for indices, rows in each(work, chunks, jobs):
            store.keep(indices, rows)
            report("evaluations", int(store.done.sum()), grid.size)
        model = _enriched(model, trainer, store)
        unknowns = trainer.structure.mesh.unknowns
        return store.written(grid, title=study.title, tolerance=tolerance, unknowns=unknowns, model=model)


def _check_laws(grid: Grid) -> None:
    """Raise the fault of the first law where no point of the grid has laws that its joints can use.

    Before the mesh, for the joints whose materials are known by then; without preloads, which change no law.
    """
    places = np.indices(grid.shape).reshape(len(grid.shape), -1)
    first = [k for k, axis in enumerate(grid.axes) if axis.key.startswith("bolt.")]
    fault: FayingError | None = None
    for index in np.flatnonzero((places[first] == 0).all(axis=0))[:MAX_LAWS]:
        point = grid.point(int(index))
        try:
            checked_laws(point.study, point.surfaces)
        except FayingError as met:
            fault = fault or met
        else:
            return
    if fault is not None:
        raise fault


def _check(study: Study, tolerance: float) -> None:
    if not 1e-10 <= tolerance <= 1e-2:
        raise InputError(f"tolerance {tolerance:g} should be between 1e-10 and 1e-2, for example 1e-6")
    if study.modes.damping == "viscous":
        raise InputError("a sweep gives hysteretic loss; leave out modes.damping, or run studies one by one")
    if any(joint.springs == "per-node" for joint in study.joints):
        raise InputError('a sweep takes springs per area; leave out springs = "per-node", or run studies one by one')


def _enriched(model: ReducedModel, trainer: Trainer, store: SweepStore) -> ReducedModel:
    """Train on the points whose estimate is far beyond the tolerance, until none is left or nothing is gained."""
    for _ in range(20):
        far = np.flatnonzero(store.rows["estimate"] > REFINED_ABOVE * trainer.tolerance)
        if not len(far):
            break
        worst = far[np.argsort(-store.rows["estimate"][far])][:4]
        trainer.report(f"enrichment: {len(far)} points", 0, 0)
        model = trainer.model(worst.tolist())
        store.keep_model(model)
        before = store.rows["estimate"][far].copy()
        for indices, rows in each(partial(evaluate, model, trainer.builder), [far.tolist()], 1):
            store.keep(indices, rows)
        if not np.any(store.rows["estimate"][far] < before):
            break
    return model
