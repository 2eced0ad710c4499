"""What a study says of the rough surface and the contact law."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from faying.contact.law import ContactLaw
from faying.errors import InputError
from faying.study.reader import Table, existing_path, number

BELONGS = {"gaps": "gw-measured", "gaps_unit": "gw-measured", "tangent_ratio": "gw-measured", "file": "table"}
FROM_SURFACE = ("D", "G", "scan_area")
JK_NUMBERS = ("gamma", "alpha", "cutoff", "shear_ratio", "psi", "modulus_ratio")


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
    """The contact law of the joints and its options.

    heights: measured asperities, for the law that takes them; table: the file of a law given as a table; own: options hold
    all that the law takes from a surface.
    """

    model: str = "jk"
    counterbody: Literal["part", "rigid"] = "part"
    options: dict[str, Any] = field(default_factory=dict)
    heights: "HeightsSpec | None" = None
    table: Path | None = None
    own: bool = False

    @property
    def needs_surface(self) -> bool:
        """Whether the law takes its inputs from [surface]."""
        return self.heights is None and self.table is None and not self.own


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
    model = table.take("model", _known_law, "jk") or "jk"
    counterbody = table.text("counterbody", "part", ("part", "rigid"))
    options: dict[str, Any] = {}
    heights = path = None
    own = False
    if _plain(model) == "jk":
        options = _jk_options(table)
    elif _plain(model) in ("gwmeasured", "measuredheights"):
        heights = HeightsSpec(file=table.take("gaps", existing_path(folder)), unit=table.text("gaps_unit"),
                              density=table.quantity("density", "1/m^2"), radius=table.quantity("radius", "m"))  # fmt: skip
        if (asperity := table.text("asperity", None)) is not None:
            options["asperity"] = asperity
        if (ratio := table.number("tangent_ratio", None)) is not None:
            options["tangent_ratio"] = ratio
    elif _plain(model) in ("table", "tabulatedlaw"):
        path = table.take("file", existing_path(folder))
    else:
        options, own = _own_options(table, model)
    for key, other in BELONGS.items():
        if key in table.data and not table.known(key):
            table.faults.add(f'{table.where}.{key} goes with model = "{other}", not "{model}"')
            table.data.pop(key)
    table.close()
    return LawSpec(model=model, counterbody=counterbody, options=options, heights=heights, table=path, own=own)


def _jk_options(table: Table) -> dict[str, Any]:
    options: dict[str, Any] = {key: value for key in JK_NUMBERS if (value := table.number(key, None)) is not None}
    for key, choices in (("closure", ("consistent", "printed")), ("loss", ("held", "literal"))):
        if (chosen := table.text(key, None, choices)) is not None:
            options[key] = chosen
    share = table.take("substrate", lambda v, name: v if v in ("exact", "computed") else number(v, name), None)
    if share is not None:
        options["substrate"] = share
    return options


def _own_options(table: Table, model: str) -> tuple[dict[str, Any], bool]:
    """The parameters that a law states, as far as they are given, and whether it needs no surface then."""
    from dataclasses import MISSING, fields

    cls: Any = law_class(model)
    options: dict[str, Any] = {}
    for name, parameter in cls.parameters.items():
        if name in FROM_SURFACE:
            continue
        if parameter.unit == "text":
            value = table.text(name, None)
        elif parameter.unit:
            value = table.quantity(name, parameter.unit, None, positive=False)
        else:
            value = table.number(name, None)
        if value is not None:
            options[name] = value
    must = {f.name for f in fields(cls) if f.init and f.default is MISSING and f.default_factory is MISSING}
    return options, must - {"pair"} <= options.keys()


def law_class(model: str) -> type[ContactLaw]:
    """Return the class of a law by any of its names; "GW-KE" and the like are Greenwood and Williamson's."""
    from faying.contact.compare import ASPERITIES
    from faying.contact.registry import find_law, laws

    return laws()["GreenwoodWilliamson"] if model.upper() in ASPERITIES else find_law(model)


def _plain(model: str) -> str:
    return model.lower().replace("-", "").replace("_", "")


def _known_law(value: Any, name: str) -> str:
    if not isinstance(value, str):
        raise InputError(f"{name} = {value!r} should be text in quotes")
    law_class(value)
    return value
