"""The surface of a study and the contact law that it gives."""

from dataclasses import dataclass, field, fields
from typing import Any, cast

from faying import units
from faying.contact.compare import ASPERITIES, law_class, laws_of_surface
from faying.contact.inputs import SurfaceInputs
from faying.contact.jk import JK
from faying.contact.law import ContactLaw
from faying.contact.measured_heights import MeasuredHeights
from faying.contact.tabulated import TabulatedLaw
from faying.errors import InputError
from faying.files import read_numbers
from faying.materials import ContactPair
from faying.study.contact import HeightsSpec, LawSpec, SurfaceSpec, needed
from faying.surface.form import prepared
from faying.surface.fractal import fit_fractal
from faying.surface.read import read_scan
from faying.surface.scan import Scan
from faying.typing import Array


@dataclass(frozen=True, kw_only=True)
class Surface:
    """D [-], G [m] and scan area [m2], whence they come, and the levelled scan where there is one."""

    D: float
    G: float
    scan_area: float
    facts: dict[str, Any]
    warnings: tuple[str, ...] = ()
    source: str = ""
    scan: Scan | None = field(default=None, repr=False)


NO_SURFACE = Surface(D=0.0, G=0.0, scan_area=0.0, facts={"origin": "none: the contact law brings its own heights"})


def surface_of(spec: SurfaceSpec) -> Surface:
    """Read and fit the scan of a study, or take D, G and scan area as given there."""
    if spec.scan is None:
        D, G, area = spec.D or 0.0, spec.G or 0.0, spec.scan_area or 0.0
        facts = {"D": D, "G [m]": G, "scan_area [m2]": area, "origin": "given in the study"}
        return Surface(D=D, G=G, scan_area=area, facts=facts)
    scan = read_scan(spec.scan, xy_unit=spec.xy_unit, z_unit=spec.z_unit)
    if not isinstance(scan, Scan) and spec.scan_area is None:
        raise InputError(f"{spec.scan.name} is a line scan, which covers no area; give surface.scan_area as well")
    fit = fit_fractal(scan, method=spec.method)
    area = spec.scan_area or (scan.size[0] * scan.size[1] if isinstance(scan, Scan) else 0.0)
    D, G = spec.D or fit.D, spec.G or fit.G
    facts = {
        "D": D,
        "D_interval": list(fit.D_interval),
        "G [m]": G,
        "G_interval [m]": list(fit.G_interval),
        "scan_area [m2]": area,
        "band [m]": list(fit.band),
        "Rq [m]": fit.Rq,
        "implied_Rq [m]": fit.implied_Rq,
        "method": spec.method,
        "convention": fit.convention,
        "origin": spec.scan.name,
    }
    level = prepared(scan).scan if isinstance(scan, Scan) else None
    return Surface(
        D=D,
        G=G,
        scan_area=area,
        facts=facts,
        warnings=tuple(fit.warnings),
        source=f"scan {spec.scan.name}: {' x '.join(map(str, scan.heights.shape))} points",
        scan=level if isinstance(level, Scan) else None,
    )


def law_of(spec: LawSpec, surface: Surface, pair: ContactPair) -> ContactLaw:
    """Return the law of a study; any but JK that is not given in full takes its inputs from the scan, so needs one."""
    if spec.heights is not None:
        gaps, chance = _heights(spec.heights)
        return MeasuredHeights(
            gaps=gaps,
            chance=chance,
            density=spec.heights.density,
            radius=spec.heights.radius,
            pair=pair,
            **spec.options,
        )
    if spec.table is not None:
        return TabulatedLaw.from_csv(spec.table)
    if spec.model.lower() == "jk":
        return JK(D=surface.D, G=surface.G, scan_area=surface.scan_area, pair=pair, **spec.options)
    if spec.own:
        cls: Any = law_class(spec.model)
        own = dict(spec.options)
        if (asperity := ASPERITIES.get(spec.model.upper())) is not None:
            own["asperity"] = asperity
        return cast(ContactLaw, cls(**own, **({"pair": pair} if any(f.name == "pair" for f in fields(cls)) else {})))
    if surface.scan is None:
        must = needed(law_class(spec.model))
        lacking = ", ".join(name for name in must or () if name not in spec.options)
        own_way = f", or its own parameters under [law] ({lacking})" if lacking else ""
        raise InputError(
            f'law.model = "{spec.model}" takes its inputs from an areal scan; give surface.scan{own_way}, or use "jk"'
        )
    inputs = SurfaceInputs.from_heights(surface.scan.heights, surface.scan.spacing, D=surface.D, G=surface.G)
    made, left_out = laws_of_surface(inputs, pair, names=[spec.model], scan=surface.scan)
    if left_out:
        raise InputError(f'law.model = "{spec.model}": {next(iter(left_out.values()))}')
    law = next(iter(made.values()))
    return law.with_(**spec.options) if spec.options else law


def _heights(spec: HeightsSpec) -> tuple[Array, Array]:
    """Gaps [m] and their probability density from a file of two columns."""
    table = read_numbers(spec.file, 2, "measured heights have the columns gap and probability density")
    return table[:, 0] * units.parse(f"1 {spec.unit}", "m", name="law.gaps_unit"), table[:, 1]


def law_facts(law: ContactLaw) -> dict[str, Any]:
    """Return the parameters of a law and what it derives from them, by name with unit."""
    own = {
        name: getattr(law, name) for name in law.parameters if isinstance(getattr(law, name, None), float | int | str)
    }
    facts: dict[str, Any] = {"name": law.name, **own, "greatest_pressure [Pa]": law.greatest_pressure}
    if isinstance(law, JK):
        facts |= {
            "E_star [Pa]": law.pair.E_star,
            "G_star [Pa]": law.pair.G_star,
            "hardness [Pa]": law.pair.hardness,
            "limits [m2]": list(law.limits),
        }
    return facts
