"""What the test in a study tells of the numbers that scatter in it."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np

from faying.case.case import mates_notes
from faying.case.mesh_error import mesh_notes
from faying.case.part_tests import KnownParts
from faying.case.scatter import of_parts
from faying.errors import InputError
from faying.identify.identification import Identification, mixed
from faying.identify.identify import Model, identify_model
from faying.identify.identity import paired, paired_modes
from faying.identify.noise import DISCREPANCY_SD, LOSS_DISCREPANCY_SD, LOSS_TEST_SD, TEST_SD, Losses
from faying.identify.predict import MIN_SAMPLES, check, check_seed, cut_notes, of_bases
from faying.identify.sampling.ensemble import Ensemble, scattering
from faying.identify.sampling.evaluate import LIMIT, Reduced
from faying.identify.sampling.store import SampleStore
from faying.joint.preload_case import preload_index
from faying.misuse import checked_call
from faying.notes import Note
from faying.progress import Report, silent
from faying.study.keys.uncertain import UncertainChoice, is_draw
from faying.study.keys.varied import MODEL
from faying.study.part_folder import fingerprint
from faying.study.study import Study
from faying.sweeps.parallel import Rows
from faying.sweeps.variant_builder import check_key
from faying.typing import Array, Index

COUNT = 1000  # samples of the posterior


class StudyModel(Model):
    """A study in its reduced bases, under one of its laws, as an identification asks for it.

    Tests of parts move its frequencies; what they leave open is less than the discrepancy that is identified. The
    error of the mesh moves them too, and what is not known of it counts with scatter and discrepancy.
    """

    def __init__(
        self, ensemble: Ensemble, reduced: Reduced, stage: "_Stage", law: int = 0, parts: KnownParts | None = None
    ) -> None:
        self.ensemble, self.reduced, self.stage, self.law = ensemble, reduced, stage, law
        self.mesh = reduced.mesh_error(ensemble, law)
        moved = np.zeros(1) if parts is None else parts.left()[0]
        self.factors = np.exp(moved if self.mesh is None else moved + self.mesh.middle)  # on the frequencies (load, m)
        inputs = ensemble.inputs
        columns = [column for column in inputs.columns if column.key != MODEL]
        self.names = tuple(column.key for column in columns)
        self.priors = tuple(column.distribution for column in columns)
        self.units = tuple(column.unit for column in columns)
        self.calls = 0
        self.last: tuple[Ensemble, Rows] | None = None  # samples that had to be good, and their rows
        self.modes: Index | None = None  # of the bases that are the test's

    def frequencies(self, values: Array, report: Report | None = None, allowed: float = inf) -> tuple[Array, list[str]]:
        """Frequencies of the test's modes (n, load, mode) [Hz] at values (n, d), and why a sample has none.

        Where the test has loss factors, those of the same modes follow. The bases grow where a frequency may miss by
        more than is allowed.
        """
        self.calls += 1
        inputs, what, stage = self.ensemble.inputs, f"{self.calls:03d}", "evaluations"
        if inputs.models:
            stage, what = f"evaluations of {inputs.models[self.law][0]}", f"{self.law}-{what}"
            values = np.column_stack([values, np.full(len(values), inputs.share(self.law))])
        self.stage.begin(stage, report)
        samples = self.ensemble.with_values(values)
        rows = self.reduced.rows(samples, what, self.law, allowed=allowed)
        rows["named"] = rows["named"] * self.factors
        if allowed < inf and len(values) > 1:
            self.last = samples, rows
        test = self.ensemble.study.test
        assert test is not None
        if self.modes is None:
            self.modes = paired_modes(np.array(test.frequencies), rows)
        given = ["named"] if test.losses is None else ["named", "named_loss"]
        found = [paired(rows[name], self.modes) for name in given]
        return np.concatenate(found, axis=2), [str(reason) for reason in rows["reasons"]]

    def own_errors(self) -> tuple[Array, Array]:
        """See `Model`."""
        if self.mesh is None or self.modes is None:
            return super().own_errors()
        offset, scatter = (np.where(self.modes < 0, 0.0, sd[self.modes]) for sd in self.mesh.sd)
        return offset, scatter


class _Stage:
    """Gives the evaluations that the bases report the name of what they are for."""

    def __init__(self, report: Report | None) -> None:
        self.report, self.name = report or silent, "evaluations"

    def begin(self, name: str, report: Report | None) -> None:
        self.report, self.name = report or self.report, name

    def __call__(self, stage: str, done: int, total: int) -> None:
        self.report(self.name if stage == "evaluations" else stage, done, total)


@checked_call
def identify(
    study: Study | str | Path,
    leave_out: str | float | Sequence[str | float] | None = None,
    *,
    seed: int = 0,
    count: int = COUNT,
    jobs: int = 1,
    out: str | Path | None = None,
    report: Report | None = None,
) -> Identification:
    """Identify the numbers that scatter in a study from the frequencies of its test, and the loss factors it gives.

    What [uncertain] says are the priors. The model's own error in each mode, the same at all preloads, and the scatter
    of the test are identified with the rest. Where [uncertain] lists laws, each is identified by itself; the evidence
    weighs them, the parameters are those of the likeliest, and the predicted frequencies are drawn from all.

    Args:
        study: a Study or the path of its TOML file; it has [test] with frequencies, and [uncertain].
        leave_out: preloads whose frequencies are predicted and not used, "12 kN" or newtons.
        seed: of all random numbers, 0 or more.
        count: samples of the posterior, 100 or more.
        jobs: processes on this machine.
        out: file to write, ending in .nc; finished work is saved next to it, and the same call resumes there.
        report: told what is done, how much of it, and of how much.

    Returns:
        The posterior, with what it predicts and what the test cannot tell.

    Raises:
        InputError: no test with frequencies, nothing that scatters, a preload that the study has not, no answer.

    Source:
        Kennedy and O'Hagan 2001, doi:10.1111/1467-9868.00294; Ching and Chen 2007,
        doi:10.1061/(ASCE)0733-9399(2007)133:7(816), for the sampling.
    """
    study = Study.read_bolted(study, first_loading=True)
    check_seed(seed)
    check(study, MIN_SAMPLES)
    if count < 100:
        raise InputError(f"count = {count!r} should be a whole number of 100 or more")
    if study.test is None or not study.test.points:
        raise InputError(
            "an identification needs a test: give [test] frequencies, one list for each preload, and the points where "
            "they were measured"
        )
    _check_draws(study)
    left = left_out(study, leave_out)
    file = None if out is None else Path(out)
    mark = fingerprint(study, left, seed, count, LIMIT)
    with SampleStore(file, mark, what="identification") as store:
        found = _identified(study, left, seed=seed, count=count, jobs=jobs, store=store, report=report)
        if file is not None:
            found.save(file)
        store.finish()
    return found


def left_out(study: Study, wanted: str | float | Sequence[str | float] | None) -> tuple[int, ...]:
    """Indices of preloads that are left out. Raises InputError for one that the study has not, and for all of them."""
    given = [] if wanted is None else [wanted] if isinstance(wanted, str | float | int) else list(wanted)
    out = {preload_index(study.loads, one, names=study.load_names, name="leave_out") for one in given}
    if len(out) == len(study.loads):
        raise InputError("leave_out names every preload of the study; keep one or more to identify from")
    return tuple(sorted(out))


def _identified(
    study: Study, left: tuple[int, ...], *, seed: int, count: int, jobs: int, store: SampleStore, report: Report | None
) -> Identification:
    choice, test = scattering(study), study.test
    assert test is not None
    _check_laws(study, choice)
    stage, ensemble = _Stage(report), Ensemble.of(study, 8, seed)
    reduced = Reduced(ensemble, jobs=jobs, report=stage, store=store)
    tested = bool(study.part_tests) and not any(of_parts(one.key) for one in choice.inputs)
    losses = None
    if test.losses is not None:
        losses = Losses(
            values=np.array(test.losses),
            scatter=choice.test_loss or LOSS_TEST_SD,
            discrepancy=choice.discrepancy_loss or LOSS_DISCREPANCY_SD,
        )
    found, cut = [], cut_notes(ensemble.inputs.columns)
    if study.part_tests and not tested:
        text = (
            "E, density or a factor on a part is listed under [uncertain] and identified; what was measured of parts "
            "alone is not used"
        )
        cut.append(Note(code="left-out", severity="limit", text=text))
    for law in range(max(len(choice.models), 1)):
        parts = KnownParts.of(study, reduced.trainer.structure, reduced.modes(ensemble, law)) if tested else None
        model = StudyModel(ensemble, reduced, stage, law, parts)
        one = identify_model(
            model,
            np.array(test.frequencies),
            np.array(study.loads),
            leave_out=left,
            count=count,
            seed=seed,
            test_sd=choice.test or TEST_SD,
            discrepancy=choice.discrepancy or DISCREPANCY_SD,
            losses=losses,
            report=report,
        )
        bases = [] if model.last is None else of_bases(reduced.errors(*model.last))
        mates = [*mates_notes(reduced.laws(ensemble)), *(() if parts is None else parts.notes())]
        found.append(replace(one, notes=(*mates, *cut, *one.notes, *bases, *mesh_notes(study, model.mesh))))
    if not choice.models:
        return found[0]
    return mixed(dict(zip([name for name, _ in choice.models], found, strict=True)), dict(choice.models), seed=seed)


def _check_draws(study: Study) -> None:
    """Raise InputError where waves are drawn anew in each sample: no number leads from one draw to the next."""
    keys = () if study.uncertain is None else (one.key for one in study.uncertain.inputs)
    drawn = next(filter(is_draw, keys), None)
    if drawn is not None:
        joint = drawn.split(".")[1]
        raise InputError(
            f"uncertain: the waves of joint {joint!r} are drawn anew in each sample, and no identification can follow "
            'that. Let their size scatter with one draw: joint.form.waviness = {Wq = "0.5 um to 2 um", seed = 0}'
        )


def _check_laws(study: Study, choice: UncertainChoice) -> None:
    """Raise InputError where laws are listed and nothing else scatters, or one of them lacks what scatters."""
    if not choice.models:
        return
    alone = replace(choice, models=())
    if not (alone.inputs or alone.fit):
        raise InputError(
            "uncertain lists laws and no other number; add what scatters, for example "
            'stiffness = {distribution = "lognormal", median = 1, sd_ln = 0.6}'
        )
    for name, _ in choice.models:
        law = replace(study.law, model=name)
        for column in alone.inputs:
            if column.key.startswith("law."):
                check_key(replace(study, law=law), column.key, models=False, where=f"uncertain.{column.key}")
