"""Takes one structure apart and bolts it together again: draws what differs, and solves each assembly in full."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Self

import numpy as np

from faying.answer.run import run
from faying.case.case import Case, bare
from faying.case.clearance import Clearance, clearances
from faying.case.provenance import provenance
from faying.case.scatter import force_factors, known_of
from faying.case.waves import MovableFace
from faying.errors import InputError
from faying.identify.assemblies import SOURCES, Assemblies
from faying.identify.sampling.ensemble import by_reason
from faying.identify.sampling.points import sobol
from faying.identify.sampling.store import SampleStore
from faying.joint.preload_case import PreloadCase
from faying.joint.shared_modes import Reanalysis
from faying.notes import Note, joint_names
from faying.numerics.damped import DampedModes
from faying.numerics.follow import follow
from faying.progress import Report, silent
from faying.result import Result
from faying.study.part_folder import fingerprint
from faying.study.study import Study
from faying.sweeps.parallel import Rows, rows_of
from faying.typing import Array, Index

MIN_ASSEMBLIES, MAX_ASSEMBLIES = 2, 100_000
CHUNK = 8  # assemblies solved in one go, by an engine that begins with the case as modelled
ENOUGH = 20  # assemblies: of fewer none need lie outside 5 to 95 %


def check_assemblies(study: Study, count: int) -> None:
    """Raise InputError for a count that says nothing of scatter, and for a study whose bolts press nothing."""
    if not MIN_ASSEMBLIES <= count <= MAX_ASSEMBLIES:
        raise InputError(
            f"assemblies = {count!r} should be a whole number from {MIN_ASSEMBLIES} to {MAX_ASSEMBLIES:,}, for example "
            "32"
        )
    if not (study.joints and study.bolts):
        raise InputError("assemblies differ by bolts and the joints that they press, and the study has none")


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """What differs between assemblies.

    Args:
        sources: Of `SOURCES`, those that the structure has.
        factors: Force of each bolt over the one that the study states [-] (n, b).
        orders: Indices of the bolts in their order (n, t).
        shifts: Displacement [m] (n, joints, 3) of the second face of each joint.
    """

    sources: tuple[str, ...]
    factors: Array
    orders: Index
    shifts: Array

    @classmethod
    def of(
        cls, case: Case, faces: Sequence[MovableFace | None], plays: Sequence[Clearance], count: int, seed: int
    ) -> Self:
        """Draw assemblies by Sobol's sequence, scrambled: forces, a permutation of the bolts, and places in a disk."""
        study, bolts = case.study, len(case.study.bolts)
        shares = sobol(2 * bolts + 2 * len(plays), count, seed)
        known = known_of(case)
        factors = [force_factors(known, study, k, shares[:, k]) for k in range(bolts)]
        base = np.array(study.preloads[0].order or range(bolts))
        orders = np.argsort(shares[:, bolts : 2 * bolts], axis=1)[:, base]  # the study's order, with bolts renamed
        shifts = np.zeros((count, len(faces), 3))
        for k, play in enumerate(plays):
            moving = [(number, sign, face) for number, sign in play.joints if (face := faces[number]) is not None]
            size, turn = shares[:, 2 * bolts + 2 * k :][:, :2].T
            radius, angle = play.reach * np.sqrt(size), 2 * np.pi * turn  # evenly over the disk
            for number, sign, _ in moving:
                x, y = moving[0][2].place.axes.x_axis, moving[0][2].place.axes.y_axis
                shifts[:, number] = sign * (np.outer(radius * np.cos(angle), x) + np.outer(radius * np.sin(angle), y))
        firm = all(bolt.stiffness is not None for bolt in case.structure.fitted_bolts)
        there = True, bolts > 1 and firm, bool(np.any(shifts))
        return cls(
            sources=tuple(name for name, one in zip(SOURCES, there, strict=True) if one),
            factors=np.stack(factors, axis=1),
            orders=orders,
            shifts=shifts,
        )


@dataclass(frozen=True, kw_only=True)
class Assembler:
    """Solves assemblies, here or in another process.

    A point is an assembly with all that is drawn, or beyond the number of assemblies with one of the sources alone.

    Args:
        case: As modelled.
        faces: Those of its joints that may lie elsewhere; None for a joint that stays as it is.
        drawn: What differs.
        shapes, frequencies, order: Modes at each load of the structure as it is put together as modelled: shapes
            (unknowns, m) and frequencies [Hz] (loads, m), rising, and which of them a mode as modelled is (loads, m).
    """

    case: Case
    faces: tuple[MovableFace | None, ...]
    drawn: Drawn
    shapes: tuple[Any, ...] = ()
    frequencies: Array | None = None
    order: Index | None = None

    @classmethod
    def of(cls, case: Case, count: int, seed: int) -> Self:
        """Draw assemblies of a case, and solve the one that is put together as modelled."""
        structure, study = case.structure, case.study
        joints = zip(study.joints, structure.joints, case.surfaces, strict=True)
        faces = tuple(MovableFace.of(study, structure.mesh, one, j.interface, surface) for one, j, surface in joints)
        made = cls(case=case, faces=faces, drawn=Drawn.of(case, faces, clearances(structure), count, seed))
        gaps = made.gaps(np.zeros((len(faces), 3)))
        engine = made.engine()
        modelled, _ = made.solved(engine, [joint.interface.gap for joint in structure.joints], study.preloads)
        found, _ = made.solved(engine, gaps, study.preloads)
        mass = structure.dynamic_matrices[1]
        order = [follow(a.shapes, b.shapes, mass, a.frequencies) for a, b in zip(modelled, found, strict=True)]
        return replace(
            made,
            shapes=tuple(one.shapes for one in found),
            frequencies=np.stack([one.frequencies for one in found]),
            order=np.stack(order),
        )

    @property
    def count(self) -> int:
        """Number of assemblies."""
        return len(self.drawn.factors)

    @property
    def points(self) -> int:
        """Number of points."""
        alone = len(self.drawn.sources) if len(self.drawn.sources) > 1 else 0
        return self.count * (1 + alone)

    def gaps(self, shifts: Array) -> list[Array]:
        """Gap [m] (q,) of each joint with its second face moved by (joints, 3) [m]."""
        joints = zip(self.case.structure.joints, self.faces, shifts, strict=True)
        return [joint.interface.gap if face is None else face.gap(shift) for joint, face, shift in joints]

    def engine(self) -> Reanalysis:
        """An engine of the case as modelled, which others go on from."""
        made = Reanalysis(self.case.modal, self.case.study.preloads)
        made.vibrate(self.case.structure.springs(made.preload(len(self.case.loads) - 1).pressures))
        return made

    def solved(
        self, engine: Reanalysis, gaps: Sequence[Array], preloads: Sequence[PreloadCase]
    ) -> tuple[list[DampedModes], Array]:
        """Modes at each preload with other gaps [m] (q,) of the joints, and the forces [N] left (loads, b)."""
        structure = self.case.structure.with_joints(gaps=gaps)
        solving = engine.like(structure, preloads)
        modes, left = [], []
        for number in range(len(preloads)):
            found = solving.preload(number)
            modes.append(solving.vibrate(structure.springs(found.pressures)).damped)
            left.append(found.bolt_forces)
        return modes, np.array(left)

    def rows(self, points: Sequence[int]) -> Rows:
        """Frequencies over those put together as modelled, and forces left, of some points; NaN without an answer."""
        assert self.frequencies is not None
        engine, loads = self.engine(), len(self.frequencies)
        nothing = np.full(self.frequencies.shape, np.nan)
        none_left = np.full((loads, self.drawn.factors.shape[1]), np.nan)
        return rows_of(points, lambda point: self._one(engine, point), {"ratio": nothing, "left": none_left})

    def _one(self, engine: Reanalysis, point: int) -> dict[str, Any]:
        assert self.frequencies is not None
        assert self.order is not None
        group, number = divmod(point, self.count)
        drawn = self.drawn
        does = drawn.sources if group == 0 else (drawn.sources[group - 1],)
        preloads = self.case.study.preloads
        if "force" in does:
            factors = drawn.factors[number]
            preloads = tuple(replace(one, forces=tuple((factors * one.forces).tolist())) for one in preloads)
        if "order" in does:
            preloads = tuple(replace(one, order=tuple(drawn.orders[number].tolist())) for one in preloads)
        shifts = drawn.shifts[number]
        found, left = self.solved(engine, self.gaps(shifts if "position" in does else np.zeros_like(shifts)), preloads)
        mass, ratios = self.case.structure.dynamic_matrices[1], []
        for shapes, before, first, after in zip(self.shapes, self.frequencies, self.order, found, strict=True):
            now = after.frequencies[follow(shapes, after.shapes, mass, before)]
            ratios.append((now / before)[first])
        return {"ratio": np.stack(ratios), "left": left}


def reassembled(
    study: Study, count: int, seed: int, *, jobs: int = 1, out: Path | None = None, report: Report | None = None
) -> Assemblies:
    """Predict how far frequencies differ between assemblies of one structure; see `faying.predict`."""
    check_assemblies(study, count)
    tell = report or silent
    plain = replace(bare(study), modes=replace(study.modes, levels=()), test=None)  # modes and their intervals
    with SampleStore(out, fingerprint(study, count, seed), what=Assemblies.KIND) as store:
        tell("run as modelled", 0, 0)
        result = run(plain)
        work = Assembler.of(Case.of(plain), count, seed)
        rows = _solved(work, jobs, store, tell)
        found = _collected(work, rows, result, seed)
        if out is not None:
            found.save(out)
        store.finish()
    return found


def _solved(work: Assembler, jobs: int, store: SampleStore, report: Report) -> Rows:
    """Rows of all points; those that interrupted work has left are not solved again."""
    chunks = [range(k, min(k + CHUNK, work.points)) for k in range(0, work.points, CHUNK)]
    sent = replace(work, case=replace(work.case, structure=replace(work.case.structure, assembled=None)))
    rows = (work if jobs == 1 else sent).rows
    return store.all_rows("assemblies", rows, chunks, jobs, partial(report, "assemblies"))


def _collected(work: Assembler, rows: Rows, result: Result, seed: int) -> Assemblies:
    """The record of all assemblies. Raises InputError where fewer than two have an answer."""
    study, drawn, count = work.case.study, work.drawn, work.count
    reasons = [str(reason) for reason in rows["reasons"][:count]]
    if sum(not reason for reason in reasons) < MIN_ASSEMBLIES:
        raise InputError(
            f"fewer than two of {count} assemblies have an answer; the first: {next(filter(None, reasons))}"
        )
    frequencies = (result.frequencies * rows["ratio"]).reshape(-1, count, *result.frequencies.shape)
    stated = np.array([one.forces for one in study.preloads])
    found = Assemblies(
        title=study.title,
        seed=seed,
        sources=drawn.sources,
        bolts=tuple(bolt.name for bolt in study.bolts),
        joints=tuple(joint.name for joint in study.joints),
        loads=np.array(study.loads),
        modelled=result.frequencies,
        frequencies=frequencies[0],
        alone=frequencies[1:] if len(frequencies) > 1 else frequencies,
        forces=drawn.factors[:, None, :] * stated,
        left=rows["left"][:count],
        orders=1 + drawn.orders,
        shifts=drawn.shifts,
        low=None if result.interval is None else result.interval.low,
        high=None if result.interval is None else result.interval.high,
        reasons=dict(by_reason(reasons)),
        provenance=provenance(study),
    )
    return replace(found, notes=tuple(_notes(work, found)))


def _notes(work: Assembler, found: Assemblies) -> Iterator[Note]:
    """What a reader of the scatter ought to know."""
    study, count = work.case.study, len(found.frequencies)
    for reason, number in found.reasons.items():
        yield Note(code="no-answer", severity="wrong", text=f"{number} of {count} assemblies have no answer: {reason}")
    if count < ENOUGH:
        text = f"of {count} assemblies none need lie below 5 or above 95 %; take {ENOUGH} or more"
        yield Note(code="few-samples", severity="limit", text=text)
    assumed = [
        one.name for one, face in zip(study.joints, work.faces, strict=True) if face is not None and one.form is None
    ]
    if assumed:
        names = joint_names(assumed)
        text = f"{names}: the study gives no form of the faces; all assemblies have one draw of assumed waves"
        yield Note(code="waves-assumed", severity="limit", text=text)
    if "order" in found.sources and not study.in_order:
        left = float(np.nanmean(found.left / found.forces))
        text = (
            "the study pulls all bolts at once; assemblies tighten one after another in one pass, which leaves the "
            f"bolts {left:.1%} of their forces in the mean. [tightening] gives the passes"
        )
        yield Note(code="assembly-order", text=text)
    missing = {
        "order": "the order of tightening changes nothing: there is one bolt, or a bolt without diameter and material",
        "position": "the position changes nothing: the holes leave no play, or the faces have no form of their own",
    }
    for name, text in missing.items():
        if name not in found.sources:
            yield Note(code="assembly-left-out", text=text)
