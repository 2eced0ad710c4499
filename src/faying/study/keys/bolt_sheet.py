"""[[bolt_sheet]]: what the sheet of a bolt needs beyond the study: working load, friction, way of tightening."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from faying.bolt.bolt import BOLT_FRICTION, Bolt
from faying.bolt.fatigue import KNEE, SLOPE, FatigueCurve
from faying.bolt.solid_bolt import SolidBolt
from faying.bolt.tightening import tightening
from faying.errors import InputError
from faying.materials import MOST_FRICTION
from faying.study.declaration.declared import QUANTITY, REQUIRED, WORDS, Declared, Inner, Key, listed, one_or_more
from faying.study.declaration.reader import Table
from faying.study.declaration.values import quantity

MAX_FACTOR = 10.0  # greatest tightening factor that is not a slip of the pen
MAX_SLOPE = 100.0  # of a curve of fatigue: from there on it is as good as upright


@dataclass(frozen=True, kw_only=True)
class BoltSheetChoice:
    """What is said of one bolt, or of all that no other table names; None for what is not said.

    Args:
        bolt: Name of the bolt; None for all others.
        way: Way of tightening, a name of `bolt.tightening.TIGHTENING`.
        tightening_factor: alpha_A, greatest over least preload.
        thread_friction, head_friction, slip_friction: Coefficients [-], in the thread, under the head, in the joint.
        loads: Load cases that give working load, transverse load, load factor and loss by temperature in place of
            typed numbers; from nothing to one, or between the least and the greatest of several.
        axial: Least and greatest working load [N] that pulls the parts apart.
        introduction: Load introduction factor n [-]; 1 for a load at the seats.
        transverse: Load [N] across the bolt that friction carries.
        clamp: Clamp load [N] that is asked for, for a seal or against opening.
        embedding: Of thread, seats and joints together [m], in place of the guide value.
        thermal_loss: Preload [N] that temperature takes.
        shear_strength: Of the tapped part [Pa].
        rolled: When the thread is rolled, "before" or "after" heat treatment.
        fatigue: Curve of its fatigue: "vdi", VDI 2230, or "iec", IEC 61400-6.
        curve: One of its own in its place.
    """

    bolt: str | None = None
    way: str | None = None
    tightening_factor: float | None = None
    thread_friction: float | None = None
    head_friction: float | None = None
    slip_friction: float | None = None
    loads: tuple[str, ...] = ()
    axial: tuple[float, float] | None = None
    introduction: float = 1.0
    transverse: float | None = None
    clamp: float | None = None
    embedding: float | None = None
    thermal_loss: float | None = None
    shear_strength: float | None = None
    rolled: Literal["before", "after"] = "before"
    fatigue: Literal["vdi", "iec"] = "vdi"
    curve: FatigueCurve | None = None

    @property
    def by_yield(self) -> bool:
        """Whether what the thread bears depends on the force at yield: rolled after heat treatment, VDI 2230."""
        return self.curve is None and self.fatigue == "vdi" and self.rolled == "after"

    def fatigue_curve(self, diameter: float | None) -> FatigueCurve | None:
        """The curve of its fatigue, before what its force changes; None where it needs a diameter [m] and has none."""
        if self.curve is not None or diameter is None:
            return self.curve
        return FatigueCurve.iec(diameter) if self.fatigue == "iec" else FatigueCurve.vdi(diameter)

    @classmethod
    def of(cls, table: Table, bolts: Sequence[str], cases: Sequence[str]) -> "BoltSheetChoice":
        """Read one [[bolt_sheet]]."""
        name = table.get("bolt")
        if name is not None and name not in bolts:
            known = ", ".join(f'"{one}"' for one in bolts)
            table.faults.add(f'{table.where}.bolt = "{name}" is not a bolt; give one of {known}')
        way = table.get("tightening")
        if way is not None:
            table.made(lambda: tightening(way, f"{table.where}.tightening"))
        loads = table.get("load")
        lacking = [one for one in loads if one not in cases]
        if lacking:
            known = ", ".join(f'"{one}"' for one in cases) or "none"
            table.faults.add(f'{table.where}.load = "{lacking[0]}" is not a [[load]]; give one of {known}')
        for key in ("axial", "transverse", "introduction", "thermal_loss"):
            if loads and key in table.data:
                table.faults.add(f"{table.where} has both load and {key}, which the load gives; leave one out")
        choice = cls(
            bolt=name,
            loads=loads,
            way=way,
            **{key: table.get(key) for key in BOLT_SHEET if key not in ("bolt", "tightening", "load", "curve")},
            curve=table.inner("curve", _curve),
        )
        if way is not None and choice.tightening_factor is not None:
            table.faults.add(f"{table.where} has both tightening and tightening_factor; give one of them")
        if choice.curve is not None and "fatigue" in table.data:
            table.faults.add(f"{table.where} has both fatigue and curve; give one of them")
        return choice


def _curve(table: Table) -> FatigueCurve | None:
    given = {key: value for key in CURVE if (value := table.get(key)) is not None}
    return FatigueCurve(**given) if "endurance" in given else None


def frictions_of(choice: BoltSheetChoice, bolt: Bolt | SolidBolt) -> tuple[float | None, float | None]:
    """Friction in the thread and under the head of a bolt [-]: of its sheet, else its own; None where not said."""
    thread, head = bolt.friction or (None, None)
    return (
        thread if choice.thread_friction is None else choice.thread_friction,
        head if choice.head_friction is None else choice.head_friction,
    )


def choice_of(choices: Sequence[BoltSheetChoice], bolt: str) -> BoltSheetChoice:
    """Return what is said for the sheet of a bolt: its own table, that of all others, or nothing."""
    named = {one.bolt: one for one in choices}
    return named.get(bolt) or named.get(None) or BoltSheetChoice()


def read_bolt_sheets(
    tables: Sequence[Table], bolts: Sequence[Bolt | SolidBolt], cases: Sequence[str]
) -> tuple[BoltSheetChoice, ...]:
    """Read all [[bolt_sheet]]; a fault is noted where two name the same bolt, or two name none.

    bolts: of the study; cases: names of its load cases.
    """
    found = tuple(BoltSheetChoice.of(table, [bolt.name for bolt in bolts], cases) for table in tables)
    names = [one.bolt for one in found]
    for table, choice in zip(tables, found, strict=True):
        if names.count(choice.bolt) > 1:
            who = "no bolt" if choice.bolt is None else f'the bolt "{choice.bolt}"'
            table.faults.add(f"{table.where}: two tables name {who}; leave one out")
        unknown = [one.name for one in bolts if one.fastener is None and choice_of(found, one.name) is choice]
        if choice.by_yield and unknown:
            table.faults.add(
                f'{table.where}.rolled = "after": what the thread bears then depends on the yield stress of its class, '
                f'and the bolt "{unknown[0]}" has none; give it grade = "10.9", or leave out rolled'
            )
    return found


def _names(value: Any, name: str) -> tuple[str, ...]:
    items = [value] if isinstance(value, str) else value
    if not isinstance(items, list) or not items or not all(isinstance(one, str) for one in items):
        raise InputError(f'{name} = {value!r} should be the name of a load, or of several: ["up", "down"]')
    return tuple(items)


def _axial(value: Any, name: str) -> tuple[float, float]:
    items = value if isinstance(value, list) else ["0 N", value]
    if len(items) != 2:
        raise InputError(f'{name} = {value!r} should be one load or the least and the greatest: ["0 kN", "4 kN"]')
    low, high = (float(quantity(one, "N", name, positive=False)) for one in items)
    if high < low or high < 0:
        raise InputError(f"{name} = {value!r}: the second load must be the greater, and pull the parts apart")
    return low, high


def _force(says: str) -> Key:
    def read(value: Any, name: str) -> float:
        force = float(quantity(value, "N", name, positive=False))
        if force < 0:
            raise InputError(f'{name} = "{value}" should be 0 or more')
        return force

    return Key("quantity [N], 0 or more", QUANTITY, says, read=read, unit="N")


CURVE: Declared = {
    "endurance": Key.quantity("Pa", "Amplitude of stress, half of a range, at the knee.", REQUIRED),
    "knee": Key.within(1e3, 1e10, "Cycles at the knee.", KNEE),
    "slope": Key.within(1.0, MAX_SLOPE, "Slope above the knee: cycles fall with its power of the amplitude.", SLOPE),
    "slope_below": Key.within(
        1.0, MAX_SLOPE, "Slope below; 2 slope - 1 where left out. At 100 lower amplitudes do no damage."
    ),
}
BOLT_SHEET: Declared = {
    "bolt": Key.text("The bolt; all that no other table names where left out."),
    "tightening": Key.text(
        'Way of tightening, as of [uncertain] preload; "torque wrench, friction estimated" where '
        "left out and nothing scatters."
    ),
    "tightening_factor": Key.within(1.0, MAX_FACTOR, "Greatest over least assembly preload, in place of tightening."),
    "thread_friction": Key.within(
        *BOLT_FRICTION, "Coefficient of friction in the thread; that of the bolt, or 0.12, where left out."
    ),
    "head_friction": Key.within(
        *BOLT_FRICTION, "Coefficient of friction under the head; that of the bolt, or 0.12, where left out."
    ),
    "slip_friction": Key.within(
        0.02, MOST_FRICTION, "Coefficient of friction of the clamped joint; the least of its joints where left out."
    ),
    "load": Key(
        "the name of a [[load]], or a list of them",
        one_or_more(WORDS),
        "A [[load]], or several, that give working load, load across, load factor and loss by temperature as they are "
        "found; in place of axial, transverse, introduction and thermal_loss. One stands for nothing and itself, "
        "several for the least and the greatest of them.",
        (),
        read=_names,
    ),
    "axial": Key(
        "quantity [N], or the least and the greatest",
        {"anyOf": [QUANTITY, listed(QUANTITY, 2, 2)]},
        "Least and greatest working load along the bolt, positive where it pulls the parts apart; one load stands for "
        "0 and that.",
        read=_axial,
        unit="N",
    ),
    "introduction": Key.within(0.0, 1.0, "Load introduction factor n, from 0 to 1; 1 is a load at the seats.", 1.0),
    "transverse": _force("Working load across the bolt, which friction carries."),
    "clamp": _force("Clamp load that is asked for, of a seal for example."),
    "embedding": Key.quantity(
        "m",
        "Embedding of thread, seats and joints together; the guide value of VDI 2230 where left out and scans give a "
        "roughness.",
    ),
    "thermal_loss": Key.quantity("N", "Preload that temperature takes; negative where it adds some.", positive=False),
    "shear_strength": Key.quantity("Pa", "Shear strength of the part that is tapped."),
    "rolled": Key.text("Whether the thread is rolled before or after heat treatment.", "before", ("before", "after")),
    "fatigue": Key.text("Curve of fatigue in vibration: VDI 2230, or IEC 61400-6.", "vdi", ("vdi", "iec")),
    "curve": Inner(says="Curve of fatigue of its own, in place of fatigue.", keys=CURVE),
}
