"""From what is not known of a case to the interval of each frequency, one thing at a time."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from faying.answer.wave_band import Draws, WaveBand
from faying.case.case import Case
from faying.case.changed import ChangedCase, can_change, frequencies_of
from faying.case.ends import Pair, at_median_ratio, quantiles
from faying.case.law_range import of_joint
from faying.case.mesh_error import MeshError
from faying.case.part_tests import KnownParts
from faying.case.scatter import ENDS, SCATTER, SCORE, default, mode_sd, stated, structure_sd
from faying.case.solve import LoadedCase
from faying.errors import FayingError
from faying.notes import Note
from faying.result.interval import Interval
from faying.typing import Array

NOTED_RATIO = 2.0  # factor between measured stiffness and a law that is noted


def intervals(
    case: Case, states: Sequence[LoadedCase], mesh: MeshError | None
) -> tuple[WaveBand | None, Interval | None, list[Note]]:
    """Draws of waves and the interval of every frequency, from states and from a small basis.

    Args:
        case, states: the case and its state under each load.
        mesh: the error of the mesh, where it is known.

    Returns:
        The draws, None where none are drawn; the interval; notes on what is assumed, or could not be found.
    """
    if not case.study.modes.intervals:
        return None, None, []
    parts = KnownParts.of(case, states)
    known = [] if parts is None else list(parts.notes())
    changes: dict[str, list[ChangedCase]] = {}
    draws = Draws(wavy=[None] * len(case.structure.joints))
    if can_change(case):
        draws, plain = Draws.of(case), ChangedCase.nothing(case)
        changes["waves"] = [replace(plain, gaps=draws.gaps(case, seed)) for seed in draws.drawn]
        # about the median of k_t/k_n: where Mindlin's ratio holds the faces, the law would hardly matter
        laws = [at_median_ratio(case, joint) for joint in case.structure.joints]
        factors = law_factors(case)
        changes["middle"] = [replace(plain, laws=laws)]
        if any(factors):
            both = [list(zip(laws, [three and three[k] for three in factors], strict=True)) for k in (0, 2)]
            changes["law"] = [
                replace(plain, laws=[law.scaled(factor or 1.0) for law, factor in pairs]) for pairs in both
            ]
        if len(case.loads) == 1:
            changes["preload"] = [replace(plain, factor=factor) for factor in _preload_factors(case)]
    try:
        found = iter(frequencies_of(case, states, [one for some in changes.values() for one in some]))
    except FayingError as fault:
        text = f"no interval from the law and no draws of waves: {fault}"
        return None, _combined(case, states, {}, mesh, parts), [*known, Note(code="interval", text=text)]
    by_name = {name: [next(found) for _ in some] for name, some in changes.items()}
    band = draws.band(states, by_name.pop("waves", []))
    middle = by_name.pop("middle")[0] if "middle" in by_name else None
    pairs = {name: (one, other) for name, (one, other) in by_name.items()}
    combined = _combined(case, states, pairs, mesh, parts, middle, band)
    return band, combined, [*known, *draws.notes(case), *law_notes(case)]


def law_factors(case: Case) -> list[tuple[float, float, float] | None]:
    """5, 50 and 95 % of the factor on the stiffness of each joint; None of a law that was not compared."""
    study, mesh = case.study, case.structure.mesh
    return [
        quantiles(case, f"joint.{joint.name}.stiffness", "joint.stiffness", of_joint(study, mesh, joint, surface))
        for joint, surface in zip(study.joints, case.surfaces, strict=True)
    ]


def law_notes(case: Case) -> Iterator[Note]:
    """Say where measured joints have less than half or more than twice the stiffness of the law in the median.

    And which laws were not compared with measurements.
    """
    unknown: dict[str, list[str]] = {}
    found: dict[tuple[str, tuple[float, float, float]], list[str]] = {}
    known = stated(case.study.uncertain)
    laws = [joint.law for joint in case.structure.joints]
    for joint, law, factors in zip(case.study.joints, laws, law_factors(case), strict=True):
        if factors is None:
            unknown.setdefault(law.model.name, []).append(joint.name)
            continue
        given = f"joint.{joint.name}.stiffness" in known or "joint.stiffness" in known
        if not (given or 1 / NOTED_RATIO <= factors[1] <= NOTED_RATIO):
            found.setdefault((law.model.name, factors), []).append(joint.name)
    for name, names in unknown.items():
        text = (
            f"{', '.join(names)}: {name} was not compared with measurements, so that the intervals do not contain how "
            "far the law is off; state joint.stiffness under [uncertain], or take a law that was compared"
        )
        yield Note(code="law-not-compared", joint=names[0] if len(names) == 1 else "", text=text)
    for (name, (low, middle, high)), names in found.items():
        text = (
            f"{', '.join(names)}: measured joints of such metals have {middle:.2g} times the stiffness of {name} in "
            f"the median, {low:.2g} to {high:.2g} times from 5 to 95 %; the intervals contain this, the frequencies do "
            "not"
        )
        yield Note(code="law-off", joint=names[0] if len(names) == 1 else "", text=text)


def _combined(
    case: Case,
    states: Sequence[LoadedCase],
    pairs: dict[str, Pair],
    mesh: MeshError | None,
    parts: KnownParts | None,
    middle: Array | None = None,
    band: WaveBand | None = None,
) -> Interval:
    """The interval from frequencies [Hz] (loads, m) at both ends of each thing, draws of waves, and the table.

    middle: frequencies at the median of k_t/k_n, about which the ends of the law lie.
    """
    frequencies = np.stack([state.damped.frequencies for state in states])
    for name in {name for state in states for name in state.ends or {} if name in SCATTER}:
        both = [(state.ends or {})[name] for state in states]
        pairs[name] = np.stack([one[0] for one in both]), np.stack([one[1] for one in both])
    found = {name: np.log(np.stack(pair) / frequencies) for name, pair in pairs.items()}
    if middle is not None:
        shift = np.log(middle / frequencies)
        if "law" in found:
            found["law"] = found["law"] - shift
        if "k_t/k_n" in found:
            half = (found["k_t/k_n"][1] - found["k_t/k_n"][0]) / 2
            found["k_t/k_n"] = np.stack([shift - half, shift + half])
    if band is not None:
        logs = np.log(band.frequencies / frequencies)
        half = SCORE * logs.std(axis=0, ddof=1)
        found["waves"] = np.stack([logs.mean(axis=0) - half, logs.mean(axis=0) + half])
    if len(states) > 1:
        found["preload"] = _by_preload(case.loads, frequencies, _preload_factors(case))
    for name, sd in (("structure", structure_sd(case.study.uncertain)), ("mode", mode_sd(case.study.uncertain))):
        found[name] = SCORE * sd * np.array([-1.0, 1.0])[:, None, None] * np.ones(frequencies.shape)
    found = found if parts is None else parts.instead(found)
    if mesh is not None:
        found["mesh"] = mesh.offsets
    names = tuple(name for name in SCATTER if name in found)
    return Interval(sources=names, offsets=np.stack([found[name] for name in names]), frequencies=frequencies)


def _preload_factors(case: Case) -> tuple[float, float]:
    """5 and 95 % of a common factor on the preload of all bolts."""
    known = stated(case.study.uncertain)
    own = [one for key, one in known.items() if key.startswith("bolt.") and key.endswith(".factor")]
    both = np.stack([one.quantile(ENDS) for one in own or [default("preload")]])
    return float(both[:, 0].min()), float(both[:, 1].max())


def _by_preload(loads: Array, frequencies: Array, factors: tuple[float, float]) -> Array:
    """Offsets of ln f (2, loads, m) under other preloads: linear in ln F between the loads, and on beyond them."""
    x, y = np.log(loads), np.log(frequencies)
    out = []
    for factor in factors:
        at = x + np.log(factor)
        right = np.clip(np.searchsorted(x, at), 1, len(x) - 1)
        share = (at - x[right - 1]) / (x[right] - x[right - 1])
        out.append((1 - share)[:, None] * y[right - 1] + share[:, None] * y[right] - y)
    return np.stack(out)
