"""What a sheet takes from load cases at each of three preloads: loads along and across each bolt, and its forces."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying.case.case import Case, Progress
from faying.case.solve import LoadedCase
from faying.errors import InputError, NotConverged
from faying.joint.modal import Engine
from faying.joint.preload_case import PreloadCase
from faying.loads.record import LoadCases
from faying.loads.solve import answers, at_preload, preloaded_case
from faying.study.keys.bolt_sheet import choice_of
from faying.study.load import Load
from faying.typing import Array

HEAT = "heat of "  # stands before the name of a case of which the temperatures alone act
COLD = "without heat: "  # the same of what else acts
AGAIN = "'"  # stands behind where a study has a case of that name


# name of a case with temperatures -> the case of these alone, and that of all else
_Parted = dict[str, tuple[Load, Load]]


@dataclass(frozen=True, kw_only=True)
class AtPreload:
    """What cases do to one bolt at one preload.

    Args:
        axial: Least and greatest working load [N].
        transverse: Greatest share of what crosses its joints [N].
        additional: Least and greatest change of the bolt's force [N], without that by temperature.
        taken: Greatest force [N] that the joint loses.
        introduction: n, that makes the load factor the one that was found under the greatest working load [-].
        thermal_loss: Greatest loss of preload by temperature [N]; None where no case changes a temperature.
        thermal_gain: Greatest gain of preload by temperature [N].
        bending: Range of the bending moment without heat [N m], at most, between the two cases that have the greatest;
            NaN where it is not known.
        damage: By the cycles of all cases [-]; None where none has any.
    """

    axial: tuple[float, float]
    transverse: float
    additional: tuple[float, float]
    taken: float
    introduction: float
    thermal_loss: float | None
    thermal_gain: float
    bending: float
    damage: float | None


@dataclass(frozen=True, kw_only=True)
class BoltLoad:
    """What load cases are to one bolt at the least preload in service, the mean one, and the greatest at assembly.

    least, greatest: None where there is no such state; missing: what there would have to be for them to be known.
    """

    least: AtPreload | None
    mean: AtPreload
    greatest: AtPreload | None
    missing: tuple[str, str] = ("", "")


def bolt_loads(
    case: Case,
    state: LoadedCase,
    engine: Engine,
    preload: PreloadCase,
    forces: tuple[Array, Array],
    share: Array,
    progress: Progress,
) -> dict[int, BoltLoad]:
    """Return what the cases that [[bolt_sheet]] names are to each bolt, by its index; those without one are left out.

    The change of a bolt's force is n Phi_K F_A and what temperature makes of it, with Phi_K of a load at the seats: the
    temperatures of a case are solved for apart. Shear by temperature gives way once it slips, and is none that friction
    has to carry.

    Args:
        case, state, engine, preload: The study under its mean preload.
        forces: The least and the greatest of each bolt [N] (b,).
        share: Phi_K of each bolt [-] (b,).
        progress: Is told of each preload.
    """
    study = case.study
    wanted = {k: choice_of(study.bolt_sheets, bolt.name).loads for k, bolt in enumerate(study.bolts)}
    names = tuple(dict.fromkeys(name for some in wanted.values() for name in some))
    if not names:
        return {}
    asked = _with_needs(study.load_cases, names)
    base = preloaded_case(case.under(state.preload), state.preload, state.springs, engine, modes=False)
    parted = _parted(asked, names)
    loads = (*asked, *(heat for heat, _ in parted.values()), *(rest for _, rest in parted.values()))
    mean = answers(base, loads, progress)
    ends: list[LoadCases | None] = []
    missing = ["", ""]
    for end, which in enumerate(("least preload in service", "greatest preload at assembly")):
        wish = forces[end]
        ends.append(None)
        if np.any(wish <= 0):
            missing[end] = f"a {which} above 0 in every bolt"
            continue
        try:
            ends[-1] = answers(at_preload(base, study, replace(preload, forces=tuple(wish.tolist()))), loads, progress)
        except (InputError, NotConverged) as fault:
            missing[end] = f"an equilibrium at the {which} ({fault})"
    out = {}
    for k, some in wanted.items():
        if some:
            least, middle, greatest = (
                None if found is None else _at_preload(found, k, some, float(share[k]), parted)
                for found in (ends[0], mean, ends[1])
            )
            assert middle is not None
            out[k] = BoltLoad(least=least, mean=middle, greatest=greatest, missing=(missing[0], missing[1]))
    return out


def _parted(asked: Sequence[Load], names: Sequence[str]) -> _Parted:
    """For each case of these names that has temperatures: a case of them alone, and one without them."""
    out: _Parted = {}
    by_name = {load.name: load for load in asked}
    taken = set(by_name)

    def free(name: str) -> str:
        while name in taken:
            name += AGAIN
        taken.add(name)
        return name

    for name in names:
        changes = {what: change for what, change in _temperatures(by_name, name).items() if change}
        if changes:
            heat = Load(free(HEAT + name), temperature=changes)
            without = {what: -change for what, change in changes.items()}
            out[name] = heat, Load(free(COLD + name), combine={name: 1.0}, temperature=without)
    return out


def _at_preload(found: LoadCases, k: int, names: Sequence[str], share: float, parted: _Parted) -> AtPreload:
    """What cases are to one bolt; share: its load factor Phi_K for a load at the seats."""
    rows = [found.index(name) for name in names]
    change = found.bolt_force[:, k] - found.bolt_preload[k]
    heat = np.array([change[found.index(parted[name][0].name)] if name in parted else 0.0 for name in names])
    across = [parted[name][1].name if name in parted else name for name in names]
    working = found.working_load[rows, k]
    most = int(np.argmax(working if working.max() > 0 else np.abs(working)))
    known = np.isfinite(found.load_factor[rows[most], k]) and share > 0
    factor = (change[rows[most]] - heat[most]) / working[most] / share if known else 1.0
    own = change[rows] - heat
    if len(rows) == 1:  # from nothing to it
        working, own = np.append(working, 0.0), np.append(own, 0.0)
    heated = any(name in parted for name in names)
    return AtPreload(
        axial=(float(working.min()), max(float(working.max()), 0.0)),
        transverse=max(float(found.transverse_load[found.index(name), k]) for name in across),
        additional=(float(own.min()), float(own.max())),
        taken=max(float((working - own).max()), 0.0),
        introduction=float(factor),
        thermal_loss=max(float((-heat).max()), 0.0) + 0.0 if heated else None,
        thermal_gain=max(float(heat.max()), 0.0),
        bending=float(sum(sorted((found.bolt_moment[found.index(name), k] for name in across), reverse=True)[:2])),
        damage=float(found.damage[rows, k].sum()) if found.cycles[rows].any() else None,
    )


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
