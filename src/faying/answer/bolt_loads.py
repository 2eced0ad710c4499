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
from faying.study.keys.bolt_sheet import choice_of
from faying.typing import Array

HEAT = "heat of "  # stands before the name of a case of which the temperatures alone act


@dataclass(frozen=True, kw_only=True)
class BoltLoad:
    """What load cases are to one bolt.

    Args:
        axial: Least and greatest working load [N].
        transverse: Greatest load across the bolt [N].
        introduction: n, that makes the load factor the one that was found under the greatest working load [-].
        thermal_loss: Greatest loss of preload by temperature [N]; None where no case has one.
    """

    axial: tuple[float, float]
    transverse: float
    introduction: float
    thermal_loss: float | None


def bolt_loads(
    case: Case, state: LoadedCase, engine: Engine, numbers: BoltNumbers, progress: Progress
) -> dict[int, BoltLoad]:
    """Return what the cases that [[bolt_sheet]] names are to each bolt, by its index; those without one are left out.

    The change of a bolt's force is n Phi_K F_A and what temperature makes of it, with Phi_K of a load at the seats: the
    temperatures of a case are solved for apart.
    """
    study = case.study
    wanted = {k: choice_of(study.bolt_sheets, bolt.name).loads for k, bolt in enumerate(study.bolts)}
    names = tuple(dict.fromkeys(name for some in wanted.values() for name in some))
    if not names:
        return {}
    asked = _with_needs(study.load_cases, names)
    heat = [_heat_of(asked, name) for name in names]
    loads = (*asked, *(one for one in heat if one is not None))
    base = preloaded_case(case, state.preload, state.springs, engine, modes=False)
    found = answers(base, loads, progress)
    out = {}
    for k, some in wanted.items():
        if not some:
            continue
        rows = [found.index(name) for name in some]
        working, change = found.working_load[rows, k], found.bolt_force[rows, k] - found.bolt_preload[k]
        lost = np.array(
            [_change(found.cases, found.bolt_force[:, k], HEAT + name, found.bolt_preload[k]) for name in some]
        )
        most = int(np.argmax(np.abs(working)))
        share = float(numbers.load_factor[0, k])
        known = np.isfinite(found.load_factor[rows[most], k]) and share > 0
        factor = (change[most] - lost[most]) / working[most] / share if known else 1.0
        ends = working if len(some) > 1 else np.append(working, 0.0)
        heated = any(HEAT + name in found.cases for name in some)
        out[k] = BoltLoad(
            axial=(float(ends.min()), float(ends.max())),
            transverse=float(found.transverse_load[rows, k].max()),
            introduction=float(factor),
            thermal_loss=float((-lost).max()) if heated else None,
        )
    return out


def _change(cases: Sequence[str], forces: Array, name: str, rest: float) -> float:
    """Change [N] of a bolt's force under a case; 0 where there is none of that name."""
    return float(forces[cases.index(name)] - rest) if name in cases else 0.0


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


def _heat_of(loads: Sequence[Load], name: str) -> Load | None:
    """A case of the temperatures of another one alone, those that it combines included; None where it has none."""
    changes = _temperatures({load.name: load for load in loads}, name)
    return Load(HEAT + name, temperature=changes) if any(changes.values()) else None


def _temperatures(loads: dict[str, Load], name: str) -> dict[str, float]:
    total = dict(loads[name].temperature)
    for other, factor in loads[name].combine.items():
        for what, change in _temperatures(loads, other).items():
            total[what] = total.get(what, 0.0) + factor * change
    return total
