"""[surface]: the scan of a rough face, or its D, G and area; read and fitted in one place."""

from dataclasses import dataclass, replace
from math import isnan, sqrt
from pathlib import Path
from typing import Any

from faying import cache, units
from faying.contact.inputs import FractalSurface, RoughSurface
from faying.contact.parameter import FRACTAL, Parameter
from faying.contact.two_faces import COUNTERS, Counter, RoughPair
from faying.errors import InputError
from faying.form.waviness import ScanWaves
from faying.study.declaration.declared import QUANTITY, Declared, Key, Put
from faying.study.declaration.reader import Table
from faying.surface.estimators.table import METHODS
from faying.surface.files.read import read_scan
from faying.surface.fractal_fit import FractalFit
from faying.surface.scan import Profile, Scan


@dataclass(frozen=True, kw_only=True)
class SurfaceChoice:
    """The rough surface: a scan with its units and estimator, or D, G [m] and scan_area [m2] as given.

    size or spacing [m]: of a scan whose file states neither. channel: of a file with several maps of heights. counter:
    the other face, the file of its scan, "same" or "smooth"; where D and G are given in place of a scan they are those
    of both faces together.
    """

    scan: Path | None = None
    xy_unit: str | None = None
    z_unit: str | None = None
    size: tuple[float, float] | float | None = None
    spacing: tuple[float, float] | float | None = None
    channel: str | None = None
    method: str = "psd"
    D: float | None = None
    G: float | None = None
    scan_area: float | None = None
    counter: str = "same"

    @classmethod
    def of(cls, table: Table) -> "SurfaceChoice":
        """Read one [surface] table."""
        choice = cls(**{key: table.get(key) for key in SURFACE if key != "counter"}, counter=_counter(table))
        missing = [k for k in ("D", "G", "scan_area") if k not in table.data]
        of_scan = [k for k in SURFACE if k in table.data and k not in ("D", "G", "scan_area")]
        if "scan" not in table.data and missing:
            table.faults.add(f"{table.where}: give scan, or D, G and scan_area ({', '.join(missing)} missing)")
        elif "scan" not in table.data and of_scan:
            table.faults.add(
                f"{table.where}: {' and '.join(of_scan)} would say how a scan is read, and D, G and scan_area stand "
                "in place of one; leave it out"
            )
        elif "scan" in table.data and len(missing) < 3 and not {"D", "G"} <= table.data.keys():
            table.faults.add(
                f"{table.where}: D, G and scan_area belong together, and {' and '.join(missing)} would be those of the "
                "scan; give D and G, or neither of the three"
            )
        if choice.D is not None and not 2 < choice.D < 3:
            table.faults.add(
                f"{table.where}.D = {choice.D}: the dimension of a surface is between 2 and 3, for example 2.4"
            )
        return choice

    def read(self) -> "Surface":
        """Read and fit the scan, or take D, G and the area as given. Raises ReadError and InputError."""
        if self.scan is None:
            inputs = FractalSurface(D=self.D or 0.0, G=self.G or 0.0, scan_area=self.scan_area or 0.0)
            return Surface(faces=RoughPair(face=inputs, stated="given in the study"), origin="given in the study")
        given: dict[str, Any] = {"xy_unit": self.xy_unit, "z_unit": self.z_unit, "channel": self.channel}
        scan = read_scan(self.scan, size=self.size, spacing=self.spacing, **given)
        other: Counter = self.counter
        if self.counter not in COUNTERS:
            found = read_scan(Path(self.counter), **given)
            if not isinstance(found, Scan):
                raise InputError(f"{Path(self.counter).name} is a line scan; two faces need two areal scans")
            other = found
        faces = RoughPair(
            face=scan,
            counter=other,
            method=self.method,
            D=self.D,
            G=self.G,
            scan_area=self.scan_area,
            cache=self.scan.parent / cache.FOLDER,
        )
        _ = faces.rough  # names its own faults
        source = f"scan {self.scan.name}: {' x '.join(map(str, scan.heights.shape))} points"
        return Surface(faces=faces, origin=self.scan.name, source=source)


def _counter(table: Table) -> str:
    value = table.data.get("counter", "same")
    if value in COUNTERS:
        return str(table.get("counter"))
    if isinstance(value, str) and not (table.faults.folder / value).is_file():
        table.faults.add(
            f'{table.where}.counter = "{value}": no such file; give the scan of the other face, "same" or "smooth"'
        )
        table.data.pop("counter")
    return str(table.existing("counter"))


def _lengths(says: str) -> Key:
    """One length or two, x and y, in one text."""
    form = 'text, for example "4 mm x 3 mm"'

    def read(value: Any, name: str) -> tuple[float, float] | float:
        if not isinstance(value, str):
            raise InputError(f"{name} = {value!r} should be {form}")
        return units.lengths(value, name=name)

    return Key(form, QUANTITY, says, read=read, unit="m")


@dataclass(frozen=True, kw_only=True)
class Surface:
    """What a law is made from, and whence it comes.

    Args:
        faces: both faces of a joint; None where the law brings its own heights.
        origin, source: the file, and a line on it.
    """

    faces: RoughPair | None
    origin: str
    source: str = ""

    @property
    def rough(self) -> RoughSurface | None:
        """Both faces of a joint as one surface."""
        return None if self.faces is None else self.faces.rough

    @property
    def fit(self) -> FractalFit | None:
        """D and G where a scan gave them."""
        return None if self.faces is None else self.faces.fit

    @property
    def counter(self) -> str:
        """Both faces in words, where a scan gave one of them."""
        return "" if self.faces is None or self.scans is None else self.faces.words

    @property
    def scans(self) -> tuple[Scan | Profile, Counter] | None:
        """Scan of one face as it was read, and the other face."""
        if self.faces is None or isinstance(self.faces.face, FractalSurface):
            return None
        return self.faces.face, self.faces.counter

    def with_number(self, name: str, value: float) -> "Surface":
        """The surface with one of D, G [m] and scan_area [m2] changed."""
        return self if self.faces is None else replace(self, faces=self.faces.with_numbers(**{name: value}))

    @property
    def scan_area(self) -> float | None:
        """Area of the scan [m2]; None without a surface."""
        return None if self.rough is None else self.rough.inputs.scan_area

    @property
    def waves(self) -> ScanWaves | None:
        """What the surface says of waves longer than its scan; None without a surface."""
        if self.rough is None or isnan(self.rough.inputs.scan_area):
            return None
        root = sqrt(self.rough.inputs.scan_area)
        scan = None if self.scans is None else self.scans[0]
        side = root if scan is None else scan.length if isinstance(scan, Profile) else max(scan.size)
        fit = self.fit
        if fit is None or isnan(fit.implied_Rq):
            return ScanWaves(side=side)
        return ScanWaves(side=side, Rq=fit.implied_Rq, length=root, hurst=3 - fit.D)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the fit of the scan warns of, and what its file says."""
        return () if self.faces is None else self.faces.warnings

    def facts(self) -> dict[str, Any]:
        """Numbers of the surface by name with unit, for the result."""
        if self.rough is None:
            return {"origin": self.origin}
        inputs = self.rough.inputs
        given = {"D": inputs.D, "G [m]": inputs.G, "scan_area [m2]": inputs.scan_area}
        given = {name: value for name, value in given.items() if not isnan(value)}
        if self.fit is None:
            return given | {"origin": self.origin} | ({"counter": self.counter} if self.counter else {})
        fitted = {
            "fitted_D": self.fit.D,
            "fitted_G [m]": self.fit.G,
            "D_interval": list(self.fit.D_interval),
            "G_interval [m]": list(self.fit.G_interval),
            "band [m]": list(self.fit.band),
            "Rq [m]": self.fit.Rq,
            "implied_Rq [m]": self.fit.implied_Rq,
            "method": self.fit.method,
            "convention": self.fit.convention,
        }
        return given | fitted | {"origin": self.origin, "counter": self.counter}


def _in_surface(name: str) -> Put:
    return lambda surface, value: surface.with_number(name, value)


NO_SURFACE = Surface(faces=None, origin="none: the contact law brings its own heights")

SURFACE: Declared = {
    "scan": Key.file("Scan of one face: X3P, text, or an instrument's format."),
    "xy_unit": Key.length_unit("Unit of x and y, where the file states none."),
    "z_unit": Key.length_unit("Unit of the heights, where the file states none."),
    "size": _lengths("Size of the scan, where the file states neither size nor spacing."),
    "spacing": _lengths("Spacing of the points, where the file states neither size nor spacing."),
    "channel": Key.text("Name of the map of heights, where the file of the scan holds several.", None),
    "method": Key.text("Estimator of D and G.", "psd", examples=lambda: METHODS),
    "D": replace(
        Key.number("Fractal dimension of both faces together, between 2 and 3."), parameter=FRACTAL["D"]
    ).varying(_in_surface("D")),
    "G": Key.of_parameter(  # fits find less than any length has: 7e-15 m at D = 2.31
        Parameter("m", "Fractal roughness of both faces together, in the convention of Yan and Komvopoulos.", 0)
    ).varying(_in_surface("G")),
    "scan_area": Key.quantity("m^2", "Area of the scan that D and G come from.").varying(_in_surface("scan_area")),
    "counter": Key.text(
        'The other face: "same" (alike in its statistics, unrelated point by point), "smooth", or the file of its '
        "scan.",
        "same",
        examples=lambda: COUNTERS,
    ),
}
