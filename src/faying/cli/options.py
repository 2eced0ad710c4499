"""What several commands share."""

from typing import Any


def quantity(value: Any, unit: str) -> dict[str, Any]:
    """A quantity as JSON shows it everywhere: its SI unit ("1" for plain numbers) and its value or values."""
    return {"unit": unit if unit not in ("", "text") else "1", "values": value}


def frequency_band(text: str) -> tuple[float, float]:
    """Turn the text of --band into two frequencies [Hz]; InputError that shows the form otherwise."""
    from faying import units
    from faying.errors import InputError

    parts = text.split(":")
    if len(parts) != 2:
        raise InputError(f'--band "{text}": give two frequencies, for example "20 Hz:800 Hz"')
    low, high = (units.parse(part, "Hz", name="--band") for part in parts)
    return low, high
