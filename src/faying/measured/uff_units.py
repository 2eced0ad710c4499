"""Which quantity and unit a function of a universal file is in: type codes, axis labels, data set 164."""

import re
from contextlib import suppress
from dataclasses import dataclass
from math import pi
from typing import Any

from faying.columns import plain_unit
from faying.errors import InputError, ReadError
from faying.units import scale

# specific data types of data set 58 that concern FRFs
MOTION = {8: "receptance", 11: "mobility", 12: "accelerance"}
FORCES = (9, 13)  # reaction and excitation
DIMENSIONS = {"receptance": "m", "mobility": "m/s", "accelerance": "m/s^2"}
FREQUENCY = 18
NONE = ("", "NONE", "-", "1", "UNKNOWN", "UNDEFINED", "N/A")
HERTZ = {
    **dict.fromkeys(("hz", "hertz", "cps", "c/s"), 1.0),
    **dict.fromkeys(("rad/s", "rad/sec", "rads/s", "rad/second"), 1 / (2 * pi)),
    **dict.fromkeys(("rpm", "cpm", "1/min"), 1 / 60),
    "khz": 1e3,
}
MAX_FACTOR = 1e12  # of a unit: nanometres are 1e9 a metre


@dataclass(frozen=True, kw_only=True)
class FileUnits:
    """Data set 164: file units per SI unit of length and force (a value divided by them is SI), and its own words."""

    length: float = 1.0
    force: float = 1.0
    words: str = ""

    @classmethod
    def of(cls, sets: list[dict[str, Any]], where: str) -> "FileUnits | None":
        """Units of a file from its data sets 164, None where there is none. ReadError for factors that cannot be."""
        found = [s for s in sets if s["type"] == 164]
        if not found:
            return None
        units = cls(length=found[0]["length"], force=found[0]["force"], words=found[0]["units_description"])
        if not all(1 / MAX_FACTOR <= factor <= MAX_FACTOR for factor in (units.length, units.force)):
            raise ReadError(
                f"{where}: data set 164 gives the factors {units.length} and {units.force}; they must be between "
                f"{1 / MAX_FACTOR:g} and {MAX_FACTOR:g}. "
                "Export the file again with its units"
            )
        return units


def _clean(label: str) -> str:
    text = plain_unit(label).replace("μ", "u")
    text = re.sub(r"\b(s|sec)\s?(2)\b", r"s^2", text, flags=re.IGNORECASE)
    text = re.sub(r"\bsec\b", "s", text, flags=re.IGNORECASE)
    return re.sub(r"\bnewtons?\b", "N", text, flags=re.IGNORECASE)


def unit_factor(label: str, unit: str) -> float | None:
    """How many SI `unit` one of the label is, or None; capitals are read as small letters where they mean nothing."""
    text = _clean(label)
    if unit.startswith("m/s^2"):
        text = re.sub(r"^\(?g('s|s|n|rms)?\)?(?=$|/)", "g_0", text, flags=re.IGNORECASE)
    for spelling in (text, re.sub(r"\bn\b", "N", text.lower())):
        with suppress(InputError):
            return scale(spelling, unit)
    return None


def states_nothing(label: str) -> bool:
    """Whether a label is one of those that programs write where they know no unit."""
    return label.strip().upper() in NONE


def hertz(data: dict[str, Any], where: str) -> float:
    """Hz in one unit of the abscissa of an FRF, from its type code and label. ReadError for other quantities."""
    label = data["abscissa_axis_units_lab"]
    kind = data["abscissa_spec_data_type"]
    if kind not in (0, 1, FREQUENCY):
        raise ReadError(
            f'{where}: an FRF over an abscissa of type {kind} ("{label.strip()}"), which is not a frequency (type 18); '
            "export it over frequency"
        )
    text = label.strip().lower().replace(" ", "")
    if states_nothing(label):
        return 1.0
    if text in HERTZ or label.strip() == "MHz":
        return HERTZ.get(text, 1e6)
    if text == "mhz":
        raise ReadError(f'{where}: the unit "{label.strip()}" of its abscissa may be MHz or mHz; export it over Hz')
    raise ReadError(
        f'{where}: the unit "{label.strip()}" of its abscissa is not a unit of frequency that Faying reads (Hz, kHz, '
        "rad/s, rpm); export it over Hz"
    )


def frf_scale(
    data: dict[str, Any], units: FileUnits | None, quantity: str | None, where: str
) -> tuple[str, float, str]:
    """Quantity of an FRF, the factor that makes it SI, and a note ("" where the file says enough).

    Order of trust: the caller's quantity, the type codes, the labels; for the unit the labels, then data set 164, then
    SI. Raises ReadError where nothing says what was measured.
    """
    top, bottom = data["ordinate_axis_units_lab"], data["orddenom_axis_units_lab"]
    named = quantity or MOTION.get(data["ordinate_spec_data_type"])
    if data["orddenom_spec_data_type"] not in (0, 1, *FORCES) and quantity is None:
        raise ReadError(
            f"{where}: a function relative to something that is not a force (type {data['orddenom_spec_data_type']}); "
            'leave it out, or give what it is, for example quantity="accelerance"'
        )
    for name in [named] if named else list(DIMENSIONS):
        whole = unit_factor(top, DIMENSIONS[name] + "/N")
        if whole is not None:
            return name, whole, ""
        motion = unit_factor(top, DIMENSIONS[name])
        if motion is not None and not states_nothing(top):
            force = unit_factor(bottom, "N")
            if force is None and not states_nothing(bottom):
                raise ReadError(_unknown(bottom, "force, such as N", where))
            if force is None and units is not None:
                force = 1 / units.force
            note = "" if force else f"{where}: no unit of force is stated; newtons are assumed"
            return name, motion / (force or 1.0), note
    if named is None:
        raise ReadError(
            f'{where}: neither its type code nor its unit "{top}" states what was measured; give it, for example '
            'quantity="accelerance", or on the command line --quantity accelerance'
        )
    if not states_nothing(top):
        raise ReadError(_unknown(top, f"{named}, such as {DIMENSIONS[named]} over N", where))
    if not states_nothing(bottom) and unit_factor(bottom, "N") != 1.0:
        raise ReadError(_unknown(bottom, "force in newtons, where the motion states no unit", where))
    if units is not None:
        return named, units.force / units.length, ""
    return named, 1.0, f"{where}: the file states no unit; SI ({DIMENSIONS[named]}/N) is assumed"


def _unknown(label: str, wanted: str, where: str) -> str:
    return (
        f'{where}: the unit "{label.strip()}" of its ordinate is not a unit of {wanted}; export it in such a unit, or '
        "correct the label in the file (NONE where the values are SI)"
    )
