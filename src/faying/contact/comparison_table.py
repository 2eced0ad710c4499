"""A comparison of laws as a labelled table, and as curves."""

from typing import TYPE_CHECKING, Any

import numpy as np

from faying.contact.compare import Comparison
from faying.contact.half_space import HalfSpace
from faying.contact.response import UNITS
from faying.errors import InputError

if TYPE_CHECKING:
    import matplotlib.axes
    import xarray

MEANINGS = {
    "area": "real area / nominal area",
    "k_n": "normal stiffness k_n",
    "k_t": "tangential stiffness k_t",
    "k_load": "normal stiffness on loading k_load",
    "k_n_low": "lower end of the range of k_n",
    "k_n_high": "upper end of the range of k_n",
    "loss_n": "normal loss factor",
    "loss_t": "tangential loss factor",
}
STIFFNESS = 1e-12  # MPa/um


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


def label_and_scale(quantity: str) -> tuple[str, float]:
    """Text of an axis and factor from SI to what it shows. Raises InputError for an unknown quantity."""
    if quantity not in MEANINGS:
        raise InputError(f"quantity = {quantity!r}; allowed: {', '.join(MEANINGS)}")
    stiff = UNITS[quantity] == "Pa/m"
    return MEANINGS[quantity] + (" [MPa/um]" if stiff else ""), STIFFNESS if stiff else 1.0


def axes_of(
    comparison: Comparison, quantity: str, *, title: str, ax: "matplotlib.axes.Axes | None"
) -> "matplotlib.axes.Axes":
    """Draw one quantity of the laws that have it; thick within the validity range, thin and dotted outside it."""
    from matplotlib import colormaps

    label, scale = label_and_scale(quantity)
    if ax is None:
        from matplotlib import pyplot

        _, ax = pyplot.subplots(figsize=(7.0, 4.4), layout="constrained")
    p = comparison.pressure * 1e-6
    for k, (law, response) in enumerate(comparison.responses.items()):
        value = response.quantities().get(quantity)
        if value is None:
            continue
        solved = law == HalfSpace.name
        color = "black" if solved else colormaps["tab20"]((2 * k + k // 10) % 20)
        ax.plot(p, value * scale, ":", color=color, lw=1.0)
        shown = np.where(response.valid, value * scale, np.nan)
        ax.plot(p, shown, color=color, lw=2.6 if solved else 1.6, label=law)
    ax.set(xscale="log", xlabel="nominal pressure [MPa]", ylabel=label)
    ax.set_title(title, fontsize="small")
    if not quantity.startswith("loss"):
        ax.set_yscale("log")
    ax.grid(alpha=0.3)
    ax.legend(title="dotted: outside its range", loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    return ax
