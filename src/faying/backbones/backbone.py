"""From a study to the frequency and damping of a mode against its amplitude."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np

from faying.backbones.result import BackboneCurve, collected
from faying.case.alternative import changed, study_with
from faying.case.case import Case, checked_laws, law_reasons, read_for, surfaces_of
from faying.errors import InputError
from faying.fe.interface import Interface
from faying.joint.attachments import nearest_node
from faying.joint.preload_case import preload_index
from faying.joint.shared_modes import modes_of
from faying.joint.springs import Springs
from faying.joint.support_check import check_motions, checked_preload
from faying.microslip.epmc import EpmcCurve, EpmcPoint
from faying.microslip.levels import cut_laws
from faying.microslip.microslip import Microslip
from faying.microslip.slip_basis import SlipBasis
from faying.misuse import checked_call
from faying.numerics.damped import damped_modes
from faying.numerics.modes import Modes
from faying.progress import Report
from faying.result.backbone import Backbone
from faying.study.keys.alternative import AlternativeChoice
from faying.study.keys.backbone import BackboneChoice, Point, check_friction, laws
from faying.study.keys.law import LawChoice
from faying.study.part_folder import PartFile, fingerprint
from faying.study.study import Study
from faying.typing import Array
from faying.units import in_mm

EXTRA_MODES = 14  # real modes beyond the one that is followed, in its basis
SPRINGS = 32  # of the law's curve at a point
TRAINING_SPRINGS = 16  # springs with which the basis is trained
SAMPLES = 64  # instants of a cycle
TRAINED = 2.5  # decades below the last level in which the basis is trained,
EACH = 0.5  # in steps of so many
SPENT = 0.05  # residual, in energy, at which a basis is spent
MIN_MOTION = 1e-3  # of the greatest motion: a point that moves less says nothing of the mode

STEPS = 1000  # of its progress

LISTS = ("sliding", "opening", "dissipated", "traction")  # one array for each joint


class CurveStore(PartFile):
    """The folder OUT.part beside the output; without an output nothing is kept."""

    def __init__(self, out: Path | None, fingerprint: str) -> None:
        super().__init__(out, fingerprint, what="backbone")

    def basis(self) -> Array | None:
        """The vectors that were kept, None where there are none."""
        found = self.arrays("basis")
        return None if found is None else found.get("vectors")

    def keep_basis(self, vectors: Array) -> None:
        """Keep the basis in which the points are."""
        self.keep_arrays("basis", {"vectors": vectors})

    def points(self, curve: int) -> list[EpmcPoint]:
        """The points of a curve that were kept, in rising amplitude, up to the first that is damaged."""
        out: list[EpmcPoint] = []
        while (point := _point(self.arrays(_name(curve, len(out))))) is not None:
            out.append(point)
        return out

    def keep(self, curve: int, number: int, point: EpmcPoint) -> None:
        """Keep one point of a curve."""
        arrays: dict[str, Any] = {}
        for f in fields(point):
            value = getattr(point, f.name)
            if f.name in LISTS:
                arrays |= {f"{f.name}.{k}": part for k, part in enumerate(value)}
            else:
                arrays[f.name] = value
        self.keep_arrays(_name(curve, number), arrays)


def _name(curve: int, number: int) -> str:
    return f"curve-{curve}-{number:04d}"


def _point(found: dict[str, Any] | None) -> EpmcPoint | None:
    """A point that was kept; None where it is missing or damaged."""
    if found is None:
        return None
    given: dict[str, Any] = {}
    try:
        for f in fields(EpmcPoint):
            if f.name in LISTS:
                count = sum(name.startswith(f"{f.name}.") for name in found)
                given[f.name] = tuple(found[f"{f.name}.{k}"] for k in range(count))
            else:
                given[f.name] = found[f.name] if f.name == "coordinates" else float(found[f.name])
    except KeyError:
        return None
    return EpmcPoint(**given)


def chosen(study: Study, friction: float | Sequence[float] | None, asked: dict[str, Any]) -> BackboneChoice:
    """[backbone] of the study with what is asked for in place of it."""
    given = {name: value for name, value in asked.items() if value is not None}
    if friction is not None:
        given["friction"] = tuple(friction) if isinstance(friction, Sequence) else (friction,)
    return replace(study.backbone or BackboneChoice(), **given)


def names(out: Path, count: int) -> list[Path]:
    """The files of several curves: numbered, but for one alone."""
    return [out] if count == 1 else [out.with_name(f"{out.stem}-{k + 1}{out.suffix}") for k in range(count)]


def friction_of(study: Study, choice: BackboneChoice) -> list[tuple[float, ...]]:
    """Coefficient of each joint for each curve. Raises InputError where a joint has none."""
    if choice.friction:
        return [(value,) * len(study.joints) for value in choice.friction]
    own: list[float] = []
    for joint in study.joints:
        if joint.friction is None:
            raise InputError(
                f"joint {joint.name!r} has no friction, and without it nothing slips; give friction = 0.2 "
                "(--friction 0.2), or friction in its [[joint]] or in [backbone]"
            )
        check_friction(joint.friction)
        own.append(joint.friction)
    return [tuple(own)]


@overload
def backbone(
    study: Study | str | Path,
    mode: int | None = ...,
    friction: float | None = ...,
    amplitude: tuple[float, float] | None = ...,
    at: Point | None = ...,
    harmonics: int | None = ...,
    *,
    load: float | str | None = ...,
    rest_damping: float | Literal["law"] | None = ...,
    slip: Literal["microslip", "coulomb"] | None = ...,
    law: str | None = ...,
    out: str | Path | None = ...,
    report: Report | None = ...,
) -> Backbone: ...


@overload
def backbone(
    study: Study | str | Path,
    mode: int | None = ...,
    friction: Sequence[float] = ...,
    amplitude: tuple[float, float] | None = ...,
    at: Point | None = ...,
    harmonics: int | None = ...,
    *,
    load: float | str | None = ...,
    rest_damping: float | Literal["law"] | None = ...,
    slip: Literal["microslip", "coulomb"] | None = ...,
    law: str | Sequence[str] | None = ...,
    out: str | Path | None = ...,
    report: Report | None = ...,
) -> tuple[Backbone, ...]: ...


@checked_call
def backbone(
    study: Study | str | Path,
    mode: int | None = None,
    friction: float | Sequence[float] | None = None,
    amplitude: tuple[float, float] | None = None,
    at: Point | None = None,
    harmonics: int | None = None,
    *,
    load: float | str | None = None,
    rest_damping: float | Literal["law"] | None = None,
    slip: Literal["microslip", "coulomb"] | None = None,
    law: str | Sequence[str] | None = None,
    out: str | Path | None = None,
    report: Report | None = None,
) -> Backbone | tuple[Backbone, ...]:
    """Follow one mode of a study from rest to large amplitudes: frequency and damping of its slipping joints.

    What is left out is taken from [backbone] of the study, or its default.

    Args:
        study: A Study or the path of its TOML file.
        mode: Elastic mode, from 1.
        friction: Coefficient [-] of all joints, 0 to 10; that of each joint in the study where left out. A list gives a
            tuple of curves, from one basis.
        amplitude: First and last acceleration amplitude [m/s2]; (0.1, 100) by default. The curve may end before.
        at: Point [m] whose acceleration that is; where the mode moves most by default.
        harmonics: Highest harmonic of the motion, 3 by default; 1 is quick.
        load: Preload of the first bolt [N], or text with a unit, one of the study's; the greatest by default.
        rest_damping: Ratio to critical [-] that is added to that of slip, or "law": what the laws lose without slip.
        slip: "microslip" (default) cuts the law's curve into springs with sliders; "coulomb" takes one slider a point.
        law: Contact law of all joints, such as "jk", in place of the study's. A list gives a tuple of curves, from one
            basis; the study's own law keeps its parameters.
        out: File (.nc) that the curve is written to. Finished steps are saved next to it until then: a computation
            that was killed resumes where it stopped. With several curves, their files are numbered.
        report: Called with a stage, the steps done, and how many there are.

    Returns:
        The curve, with its error bounds and the reason why it ends.

    Raises:
        InputError: No friction is given, the law has no tangential stiffness, there is no such mode or load.
        NotConverged: The preload, the modes or the first point of the curve are not found.

    Source:
        Extended periodic motion concept: Krack 2015, doi:10.1016/j.compstruc.2015.03.008.
    """
    several = isinstance(law, Sequence) and not isinstance(law, str)
    many = isinstance(friction, Sequence) or several
    asked: dict[str, Any] = {"mode": mode, "amplitude": amplitude, "at": at, "harmonics": harmonics}
    asked |= {"rest_damping": rest_damping, "slip": slip}
    asked["laws"] = None if law is None else laws([law] if isinstance(law, str) else list(law), "law")
    study = Study.read_bolted(study)
    choice = chosen(study, friction, asked)
    if not many and len(choice.friction) > 1:
        given = ", ".join(f"{value:g}" for value in choice.friction)
        raise InputError(f"[backbone] lists friction {given}: give one of them, or the list for a tuple of curves")
    if not many and len(choice.laws) > 1:
        given = ", ".join(one.model for one in choice.laws)
        raise InputError(f"[backbone] lists the laws {given}: give one of them, or the list for a tuple of curves")
    index = preload_index(study.loads, load, names=study.load_names)
    curves = backbones(study, choice, loads=[index], out=out, report=report)
    return curves if many else curves[0]


def backbones(
    study: Study,
    choice: BackboneChoice,
    *,
    loads: Sequence[int] | None = None,
    out: str | Path | None = None,
    report: Report | None = None,
) -> tuple[Backbone, ...]:
    """Curves for every law and friction of a choice at some loads of a study (indices, all where None), from one basis.

    Args, Raises: see `backbone`.
    """
    indices = list(range(len(study.loads))) if loads is None else list(loads)
    frictions = friction_of(study, choice)
    progress = _Progress(report, max(len(choice.laws), 1) * len(indices) * len(frictions))
    progress.stage("surface and mesh", 0.0)
    read = read_for(study, surfaces_of(study))
    for law in choice.laws:
        other = study_with(study, _on_all_joints(study, law))
        checked_laws(other, surfaces_of(other, read))  # raises, before the mesh
    case = Case.of(study, read=read)
    file = None if out is None else Path(out)
    with CurveStore(file, fingerprint(study, choice, indices)) as store:
        made = _curves(case, choice, indices, frictions, store, progress)
        if file is not None:
            for path, curve in zip(names(file, len(made)), made, strict=True):
                curve.save(path)
            store.finish()
    return tuple(made)


def backbones_of(case: Case, choice: BackboneChoice) -> tuple[Backbone, ...]:
    """Curves for every law and friction of a choice, at the last preload of a case that is ready to be solved.

    Raises: see `backbone`.
    """
    frictions = friction_of(case.study, choice)
    progress = _Progress(None, max(len(choice.laws), 1) * len(frictions))
    with CurveStore(None, "") as store:
        return tuple(_curves(case, choice, [len(case.study.loads) - 1], frictions, store, progress))


@dataclass
class _Progress:
    """Shares of the work: a fifth until the basis stands, the rest in equal parts for the curves."""

    report: Report | None
    curves: int
    curve: int = 0

    def stage(self, text: str, share: float) -> None:
        if self.report is not None:
            self.report(text, int(STEPS * 0.2 * share), STEPS)

    def within(self, text: str, share: float) -> None:
        if self.report is not None:
            done = 0.2 + 0.8 * (self.curve + min(max(share, 0.0), 1.0)) / self.curves
            self.report(text, int(STEPS * done), STEPS)


def _curves(
    case: Case,
    choice: BackboneChoice,
    indices: Sequence[int],
    frictions: Sequence[tuple[float, ...]],
    store: CurveStore,
    progress: _Progress,
) -> list[Backbone]:
    cases = []
    for law in choice.laws:
        under = changed(case, _on_all_joints(case.study, law))
        kept = [note for note in case.notes if note not in law_reasons(case.structure, case.surfaces)]
        cases.append(replace(under, notes=(*kept, *law_reasons(under.structure, under.surfaces))))
    cases = cases or [case]
    places = [(one, k) for one in cases for k in indices]
    bases = _bases(places, choice, progress)
    prepared = [
        _Prepared(case=one, choice=choice, load=one.study.loads[k], basis=b)
        for (one, k), b in zip(places, bases, strict=True)
    ]
    vectors = store.basis()
    if vectors is not None:
        bases[0].basis.append(vectors)
    else:
        bases[0].begin(lambda text: progress.stage(text, 0.5))
        for other in bases[1:]:
            other.take_modes()
        for one, friction in product(prepared, frictions):
            one.train(friction, progress)
        store.keep_basis(bases[0].basis.vectors)
    out = []
    for number, (one, friction) in enumerate(product(prepared, frictions)):
        progress.curve = number
        found = one.curve(friction, store.points(number), partial(store.keep, number), progress)
        out.append(collected(found))
    return out


def _on_all_joints(study: Study, law: LawChoice) -> AlternativeChoice:
    """A law on all joints, with the parameters that the study gives it where all of them have it already."""
    own = {study.law_of(joint).kind.label: study.law_of(joint) for joint in study.joints}
    return AlternativeChoice(name=law.model, law=own[law.kind.label] if set(own) == {law.kind.label} else law)


def _bases(places: Sequence[tuple[Case, int]], choice: BackboneChoice, progress: _Progress) -> list[SlipBasis]:
    """The structure of each case under one of its loads, with one basis, which is empty yet."""
    bases: list[SlipBasis] = []
    before: Case | None = None
    for case, index in places:
        study, structure = case.study, case.structure
        if case is not before:
            problem, before = structure.assembly(solver=study.modes.solver), case
        progress.stage(f"preload {study.preloads[index].name}", 0.2)
        preload = checked_preload(structure, problem, study.preloads[index])
        structure = structure.under(preload)
        springs = structure.springs(preload.pressures)
        for joint, own in zip(structure.joints, springs, strict=True):
            if not np.any(own.k_t > 0):
                raise InputError(
                    f"joint {joint.name!r}: {joint.law.model.name} has no tangential stiffness, so that nothing slips; "
                    'set tangential = "mindlin", or take another law'
                )
        if bases:
            bases.append(bases[0].under(structure, preload, springs))
            continue
        progress.stage("modes", 0.4)
        bases.append(
            SlipBasis(
                structure=structure,
                preload=preload,
                springs=springs,
                modes=_modes(case, springs, choice.mode),
                mode=choice.mode,
            )
        )
    return bases


def _modes(case: Case, springs: Sequence[Springs[Interface]], mode: int) -> Modes:
    most = int(np.count_nonzero(case.structure.dynamic_matrices[1].diagonal() > 0)) // 2
    wanted = max(min(mode + EXTRA_MODES, most - case.rigid_count), 1)
    modes, *_ = modes_of(case.modal, springs, case.rigid_count + wanted)
    check_motions(case.structure, modes)
    return modes


@dataclass(frozen=True, kw_only=True)
class _Prepared:
    """A case under one load, ready for its curves."""

    case: Case
    choice: BackboneChoice
    load: float
    basis: SlipBasis

    def laws(self, friction: Sequence[float], springs: int = SPRINGS) -> list[Microslip]:
        """The microslip law of each joint under the preload."""
        structure, preload = self.basis.structure, self.basis.preload
        if self.choice.slip != "coulomb":
            return cut_laws(structure, preload, friction, springs)
        return [
            Microslip.coulomb(joint.law, -opening, friction=mu, gap=joint.interface.gap)
            for joint, opening, mu in zip(structure.joints, preload.openings, friction, strict=True)
        ]

    def train(self, friction: Sequence[float], progress: _Progress) -> None:
        """Make the basis fit the curve."""
        _, _, observer = self.observed()
        levels = self.choice.amplitude[1] * 10 ** -np.arange(0.0, TRAINED + EACH / 2, EACH)[::-1]
        self.basis.train(
            self.laws(friction, TRAINING_SPRINGS),
            lambda epmc: [level / epmc.level_of(1.0) for level in levels],
            harmonics=min(self.choice.harmonics, 2),
            samples=SAMPLES // 2,
            observer=observer,
            report=lambda text: progress.stage(text, 0.8),
        )

    def observed(self) -> tuple[int, Array, Array]:
        """Node, direction (3,) and functional (unknowns,) of the motion that is given."""
        mesh, shape = self.case.structure.mesh, self.basis.shape.reshape(-1, 3)
        size = np.linalg.norm(shape, axis=1)
        at = self.choice.at
        node = int(np.argmax(size)) if at is None else nearest_node(mesh, at, "point of the backbone")
        if size[node] < MIN_MOTION * size.max():
            raise InputError(
                f"mode {self.choice.mode} hardly moves at this point ({size[node] / size.max():.1e} of its greatest "
                f"motion); give another one, such as {in_mm(mesh.points[np.argmax(size)])}, where it moves most"
            )
        direction = shape[node] / size[node]
        functional = np.zeros(mesh.unknowns)
        functional[3 * node : 3 * node + 3] = direction
        return node, direction, functional

    def rest_damping(self) -> float:
        """Ratio to critical [-] that is added: as given, or half of the loss factor that the laws give at rest."""
        if self.choice.rest_damping != "law":
            return float(self.choice.rest_damping)
        basis, structure = self.basis, self.case.structure
        if not structure.predicts_loss:
            raise InputError('rest_damping = "law": no law of this study predicts a loss; give a number such as 0.001')
        stiffness, loss = structure.coupled(basis.springs)
        own, rigid = basis.modes_here(), structure.rigid_count
        found = damped_modes(own, stiffness, basis.mass, loss, rigid=rigid, count=basis.mode)
        return float(found.damping_ratios[basis.mode - 1])

    def curve(
        self,
        friction: tuple[float, ...],
        known: Sequence[EpmcPoint],
        keep: Callable[[int, EpmcPoint], None],
        progress: _Progress,
    ) -> BackboneCurve:
        """Follow the curve, from the points that are known."""
        node, direction, observer = self.observed()
        epmc = self.basis.epmc(self.laws(friction), harmonics=self.choice.harmonics, samples=SAMPLES, observer=observer)
        low, high = self.choice.amplitude
        residuals: list[float] = [self.basis.residual(epmc, point)[0] for point in known]

        def found(point: EpmcPoint) -> str | None:
            residuals.append(self.basis.residual(epmc, point)[0])
            keep(len(residuals) - 1, point)
            progress.within(f"{point.level:.3g} m/s2", 0.8 * np.log(point.level / low) / np.log(high / low))
            if residuals[-1] > SPENT:
                return f"the basis is spent: the full equations leave a residual of {residuals[-1]:.1%} in energy"
            return None

        line: EpmcCurve = epmc.follow(low, high, known=known, keep=found)
        progress.within("error bounds", 0.85)
        return BackboneCurve(
            case=self.case,
            choice=self.choice,
            load=self.load,
            friction=friction,
            basis=self.basis,
            epmc=epmc,
            line=line,
            residuals=residuals,
            node=node,
            direction=direction,
            rest_damping=self.rest_damping(),
        )
