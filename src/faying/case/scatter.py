"""What scatters in a bolted structure where the study says nothing of it: how far, and where that is known from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot, sqrt
from typing import final

import numpy as np

from faying.bolt.tightening import DEFAULT_WAY, TIGHTENING
from faying.case.case import Case
from faying.case.law_range import of_joint
from faying.case.waves import drawn_on
from faying.distribution import Distribution
from faying.form.waviness import ASSUMED
from faying.joint.structure import Structure
from faying.study.keys.bolt_sheet import BoltSheetChoice
from faying.study.keys.surface import Surface
from faying.study.keys.uncertain import ANY_DRAW, Input, UncertainChoice
from faying.study.keys.varied import number_of
from faying.study.study import Study
from faying.typing import Array

LEVELS = np.array([0.05, 0.5, 0.95])
TWO_SIGMA = 0.02275  # probability below two standard deviations
Known = Mapping[str, Distribution]  # what scatters, by its key
SCORE = 1.6449  # standard deviations from the median to these ends
ONE_EACH_WAY = np.array([-1.0, 1.0])[:, None, None]  # of ends (2, loads, m) about a median
# numbers, each with its table, that a run takes from [uncertain] beside those of parts
IN_INTERVALS = {
    *(("joint", name) for name in ("stiffness", "tangential", "form.waviness_seed")),
    *(("bolt", name) for name in ("preload", "factor")),
}
# of ln f by E: half of the coefficient of variation 0.03 of steel, JCSS Probabilistic Model Code, part 3.2
YOUNG = 0.015
DENSITY_SD = 0.01  # of ln density of steel (JCSS Probabilistic Model Code, part 2.1)
MESH_NOTED = 5e-3  # estimated error of a frequency by the mesh that is noted


@final
@dataclass(frozen=True, kw_only=True)
class Scatter:
    """One thing that is not known.

    Args:
        distribution: of its value, or of a factor on it; None where a run has other ends for it.
        source: where the distribution comes from.
        remedy: how it can be known better; "" where it cannot.
        left: of its spread, then [-].
    """

    distribution: Distribution | None = None
    source: str
    remedy: str = ""
    left: float = 1.0


TORQUE = TIGHTENING["torque wrench, friction estimated"]

SCATTER = {
    "scan": Scatter(
        source="the range that the law states of what the scan resolves, its window and its hardness",
        remedy="a larger, finer scan",
        left=0.5,
    ),
    "law": Scatter(
        source="measured stiffness over that of the law, of 20 pairs of faces by four sources, with a median for steel "
        "and one for soft metals (benchmarks/law_range.py)",
        remedy="stiffness measured on this joint",
        left=0.15,
    ),
    "k_t/k_n": Scatter(
        distribution=Distribution(kind="uniform", centre=0.55, spread=0.389),
        source="0.2 to 0.9 from 5 to 95 %: 0.3 to 0.7 by ultrasound, Mindlin's 0.83 at most",
        remedy="measured joint.tangential",
        left=0.2,
    ),
    "waves": Scatter(
        source="draws of the waves that the process leaves, or that are assumed",
        remedy="measured form of the faces",
        left=0.1,
    ),
    "preload": Scatter(
        distribution=TORQUE.distribution,
        source=TORQUE.source,
        remedy="tighten by elongation",
        left=TIGHTENING["elongation"].scatter / TORQUE.scatter,
    ),
    "mesh": Scatter(
        source="functions one degree higher on edges and faces of the elements (doi:10.1137/0730048), half of the "
        "points of the joints",
        remedy="smaller elements",
        left=0.35,
    ),
    "structure": Scatter(
        distribution=Distribution(kind="normal", centre=1.0, spread=0.03),
        source="tests over nominal models of four structures (docs/theory/model-versus-test.csv); common to all modes",
        remedy="weigh and ring each part alone",
        left=0.2,
    ),
    "parts": Scatter(source="stiffness and mass of each part, as its own weight and free modes leave them"),
    "mode": Scatter(
        distribution=Distribution(kind="normal", centre=1.0, spread=0.025),
        source="the same pairs, what is left of each mode: dimensions, supports and what the model leaves out",
    ),
}


def default(name: str) -> Distribution:
    """The distribution of an entry of `SCATTER` that has one."""
    found = SCATTER[name].distribution
    assert found is not None
    return found


def stated(choice: UncertainChoice | None) -> Known:
    """What [uncertain] says, by its key."""
    return {} if choice is None else {one.key: one.distribution for one in choice.inputs}


def of_parts(key: str) -> bool:
    """Whether a number that varies is one that parts' own tests tell: E, density, or a factor on a part."""
    return number_of(key).room in ("material", "part")


def in_intervals(key: str) -> bool:
    """Whether a run takes from [uncertain] how a number scatters."""
    return of_parts(key) or (number_of(key).room, number_of(key).name) in IN_INTERVALS


def known_of(case: Case) -> Known:
    """What scatters in a case, by its key: as [uncertain] lists it, and as is assumed of the rest."""
    return stated(with_assumed(case.study, case.structure, case.surfaces))


def of_number(known: Known, joint: str, name: str) -> Distribution | None:
    """How a number of a joint scatters: by its own key, or by that of all joints; None where it does not."""
    return known.get(f"joint.{joint}.{name}") or known.get(f"joint.{name}")


def force_key(known: Known, bolt: str) -> str:
    """The key by which the force of a bolt scatters: its own, or that of all; "" where it does not."""
    keys = (f"{owner}.{name}" for owner in (f"bolt.{bolt}", "bolt") for name in ("factor", "preload"))
    return next((key for key in keys if key in known), "")


def force_factors(known: Known, study: Study, bolt: int, shares: Array) -> Array:
    """Force of a bolt over the one that the study states [-], at shares of probability of any shape."""
    key = force_key(known, study.bolts[bolt].name)
    if not key:
        return np.ones_like(shares)
    values = known[key].quantile(shares)
    # a force itself: of studies of one preload alone
    return values if key.endswith(".factor") else np.asarray(values / study.preloads[0].forces[bolt])


def structure_sd(choice: UncertainChoice | None) -> float:
    """Standard deviation of ln f that all modes share [-], beyond E and density where [uncertain] lists them."""
    if choice is not None and choice.structure is not None:
        return float(choice.structure.median)
    common = default("structure").spread
    return sqrt(common**2 - YOUNG**2) if any(map(of_parts, stated(choice))) else common


def mode_sd(choice: UncertainChoice | None) -> float:
    """Standard deviation of ln f of each mode by itself [-]: the discrepancy of [uncertain], else that of the table."""
    given = None if choice is None else choice.discrepancy
    return default("mode").spread if given is None else float(given.median)


def discrepancy(choice: UncertainChoice) -> float:
    """Standard deviation of ln f [-] that samples of a prediction lack."""
    return hypot(mode_sd(choice), structure_sd(choice))


def with_assumed(
    study: Study, structure: Structure, surfaces: Sequence[Surface], *, laws_drawn: bool = False
) -> UncertainChoice:
    """What scatters in a study: what [uncertain] lists, and what is assumed of the rest unless that is left out.

    structure, surfaces: what the study is made into; laws_drawn: whether the laws that it lists are drawn themselves.
    """
    given = study.uncertain or UncertainChoice()
    if not study.assumes_scatter:
        return given
    listed = [number_of(one.key) for one in given.inputs]
    more: list[Input] = []
    for one in _assumed(study, structure, surfaces):
        number = number_of(one.key)
        owners = {other.owner for other in listed if (other.room, other.varies) == (number.room, number.varies)}
        if number.name == "stiffness" and laws_drawn and given.models:
            continue
        if number.owner is None and owners and None not in owners:  # listed for some joints: the others have their own
            rest = [joint.name for joint in study.joints if joint.name not in owners]
            more += [replace(one, key=f"{number.room}.{name}.{number.name}") for name in rest]
        elif not owners & {None, number.owner}:
            more.append(one)
    return replace(given, inputs=(*given.inputs, *more))


def _assumed(study: Study, structure: Structure, surfaces: Sequence[Surface]) -> list[Input]:
    """What scatters in a study that says nothing of it: stiffness of the joints, k_t/k_n, preloads, and waves."""
    found, waves = dict[str, Distribution](), dict[str, Distribution]()
    laws, ratios = dict[str, Distribution | None](), dict[str, Distribution | None]()
    for joint, fitted, surface in zip(study.joints, structure.joints, surfaces, strict=True):
        name = joint.name
        laws[name] = of_joint(study, structure.mesh, joint, surface)
        ratios[name] = None if isinstance(joint.tangential, int | float) else default("k_t/k_n")
        if drawn_on(study, structure.mesh, joint, fitted.interface, surface) is not None:
            if joint.form is None and ASSUMED.Wq is not None:
                waves[f"joint.{name}.form.waviness"] = Distribution(kind="lognormal", centre=ASSUMED.Wq, spread=0.4)
            waves[f"joint.{name}.form.waviness_seed"] = ANY_DRAW
    for key, of_joints in (("stiffness", laws), ("tangential", ratios)):
        alike = len(set(of_joints.values())) == 1  # all joints move together then
        owners = {"joint": next(iter(of_joints.values()))} if alike else {f"joint.{k}": d for k, d in of_joints.items()}
        found |= {f"{owner}.{key}": one for owner, one in owners.items() if one is not None}
    found |= {f"bolt.{bolt.name}.factor": default("preload") for bolt in study.bolts} | waves
    units = {key: "m" if key.endswith("waviness") else "" for key in found}
    return [Input(key=key, distribution=one, unit=units[key]) for key, one in found.items()]


def preload_scatter(study: Study, bolt: str, choice: BoltSheetChoice) -> tuple[float, str]:
    """Half of the range of the preload over its mean [-], and where that comes from."""
    if choice.tightening_factor is not None:
        return (choice.tightening_factor - 1) / (choice.tightening_factor + 1), "from tightening_factor"
    if choice.way is not None:
        return TIGHTENING[choice.way].scatter, f"{choice.way} ({TIGHTENING[choice.way].source})"
    index = [one.name for one in study.bolts].index(bolt)
    low, high = force_factors(stated(study.uncertain), study, index, np.array([TWO_SIGMA, 1 - TWO_SIGMA])).tolist()
    if high > low:
        return (high - low) / (high + low), "from [uncertain], two standard deviations each way"
    way = TIGHTENING[DEFAULT_WAY]
    return way.scatter, f"default: {DEFAULT_WAY} ({way.source})"
