"""What a study says of the rough surface and the contact law."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from faying.errors import InputError
from faying.study.reader import Table, existing_path, number

MEASURED = ("gaps", "gaps_unit", "density", "radius", "asperity", "tangent_ratio")
LAW_NUMBERS = ("gamma", "alpha", "cutoff", "shear_ratio", "psi", "modulus_ratio")


@dataclass(frozen=True, kw_only=True)
class SurfaceSpec:
    """The rough surface: a scan with its units and estimator, or D, G [m] and scan_area [m2] as given."""

    scan: Path | None = None
    xy_unit: str | None = None
    z_unit: str | None = None
    method: str = "psd"
    D: float | None = None
    G: float | None = None
    scan_area: float | None = None


@dataclass(frozen=True, kw_only=True)
class LawSpec:
    """The contact law of the joints and its options; heights: measured asperities, for the law that takes them."""

    model: str = "jk"
    counterbody: Literal["part", "rigid"] = "part"
    options: dict[str, Any] = field(default_factory=dict)
    heights: "HeightsSpec | None" = None

    @property
    def needs_surface(self) -> bool:
        """Whether the law takes its inputs from [surface]; measured heights bring their own."""
        return self.heights is None


@dataclass(frozen=True, kw_only=True)
class HeightsSpec:
    """Measured asperities: a file of gap and probability density, unit of the gap; density [1/m2], radius [m]."""

    file: Path
    unit: str
    density: float
    radius: float


def surface_spec(table: Table, folder: Path) -> SurfaceSpec:
    """Read one [surface] table."""
    given = "scan" in table.data
    spec = SurfaceSpec(
        scan=table.take("scan", existing_path(folder), None),
        xy_unit=table.text("xy_unit", None),
        z_unit=table.text("z_unit", None),
        method=table.text("method", "psd"),
        D=table.number("D", None),
        G=table.quantity("G", "m", None),
        scan_area=table.quantity("scan_area", "m^2", None),
    )
    if not given and "scan" not in table.data:
        lacking = [k for k in ("D", "G", "scan_area") if k not in table.data]
        if lacking:
            table.faults.add(f"surface: give scan, or D, G and scan_area ({', '.join(lacking)} missing)")
    if spec.D is not None and not 2 < spec.D < 3:
        table.faults.add(f"surface.D = {spec.D}: the dimension of a surface lies between 2 and 3, for example 2.4")
    table.close()
    return spec


def law_spec(table: Table, folder: Path) -> LawSpec:
    """Read one [law] table; file names are relative to `folder`."""
    options: dict[str, Any] = {key: value for key in LAW_NUMBERS if (value := table.number(key, None)) is not None}
    for key, choices in (("closure", ("consistent", "printed")), ("loss", ("held", "literal"))):
        if (chosen := table.text(key, None, choices)) is not None:
            options[key] = chosen
    share = table.take("substrate", lambda v, name: v if v in ("exact", "computed") else number(v, name), None)
    if share is not None:
        options["substrate"] = share
    model = table.take("model", _known_law, "jk")
    counterbody = table.text("counterbody", "part", ("part", "rigid"))
    heights = None
    if _is_measured(model):
        heights = HeightsSpec(file=table.take("gaps", existing_path(folder)), unit=table.text("gaps_unit"),
                              density=table.quantity("density", "1/m^2"), radius=table.quantity("radius", "m"))  # fmt: skip
        if (asperity := table.text("asperity", None)) is not None:
            options["asperity"] = asperity
        if (ratio := table.number("tangent_ratio", None)) is not None:
            options["tangent_ratio"] = ratio
    else:
        for key in [k for k in MEASURED if k in table.data]:
            table.faults.add(f'{table.where}.{key} goes with model = "gw-measured", not "{model}"')
            table.data.pop(key)
    table.close()
    return LawSpec(model=model, counterbody=counterbody, options=options, heights=heights)


def _is_measured(model: str) -> bool:
    return model.lower().replace("-", "").replace("_", "") in ("gwmeasured", "measuredheights")


def _known_law(value: Any, name: str) -> str:
    from faying.contact.compare import ASPERITIES
    from faying.contact.registry import find_law

    if not isinstance(value, str):
        raise InputError(f"{name} = {value!r} should be text in quotes")
    if value.upper() not in ASPERITIES:
        find_law(value)
    return value
