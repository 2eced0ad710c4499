"""What several commands share."""

from typing import Any


def quantity(value: Any, unit: str) -> dict[str, Any]:
    """A quantity as JSON shows it everywhere: its SI unit ("1" for plain numbers) and its value or values."""
    return {"unit": unit if unit not in ("", "text") else "1", "values": value}
