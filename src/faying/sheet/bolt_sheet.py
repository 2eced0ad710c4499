"""The sheet of each bolt of a study: steps R0 to R13 of VDI 2230 with the numbers of this structure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from faying.answer.bolt_numbers import bolt_numbers
from faying.answer.tracks import shapes_of
from faying.bolt.bolt import Bolt, FittedBolt
from faying.bolt.fatigue import bending_modulus
from faying.bolt.solid_bolt import SolidBolt
from faying.bolt.threads import Thread
from faying.bolt.vdi2230 import DEFAULT_FRICTION, TIGHTENED
from faying.case.case import Case, Progress, bare
from faying.case.scatter import preload_scatter
from faying.case.solve import solve
from faying.errors import InputError
from faying.joint.load_path import LoadPaths
from faying.joint.preload_case import preload_index
from faying.joint.strength import seat_limit
from faying.misuse import checked_call
from faying.progress import Report
from faying.result.bolts import BoltNumbers
from faying.result.vibration import VibrationResponse
from faying.service.vibration import vibrations_of
from faying.sheet.bolt_loads import AtPreload, BoltLoad, bolt_loads
from faying.sheet.rows import Quantity, Row, evaluate
from faying.sheet.steps import SHEAR, steps
from faying.study.keys.bolt_sheet import BoltSheetChoice, choice_of, frictions_of
from faying.study.study import Study
from faying.units import show

NEGATIVE = (
    "; below 0: where this load relieves the joint round the bolt, the bolt loses force too, as parts do that bend "
    "between bolts. Phi and all rows take it as found, not as 0"
)


@dataclass(frozen=True, kw_only=True)
class BoltSheet:
    """The sheet of one bolt.

    Args:
        bolt: Its name.
        preload: Its own [N].
        size: Thread and class, "M8x1.25 8.8", as far as they are known.
        rows: Steps R0 to R13.
    """

    bolt: str
    preload: float
    size: str
    rows: tuple[Row, ...]

    @property
    def verdict(self) -> str:
        """How many rows are ok, exceeded and not known, in words."""
        found = [row.verdict for row in self.rows]
        return ", ".join(f"{found.count(word)} {word}" for word in ("ok", "exceeded", "not known"))

    def row(self, symbol: str) -> Row:
        """Return the row of a symbol. Raises InputError that lists those known."""
        for row in self.rows:
            if row.result.symbol == symbol:
                return row
        raise InputError(f"no row {symbol!r}; give one of {', '.join(row.result.symbol for row in self.rows)}")

    def to_dict(self) -> dict[str, Any]:
        """Return the sheet in SI units, for JSON."""
        return {
            "bolt": self.bolt,
            "preload": {"unit": "N", "values": self.preload},
            "size": self.size,
            "rows": [row.to_dict() for row in self.rows],
        }


@dataclass(frozen=True, kw_only=True)
class BoltSheets:
    """The sheets of all bolts of a study, at one preload [N] of its first bolt."""

    title: str
    load: float
    sheets: tuple[BoltSheet, ...]

    def __repr__(self) -> str:
        lines = [f"{one.bolt}, {one.size}, at {show(one.preload, 'N')}: {one.verdict}" for one in self.sheets]
        return "\n".join([f"Bolt sheets of {self.title}", *lines])

    def to_dict(self) -> dict[str, Any]:
        """Return all sheets in SI units, for JSON."""
        return {
            "title": self.title,
            "load": {"unit": "N", "values": self.load},
            "bolts": [sheet.to_dict() for sheet in self.sheets],
        }


@checked_call
def bolt_sheet(
    study: Study | str | Path, preload: float | str | None = None, *, report: Report | None = None
) -> BoltSheets:
    """Return a sheet for each bolt of a study, by VDI 2230, with compliances found by finite elements.

    Args:
        study: The study, or its file.
        preload: Which of its preloads, force of the first bolt [N] or text such as "8 kN"; the last where None.
        report: Is called with what is being done.

    Returns:
        Sheets whose rows have inputs, value, limit, utilisation and verdict; what is not known says what is missing.

    Raises:
        InputError: The study has no such preload, or no bolt.
        NotConverged: The preload or a load case has no solution, or what a bolt clamps has no stiffness.

    Source:
        VDI 2230 Part 1:2015, section 4, for concentric clamping and loading.
    """
    plan = Study.read(study)
    number = preload_index(plan.loads, preload, names=plan.load_names)
    stages = 7 if any(choice_of(plan.bolt_sheets, bolt.name).loads for bolt in plan.bolts) else 4
    progress = Progress(stages + bool(plan.vibrations), report)
    case = Case.of(replace(bare(plan), vibrations=plan.vibrations), progress)
    engine = case.engine("reanalysis")
    state = solve(case, number, engine, progress, ranges=False)
    if plan.vibrations:
        progress.begin("vibration")
    shaken = vibrations_of(case, state)
    numbers = bolt_numbers(case, [state], shapes_of(case, [state]))
    if numbers is None:
        raise InputError("the study has no bolt, so that there is no sheet; add [[bolt]]")
    forces = np.array(state.preload.bolt_forces)
    least, greatest = np.array([_ends(plan, k, numbers, float(force)) for k, force in enumerate(forces)]).T
    found = bolt_loads(case, state, engine, plan.preloads[number], (least, greatest), numbers.load_factor[0], progress)
    sheets = [
        _sheet(case, index, numbers, float(force), found.get(index), shaken) for index, force in enumerate(forces)
    ]
    return BoltSheets(title=plan.title, load=state.load, sheets=tuple(sheets))


def _ends(study: Study, index: int, numbers: BoltNumbers, force: float) -> tuple[float, float]:
    """Least preload in service, before any temperature, and greatest at assembly [N]."""
    bolt = study.bolts[index].name
    choice = choice_of(study.bolt_sheets, bolt)
    scatter, _ = preload_scatter(study, bolt, choice)
    embedding, _ = _embedding(numbers, index, choice)
    lost = embedding / float(numbers.compliance[0, index] + numbers.member_compliance[0, index])
    return force * (1 - scatter) - (lost if isfinite(lost) else 0.0), force * (1 + scatter)


def _sheet(
    case: Case,
    index: int,
    numbers: BoltNumbers,
    force: float,
    found: BoltLoad | None,
    shaken: Sequence[VibrationResponse],
) -> BoltSheet:
    fitted = case.structure.fitted_bolts[index]
    bolt, choice = fitted.bolt, choice_of(case.study.bolt_sheets, fitted.bolt.name)
    if found is not None:
        low = found.least or found.mean
        choice = replace(
            choice,
            axial=low.axial,
            transverse=low.transverse,
            introduction=found.mean.introduction,
            thermal_loss=low.thermal_loss,
        )
    states = () if found is None else (found.least, found.mean, found.greatest)
    damage = max((one.damage for one in states if one is not None and one.damage is not None), default=None)
    fatigue = _cycles(damage, {one.name: float(one.damage[2, index]) for one in shaken})
    known = {
        one.symbol: one
        for one in (
            *_thread(bolt),
            _endurance(choice, _metric(bolt)),
            *_tightening(case.study, bolt, choice, force),
            *_loads(case, index, choice, 0.0 if found is None else (found.greatest or found.mean).thermal_gain),
            *_compliances(numbers, index, choice),
            *_departures(float(numbers.load_factor[0, index]), choice, found),
            *fatigue,
            _bending(_metric(bolt), states),
            *_seats(case, index, numbers, force, choice),
        )
    }
    fastener, metric = bolt.fastener, _metric(bolt)
    size = "thread not known" if metric is None else f"{metric} {fastener.grade if fastener else '(no grade)'}"
    tapped = isinstance(fitted, FittedBolt) and fitted.thread is not None
    curve = "as given" if choice.curve is not None else "IEC 61400-6" if choice.fatigue == "iec" else ""
    taken = steps(tapped=tapped, rolled_after=choice.by_yield, cycles=bool(fatigue), curve=curve)
    rows = evaluate(taken, known)
    return BoltSheet(bolt=bolt.name, preload=force, size=size, rows=rows)


def _endurance(choice: BoltSheetChoice, thread: Thread | None) -> Quantity:
    """Stress amplitude at the knee of the curve of fatigue."""
    curve = choice.fatigue_curve(None if thread is None else thread.diameter)
    value = None if curve is None else curve.endurance
    return _quantity("sigma_K", "stress amplitude at the knee of the curve", "Pa", value, "bolt.thread")


def _cycles(damage: float | None, shaken: Mapping[str, float]) -> list[Quantity]:
    """What load cases that come and go, and vibrations that last, do to the bolt; nothing where there are none.

    shaken: Damage by each vibration, 95 % of friction and of damping at rest; NaN where its time is not given.
    """
    lasting = {name: one for name, one in shaken.items() if isfinite(one)}
    if damage is None and not lasting:
        return []
    of_load, of_noise = (" (none)" * absent for absent in (damage is None, not lasting))
    names = f"damage by vibration {', '.join(map(repr, lasting))} at the preload, 95 %"
    return [
        _quantity("D_c", f"damage by the cycles of load cases, bending included{of_load}", "", damage or 0.0, ""),
        _quantity("D_v", names if lasting else f"damage by vibration{of_noise}", "", sum(lasting.values()), ""),
        _quantity("D_1", "damage at failure", "", 1.0, ""),
    ]


def _bending(thread: Thread | None, states: Sequence[AtPreload | None]) -> Quantity:
    """Amplitude of the stress by bending under load cases; 0 where none tells it."""
    known = [one.bending for one in states if one is not None and isfinite(one.bending)]
    stress = max(known) / bending_modulus(thread.stress_area) / 2 if known and thread is not None else 0.0
    name = f"amplitude of the bending stress, at most, of the three preloads{'' if known else ' (not told: none)'}"
    return _quantity("sigma_b", name, "Pa", stress, "")


def _departures(factor: float, choice: BoltSheetChoice, found: BoltLoad | None) -> list[Quantity]:
    """What load cases, each at its own preload, change of the forces beyond the load factor times the working load.

    factor: Phi_K, of a load at the seats.
    """
    low, high = choice.axial or (0.0, 0.0)
    share = choice.introduction * factor
    typed = found is None
    values: dict[str, float | None] = dict.fromkeys(("dF_u", "dF_o", "dF_P", "dF_M"), 0.0 if typed else None)
    if found is not None and found.least is not None:
        (least, most), taken = found.least.additional, found.least.taken
        values |= {"dF_u": least - share * low, "dF_o": most - share * high, "dF_P": taken - (1 - share) * high}
    if found is not None and found.greatest is not None:
        values["dF_M"] = found.greatest.additional[1] - share * high
    names = {
        "dF_u": "least bolt force at the least preload",
        "dF_o": "greatest bolt force at the least preload",
        "dF_P": "force that the joint loses at the least preload",
        "dF_M": "greatest bolt force at the greatest preload",
    }
    under = f"{'' if typed else ', as found,'} that the load factor does not give{' (no load case: none)' * typed}"
    ends = ("", "") if found is None else found.missing
    missing = {symbol: ends[symbol == "dF_M"] or "bolt.diameter and bolt.material" for symbol in values}
    return [_quantity(symbol, names[symbol] + under, "N", values[symbol], missing[symbol]) for symbol in values]


def _quantity(symbol: str, name: str, unit: str, value: float | None, missing: str) -> Quantity:
    """A quantity that is not known where its value is None or not finite; `missing` says what would give it."""
    if value is None or not isfinite(value):
        return Quantity(symbol=symbol, name=name, unit=unit, value=None, missing=(missing,))
    return Quantity(symbol=symbol, name=name, unit=unit, value=float(value))


def _metric(bolt: Bolt | SolidBolt) -> Thread | None:
    """The thread of a bolt, None where nothing says it."""
    if isinstance(bolt, Bolt):
        return bolt.metric
    return None if bolt.fastener is None else bolt.fastener.thread


def _thread(bolt: Bolt | SolidBolt) -> list[Quantity]:
    """Geometry of the thread, and strengths of the class."""
    fastener, thread = bolt.fastener, _metric(bolt)
    least = None
    if thread is not None:
        least = (thread.pitch_diameter + thread.minor_diameter) / 2
        if bolt.diameter is not None:
            least = min(least, bolt.diameter)
    sized, graded = f"bolt.{bolt.name}.thread", f"bolt.{bolt.name}.grade"
    strength = None if fastener is None else fastener.tensile_strength
    yielding = None if fastener is None else fastener.yield_stress
    return [
        _quantity("d", "nominal diameter", "m", None if thread is None else thread.diameter, sized),
        _quantity("P", "pitch", "m", None if thread is None else thread.pitch, sized),
        _quantity("d_2", "pitch diameter", "m", None if thread is None else thread.pitch_diameter, sized),
        _quantity("d_0", "diameter of the least section", "m", least, sized),
        _quantity("A_S", "stress area", "m^2", None if thread is None else thread.stress_area, sized),
        _quantity("S_p", "stress under proof load", "Pa", None if fastener is None else fastener.proof_stress, graded),
        _quantity("F_p", "proof load", "N", None if fastener is None else fastener.proof_load, graded),
        _quantity("R_m", "tensile strength", "Pa", strength, graded),
        _quantity("R_p", "stress at yield", "Pa", yielding, graded),
        _quantity("R_p09", "0.9 times the stress at yield", "Pa", yielding and TIGHTENED * yielding, graded),
        _quantity("tau_BS", "0.6 times the tensile strength", "Pa", strength and SHEAR * strength, graded),
    ]


def _tightening(study: Study, bolt: Bolt | SolidBolt, choice: BoltSheetChoice, force: float) -> list[Quantity]:
    scatter, origin = preload_scatter(study, bolt.name, choice)
    out = [
        _quantity("F_V", "preload", "N", force, ""),
        _quantity("s", f"scatter of the preload, {origin}", "", scatter, ""),
    ]
    places = ("mu_G", "in the thread"), ("mu_K", "under the head")
    for (symbol, where), value in zip(places, frictions_of(choice, bolt), strict=True):
        origin = "" if value is not None else ", default: middle of class B of VDI 2230, Table A5"
        out.append(_quantity(symbol, f"friction {where}{origin}", "", value or DEFAULT_FRICTION, ""))
    return out


def _loads(case: Case, index: int, choice: BoltSheetChoice, gain: float) -> list[Quantity]:
    cuts = LoadPaths.of(case.structure).cuts[index]
    frictions = [case.structure.joints[k].friction for cut in cuts for k in cut.joints]
    friction = choice.slip_friction
    if friction is None and all(frictions):  # neither a joint that sticks nor one without friction says it
        friction = min((f for f in frictions if f), default=None)
    low, high = choice.axial or (None, None)
    stated = choice.transverse is not None or choice.clamp is not None
    none_of_it = " (not given: none)" if stated else ""
    across = choice.transverse if choice.transverse is not None or not stated else 0.0
    asked = choice.clamp if choice.clamp is not None or not stated else 0.0
    thermal = choice.thermal_loss
    gain = max(gain, -(thermal or 0.0))
    under = f", of load {' and '.join(map(repr, choice.loads))}" if choice.loads else ""
    introduced = "load introduction factor" + under + NEGATIVE * (choice.introduction < 0)
    return [
        _quantity("mu_T", "friction of the joint", "", friction, "joint.friction or bolt_sheet.slip_friction"),
        _quantity(
            "F_Q",
            "transverse load" + under + none_of_it * (choice.transverse is None),
            "N",
            across,
            "bolt_sheet.transverse",
        ),
        _quantity(
            "F_KP", "clamp load that is asked for" + none_of_it * (choice.clamp is None), "N", asked, "bolt_sheet.clamp"
        ),
        _quantity("F_Au", "least working load" + under, "N", low, "bolt_sheet.axial"),
        _quantity("F_Ao", "greatest working load" + under, "N", high, "bolt_sheet.axial"),
        _quantity("n", introduced, "", choice.introduction, ""),
        _quantity("F_th", "loss by temperature" + under, "N", thermal, "bolt_sheet.thermal_loss"),
        _quantity("F_thg", "gain by temperature" + under * (gain > 0), "N", gain, ""),
        _quantity("F_thd", "loss by temperature" + " (not given: none)" * (thermal is None), "N", thermal or 0.0, ""),
    ]


def _embedding(numbers: BoltNumbers, index: int, choice: BoltSheetChoice) -> tuple[float, str]:
    """Embedding [m] that the sheet counts with, and where it is from."""
    if choice.embedding is not None:
        return choice.embedding, "as given"
    guide = float(numbers.embedding_guide[index])
    if isfinite(guide):
        return guide, "guide value"
    compliance = float(numbers.compliance[0, index] + numbers.member_compliance[0, index])
    return float(numbers.embedding_loss[1, 0, index]) * compliance, "by the contact law"


def _compliances(numbers: BoltNumbers, index: int, choice: BoltSheetChoice) -> list[Quantity]:
    own, members = float(numbers.compliance[0, index]), float(numbers.member_compliance[0, index])
    guide = float(numbers.embedding_guide[index])
    law = float(numbers.embedding_loss[1, 0, index]) * (own + members)
    counted, whose = _embedding(numbers, index, choice)
    scan, loading = "a scan of each joint", "a law with a loading curve of its own"
    return [
        _quantity("delta_S", "compliance of the bolt", "m/N", own, "bolt.diameter and bolt.material"),
        _quantity("delta_P", "compliance of the parts, by finite elements", "m/N", members, ""),
        _quantity(
            "delta_Pc",
            "compliance of the parts, by the cone",
            "m/N",
            float(numbers.cone_compliance[index]),
            "a seat that is a ring, on a chain of parts",
        ),
        _quantity("f_Z", "embedding, guide value", "m", guide, scan),
        _quantity("f_law", "embedding, greatest by the contact law", "m", law, loading),
        _quantity("f_Zd", f"embedding, {whose}", "m", counted, f"bolt_sheet.embedding, or {scan}"),
    ]


def _seats(case: Case, index: int, numbers: BoltNumbers, force: float, choice: BoltSheetChoice) -> list[Quantity]:
    fitted = case.structure.fitted_bolts[index]
    pressure = float(numbers.seat_pressure[0, index])
    area = force / pressure if isfinite(pressure) and pressure > 0 else None
    pressed = fitted.pressed if isinstance(fitted, FittedBolt) else ()
    head = pressed[0] if pressed and pressed[0].is_ring else None
    thread = fitted.thread if isinstance(fitted, FittedBolt) else None
    seat = "bolt.seat, of a bolt that is not in the mesh"
    found = [seat_limit(case.structure, one.face) for one in pressed]
    softest = min((one for one in found if one is not None), key=lambda one: one[0], default=(None, "bearing limit"))
    return [
        _quantity("A_p", "area of the smaller seat", "m^2", area, seat),
        _quantity("p_G", f"{softest[1]} of the softer seat", "Pa", float(numbers.seat_limit[index]), "bearing_limit"),
        _quantity("D_Km", "mean diameter of the seat", "m", None if head is None else head.mean_diameter, seat),
        _quantity(
            "m", "length of engagement", "m", None if thread is None else thread.high - thread.low, "a tapped hole"
        ),
        _quantity(
            "tau_B", "shear strength of the tapped part", "Pa", choice.shear_strength, "bolt_sheet.shear_strength"
        ),
    ]
