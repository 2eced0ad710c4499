"""From a study whose numbers scatter to the quantiles of its frequencies."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, overload

import numpy as np

from faying.case.case import checked_mesh, mates_notes, structure_of, surfaces_of
from faying.case.mesh_error import MeshError, mesh_notes
from faying.case.part_tests import KnownParts
from faying.case.provenance import provenance
from faying.case.scatter import SCORE, discrepancy, of_number, of_parts, stated, with_assumed
from faying.errors import InputError
from faying.identify.assemblies import Assemblies
from faying.identify.identity import paired, paired_modes
from faying.identify.prediction import Prediction
from faying.identify.reassembly import reassembled
from faying.identify.sampling.ensemble import Ensemble, by_reason
from faying.identify.sampling.evaluate import LIMIT, Reduced
from faying.identify.sampling.store import SampleStore
from faying.misuse import checked_call
from faying.notes import Note, joint_names
from faying.progress import Report, silent
from faying.study.keys.uncertain import UncertainChoice
from faying.study.part_folder import fingerprint
from faying.study.study import Study
from faying.sweeps.parallel import Rows
from faying.typing import Array

MIN_SAMPLES, MAX_SAMPLES = 8, 1_000_000  # samples
ABOVE_RANGE = 0.1  # share of the contact above the end of the law from which a sample is noted
TOLERANCE = 1e-3  # relative error of a frequency by the bases from which it is noted
MOVED = 0.1  # of the distance from 5 to 95 % that half of the samples may move either by


@overload
def predict(
    study: Study | str | Path,
    samples: int = ...,
    seed: int = ...,
    *,
    jobs: int = ...,
    out: str | Path | None = ...,
    report: Report | None = ...,
    assemblies: None = ...,
) -> Prediction: ...


@overload
def predict(
    study: Study | str | Path,
    *,
    seed: int = ...,
    jobs: int = ...,
    out: str | Path | None = ...,
    report: Report | None = ...,
    assemblies: int,
) -> Assemblies: ...


@checked_call
def predict(
    study: Study | str | Path,
    samples: int = 1024,
    seed: int = 0,
    *,
    jobs: int = 1,
    out: str | Path | None = None,
    report: Report | None = None,
    assemblies: int | None = None,
) -> Prediction | Assemblies:
    """Evaluate a study under the scatter of its numbers: as its [uncertain] says, and as is assumed of the rest.

    The parts are reduced once to small bases; every sample is evaluated in these, at each load of the study.

    Args:
        study: a Study or the path of its TOML file.
        samples: points of Sobol's sequence, 8 to 1,000,000; powers of 2 fill the space most evenly.
        seed: of the points, 0 or more.
        jobs: processes on this machine.
        out: file to write, ending in .nc; finished work is saved next to it, and the same call resumes there.
        report: called with a stage, the samples done, and their number; 0 of 0 while the bases grow.
        assemblies: how often one structure is taken apart and bolted together again, 2 or more, each solved in full,
            in place of samples of structures: the force of each bolt, their order and the position of the parts within
            their holes are drawn, and nothing else.

    Returns:
        The samples with their frequencies; `quantiles()` and `shares()` say what they come to. With `assemblies` the
        `Assemblies`.

    Raises:
        InputError: nothing in the study scatters, it does not fit, or no sample has an answer.

    Source:
        Sobol's sequence: Joe and Kuo 2008, doi:10.1137/070709359, as SciPy has it.
    """
    study = Study.read_bolted(study, first_loading=True)
    check_seed(seed)
    if assemblies is not None:
        return reassembled(study, assemblies, seed, jobs=jobs, out=None if out is None else Path(out), report=report)
    check(study, samples)
    (report or silent)("mesh", 0, 0)
    surfaces = surfaces_of(study)
    structure = structure_of(study, checked_mesh(study), surfaces)
    uncertain = with_assumed(study, structure, surfaces, laws_drawn=True)
    if study.part_tests:  # they say what E and density are; what is listed is their prior
        uncertain = replace(uncertain, inputs=tuple(one for one in uncertain.inputs if not of_parts(one.key)))
    given, study = study, replace(study, uncertain=uncertain)
    ensemble = Ensemble.of(study, samples, seed, surfaces)
    file = None if out is None else Path(out)
    with SampleStore(file, fingerprint(study, samples, seed, LIMIT), what="prediction") as store:
        reduced = Reduced(ensemble, structure=structure, jobs=jobs, report=report, store=store)
        rows = reduced.rows(ensemble)
        parts = KnownParts.of(given, structure, reduced.modes(ensemble)) if study.part_tests else None
        found = predicted(study, ensemble, reduced, rows, seed, parts)
        if file is not None:
            found.save(file)
        store.finish()
    return found


def check_seed(seed: int) -> None:
    """Raise InputError for what is not a seed."""
    if seed < 0:
        raise InputError(f"seed = {seed!r} should be a whole number of 0 or more")


def check(study: Study, samples: int) -> None:
    """Raise InputError for counts that make no prediction, and for studies that bases cannot hold."""
    if not MIN_SAMPLES <= samples <= MAX_SAMPLES:
        raise InputError(
            f"samples = {samples!r} should be a whole number from {MIN_SAMPLES} to {MAX_SAMPLES:,}, for example 1024"
        )
    if study.modes.damping == "viscous":
        raise InputError("a prediction gives hysteretic loss; leave out modes.damping")
    if any(joint.springs == "per-node" for joint in study.joints):
        raise InputError('a prediction takes springs per area; leave out springs = "per-node"')


def predicted(
    study: Study, ensemble: Ensemble, reduced: Reduced, rows: Rows, seed: int, parts: KnownParts | None
) -> Prediction:
    """Put the rows of all samples together, with what there is to say of them.

    parts: those with tests of their own, which move every sample alike, as the error of the mesh does.
    """
    reasons = [str(reason) for reason in rows["reasons"]]
    if all(reasons):
        raise InputError(f"none of {len(reasons)} samples has an answer; the first: {reasons[0]}")
    mesh, moved = reduced.mesh_error(ensemble), np.zeros(rows["frequencies"].shape[1:])
    lacking = np.full(moved.shape, discrepancy(study.uncertain or UncertainChoice()))
    if parts is not None:
        moved, lacking = parts.left()
    if mesh is not None:
        moved, lacking = moved + mesh.middle, np.hypot(lacking, mesh.total / SCORE)
    rows = {**rows, **{name: rows[name] * np.exp(moved) for name in ("frequencies", "named")}}
    tested: dict[str, Any] = {}
    if study.test is not None:
        test = np.array(study.test.frequencies)
        names = paired_modes(test, rows)
        tested = {"paired": paired(rows["named"], names), "test": test}
        tested["discrepancy_of_test_mode"] = paired(lacking[None], names)[0]
        tested["test_source"] = study.test.source
    found = Prediction(
        title=study.title,
        inputs=ensemble.inputs,
        seed=seed,
        tolerance=TOLERANCE,
        basis=(len(reduced.model.static_stiffness), len(reduced.model.dynamic_mass)),
        loads=np.array(study.loads),
        values=ensemble.values[ensemble.training :],
        frequencies=rows["frequencies"],
        loss_factors=rows["loss_factors"],
        open_share=rows["open_share"],
        above_range_share=rows["above_range_share"],
        reasons=dict(by_reason(reasons)),
        discrepancy=lacking,
        provenance=provenance(study),
        **tested,
    )
    mates = mates_notes(reduced.laws(ensemble))
    of_parts = () if parts is None else parts.notes()
    return found.with_notes([*mates, *of_parts, *_notes(study, found, mesh), *of_bases(reduced.errors(ensemble, rows))])


def _notes(study: Study, found: Prediction, mesh: MeshError | None) -> Iterator[Note]:
    """What a reader of the intervals ought to know."""
    yield from cut_notes(found.inputs.columns)
    choice, known = study.uncertain or UncertainChoice(), stated(study.uncertain)
    flat = [
        one.name for one in study.joints if one.form is None and not of_number(known, one.name, "form.waviness_seed")
    ]
    if flat and study.assumes_scatter:
        text = "no waves are drawn: the faces are curved, have no room for waves, or are seats of a solid bolt"
        yield Note(code="no-waves", text=f"{joint_names(flat)}: {text}")
    for reason, count in found.reasons.items():
        yield Note(
            code="no-answer", severity="wrong", text=f"{count} of {len(found.values)} samples have no answer: {reason}"
        )
    if found.convergence > MOVED:
        text = (
            f"half of the samples give ends of the intervals that differ by up to {found.convergence:.0%} of their "
            "width; take more samples"
        )
        yield Note(code="few-samples", severity="limit", text=text)
    far = int(np.count_nonzero(np.nanmax(found.above_range_share[found.sound], axis=1) > ABOVE_RANGE))
    if far:
        text = (
            f"{far} of {found.answered} samples press more than a tenth of the contact above the end of the law, "
            "where its stiffness stays constant; faying run bounds what that does to a frequency"
        )
        yield Note(code="beyond", text=text)
    if found.paired is not None:
        lost = np.isnan(found.paired[found.sound]).any(axis=1)
        for mode in np.flatnonzero(lost.any(axis=0)):
            text = (
                f"test mode {mode + 1} has no partner in {int(lost[:, mode].sum())} of {found.answered} samples; its "
                "interval is that of the others"
            )
            yield Note(code="test-modes", severity="limit", text=text)
    if not choice.models:
        low, high = (f"{end:.2%}" for end in (found.discrepancy.min(), found.discrepancy.max()))
        of_mesh = "" if mesh is None else f", and for the error of the mesh, {mesh.parts.max():.2%} or less taken off"
        text = (
            f"the intervals include what is listed above, and {low if low == high else f'{low} to {high}'} of each "
            f"frequency for what else the parts are (uncertain.structure, discrepancy, tests of parts){of_mesh}"
        )
        yield Note(code="interval", severity="limit", text=text)
    yield from mesh_notes(study, mesh)


def of_bases(errors: Array) -> list[Note]:
    """Say what the small bases miss, from errors of a frequency (2, n): at the worst samples, and at some others."""
    known = [row[np.isfinite(row)] for row in errors]
    if not np.any(np.concatenate(known) > TOLERANCE):
        return []
    places = ("the worst by their own estimate", "some others from all over")
    pairs = zip(known, places, strict=True)
    parts = [f"{row.max():.1e} at {place} ({len(row)} looked at)" for row, place in pairs if len(row)]
    return [
        Note(
            code="bases",
            severity="wrong",
            text=f"the small bases miss a frequency of a sample by up to {', '.join(parts)}",
        )
    ]


def cut_notes(columns: Sequence[Any]) -> list[Note]:
    """Say what was cut of a distribution that reaches values which the number cannot have."""
    text = "of its probability is outside the possible values and is left out"
    cut = [column for column in columns if column.cut > 1e-6]
    return [Note(code="uncertain-cut", severity="limit", text=f"{one.key}: {one.cut:.2g} {text}") for one in cut]
