"""The sheet of each bolt of a study: steps R0 to R13 of VDI 2230 with the numbers of this structure."""

from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from faying.answer.bolt_loads import BoltLoad, bolt_loads
from faying.answer.bolt_numbers import bolt_numbers
from faying.answer.load_answers import bare
from faying.answer.tracks import shapes_of
from faying.bolt.bolt import Bolt, FittedBolt
from faying.bolt.sheet import Quantity, Row, evaluate
from faying.bolt.sheet_steps import SHEAR, steps
from faying.bolt.solid_bolt import SolidBolt
from faying.bolt.threads import Thread
from faying.bolt.tightening import TIGHTENING
from faying.case.case import Case, Progress
from faying.case.engine import engine_of
from faying.case.solve import solve
from faying.errors import InputError
from faying.joint.clamping import seat_ring, stack_of
from faying.joint.preload_case import preload_index
from faying.joint.strength import seat_limit
from faying.misuse import checked_call
from faying.progress import Report
from faying.result.bolts import BoltNumbers
from faying.study.keys.bolt_sheet import BoltSheetChoice, choice_of
from faying.study.study import Study
from faying.units import show

NEGATIVE = (
    "; below 0: where this load relieves the joint round the bolt, the bolt loses force too, as parts do that bend "
    "between bolts. Phi and all rows take it as found, not as 0"
)
DEFAULT_WAY = "torque wrench, friction estimated"
DEFAULT_FRICTION = 0.12  # the middle of class B, 0.08 to 0.16: metal, oiled or coated (VDI 2230 Part 1:2015, Table A5)
TWO_SIGMA = 0.02275  # probability below two standard deviations
USED = 0.9  # of the yield stress that tightening may use (VDI 2230 Part 1:2015, R7)


@dataclass(frozen=True, kw_only=True)
class BoltSheet:
    """The sheet of one bolt.

    Args:
        bolt: Its name.
        size: Thread and class, "M8x1.25 8.8", as far as they are known.
        rows: Steps R0 to R13.
    """

    bolt: str
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
        return {"bolt": self.bolt, "size": self.size, "rows": [row.to_dict() for row in self.rows]}


@dataclass(frozen=True, kw_only=True)
class BoltSheets:
    """The sheets of all bolts of a study, at one preload [N] of its first bolt."""

    title: str
    load: float
    sheets: tuple[BoltSheet, ...]

    def __repr__(self) -> str:
        lines = [f"{one.bolt}, {one.size}: {one.verdict}" for one in self.sheets]
        return "\n".join([f"Bolt sheets of {self.title} at {show(self.load, 'N')}", *lines])

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
        preload: Which of its preloads, force of the first bolt [N] or text such as "8 kN"; the greatest where None.
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
    number = preload_index(plan.loads, preload)
    progress = Progress(5, report)
    case = Case.of(bare(plan), progress)
    engine = engine_of("reanalysis", case)
    state = solve(case, number, engine, progress, ranges=False)
    numbers = bolt_numbers(case, [state], shapes_of(case, [state]))
    if numbers is None:
        raise InputError("the study has no bolt, so that there is no sheet; add [[bolt]]")
    forces = np.array(state.preload.bolt_forces)
    found = bolt_loads(case, state, engine, numbers, progress)
    sheets = [_sheet(case, index, numbers, float(forces[index]), found.get(index)) for index in range(len(forces))]
    return BoltSheets(title=plan.title, load=state.load, sheets=tuple(sheets))


def choice_for(study: Study, bolt: str) -> BoltSheetChoice:
    """Return what the study says for the sheet of a bolt: its own table, that of all others, or nothing."""
    return choice_of(study.bolt_sheets, bolt)


def _sheet(case: Case, index: int, numbers: BoltNumbers, force: float, found: BoltLoad | None) -> BoltSheet:
    fitted = case.structure.fitted_bolts[index]
    bolt, choice = fitted.bolt, choice_for(case.study, fitted.bolt.name)
    if found is not None:
        choice = replace(
            choice,
            axial=found.axial,
            transverse=found.transverse,
            introduction=found.introduction,
            thermal_loss=found.thermal_loss,
        )
    known = {
        one.symbol: one
        for one in (
            *_thread(bolt),
            *_tightening(case.study, bolt, choice, force),
            *_loads(case, index, choice, 0.0 if found is None else found.thermal_gain),
            *_compliances(numbers, index, choice),
            *_beyond(numbers, index, choice, found),
            *_seats(case, index, numbers, force, choice),
        )
    }
    fastener, metric = bolt.fastener, _metric(bolt)
    size = "thread not known" if metric is None else f"{metric} {fastener.grade if fastener else '(no grade)'}"
    tapped = isinstance(fitted, FittedBolt) and fitted.thread is not None
    rows = evaluate(steps(tapped=tapped, rolled_after=choice.rolled == "after"), known)
    return BoltSheet(bolt=bolt.name, size=size, rows=rows)


def _beyond(numbers: BoltNumbers, index: int, choice: BoltSheetChoice, found: BoltLoad | None) -> list[Quantity]:
    """What load cases change of the forces of bolt and joint beyond the load factor times the working load."""
    more = (0.0, 0.0, 0.0)
    if found is not None:
        share = choice.introduction * float(numbers.load_factor[0, index])
        (low, high), (least, most) = found.axial, found.additional
        more = (least - share * low, most - share * high, found.taken - (1 - share) * high)
    names = ("least bolt force", "greatest bolt force", "force that the joint loses")
    under = (
        ", as found, that the load factor does not give"
        if found is not None
        else " that the load factor does not give (no load case: none)"
    )
    return [
        _quantity(symbol, name + under, "N", value, "bolt.diameter and bolt.material")
        for symbol, name, value in zip(("dF_u", "dF_o", "dF_P"), names, more, strict=True)
    ]


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
        _quantity("R_p09", "0.9 times the stress at yield", "Pa", yielding and USED * yielding, graded),
        _quantity("tau_BS", "0.6 times the tensile strength", "Pa", strength and SHEAR * strength, graded),
    ]


def preload_scatter(study: Study, bolt: str, choice: BoltSheetChoice) -> tuple[float, str]:
    """Half of the range of the preload over its mean [-], and where that comes from."""
    if choice.tightening_factor is not None:
        return (choice.tightening_factor - 1) / (choice.tightening_factor + 1), "from tightening_factor"
    if choice.way is not None:
        return TIGHTENING[choice.way].scatter, f"{choice.way} ({TIGHTENING[choice.way].source})"
    inputs = () if study.uncertain is None else study.uncertain.inputs
    for one in inputs:
        if one.key in (f"bolt.{bolt}.factor", "bolt.factor"):
            low, high = one.distribution.quantile(np.array([TWO_SIGMA, 1 - TWO_SIGMA]))
            return float((high - low) / (high + low)), "from [uncertain], two standard deviations each way"
    way = TIGHTENING[DEFAULT_WAY]
    return way.scatter, f"default: {DEFAULT_WAY} ({way.source})"


def _tightening(study: Study, bolt: Bolt | SolidBolt, choice: BoltSheetChoice, force: float) -> list[Quantity]:
    scatter, origin = preload_scatter(study, bolt.name, choice)
    stated = getattr(bolt, "friction", None) or (None, None)
    out = [
        _quantity("F_V", "preload", "N", force, ""),
        _quantity("s", f"scatter of the preload, {origin}", "", scatter, ""),
    ]
    for symbol, where, given, of_bolt in (
        ("mu_G", "in the thread", choice.thread_friction, stated[0]),
        ("mu_K", "under the head", choice.head_friction, stated[1]),
    ):
        value = given if given is not None else of_bolt
        origin = "" if value is not None else ", default: middle of class B of VDI 2230, Table A5"
        out.append(_quantity(symbol, f"friction {where}{origin}", "", value or DEFAULT_FRICTION, ""))
    return out


def _loads(case: Case, index: int, choice: BoltSheetChoice, gain: float) -> list[Quantity]:
    stack = stack_of(case.structure, index)
    joints = case.structure.joints if stack is None else [case.structure.joints[k] for k in stack.joints]
    frictions = [joint.friction for joint in joints]
    friction = choice.slip_friction
    if friction is None and None not in frictions:
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


def _compliances(numbers: BoltNumbers, index: int, choice: BoltSheetChoice) -> list[Quantity]:
    own, members = float(numbers.compliance[0, index]), float(numbers.member_compliance[0, index])
    guide = float(numbers.embedding_guide[index])
    law = float(numbers.embedding_loss[1, 0, index]) * (own + members)
    counted, whose = (guide, "guide value") if isfinite(guide) else (law, "by the contact law")
    if choice.embedding is not None:
        counted, whose = choice.embedding, "as given"
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
    ring = seat_ring(case.structure.mesh, fitted) if isinstance(fitted, FittedBolt) else None
    thread = fitted.thread if isinstance(fitted, FittedBolt) else None
    seat = "bolt.seat, of a bolt that is not in the mesh"
    found = [seat_limit(case.structure, face) for face in fitted.bolt.faces]
    softest = min((one for one in found if one is not None), key=lambda one: one[0], default=(None, "bearing limit"))
    return [
        _quantity("A_p", "area of the smaller seat", "m^2", area, seat),
        _quantity("p_G", f"{softest[1]} of the softer seat", "Pa", float(numbers.seat_limit[index]), "bearing_limit"),
        _quantity("D_Km", "mean diameter of the seat", "m", None if ring is None else sum(ring) / 2, seat),
        _quantity(
            "m", "length of engagement", "m", None if thread is None else thread.high - thread.low, "a tapped hole"
        ),
        _quantity(
            "tau_B", "shear strength of the tapped part", "Pa", choice.shear_strength, "bolt_sheet.shear_strength"
        ),
    ]
