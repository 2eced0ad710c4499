"""What a sheet takes from load cases: working and transverse load, load factor and loss by temperature of each bolt."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying.answer.load_answers import answers, preloaded_case
from faying.case.case import Case, Progress
from faying.case.engine import Engine
from faying.case.solve import LoadedCase
from faying.loads.load import Load
from faying.result.bolts import BoltNumbers
from faying.result.load_cases import LoadCases
from faying.study.keys.bolt_sheet import choice_of

HEAT = "heat of "  # stands before the name of a case of which the temperatures alone act
COLD = "without heat: "  # the same of what else acts
AGAIN = "'"  # stands behind where a study has a case of that name


@dataclass(frozen=True, kw_only=True)
class _Parted:
    """Cases with temperatures, by name: the case of these alone, and that of all else."""

    heat: dict[str, Load]
    rest: dict[str, Load]


@dataclass(frozen=True, kw_only=True)
class BoltLoad:
    """What load cases are to one bolt.

    Args:
        axial: Least and greatest working load [N].
        transverse: Greatest load across the bolt [N], on the joint round it and across its shank.
        additional: Least and greatest change of the bolt's force [N], without that by temperature.
        taken: Greatest force [N] that the joint loses.
        introduction: n, that makes the load factor the one that was found under the greatest working load [-].
        thermal_loss: Greatest loss of preload by temperature [N]; None where no case changes a temperature.
        thermal_gain: Greatest gain of preload by temperature [N].
    """

    axial: tuple[float, float]
    transverse: float
    additional: tuple[float, float]
    taken: float
    introduction: float
    thermal_loss: float | None
    thermal_gain: float


def bolt_loads(
    case: Case, state: LoadedCase, engine: Engine, numbers: BoltNumbers, progress: Progress
) -> dict[int, BoltLoad]:
    """Return what the cases that [[bolt_sheet]] names are to each bolt, by its index; those without one are left out.

    The change of a bolt's force is n Phi_K F_A and what temperature makes of it, with Phi_K of a load at the seats: the
    temperatures of a case are solved for apart. Shear by temperature gives way once it slips, and is none that friction
    has to carry.
    """
    study = case.study
    wanted = {k: choice_of(study.bolt_sheets, bolt.name).loads for k, bolt in enumerate(study.bolts)}
    names = tuple(dict.fromkeys(name for some in wanted.values() for name in some))
    if not names:
        return {}
    asked = _with_needs(study.load_cases, names)
    base = preloaded_case(case, state.preload, state.springs, engine, modes=False)
    parted = _parted(asked, names)
    found = answers(base, (*asked, *parted.heat.values(), *parted.rest.values()), progress)
    shares = numbers.load_factor[0]
    return {k: _bolt_load(found, k, some, float(shares[k]), parted) for k, some in wanted.items() if some}


def _parted(asked: Sequence[Load], names: Sequence[str]) -> _Parted:
    """For each case of these names that has temperatures: a case of them alone, and one without them."""
    out, by_name = _Parted(heat={}, rest={}), {load.name: load for load in asked}
    taken = set(by_name)

    def free(name: str) -> str:
        while name in taken:
            name += AGAIN
        taken.add(name)
        return name

    for name in names:
        changes = {what: change for what, change in _temperatures(by_name, name).items() if change}
        if changes:
            out.heat[name] = Load(free(HEAT + name), temperature=changes)
            without = {what: -change for what, change in changes.items()}
            out.rest[name] = Load(free(COLD + name), combine={name: 1.0}, temperature=without)
    return out


def _bolt_load(found: LoadCases, k: int, names: Sequence[str], share: float, parted: _Parted) -> BoltLoad:
    """What cases are to one bolt; share: its load factor Phi_K for a load at the seats."""
    rows = [found.index(name) for name in names]
    change = found.bolt_force[:, k] - found.bolt_preload[k]
    heat = np.array([change[found.index(parted.heat[name].name)] if name in parted.heat else 0.0 for name in names])
    across = [parted.rest[name].name if name in parted.rest else name for name in names]
    working = found.working_load[rows, k]
    most = int(np.argmax(working if working.max() > 0 else np.abs(working)))
    known = np.isfinite(found.load_factor[rows[most], k]) and share > 0
    factor = (change[rows[most]] - heat[most]) / working[most] / share if known else 1.0
    own = change[rows] - heat
    if len(rows) == 1:  # from nothing to it
        working, own = np.append(working, 0.0), np.append(own, 0.0)
    heated = any(name in parted.heat for name in names)
    return BoltLoad(
        axial=(float(working.min()), max(float(working.max()), 0.0)),
        transverse=max(_across(found, found.index(name), k) for name in across),
        additional=(float(own.min()), float(own.max())),
        taken=max(float((working - own).max()), 0.0),
        introduction=float(factor),
        thermal_loss=max(float((-heat).max()), 0.0) + 0.0 if heated else None,
        thermal_gain=max(float(heat.max()), 0.0),
    )


def _across(found: LoadCases, row: int, k: int) -> float:
    """Load across a bolt [N]: what the joint round it bears by friction, and its shank beyond that."""
    shank = float(found.bolt_shear[row, k])
    return float(found.transverse_load[row, k]) + (shank if np.isfinite(shank) else 0.0)


def _with_needs(loads: Sequence[Load], names: Sequence[str]) -> tuple[Load, ...]:
    """The cases of these names and those that they refer to, in their order."""
    by_name = {load.name: load for load in loads}
    kept: set[str] = set()
    left = list(names)
    while left:
        name = left.pop()
        if name not in kept:
            kept.add(name)
            left += by_name[name].needs
    return tuple(load for load in loads if load.name in kept)


def _temperatures(loads: dict[str, Load], name: str) -> dict[str, float]:
    total = dict(loads[name].temperature)
    for other, factor in loads[name].combine.items():
        for what, change in _temperatures(loads, other).items():
            total[what] = total.get(what, 0.0) + factor * change
    return total
