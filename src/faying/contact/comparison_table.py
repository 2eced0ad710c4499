"""A comparison of laws as a labelled table, and how its quantities are called on axes."""

from typing import TYPE_CHECKING, Any

import numpy as np

from faying.contact.compare import Comparison
from faying.contact.models.half_space import HalfSpace
from faying.contact.response import MEANINGS, UNITS

if TYPE_CHECKING:
    import xarray


def dataset(comparison: Comparison, *, mates: str) -> "xarray.Dataset":
    """Return the responses over (law, pressure) as an xarray.Dataset in SI units; mates: a line on both faces."""
    import xarray as xr

    shape = len(comparison.responses), comparison.pressure.size
    variables: dict[str, Any] = {}
    for name, meaning in MEANINGS.items():
        values = np.full(shape, np.nan)
        for row, response in zip(values, comparison.responses.values(), strict=True):
            row[:] = response.quantities().get(name, np.nan)
        variables[name] = (("law", "pressure"), values, {"long_name": meaning, "units": UNITS[name] or "1"})
    solved = comparison.responses.get(HalfSpace.name)
    exact = np.full(shape[1], np.nan) if solved is None or solved.k_n is None else solved.k_n
    text = "k_n over that of the half-space"
    variables["over_half_space"] = (
        ("law", "pressure"),
        variables["k_n"][1] / exact,
        {"long_name": text, "units": "1"},
    )
    valid = np.array([r.valid for r in comparison.responses.values()], dtype=bool).reshape(shape)
    variables["valid"] = (("law", "pressure"), valid, {"long_name": "within the validity range of the law"})
    pressure = ("pressure", comparison.pressure, {"long_name": "nominal pressure", "units": "Pa"})
    return xr.Dataset(
        variables,
        coords={"law": list(comparison.responses), "pressure": pressure},
        attrs={"mates": mates, "left_out": "\n".join(f"{name}: {why}" for name, why in comparison.left_out.items())},
    )
