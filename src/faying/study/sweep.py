"""Many laws and preloads on one structure: reduced once, then evaluated in milliseconds each."""

import hashlib
import json
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from faying import __version__
from faying.errors import FayingError, InputError
from faying.joint.face_axes import FaceAxes
from faying.joint.form import Form
from faying.joint.joint_law import JointLaw
from faying.joint.reduce import STATIC_SHARE, Reduction
from faying.joint.reduced import ReducedModel
from faying.joint.structure import Structure
from faying.materials import Material
from faying.study.axes import Axis, Grid
from faying.study.case import checked_laws, checked_mesh, joint_law, materials_at, structure_of, surfaces_of
from faying.study.study import Study
from faying.study.sweep_files import Store, Sweep
from faying.typing import Array

CORNERS, RANDOM, CHECKS = 16, 8, 5  # variants trained on, and those that are looked at afterwards
SPARE_MODES = 3  # trained beyond those wanted: a mode that comes down between the corners is in the basis then
CHUNK = 25  # evaluations between two writings to disk
# the estimate is that of a basis a hundred times coarser; beyond this multiple of the tolerance a point is trained on
FAR = 60.0
SEED = 20241121
MOST_LAWS = 100  # looked at before there is a mesh
LATELY = 32  # laws kept with their tables


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a joint lies: its points (q, 3) [m], the gap of its geometry there (q,) [m], and the face's own axes."""

    positions: Array
    geometry: Array
    axes: FaceAxes

    @classmethod
    def all(cls, structure: Structure, grid: Grid) -> "tuple[Place, ...]":
        """The place of each joint; none where no axis varies a form."""
        if not any(".form." in axis.key for axis in grid.axes):
            return ()
        out = []
        for joint, choice in zip(structure.joints, grid.study.joints, strict=True):
            interface, form = joint.interface, choice.form
            axes = FaceAxes.of(structure.mesh, joint.faces, interface, None if form is None else form.along)
            laid = 0.0 if form is None else form.at(interface.positions, axes)
            out.append(cls(positions=interface.positions, geometry=interface.gap - laid, axes=axes))
        return tuple(out)

    def gap(self, form: Form | None) -> Array:
        """Gap [m] (q,) before any load with a form on the geometry."""
        return self.geometry if form is None else self.geometry + form.at(self.positions, self.axes)


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """All that makes the laws and forces of a point: the grid, and the materials that meet at each joint."""

    grid: Grid
    pairs: tuple[tuple[Material, Material], ...]
    places: tuple["Place", ...] = ()  # of each joint, where its form varies; empty where none does
    # laws made lately, with their tables: along an axis of preload they stay the same
    _lately: dict[tuple[Any, ...], JointLaw] = field(default_factory=dict, repr=False, compare=False)

    def __getstate__(self) -> dict[str, Any]:
        return {"grid": self.grid, "pairs": self.pairs, "places": self.places, "_lately": {}}

    def gaps(self, index: int) -> list[Array] | None:
        """Gap [m] (q,) of each joint at one point of the grid; None where no axis varies a form."""
        if not self.places:
            return None
        joints = self.grid.point(index).study.joints
        return [place.gap(joint.form) for place, joint in zip(self.places, joints, strict=True)]

    def laws(self, index: int) -> tuple[list[JointLaw], Array, list[float | None]]:
        """Law of each joint, force of each bolt [N] and friction of each joint at one point of the grid."""
        point = self.grid.point(index)
        laws = []
        for number, (joint, surface) in enumerate(zip(point.study.joints, point.surfaces, strict=True)):
            choice = point.study.law_of(joint)
            key = (number, repr(choice), repr(surface.rough and surface.rough.inputs))
            if key not in self._lately:
                if len(self._lately) >= LATELY:
                    self._lately.pop(next(iter(self._lately)))
                self._lately[key] = joint_law(joint, choice, surface, *self.pairs[number])
            laws.append(self._lately[key])
        return laws, point.forces, [joint.friction for joint in point.study.joints]


def evaluate(model: ReducedModel, recipe: Recipe, indices: Sequence[int]) -> dict[str, Array]:
    """Evaluate some points; rows of what the sweep stores, NaN where a point has no answer, and `reasons`."""
    rows: dict[str, list[Any]] = {name: [] for name in (*Store.COLUMNS, "reasons")}
    weights = np.concatenate(model.weights)
    start: Array | None = None
    for index in indices:
        nothing = np.full(model.count, np.nan)
        row: dict[str, Any] = {
            "frequencies": nothing,
            "loss_factors": nothing,
            "estimate": np.nan,
            "greatest_pressure": np.nan,
            "open_share": np.nan,
            "beyond_share": np.nan,
        }
        reason = ""
        try:
            laws, forces, friction = recipe.laws(index)
            found = model.with_gaps(recipe.gaps(index)).evaluate(laws, forces, friction, start)
            start = found.preload.displacement
            p = np.concatenate(found.preload.pressures)
            end = np.concatenate(
                [np.full(len(q), s.model.greatest_pressure) for q, s in zip(found.preload.pressures, laws, strict=True)]
            )
            touching = float(weights @ (p > 0))
            beyond = float(weights @ (p > end)) / touching if touching else 0.0
            row |= {
                "estimate": found.estimate.max(),
                "greatest_pressure": p.max(),
                "beyond_share": beyond,
                "open_share": 1 - touching / weights.sum(),
            }
            lost = found.loss_factors if any(law.predicts_loss for law in laws) else nothing
            row |= {"frequencies": found.frequencies, "loss_factors": lost}
        except FayingError as fault:
            reason = str(fault)
            start = None
        for name, value in row.items():
            rows[name].append(value)
        rows["reasons"].append(reason)
    return {name: np.array(values) for name, values in rows.items()}


def sweep(
    study: Study | str | Path,
    axes: Sequence[Axis],
    out: str | Path,
    *,
    tolerance: float = 4e-6,
    jobs: int = 1,
    dask: str | None = None,
    report: Callable[[str, int], None] | None = None,
) -> Sweep:
    """Evaluate a study at all combinations of the values of `axes` and write them to `out` (NetCDF).

    What is done is kept beside `out` until all is: a sweep that was interrupted goes on where it stopped.

    Args:
        study: a Study or the path of its TOML file.
        axes: what varies, from `axis_of`.
        out: the file to write, ending in .nc.
        tolerance: relative error of a frequency that the bases are made for, 1e-10 to 1e-2.
        jobs: processes on this machine.
        dask: address of a Dask scheduler, in place of processes.
        report: called with a stage and the number of points just done.

    Returns:
        The finished sweep.

    Raises:
        InputError: axes that do not fit the study, leftovers of another sweep.
    """
    study = Study.read(study)
    report = report or (lambda _stage, _done: None)
    _check(study, tolerance)
    report("surface", 0)
    grid = Grid(study=study, surfaces=surfaces_of(study), axes=tuple(axes))
    _check_laws(grid)
    with closing(Store(Path(out), fingerprint(study, axes, tolerance), grid.size, study.modes.count)) as store:
        report("mesh", 0)
        try:
            trainer, model = _begun(study, grid, store, tolerance, report)
        except FayingError:
            store.forget()
            raise
        report("evaluations", store.found)
        # within a chunk each point starts from the last; chunks are the same after an interruption, so the answers are
        path = grid.winding()
        chunks = [c for c in (path[i : i + CHUNK] for i in range(0, len(path), CHUNK)) if not store.done[c].all()]
        for indices, rows in _each(model, trainer.recipe, chunks, jobs, dask):
            report("evaluations", int((~store.done[indices]).sum()))
            store.keep(indices, rows)
        model = _enriched(model, trainer, store, trainer.recipe)
        unknowns = trainer.structure.mesh.unknowns
        return store.finish(grid, title=study.title, tolerance=tolerance, unknowns=unknowns, model=model)


def _begun(
    study: Study, grid: Grid, store: Store, tolerance: float, report: Callable[[str, int], None]
) -> tuple["_Trainer", ReducedModel]:
    """What makes the bases, and the model in them: made now, or left by an interrupted sweep."""
    mesh = checked_mesh(study)
    pairs = tuple(materials_at(study, mesh, joint) for joint in study.joints)
    structure = structure_of(study, mesh, grid.surfaces)
    recipe = Recipe(grid=grid, pairs=pairs, places=Place.all(structure, grid))
    trainer = _Trainer(study, structure, recipe, tolerance, report)
    model = store.model()
    if model is None:
        model = trainer.model()
        store.keep_model(model)
    return trainer, model


def _check_laws(grid: Grid) -> None:
    """Raise the fault of the first law where no point of the grid has laws that its joints can use.

    Before the mesh, for the joints whose materials are known by then; without preloads, which change no law.
    """
    places = np.indices(grid.shape).reshape(len(grid.shape), -1)
    first = [k for k, axis in enumerate(grid.axes) if axis.key.startswith("bolt.")]
    fault: FayingError | None = None
    for index in np.flatnonzero((places[first] == 0).all(axis=0))[:MOST_LAWS]:
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
        raise InputError(f"tolerance {tolerance:g} should lie between 1e-10 and 1e-2, for example 1e-6")
    if study.modes.damping == "viscous":
        raise InputError("a sweep gives hysteretic loss; leave out modes.damping, or run studies one by one")
    if any(joint.springs == "per-node" for joint in study.joints):
        raise InputError('a sweep takes springs per area; leave out springs = "per-node", or run studies one by one')


def _enriched(model: ReducedModel, trainer: "_Trainer", store: Store, recipe: Recipe) -> ReducedModel:
    """Train on the points whose estimate is far beyond the tolerance, until none is left or nothing is gained."""
    for _ in range(20):
        far = np.flatnonzero(store.rows["estimate"] > FAR * trainer.tolerance)
        if not len(far):
            break
        worst = far[np.argsort(-store.rows["estimate"][far])][:4]
        trainer.report(f"enrichment: {len(far)} points", 0)
        model = trainer.model(worst.tolist())
        store.keep_model(model)
        before = store.rows["estimate"][far].copy()
        for indices, rows in _each(model, recipe, [far.tolist()], 1, None):
            store.keep(indices, rows)
        if not np.any(store.rows["estimate"][far] < before):
            break
    return model


class _Trainer:
    """Makes the bases when they are first needed, and enriches them at points of the grid."""

    def __init__(
        self, study: Study, structure: Structure, recipe: Recipe, tolerance: float, report: Callable[[str, int], None]
    ) -> None:
        self.study, self.structure, self.recipe, self.tolerance = study, structure, recipe, tolerance
        self.report = report
        self.reduction: Reduction | None = None

    def model(self, more: Sequence[int] = ()) -> ReducedModel:
        """Return the bases as `trained` leaves them, for the modes that are wanted."""
        return replace(self.trained(more).model, count=self.study.modes.count)

    def trained(self, more: Sequence[int] = ()) -> Reduction:
        """Return the bases, trained on the corners and some points between, and on the points of `more`."""
        grid = self.recipe.grid
        generator = np.random.default_rng(SEED)
        if self.reduction is None:
            points = grid.corners(CORNERS)
            points += generator.choice(grid.size, min(RANDOM, grid.size), replace=False).tolist()
            middle = int(np.ravel_multi_index(tuple(n // 2 for n in grid.shape), grid.shape))
            self.reduction = self._begun([middle, *points])
            self._train(self.reduction, [*points, *more], "training")
            self.reduction.compress(self.tolerance)
            # a form changes which points touch: more of its grid is looked at
            count = (3 if self.recipe.places else 1) * CHECKS
            checks = generator.choice(grid.size, min(count, grid.size), replace=False).tolist()
            self._check(self.reduction, checks)
        else:
            self._train(self.reduction, more, "training")
        return self.reduction

    def _begun(self, points: Sequence[int]) -> Reduction:
        """Bases from the first of the points that has an answer; raises what the first of them met where none has."""
        fault: FayingError | None = None
        for index in dict.fromkeys(points):
            self.report("reference solution", 0)
            try:
                laws, forces, _ = self.recipe.laws(index)
                return Reduction.of(
                    _with_gaps(self.structure, self.recipe.gaps(index)),
                    laws,
                    forces,
                    count=self.study.modes.count + SPARE_MODES,
                    shift_frequency=self.study.modes.shift_frequency,
                    solver=self.study.modes.solver,
                )
            except FayingError as met:
                fault = fault or met
        assert fault is not None
        raise fault

    def _train(self, reduction: Reduction, points: Iterable[int], what: str) -> None:
        fault: FayingError | None = None
        start: Array | None = None
        for number, index in enumerate(points):
            self.report(f"{what} {number + 1}", 0)
            try:
                gaps = self.recipe.gaps(index)
                start = reduction.train(*self.recipe.laws(index), tolerance=self.tolerance, start=start, gaps=gaps)
            except FayingError as met:  # a point without an answer is reported when it is evaluated
                fault = met
                start = None
        if fault is not None and not reduction.trained:
            raise fault

    def _check(self, reduction: Reduction, points: Sequence[int]) -> None:
        """Look at points that were not trained on by their full residual; train on those that are not good enough."""
        poor = []
        for index in points:
            self.report("check", 0)
            try:
                laws, forces, friction = self.recipe.laws(index)
                reduction.model = reduction.model.with_gaps(self.recipe.gaps(index))
                found = reduction.model.equilibrium(laws, forces, friction)
                error, _ = reduction.modal_error(laws, found.pressures)
                balance, _ = reduction.static_error(laws, forces, friction, found)
            except FayingError:
                continue
            if error.max() > 4 * self.tolerance or balance > 4 * STATIC_SHARE * self.tolerance:
                poor.append(index)
        self._train(reduction, poor, "training")


def _with_gaps(structure: Structure, gaps: Sequence[Array] | None) -> Structure:
    """The structure with other gaps [m] (q,) of its joints before any load; itself where None."""
    if gaps is None:
        return structure
    pairs = zip(structure.joints, gaps, strict=True)
    return replace(
        structure, joints=tuple(replace(joint, interface=replace(joint.interface, gap=gap)) for joint, gap in pairs)
    )


def _each(
    model: ReducedModel, recipe: Recipe, chunks: Sequence[Sequence[int]], jobs: int, dask: str | None
) -> Iterable[tuple[Sequence[int], dict[str, Array]]]:
    """Evaluate chunk by chunk, here, in processes, or on a cluster, as they come."""
    if dask is None and jobs == 1:
        for indices in chunks:
            yield indices, evaluate(model, recipe, indices)
        return
    if dask is not None:
        try:
            distributed: Any = import_module("distributed")
        except ImportError:
            raise InputError("--dask needs the package distributed: add --extra dask to uv run") from None
        try:
            client = distributed.Client(dask, timeout="10s")
        except OSError as fault:
            raise InputError(f"no Dask scheduler answers at {dask} ({fault}); start one with: dask scheduler") from None
        with client:
            there = client.scatter((model, recipe), broadcast=True)
            futures = {client.submit(_evaluate_there, there, list(indices)): indices for indices in chunks}
            for future in distributed.as_completed(futures):
                yield futures[future], future.result()
        return
    from joblib import Parallel, delayed

    work = (delayed(_with_indices)(model, recipe, indices) for indices in chunks)
    yield from Parallel(n_jobs=jobs, return_as="generator_unordered")(work)


def _with_indices(
    model: ReducedModel, recipe: Recipe, indices: Sequence[int]
) -> tuple[Sequence[int], dict[str, Array]]:
    return indices, evaluate(model, recipe, indices)


def _evaluate_there(there: tuple[ReducedModel, Recipe], indices: Sequence[int]) -> dict[str, Array]:
    return evaluate(*there, indices)


def fingerprint(study: Study, axes: Sequence[Axis], tolerance: float) -> str:
    """What tells one sweep from another: Faying's version, the study, the bytes of its files, axes and tolerance."""
    digest = hashlib.sha256(f"{__version__} {study!r}".encode())
    for file in study.files:
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    digest.update(json.dumps([[a.key, list(a.values)] for a in axes] + [tolerance]).encode())
    return digest.hexdigest()
