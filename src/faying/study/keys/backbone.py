"""[backbone]: frequency and damping of a mode against its amplitude."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from faying import units
from faying.contact.build import find
from faying.errors import InputError
from faying.joint.modal import MAX_MODES
from faying.measured.ring_down import MeasuredBackbone
from faying.study.declaration.declared import NUMBER, QUANTITY, WORDS, Declared, Key, listed, one_or_more
from faying.study.declaration.reader import Table
from faying.study.declaration.values import number
from faying.study.keys.law import LawChoice

Point = tuple[float, float, float]
RANGE = (0.1, 100.0)  # m/s2


@dataclass(frozen=True, kw_only=True)
class BackboneChoice:
    """Which curve is asked for.

    Args:
        mode: Elastic mode, from 1.
        amplitude: First and last acceleration [m/s2].
        at: Point [m] whose acceleration that is; where the mode moves most if None.
        friction: Coefficients [-], each for all joints and each a curve; those of the joints where empty.
        harmonics: Highest harmonic of the motion, 1 to 9.
        rest_damping: Ratio to critical [-] that is added, or "law": what the laws lose without slip.
        slip: "microslip" cuts the law's own curve, "coulomb" takes one slider a point.
        laws: Laws of all joints, each a curve; those of the joints where empty.
        measured: CSV file of measured points that are drawn beside.

    Raises:
        InputError: One of them is out of range.
    """

    mode: int = 1
    amplitude: tuple[float, float] = RANGE
    at: Point | None = None
    friction: tuple[float, ...] = ()
    harmonics: int = 3
    rest_damping: float | Literal["law"] = 0.0
    slip: Literal["microslip", "coulomb"] = "microslip"
    laws: tuple[LawChoice, ...] = ()
    measured: Path | None = None

    def __post_init__(self) -> None:
        if isinstance(self.mode, bool) or self.mode < 1:
            raise InputError(f"mode = {self.mode}: elastic modes count from 1")
        low, high = self.amplitude
        if not 0 < low < high < float("inf"):
            raise InputError(
                f"amplitude from {low:g} to {high:g} m/s2: give the least acceleration, above 0, and then the greatest"
            )
        for value in self.friction:
            check_friction(value)
        if not 1 <= self.harmonics <= 9:
            raise InputError(f"harmonics = {self.harmonics}: give 1 to 9; 3 is usual, 1 is quick")
        if self.rest_damping != "law" and not 0 <= self.rest_damping < 1:
            raise InputError(
                f'rest_damping = {self.rest_damping}: give a ratio to critical such as 0.001 (0.1 %), or "law"'
            )
        if self.slip not in ("microslip", "coulomb"):
            raise InputError(f'slip = "{self.slip}" should be one of microslip, coulomb')

    @classmethod
    def of(cls, table: Table) -> "BackboneChoice | None":
        """Read [backbone]; None where its faults leave none."""
        given = {key: table.get(key) for key in BACKBONE if key != "law"} | {"laws": table.get("law")}
        if given["measured"] is not None:
            table.made(lambda: MeasuredBackbone.read(given["measured"]))  # a fault shows at once
        return table.made(lambda: cls(**given))


def check_friction(value: float) -> None:
    """Raise InputError unless a value is a coefficient with which a joint holds and can slip."""
    if not 0 < value < 10:
        raise InputError(f"friction = {value:g} is not a coefficient of a joint that slips; give one such as 0.2")


def accelerations(value: Any, name: str) -> tuple[float, float]:
    """Convert two accelerations with units, as a list or as "first:last"; InputError that shows the form."""
    parts = value.split(":") if isinstance(value, str) else value
    if not isinstance(parts, list) or len(parts) != 2:
        raise InputError(f'{name} = {value!r} should be two accelerations, for example ["0.1 m/s^2", "60 m/s^2"]')
    low, high = (units.parse(part, "m/s^2", name=name) for part in parts)
    return low, high


def frictions(value: Any, name: str) -> tuple[float, ...]:
    """Convert one coefficient of friction, or a list of them."""
    values: Sequence[Any] = value if isinstance(value, list) else [value]
    return tuple(number(one, name) for one in values)


def laws(value: Any, name: str) -> tuple[LawChoice, ...]:
    """Convert the name of one law, or a list of them. Raises InputError where there is no such law."""
    values: Sequence[Any] = value if isinstance(value, list) else [value]
    for one in values:
        if not isinstance(one, str):
            form = 'the name of a law, or a list of them, such as ["auto", "jk"]'
            raise InputError(f"{name} = {value!r} should be {form}")
    return tuple(LawChoice(model=find(one).label) for one in values)


BACKBONE: Declared = {
    "mode": Key.count("Elastic mode, from 1.", 1, most=MAX_MODES),
    "amplitude": Key(
        'two accelerations, for example ["0.1 m/s^2", "60 m/s^2"]',
        listed(QUANTITY, 2, 2),
        "First and last acceleration.",
        RANGE,
        read=accelerations,
        unit="m/s^2",
    ),
    "at": Key.point("Point whose acceleration that is; where the mode moves most if left out."),
    "friction": Key(
        "a number or a list of them",
        one_or_more(NUMBER),
        "Coefficient for all joints, or a list with a curve for each; those of the joints where left out.",
        (),
        read=frictions,
    ),
    "harmonics": Key.count("Highest harmonic of the motion, 1 to 9.", 3, most=9),
    "rest_damping": Key(
        'a number, or "law"',
        {"anyOf": [{"type": "number"}, {"const": "law"}]},
        'Ratio to critical that is added, or "law": what the laws lose without slip.',
        0.0,
        read=lambda value, name: "law" if value == "law" else number(value, name),
    ),
    "slip": Key.text(
        "Sliders that follow the curve of the law, or one slider at each point.", "microslip", ("microslip", "coulomb")
    ),
    "law": Key(
        'the name of a law, or a list of them, such as ["auto", "jk"]',
        one_or_more(WORDS),
        "Contact law of all joints, or a list with a curve for each; that of the study where left out.",
        (),
        read=laws,
    ),
    "measured": Key.file("CSV file of measured points: acceleration, frequency, damping."),
}
