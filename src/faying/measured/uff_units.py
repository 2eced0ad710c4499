"""Which quantity and unit a function of a universal file is in: type codes, axis labels, data set 164."""

from dataclasses import dataclass
from math import inf
from typing import Any

from faying.errors import InputError, ReadError
from faying.units import scale

# specific data types of data set 58 that concern FRFs
MOTION = {8: "receptance", 11: "mobility", 12: "accelerance"}
FORCE = 13
DIMENSIONS = {"receptance": "m", "mobility": "m/s", "accelerance": "m/s^2"}
NONE = ("", "NONE", "-", "1")


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
        if not (0 < units.length < inf and 0 < units.force < inf):
            raise ReadError(
                f"{where}: data set 164 gives the factors {units.length} and {units.force}; they must be positive. "
                "Export the file again with its units"
            )
        return units


def _clean(label: str) -> str:
    text = label.strip().replace("²", "^2").replace("\ufffd", "^2").replace("**", "^").replace("·", "*")
    for wrong, right in (("s2", "s^2"), ("sec", "s"), ("µ", "u"), ("μ", "u")):
        text = text.replace(wrong, right)
    return text


def unit_factor(label: str, unit: str) -> float | None:
    """How many SI `unit` one of the label is, or None."""
    text = _clean(label)
    if unit.startswith("m/s^2") and text.split("/")[0].lower() in ("g", "gn"):
        text = "g_0" + text[len(text.split("/")[0]) :]
    try:
        return scale(text, unit)
    except InputError:
        return None


def frf_scale(
    data: dict[str, Any], units: FileUnits | None, quantity: str | None, where: str
) -> tuple[str, float, str]:
    """Quantity of an FRF, the factor that makes it SI, and a note ("" where the file says enough).

    Order of trust: the caller's quantity, the type codes, the labels; for the unit the labels, then data set 164, then
    SI. Raises ReadError where nothing says what was measured.
    """
    top, bottom = data["ordinate_axis_units_lab"], data["orddenom_axis_units_lab"]
    named = quantity or MOTION.get(data["ordinate_spec_data_type"])
    if data["orddenom_spec_data_type"] not in (0, 1, FORCE) and quantity is None:
        raise ReadError(
            f"{where}: a function relative to something that is no force (type {data['orddenom_spec_data_type']}); "
            'leave it out, or say what it is, for example quantity="accelerance"'
        )
    for name in [named] if named else list(DIMENSIONS):
        whole = unit_factor(top, DIMENSIONS[name] + "/N")
        if whole is not None:
            return name, whole, ""
        motion = unit_factor(top, DIMENSIONS[name])
        if motion is not None and top.strip().upper() not in NONE:
            force = unit_factor(bottom, "N")
            if force is None and units is not None:
                force = 1 / units.force
            return (
                name,
                motion / (force or 1.0),
                "" if force else f"{where}: no unit of force is stated; newtons are assumed",
            )
    if named is None:
        raise ReadError(
            f'{where}: neither its type code nor its unit "{top}" says what was measured; say it, for example '
            'quantity="accelerance", or on the command line --quantity accelerance'
        )
    if units is not None:
        return named, units.force / units.length, ""
    return named, 1.0, f"{where}: the file states no unit; SI ({DIMENSIONS[named]}/N) is assumed"
