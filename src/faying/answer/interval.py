"""From what is not known of a case to the interval of each frequency, one thing at a time."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from statistics import NormalDist

import numpy as np

from faying.case.case import Case
from faying.case.changed import BETWEEN, ChangedCase, can_change, frequencies_of
from faying.case.mesh_error import MeshError, elastic_modes
from faying.case.part_tests import KnownParts
from faying.case.scatter import (
    LEVELS,
    ONE_EACH_WAY,
    SCATTER,
    SCORE,
    Known,
    force_factors,
    force_key,
    known_of,
    mode_sd,
    of_number,
    stated,
    structure_sd,
)
from faying.case.solve import LoadedCase
from faying.case.waves import JointPlacement, drawn_on, form_of
from faying.errors import NotConverged
from faying.form.form import Form
from faying.form.waviness import ASSUMED_GAP, LaidWaves
from faying.joint.joint_law import JointLaw
from faying.notes import INCOMPLETE, Note, joint_names
from faying.numerics.follow import same_group
from faying.result.groups import WaveDraws
from faying.result.interval import Interval
from faying.result.run_record import preload_slope
from faying.typing import Array
from faying.units import show

DRAWS = 4
MIN_DRAWS = 2  # that have a scatter
PRELOAD = "preload"
BOTH = {"law", "k_t/k_n"}  # act on the same springs: what they do together is no sum
TRAINED = 4  # bolts that scatter apart up to which the basis is made for each; for more it is right to a thousandth
MOVES = 0.1  # of what both do together: less by each alone says nothing of their shares
GRID = 64  # equal shares of the probability of either: a quantile of both is right to a hundredth of the width


@dataclass(frozen=True, kw_only=True)
class _Wavy:
    """A joint on which waves are drawn: its form, whose seed varies, and its waves on the mesh.

    own: the seed of the draw that the case has; None where it has none.
    """

    place: JointPlacement
    form: Form
    laid: LaidWaves
    own: int | None

    def gap(self, seed: int) -> Array:
        """Gap (q,) [m] in one draw."""
        assert self.form.waviness is not None
        return self.place.gap(replace(self.form, waviness=replace(self.form.waviness, seed=seed)))


@dataclass(frozen=True, kw_only=True)
class Draws:
    """The draws of waves on the joints of a case; nothing on a joint that stays as it is."""

    wavy: Sequence[_Wavy | None]
    seeds: tuple[int, ...] = tuple(range(DRAWS))

    @classmethod
    def of(cls, case: Case, known: Known) -> "Draws":
        """The draws of a case of which so much scatters."""
        return cls(wavy=_wavy(case, known))

    @property
    def drawn(self) -> tuple[int, ...]:
        """The seeds of the draws that the case itself does not have."""
        if not any(self.wavy):
            return ()
        own = {waves.own for waves in self.wavy if waves is not None}
        return tuple(seed for seed in self.seeds if own != {seed})

    def gaps(self, case: Case, seed: int) -> list[Array]:
        """Gap of each joint [m] (q,) in one draw."""
        pairs = zip(case.structure.joints, self.wavy, strict=True)
        return [joint.interface.gap if waves is None else waves.gap(seed) for joint, waves in pairs]

    def band(
        self, loads: Array, states: Sequence[LoadedCase], found: Sequence[Array | NotConverged]
    ) -> WaveDraws | None:
        """The frequencies of all draws that have an answer, from those of `drawn` [Hz] (loads, m).

        loads: preloads of the first bolt [N]. None where nothing is drawn, or fewer than two draws have an answer.
        """
        if not any(self.wavy):
            return None
        solved = np.stack([state.damped.frequencies for state in states])
        by_seed = dict.fromkeys(self.seeds, solved) | dict(zip(self.drawn, found, strict=True))
        rows = {seed: row for seed, row in by_seed.items() if not isinstance(row, NotConverged)}
        if len(rows) < MIN_DRAWS:
            return None
        ends = [
            (np.nan, np.nan) if w is None else (max(w.laid.waves.shortest, w.laid.carried), w.laid.waves.longest)
            for w in self.wavy
        ]
        rms = [np.nan if w is None else w.laid.waves.Wq for w in self.wavy]
        frequencies = np.stack(list(rows.values()))
        slopes = np.stack([preload_slope(values, loads) for values in frequencies]) if len(loads) > 1 else None
        return WaveDraws(
            seeds=np.array(list(rows)),
            frequencies=frequencies,
            slopes=slopes,
            rms=np.array(rms),
            lengths=np.array(ends),
        )

    def notes(self, case: Case) -> list[Note]:
        """What is assumed of the faces that the study says nothing of."""
        named = zip(case.study.joints, self.wavy, strict=True)
        silent = [joint.name for joint, waves in named if waves is not None and joint.form is None]
        if not silent:
            return []
        text = (
            f"{joint_names(silent)}: the study gives no form of the faces. The table of modes has them as meshed; "
            f"machined faces have waves, and {DRAWS} draws of waves with a gap of {show(ASSUMED_GAP, 'm')} rms say how "
            "far that moves each frequency. Give [joint.form] a measured map, waviness, or flat = true"
        )
        return [Note(code="waves-assumed", severity="limit", text=text)]


def _wavy(case: Case, known: Known) -> list[_Wavy | None]:
    """Where waves are drawn on each joint; None where it stays as it is."""
    study, mesh, out = case.study, case.structure.mesh, list[_Wavy | None]()
    for joint, choice, surface in zip(case.structure.joints, study.joints, case.surfaces, strict=True):
        laid = drawn_on(study, mesh, choice, joint.interface, surface)
        if laid is None or of_number(known, choice.name, "form.waviness_seed") is None:
            out.append(None)
            continue
        place = JointPlacement.of(mesh, choice, joint.interface, surface)
        own = None if choice.form is None else laid.waves.seed
        out.append(_Wavy(place=place, form=form_of(choice, surface), laid=laid, own=own))
    return out


Found = Array | NotConverged  # frequencies [Hz] (loads, m) of a change, or why it has none
NOTED_RATIO = 2.0  # factor between measured stiffness and a law that is noted


@dataclass(frozen=True, kw_only=True)
class Joints:
    """Frequencies [Hz] (loads, m) of a case whose joints are changed.

    Args:
        band: draws of waves under the laws as they are; None where none are drawn.
        medians: the same draws, or the case as it is where none are drawn, and with the medians of the law, of k_t/k_n
            and of the preload; none where the joints cannot be changed.
        pairs: both ends of each thing about the first of these.
        corners: the law at both ends with k_t/k_n at both ends, about the same (4); none where either does not scatter.
    """

    band: WaveDraws | None = None
    medians: Sequence[tuple[Found | None, Found]] = ()
    pairs: Mapping[str, tuple[Found, Found]] = field(default_factory=dict)
    corners: Sequence[Found] = ()


def intervals(
    case: Case, states: Sequence[LoadedCase], mesh: MeshError | None
) -> tuple[WaveDraws | None, Interval | None, list[Note]]:
    """Draws of waves and the interval of every frequency, from states and from a small basis.

    Args:
        case, states: the case and its state under each load.
        mesh: the error of the mesh, where it is known.

    Returns:
        The draws, None where none are drawn; the interval; notes on what is assumed, or could not be found.
    """
    if not case.study.modes.intervals:
        return None, None, []
    parts = KnownParts.of(case.study, case.structure, [elastic_modes(case, state) for state in states])
    of_parts = [] if parts is None else list(parts.notes())
    known = known_of(case)
    if not case.structure.joints or not can_change(case):
        text = (
            "the intervals do not contain law, k_t/k_n, preload and waves, which are found for bolts pulled at once, "
            "springs per area and hysteretic damping"
        )
        lost = (
            [Note(code=INCOMPLETE, severity="wrong", text=text), *law_notes(case, known)]
            if case.structure.joints
            else []
        )
        return None, _combined(case, known, states, mesh, parts, Joints()), [*lost, *of_parts]
    draws = Draws.of(case, known)
    plain = ChangedCase.nothing(case)
    waves = [replace(plain, gaps=draws.gaps(case, seed)) for seed in draws.drawn]
    laws, factors = _laws(case, known), _preload_factors(case, known)[1]
    medians = [replace(one, laws=laws, factor=factors) for one in waves or [plain]]
    ends = _ends(case, known, medians[0])
    corners = _corners(case, known, medians[0]) if ends.keys() >= BOTH else []
    of_ends = [*(one for pair in ends.values() for one in pair), *corners]
    # modes of a draw under the medians are those of the draw, and those of the ends are those of the first median
    after = [*[None] * len(waves), *(range(len(waves)) or [None]), *[len(waves)] * len(of_ends)]
    found = iter(frequencies_of(case, states, [*waves, *medians, *of_ends], after))
    of_waves, of_medians = ([next(found) for _ in some] for some in (waves, medians))
    pairs = {name: (next(found), next(found)) for name in ends}
    band = draws.band(case.loads, states, of_waves)
    both = list(zip(of_waves or (None,), of_medians, strict=True))
    of_joints = Joints(band=band, medians=both, pairs=pairs, corners=list(found))
    of_draws = [
        drawn if isinstance(drawn, NotConverged) else at for drawn, at in of_joints.medians if drawn is not None
    ]
    of_about = f"{', '.join(pairs)} and their medians" if pairs else "medians"
    lost = [*_incomplete({"draws of waves": of_draws, of_about: of_medians[:1], **pairs})]
    notes = [*lost, *of_parts, *draws.notes(case), *law_notes(case, known)]
    return band, _combined(case, known, states, mesh, parts, of_joints), notes


def _laws(case: Case, known: Known, factor: int = 1, ratio: int = 1) -> list[JointLaw]:
    """The law of each joint at 5, 50 or 95 % (0, 1, 2) of the factor on its stiffness and of k_t/k_n."""
    out = []
    scatter = of_each(case, known, "stiffness"), of_each(case, known, "tangential")
    for joint, factors, ratios in zip(case.structure.joints, *scatter, strict=True):
        law = replace(joint.law, tangential=ratios[ratio]) if ratios else joint.law
        out.append(law.scaled(factors[factor]) if factors else law)
    return out


def _ends(case: Case, known: Known, middle: ChangedCase) -> dict[str, tuple[ChangedCase, ChangedCase]]:
    """Both ends of what moves the joints, about a draw of waves with the medians of the law and of k_t/k_n.

    Faces without waves under Mindlin's ratio are the stiffest that they can be: there a law would hardly matter.
    """
    out: dict[str, tuple[ChangedCase, ChangedCase]] = {}
    if any(of_each(case, known, "stiffness")):
        out["law"] = replace(middle, laws=_laws(case, known, 0)), replace(middle, laws=_laws(case, known, 2))
    if any(of_each(case, known, "tangential")):
        out["k_t/k_n"] = replace(middle, laws=_laws(case, known, 1, 0)), replace(middle, laws=_laws(case, known, 1, 2))
    low, factors, high = _preload_factors(case, known)
    apart = [bolts for bolts in _bolts_alike(case, known) if np.any(low[bolts] < high[bolts])]
    for bolts in apart:
        who = "" if len(apart) == 1 else f" of {' and '.join(case.study.bolts[k].name for k in bolts)}"
        both = factors.copy(), factors.copy()
        both[0][bolts], both[1][bolts] = low[bolts], high[bolts]
        first, second = (replace(middle, factor=one, trained=len(apart) <= TRAINED) for one in both)
        out[f"{PRELOAD}{who}"] = first, second
    return out


def _preload_factors(case: Case, known: Known) -> Array:
    """Factors on the preload of each bolt (3, b): 5 %, median and 95 %."""
    return np.stack([force_factors(known, case.study, k, LEVELS) for k in range(len(case.study.bolts))], axis=1)


def _bolts_alike(case: Case, known: Known) -> list[list[int]]:
    """Bolts whose preloads scatter by one key: each with a key of its own before the others together."""
    groups: dict[str, list[int]] = {}
    for k, bolt in enumerate(case.study.bolts):
        groups.setdefault(force_key(known, bolt.name), []).append(k)
    return sorted(groups.values(), key=len)


def _corners(case: Case, known: Known, middle: ChangedCase) -> list[ChangedCase]:
    """The law at both ends with k_t/k_n at both ends."""
    laws = [_laws(case, known, factor, ratio) for factor in (0, 2) for ratio in (0, 2)]
    return [replace(middle, laws=one, trained=False) for one in laws]


def _incomplete(found: Mapping[str, Sequence[Found]]) -> Iterator[Note]:
    """Say what has no answer and is not in the intervals, and of several draws how many."""
    for name, some in found.items():
        faults = [one for one in some if isinstance(one, NotConverged)]
        if faults:
            what = f"{len(faults)} of {len(some)} {name}" if len(some) > 2 else name
            yield Note(
                code=INCOMPLETE,
                severity="wrong",
                text=f"the intervals do not contain {what}, which found no answer: {faults[0]}",
            )


def of_each(case: Case, known: Known, name: str) -> list[tuple[float, ...] | None]:
    """5, 50 and 95 % of a number of each joint; None where it does not scatter."""
    found = (of_number(known, joint.name, name) for joint in case.study.joints)
    return [None if one is None else tuple(one.quantile(LEVELS).tolist()) for one in found]


def law_notes(case: Case, known: Known) -> Iterator[Note]:
    """Say where measured joints have less than half or more than twice the stiffness of the law in the median.

    And which laws were not compared with measurements.
    """
    unknown: dict[str, list[str]] = {}
    found: dict[tuple[str, tuple[float, ...]], list[str]] = {}
    listed = stated(case.study.uncertain)
    laws = [joint.law for joint in case.structure.joints]
    for joint, law, factors in zip(case.study.joints, laws, of_each(case, known, "stiffness"), strict=True):
        if factors is None:
            if case.study.assumes_scatter:
                unknown.setdefault(law.model.name, []).append(joint.name)
            continue
        if not (of_number(listed, joint.name, "stiffness") or 1 / NOTED_RATIO <= factors[1] <= NOTED_RATIO):
            found.setdefault((law.model.name, factors), []).append(joint.name)
    for name, names in unknown.items():
        text = (
            f"{', '.join(names)}: {name} was not compared with measurements, so that the intervals do not contain how "
            "far the law is off; state joint.stiffness under [uncertain], or take a law that was compared"
        )
        yield Note(code="law-not-compared", severity="limit", joint=names[0] if len(names) == 1 else "", text=text)
    for (name, (low, middle, high)), names in found.items():
        text = (
            f"{', '.join(names)}: measured joints of such metals have {middle:.2g} times the stiffness of {name} in "
            f"the median, {low:.2g} to {high:.2g} times from 5 to 95 %; the intervals contain this, the frequencies do "
            "not"
        )
        yield Note(code="law-off", severity="limit", joint=names[0] if len(names) == 1 else "", text=text)


def _combined(
    case: Case,
    known: Known,
    states: Sequence[LoadedCase],
    mesh: MeshError | None,
    parts: KnownParts | None,
    joints: Joints,
) -> Interval:
    """The interval of each frequency, by what each thing moves ln f (loads, m) from the best estimate.

    Twins have one for both: which of them is which no shape tells.
    """
    f = np.stack([state.damped.frequencies for state in states])
    groups = same_group(f)

    def of_group(values: Array) -> Array:
        return np.asarray(np.einsum("lij,...lj->...li", groups / groups.sum(axis=-1, keepdims=True), values))

    found, moved, middle = {}, np.zeros(f.shape), np.zeros(f.shape)
    about = joints.medians[0][1] if joints.medians else None
    both = [(f if drawn is None else drawn, at) for drawn, at in joints.medians]
    shifts = [np.log(at / drawn) for drawn, at in both if isinstance(at, np.ndarray) and isinstance(drawn, np.ndarray)]
    if shifts:
        middle += np.mean(shifts, axis=0)
    if isinstance(about, np.ndarray):
        bolts = []
        for name, (low, high) in joints.pairs.items():
            if isinstance(low, np.ndarray) and isinstance(high, np.ndarray):
                found[name] = np.log(np.stack([low, high]) / about)
                if name.startswith(PRELOAD):
                    bolts.append(found.pop(name))
        if bolts:  # independent of each other: the squares of each side add
            ends = np.array([[np.minimum(one.min(axis=0), 0), np.maximum(one.max(axis=0), 0)] for one in bolts])
            found[PRELOAD] = bolts[0] if len(bolts) == 1 else ONE_EACH_WAY * np.linalg.norm(ends, axis=0)
        corners = [np.log(one / about) for one in joints.corners if isinstance(one, np.ndarray)]
        if found.keys() >= BOTH and len(corners) == 4:
            found |= _together({name: found[name] for name in BOTH}, np.stack(corners))
    if joints.band is not None:
        logs = np.log(joints.band.frequencies / f)
        mean = logs.mean(axis=0)
        middle += mean
        split = of_group((mean - of_group(mean)) ** 2)  # of twins, by waves that are nowhere alike
        found["waves"] = SCORE * np.sqrt(of_group(logs.var(axis=0, ddof=1)) + split) * ONE_EACH_WAY
    if case.study.assumes_scatter and all(state.ends and "scan" in state.ends for state in states):
        found["scan"] = np.log(np.stack([(state.ends or {})["scan"] for state in states], axis=1) / f)
    for name, sd in (("structure", structure_sd(case.study.uncertain)), ("mode", mode_sd(case.study.uncertain))):
        found[name] = SCORE * sd * ONE_EACH_WAY * np.ones(f.shape)
    if parts is not None:
        found, moved = parts.instead(found)
    if mesh is not None:
        found["mesh"], moved = mesh.offsets, moved + mesh.middle
    named = {name: of_group(found[name]) for name in SCATTER if name in found}
    return Interval.about(np.exp(of_group(np.log(f) + middle + moved)), named, of_group(moved))


def _together(alone: Mapping[str, Array], corners: Array) -> dict[str, Array]:
    """What the law and k_t/k_n move ln f by, so that their squares add to the ends of what both do together.

    Where a joint is soft its shear counts more: both at an end move a mode by more, or less, than their sum. Between
    the ends and beyond them ln f goes with each normal score, and with the product of both in each quadrant.

    Args:
        alone: Both ends of each by itself (2, loads, m), by the names in `BOTH`.
        corners: Both at their ends, those of the law first (4, loads, m).
    """
    law, ratio = alone["law"], alone["k_t/k_n"]
    known = np.zeros((3, 3, *law.shape[1:]))
    known[::2, 1], known[1, ::2], known[::2, ::2] = law, ratio, corners.reshape(2, 2, *law.shape[1:])
    scores = np.array([NormalDist().inv_cdf((k + 0.5) / GRID) for k in range(GRID)]) / SCORE
    weights = np.stack([np.maximum(-scores, 0.0), 1 - np.abs(scores), np.maximum(scores, 0.0)])
    values = np.einsum("ia,jb,ij...->ab...", weights, weights, known).reshape(GRID**2, *law.shape[1:])
    low, high = np.quantile(values, LEVELS[::2], axis=0)
    # the end that moves it up: the upper one, unless the lower does by more than bases miss; the other moves it down
    up = {name: np.where(one[0] > one[1] + BETWEEN, 0, 1)[None] for name, one in alone.items()}
    out = {name: np.array(one) for name, one in alone.items()}
    for sign, end in ((-1, np.maximum(-low, 0.0)), (1, np.maximum(high, 0.0))):
        sides = [np.maximum(sign * one, 0.0).max(axis=0) for one in (law, ratio)]
        own = np.hypot(*sides)
        # where neither moves it this way by itself, both together do: the law has it all
        share = np.where(own > MOVES * end, sides[0] / np.where(own > 0, own, 1.0), 1.0)
        for name, part in (("law", share), ("k_t/k_n", np.sqrt(1 - share**2))):
            which = up[name] if sign > 0 else 1 - up[name]
            np.put_along_axis(out[name], which, (sign * end * part)[None], axis=0)
    return out
