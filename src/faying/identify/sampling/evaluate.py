"""Evaluates samples of a study in its small bases: modes at every load, and which of them are those of the test."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from typing import Any, Self

import numpy as np

from faying.case.mesh_error import MeshError
from faying.errors import FayingError
from faying.identify.identity import by_name, named
from faying.identify.sampling.ensemble import Ensemble
from faying.identify.sampling.points import at_shares, sobol
from faying.identify.sampling.store import SampleStore
from faying.joint.equilibrium import PreloadState
from faying.joint.joint_law import JointLaw, all_predict_loss
from faying.joint.structure import Structure
from faying.measured.mac import mac
from faying.measured.pairing import pair_over_loads
from faying.numerics.follow import follow
from faying.progress import Report, silent
from faying.reduction.reduce import Gapped, Reduction
from faying.reduction.reduced import ReducedModel, Variant
from faying.study.keys.test import TestChoice
from faying.study.keys.uncertain import is_draw
from faying.sweeps.parallel import Rows, Work, each, rows_of
from faying.sweeps.trainer import Trainer
from faying.sweeps.variant_builder import VariantBuilder, contact_shares
from faying.typing import Array, Index

TRAINED = 1.5e-4  # relative error of a frequency where the bases are trained
# estimate of the error of a frequency up to which the bases do not grow for a sample; the error is less, mostly
LIMIT = 7.5e-3
CHUNK = 32  # samples evaluated in one go
DRAWN = 5e-4  # relative error of a frequency where the bases are trained on samples with waves of their own
DRAWN_TOGETHER = 8  # of these: fewer share less of a factor that is read, more make the bases large
ROUNDS = 2  # of training at samples that the bases do not fit
WORST = 4  # samples trained on in each round
LEARNT = 64  # samples, at all of their loads, to whose needs the bases are compressed
NEW = 16  # of those that bases do not fit, worst first: to whose needs they are compressed after they have grown
OF_MODES = ("frequencies", "loss_factors", "named", "named_loss")  # columns of rows with a value for each mode
OF_LOADS = ("estimate", "open_share", "above_range_share")  # and those with one for each load
Trained = Mapping[int, Sequence[PreloadState] | FayingError]  # equilibria of samples, or why they have none
GAINED = 0.9  # of the samples that the bases do not fit: a round that leaves more of them is the last


@dataclass(frozen=True, kw_only=True)
class Evaluator:
    """Evaluates samples, here or in another process.

    Args:
        model: The bases.
        builder: Makes laws, forces, gaps and scales; its design is the ensemble.
        seen: What the points of the test see of the basis (k, d) and of the rigid motions (k, r) along its direction.
        test: The test; None where the study has none.
        median: The median at each load: after the shapes of its modes those of samples are named, and its equilibria
            are where those of samples start.
        trained: Equilibria of samples at the first and the last load, or why they have none, where it is known.
    """

    model: ReducedModel
    builder: VariantBuilder
    seen: tuple[Array, Array] | None = None
    test: TestChoice | None = None
    median: tuple[Variant, ...] = ()
    trained: Trained = field(default_factory=dict)

    @property
    def ensemble(self) -> Ensemble:
        """The samples."""
        assert isinstance(self.builder.design, Ensemble)
        return self.builder.design

    def rows(self, samples: Sequence[int]) -> Rows:
        """Rows of some samples, counted without those for training; NaN where there is no answer, and `reasons`."""
        ensemble, count = self.ensemble, self.model.count
        modes = ensemble.loads, count
        tested = 0 if self.test is None else len(self.test.frequencies[0])
        nothing: dict[str, Any] = dict.fromkeys(OF_MODES, np.full(modes, np.nan))
        nothing |= dict.fromkeys(OF_LOADS, np.full(ensemble.loads, np.nan))
        return rows_of(samples, self._one, {**nothing, "modes": np.full(tested, np.nan)})

    def solved(self, sample: int, *, drawn: bool = True) -> tuple[ReducedModel, list[Variant], list[JointLaw]]:
        """One sample at all loads, with the model under its form and scales, and its laws.

        drawn: whether with its own draw of waves, or with the form of the study.
        """
        known = self.trained.get(sample, ())
        if isinstance(known, FayingError):
            raise known
        starts = dict(zip(self.ensemble.ends, known, strict=False))
        ensemble, builder = self.ensemble, self.builder
        first = (ensemble.training + sample) * ensemble.loads
        model = builder.model_at(self.model, first)
        model = model if drawn else model.with_gaps(builder.modelled_gaps)
        found: list[Variant] = []
        usual = [one.preload.displacement for one in self.median]
        for load in range(ensemble.loads):
            laws, forces, friction = builder.laws(first + load)
            start = found[-1].preload.displacement if found else None
            if usual:
                start = usual[load] if start is None else start + usual[load] - usual[load - 1]
            start = starts[load].displacement if load in starts else start
            found.append(model.evaluate(laws, forces, friction, start))
        return model, found, laws

    def within(self, bases: Reduction, seen: tuple[Array, Array] | None, trained: Trained) -> Self:
        """The same in bases that have grown from these."""
        size, static = len(bases.dynamic.small[0]), len(bases.static.small[0])
        median = []
        for one in self.median:
            shapes = np.pad(one.shapes, ((0, size - len(one.shapes)), (0, 0)))
            moved = np.pad(one.preload.displacement, (0, static - len(one.preload.displacement)))
            median.append(replace(one, shapes=shapes, preload=replace(one.preload, displacement=moved)))
        model = replace(bases.model, count=self.model.count)
        return replace(self, model=model, seen=seen, median=tuple(median), trained=trained)

    def with_median(self, law: int) -> "Evaluator":
        """The same, with the median under one of the laws, or the first sample that has an answer.

        Its faces have the form of the study: a draw of waves has modes of its own, and none is the middle of all. Its
        modes are in the order that they have as modelled: a run numbers them so.
        """
        training = self.ensemble.training
        for sample in (law - training, *range(-training, self.ensemble.count)):
            try:
                median = self.solved(sample, drawn=False)[1]
            except FayingError:
                continue
            return replace(self, median=tuple(map(self._as_modelled, range(len(median)), median)))
        return self

    def _as_modelled(self, load: int, median: Variant) -> Variant:
        """The median at a load, its modes in the order of the study as it stands; as it is where that has no answer."""
        model = self.model.with_gaps(self.builder.modelled_gaps)
        try:
            laws, forces, friction = self.builder.of(self.ensemble.as_modelled(load))
            found = model.evaluate(laws, forces, friction, median.preload.displacement)
        except FayingError:
            return median
        k = follow(found.shapes, median.shapes, model.matrices[2], found.frequencies)
        modes = {name: getattr(median, name)[..., k] for name in ("frequencies", "loss_factors", "shapes")}
        return replace(median, **modes)

    def _one(self, sample: int) -> dict[str, Any]:
        ensemble = self.ensemble
        model, found, laws = self.solved(sample)
        weights = np.concatenate(model.weights)
        shares = [contact_shares(weights, laws, one.preload.pressures) for one in found]
        frequencies = np.stack([one.frequencies for one in found])
        loss = np.stack([one.loss_factors for one in found])
        names = named([one.shapes for one in self.median], [one.shapes for one in found], model.matrices[2])
        lossless = not all_predict_loss(laws)
        nothing = np.full((ensemble.loads, model.count), np.nan)
        loss = nothing if lossless else loss
        # the mode that has the shape of each mode of the median, or the next one left
        pairs = zip(self.median or found, found, strict=True)
        order = np.stack([follow(a.shapes, b.shapes, model.matrices[2], a.frequencies) for a, b in pairs])
        return {
            "frequencies": np.take_along_axis(frequencies, order, axis=1),
            "loss_factors": np.take_along_axis(loss, order, axis=1),
            "named": by_name(frequencies, names),
            "named_loss": by_name(loss, names),
            "modes": self._modes(model, found, names),
            "estimate": np.array([one.estimate.max() for one in found]),
            "open_share": np.array([share for share, _ in shares]),
            "above_range_share": np.array([share for _, share in shares]),
        }

    def _modes(self, model: ReducedModel, found: Sequence[Variant], names: Index) -> Array:
        """Names (t,) of the modes that this sample pairs with the test's, -1 where one has no partner."""
        if self.test is None or self.seen is None:
            return np.zeros(0)
        mass = model.matrices[2]
        shapes = [one.shapes for one in found]
        rows = self.seen[0]
        if model.scales is not None and model.shares is not None:
            rows = rows + self.seen[1] @ model.shares.motion(model.scales)
        modes = pair_over_loads(
            np.array(self.test.frequencies),
            [one.frequencies for one in found],
            [np.abs(rows @ _real(shape, mass)).max(axis=0) for shape in shapes],
            [mac(a.T, b.T, mass) for a, b in pairwise(shapes)],
            threshold=self.test.threshold,
        ).modes
        called = {int(index): name for name, index in enumerate(names[0]) if index >= 0}
        return np.array([called.get(int(mode), -1) for mode in modes], dtype=float)


def _real(shapes: Any, mass: Array) -> Array:
    """Real shapes (d, m) of the motion at its greatest, mass-normalised, from complex ones."""
    turned = shapes / np.sqrt(np.einsum("im,im->m", shapes, mass @ shapes))
    real = turned.real
    return np.asarray(real / np.sqrt(np.einsum("im,im->m", real, mass @ real)))


def probe(structure: Structure, test: TestChoice) -> Any:
    """Sparse rows (points, unknowns) of the motion at the points of a test along its direction."""
    from scipy.sparse import csr_array

    nodes, axis = test.seen(structure.mesh.points)
    where = np.repeat(np.arange(len(nodes)), 3), (3 * nodes[:, None] + np.arange(3)).ravel()
    return csr_array((np.tile(axis, len(nodes)), where), shape=(len(nodes), structure.mesh.unknowns))


class Reduced:
    """A study that scatters, in bases that are made when first needed and grow where samples need it.

    Args:
        ensemble: The samples.
        structure: That of the study; it is made where None.
        jobs: Processes on this machine.
        report: Called with a stage, the samples done, and their number; 0 of 0 while the bases grow.
        store: Keeps bases and samples on disk, so that interrupted work goes on; None keeps nothing.
    """

    def __init__(
        self,
        ensemble: Ensemble,
        *,
        structure: Structure | None = None,
        jobs: int = 1,
        report: Report | None = None,
        store: SampleStore | None = None,
    ) -> None:
        self.jobs = jobs
        self.report: Report = report or silent
        self.report("mesh", 0, 0)
        inputs = ensemble.inputs
        spread = ensemble.with_values(at_shares(inputs.priors, sobol(len(inputs.columns), LEARNT, 0)))
        self.trainer = Trainer.of(ensemble.study, spread, TRAINED, self.report, structure)
        self.store = store or SampleStore(None, what="samples")
        self.seen: tuple[Array, Array] | None = None
        self._work: dict[int, Evaluator] = {}  # in the bases as they are, with the median under each law
        self.draws_waves = any(map(is_draw, inputs.names))
        self.medians = range(max(len(inputs.models), 1) * ensemble.loads)
        kept = self.store.model()
        if kept is None:
            self._train((), _all_loads(spread, range(LEARNT)))
        else:
            self.model, self.seen = kept

    def _train(self, points: Sequence[int], learn: Sequence[int]) -> None:
        """Make or enrich the bases at some points and compress them to the needs of others; what the test sees."""
        if points:
            self._resume()
        if self.draws_waves:
            # draws are nowhere alike: what one of them needs is of no use to others
            self.model = replace(self.trainer.modelled(self.medians).model, count=self.trainer.study.modes.count)
        else:
            self.model = self.trainer.model(points, learn)
        self._work = {}
        test, reduction = self.trainer.study.test, self.trainer.reduction
        assert reduction is not None
        if test is not None:
            self.seen = reduction.probe(probe(self.trainer.structure, test))
        self.store.keep(self.model, self.seen, reduction)

    def _resume(self) -> None:
        """Take up the bases that interrupted work has left, where there are none yet."""
        bases = None if self.trainer.reduction is not None else self.store.bases()
        if bases is not None:
            self.trainer.resume(bases)

    def laws(self, ensemble: Ensemble) -> list[JointLaw]:
        """The law of each joint at the medians."""
        return replace(self.trainer.builder, design=ensemble).laws(ensemble.middle)[0]

    def errors(self, ensemble: Ensemble, rows: Rows) -> Array:
        """Relative errors of the frequencies [-] (2, n) at some samples, each at the load of its greatest estimate.

        By what the bases leave in the full equations: at the samples of the greatest estimates, and at as many evenly
        down to the least; NaN where there are too few, or no answer. The estimate of a sample tells which are worse
        than others; these tell how wrong they are.
        """
        bases, worst = self._whole(), _worst(rows)
        if self.draws_waves:
            sound = np.flatnonzero(np.isfinite(rows["frequencies"][:, 0, 0]))
            some = sound[np.unique(np.linspace(0, len(sound) - 1, WORST).astype(int))]
            bases, _ = self._of_draws(ensemble, 0, some)
            middle = (ensemble.training + some) * ensemble.loads + ensemble.loads // 2
            drawn = np.array([self.trainer.error(int(index), bases) for index in middle])
            return np.stack([np.full(len(drawn), np.nan), drawn])
        ranked = np.argsort(-worst)[: np.count_nonzero(worst)]
        places = np.concatenate([np.arange(WORST), np.linspace(WORST, len(ranked) - 1, WORST + 1)[1:]]).astype(int)
        self.report("check", 0, 0)
        points = self._points(ensemble, rows, ranked[np.unique(places[places < len(ranked)])])
        found = np.full(2 * WORST, np.nan)
        found[: len(points)] = [self.trainer.error(index, bases) for index in points]
        return found.reshape(2, WORST)

    def _whole(self) -> Reduction:
        """The bases at the size of the structure."""
        self._resume()
        if self.trainer.reduction is None:  # what was kept is damaged
            self._train((), ())
        assert self.trainer.reduction is not None
        return self.trainer.reduction

    def modes(self, ensemble: Ensemble, law: int = 0) -> list[tuple[Array, Array]]:
        """Modes of the medians under each load: frequencies [Hz] (m,) and real, mass-normalised shapes (n, m)."""
        basis, mass = self._whole().dynamic.vectors, self.model.matrices[2]
        return [(one.frequencies, basis @ _real(one.shapes, mass)) for one in self._evaluator(ensemble, law).median]

    def mesh_error(self, ensemble: Ensemble, law: int = 0) -> MeshError | None:
        """The error of the mesh in the modes of the medians; None where they, or the elements, do not tell it."""
        self.report("error of the mesh", 0, 0)
        try:
            _, found, laws = self._evaluator(ensemble, law).solved(law - ensemble.training, drawn=False)
        except FayingError:
            return None
        structure, bases = self.trainer.structure.with_joints(laws=laws), self._whole().branch()
        bases.model = self.trainer.builder.model_at(replace(bases.model, count=self.model.count), law * ensemble.loads)
        modes = [bases.with_halves(laws, one.preload.pressures) for one in found]
        springs = [structure.springs(one.preload.pressures) for one in found]
        error = MeshError.of(structure, [one[:2] for one in modes], springs, [one[2] for one in modes])
        median = self._evaluator(ensemble, law).median
        return error and error.of_modes(np.argsort(np.argsort([one.frequencies for one in median], axis=1), axis=1))

    def rows(self, ensemble: Ensemble, what: str = "samples", law: int = 0, *, allowed: float = LIMIT) -> Rows:
        """Rows of all samples of an ensemble that has the same training; those that the bases do not fit, anew.

        what: the name under which they are kept on disk; law: under which the median names the modes; allowed: estimate
        of the error of a frequency up to which the bases do not grow for a sample.
        """
        known = self.store.rows(f"{what}-all", 0)
        if known is not None:
            return known
        size = DRAWN_TOGETHER if self.draws_waves else CHUNK
        chunks = [range(i, min(i + size, ensemble.count)) for i in range(0, ensemble.count, size)]
        tell = partial(self.report, "evaluations")
        work: Work = partial(self._drawn, ensemble, law) if self.draws_waves else self._evaluator(ensemble, law).rows
        out = self.store.all_rows(what, work, chunks, 1 if self.draws_waves else self.jobs, tell)
        out["reasons"] = out["reasons"].astype(object)  # of any length
        for _ in range(0 if self.draws_waves else ROUNDS):
            worst = _worst(out)
            far = np.flatnonzero(worst > allowed)
            if not len(far):
                break
            self.report(f"enrichment: {len(far)} samples", 0, 0)
            ranked = far[np.argsort(-worst[far])]
            self._train(self._points(ensemble, out, ranked[:WORST]), _all_loads(ensemble, ranked[:NEW]))
            for indices, rows in each(self._evaluator(ensemble, law).rows, [far.tolist()], self.jobs):
                for name, values in rows.items():
                    out[name][list(indices)] = values
            if np.count_nonzero(out["estimate"].max(axis=1) > allowed) > GAINED * len(far):
                break
        self.store.keep_rows(f"{what}-all", 0, out)
        return out

    def _of_draws(self, ensemble: Ensemble, law: int, samples: Sequence[int]) -> tuple[Reduction, Evaluator]:
        """Bases that have grown by what the waves of some samples need at the first and the last load, and their work.

        They grow from those of the medians, each time anew: a basis for all draws would be as large as the structure.
        """
        work, bases, loads = self._evaluator(ensemble, law), self._whole().branch(), ensemble.loads
        self.trainer.builder = work.builder
        starts: list[Array | None] = [one.preload.displacement for one in work.median]
        starts = starts or [None] * loads
        gaps = [joint.interface.gap for joint in self.trainer.structure.joints]
        every: dict[int, list[Gapped]] = {}
        trained: dict[int, Sequence[PreloadState] | FayingError] = {}
        for sample in map(int, samples):
            first = (ensemble.training + sample) * loads
            try:
                every[sample] = [work.builder.variant(first + load, gaps, starts[load]) for load in ensemble.ends]
            except FayingError as fault:
                trained[sample] = fault
        trained |= zip(every, bases.train_each(list(every.values()), DRAWN), strict=True)
        test = self.trainer.study.test
        seen = None if test is None else bases.probe(probe(self.trainer.structure, test))
        return bases, work.within(bases, seen, trained)

    def _drawn(self, ensemble: Ensemble, law: int, samples: Sequence[int]) -> Rows:
        """Rows of some samples, each with waves of its own."""
        return self._of_draws(ensemble, law, samples)[1].rows(samples)

    def _points(self, ensemble: Ensemble, rows: Rows, chosen: Index) -> list[int]:
        """Points of some samples, each at the load of its greatest estimate; the trainer then has their ensemble."""
        self.trainer.builder = replace(self.trainer.builder, design=ensemble)
        loads = np.argmax(np.nan_to_num(rows["estimate"][chosen]), axis=1)
        return [int(point) for point in (ensemble.training + chosen) * ensemble.loads + loads]

    def _evaluator(self, ensemble: Ensemble, law: int) -> Evaluator:
        """What evaluates samples in the bases as they are."""
        builder = replace(self.trainer.builder, design=ensemble)
        if law not in self._work:
            work = Evaluator(model=self.model, builder=builder, seen=self.seen)
            self._work[law] = work.with_median(law)
        return replace(self._work[law], builder=builder, test=ensemble.study.test)


def _all_loads(ensemble: Ensemble, samples: Iterable[int]) -> list[int]:
    """Points of some samples at all loads, counted without those for training."""
    loads = ensemble.loads
    return [int(ensemble.training + sample) * loads + load for sample in samples for load in range(loads)]


def _worst(rows: Rows) -> Array:
    """Greatest estimate of each sample over its loads (n,), 0 where it has no answer."""
    return np.asarray(np.nanmax(rows["estimate"], axis=1, initial=0.0))
