"""What a study says of the rough surface and the contact law."""

from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Literal

from faying.contact.compare import ASPERITIES, law_class
from faying.contact.law import ContactLaw
from faying.contact.tabulated import TabulatedLaw
from faying.errors import InputError
from faying.study.reader import Table, existing_path, number

BELONGS = {"gaps": "gw-measured", "gaps_unit": "gw-measured", "tangent_ratio": "gw-measured", "file": "table"}
FROM_SURFACE = ("D", "G", "scan_area")
MISSING_SURFACE = "[surface] is missing"
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
    all that the law takes from a surface; lacking: the fault where there is no surface, empty for laws that need none.
    """

    model: str = "jk"
    counterbody: Literal["part", "rigid"] = "part"
    options: dict[str, Any] = field(default_factory=dict)
    heights: "HeightsSpec | None" = None
    table: Path | None = None
    own: bool = False
    lacking: str = ""

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
    model = table.take("model", _known_law, None)
    unknown, model = model is None and "model" in table.data, model or "jk"
    counterbody = table.text("counterbody", "part", ("part", "rigid"))
    options: dict[str, Any] = {}
    heights = path = None
    own, lacking = False, ""
    if unknown:
        return LawSpec()
    if _plain(model) == "jk":
        options = _jk_options(table)
        lacking = MISSING_SURFACE
    elif _plain(model) in ("gwmeasured", "measuredheights"):
        heights = HeightsSpec(
            file=table.take("gaps", existing_path(folder)),
            unit=table.text("gaps_unit"),
            density=table.quantity("density", "1/m^2"),
            radius=table.quantity("radius", "m"),
        )
        if (asperity := table.text("asperity", None)) is not None:
            options["asperity"] = asperity
        if (ratio := table.number("tangent_ratio", None)) is not None:
            options["tangent_ratio"] = ratio
    elif _plain(model) in ("table", "tabulatedlaw"):
        path = table.take("file", _table_file(folder))
    elif _plain(model) == "persson":
        table.faults.add(
            f'{table.where}.model = "{model}" cannot carry a joint by itself: its stiffness grows in proportion to '
            "pressure from zero, so the faces never meet; take another law here, and this one with `faying law`"
        )
        return LawSpec(model=model)
    else:
        options, own, lacking = _own_options(table, model)
    if _misplaced(table, model):  # another model may be meant, which needs no surface
        lacking = ""
    table.close()
    return LawSpec(
        model=model, counterbody=counterbody, options=options, heights=heights, table=path, own=own, lacking=lacking
    )


def _misplaced(table: Table, model: str) -> bool:
    """Note keys that belong elsewhere, each with its place; whether one belongs to another model."""
    foreign = [key for key in BELONGS if key in table.data and not table.known(key)]
    for key in foreign:
        table.faults.add(f'{table.where}.{key} goes with model = "{BELONGS[key]}", not "{model}"')
        table.data.pop(key)
    if "asperity" in table.data and model.upper() in ASPERITIES:
        table.faults.add(
            f'{table.where}.asperity goes with model = "gw"; "{model}" has the asperity {ASPERITIES[model.upper()]}'
        )
    for key in FROM_SURFACE:
        if key in table.data and key in law_class(model).parameters:
            table.faults.add(f"{table.where}.{key} is not a key of the law; D, G and scan_area go under [surface]")
            table.data.pop(key)
    return bool(foreign)


def _table_file(folder: Path) -> Any:
    """Return a converter of the names of table files, which are read once to see that they can be."""

    def convert(value: Any, name: str) -> Path:
        path: Path = existing_path(folder)(value, name)
        TabulatedLaw.from_csv(path)
        return path

    return convert


def _jk_options(table: Table) -> dict[str, Any]:
    options: dict[str, Any] = {key: value for key in JK_NUMBERS if (value := table.number(key, None)) is not None}
    for key, choices in (("closure", ("consistent", "printed")), ("loss", ("held", "literal"))):
        if (chosen := table.text(key, None, choices)) is not None:
            options[key] = chosen
    share = table.take("substrate", lambda v, name: v if v in ("exact", "computed") else number(v, name), None)
    if share is not None:
        options["substrate"] = share
    return options


def _own_options(table: Table, model: str) -> tuple[dict[str, Any], bool, str]:
    """The parameters that a law states, as far as they are given; whether it needs no surface then; what it lacks else."""
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
    must = needed(cls)
    if must is None:
        return options, False, f'{MISSING_SURFACE}; model = "{model}" takes its inputs from a scan there'
    # a key with a fault of its own, or misspelt, is told as such and not missing besides
    meant = {near for key in table.data if not table.known(key) for near in get_close_matches(key, must, n=1)}
    missing = [name for name in must if name not in table.data and name not in meant]
    if not missing:
        return options, all(name in options for name in must), ""
    notes = {
        name: ", ".join(filter(None, (cls.parameters[name].meaning, cls.parameters[name].unit))) for name in missing
    }
    if len(missing) == 1:
        fault = f"{table.where}.{missing[0]} is missing ({notes[missing[0]]}); give it"
    else:
        *some, last = (f"{name} ({note})" for name, note in notes.items())
        fault = f"{table.where}: {', '.join(some)} and {last} are missing; give them"
    if cls.from_surface.__func__ is ContactLaw.from_surface.__func__:  # type: ignore[attr-defined]
        table.faults.add(fault)  # no scan gives them
        return options, False, ""
    return options, False, f"{fault}, or a [surface] with a scan"


def needed(cls: Any) -> list[str] | None:
    """The parameters without which a law cannot be given in full; None for laws that take theirs from a surface."""
    from dataclasses import MISSING, fields

    must = [f.name for f in fields(cls) if f.init and f.default is MISSING and f.default_factory is MISSING]
    own = [name for name in must if name != "pair"]
    return own if all(name in cls.parameters and name not in FROM_SURFACE for name in own) else None


def own_numbers(law: type[ContactLaw]) -> dict[str, str]:
    """SI unit of every number that a law states as its own parameter ("" for plain ones), by name."""
    return {name: p.unit for name, p in law.parameters.items() if p.unit != "text" and name not in FROM_SURFACE}


def _plain(model: str) -> str:
    return model.lower().replace("-", "").replace("_", "")


def _known_law(value: Any, name: str) -> str:
    if not isinstance(value, str):
        raise InputError(f"{name} = {value!r} should be text in quotes")
    law_class(value)
    return value
