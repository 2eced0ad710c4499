"""What the two faces of a joint make together: the rough surface whose gap to a plane is the gap between the two."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf, nan, sqrt
from pathlib import Path
from typing import Any, final

import numpy as np

from faying.contact.inputs import FractalSurface, RoughSurface, SurfaceInputs
from faying.errors import FayingError, InputError, shown
from faying.surface.combine import combine
from faying.surface.estimators.table import METHODS
from faying.surface.form import Prepared, levelled, prepared
from faying.surface.fractal import fit_fractal
from faying.surface.fractal_fit import FractalFit
from faying.surface.heights import usable
from faying.surface.scan import Profile, Scan
from faying.typing import Array
from faying.units import show

MIN_G = 1e-300  # m
# correlation of a scan with its shifted mirror image: from which they are no two faces (a fifth in the rms of both; one
# in ten self-affine scans has as much by chance), and up to which they are unrelated
RELATED, UNRELATED = 0.4, 0.02
Counter = Scan | str  # the other face: its scan, "same" or "smooth"
COUNTERS = ("same", "smooth")
GIVEN = "as given"


@final
@dataclass(frozen=True, kw_only=True)
class RoughPair:
    """Two faces as one rough surface. What nobody asks for is not computed; what was asked for is not computed again.

    A line scan stands for the isotropic surface that it is cut from: D is that of the line plus 1, and G is that of the
    surface, `FractalFit.surface_G`. Laws take G of the surface, the power of all directions together.

    Args:
        face: the scan of one face; or the numbers of both faces together, and then only `stated` is given besides.
        counter: the scan of the other face; "same", alike in its statistics but unrelated point by point; or "smooth".
        method: estimator of D and G; with two scans the spectrum is taken.
        D, G: of both faces together [-], [m], in place of those that are fitted.
        scan_area: [m2], in place of that of the scan; needed for a line scan.
        cache: folder that keeps solved contacts of the surface.
        stated: where numbers come from that were given in place of a scan, in words.
        made: the rough surface itself, in place of what would be made from all others.

    Raises:
        InputError: for what is not a scan, another counter, a line scan without scan_area, or numbers out of range.
    """

    face: Scan | Profile | FractalSurface
    counter: Counter = "same"
    method: str = "psd"
    D: float | None = None
    G: float | None = None
    scan_area: float | None = None
    cache: Path | None = None
    stated: str = GIVEN
    made: RoughSurface | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if isinstance(self.face, FractalSurface):
            return
        if not isinstance(self.face, Scan | Profile):
            raise InputError(
                f"a face is given as {type(self.face).__name__}; give a scan as faying.read_scan returns it, or D, G "
                "and scan_area with Mates.of_fractal"
            )
        if not isinstance(self.counter, Scan | str) or (isinstance(self.counter, str) and self.counter not in COUNTERS):
            given = f'"{self.counter}"' if isinstance(self.counter, str) else type(self.counter).__name__
            raise InputError(f'counter = {given}; give the scan of the other face, "same" or "smooth"')
        if not isinstance(self.method, str) or self.method not in METHODS:
            raise InputError(f"method = {shown(self.method)}; allowed: {', '.join(METHODS)}")
        if isinstance(self.face, Profile) and self.scan_area is None:
            raise InputError(f"{self.face.source} is a line scan, which covers no area; give surface.scan_area as well")
        if isinstance(self.face, Profile) and isinstance(self.counter, Scan):
            raise InputError(f"{self.face.source} is a line scan; two faces need two areal scans")
        if self.D is not None and not 2 < self.D < 3:
            raise InputError(f"D = {self.D}: the dimension of a surface is between 2 and 3, for example 2.4")
        for name, value in (("G", self.G), ("scan_area", self.scan_area)):
            if value is not None and not 0 < value < inf:
                raise InputError(f"{name} = {value}; it must be positive and finite")

    @property
    def origin(self) -> str:
        """Name of the file of the scan; where numbers come from that were given in place of one."""
        return self.stated if isinstance(self.face, FractalSurface) else Path(self.face.source).name

    @property
    def words(self) -> str:
        """Both faces in one line."""
        if isinstance(self.face, FractalSurface):
            of = self.face
            numbers = f"D {of.D:.4g}, G {show(of.G, 'm')}, scan area {of.scan_area * 1e6:.4g} mm^2"
            return f"both faces together: {numbers}, {self.stated}"
        if isinstance(self.counter, Scan):
            return f"{self.origin} on {Path(self.counter.source).name}"
        if self.counter == "smooth":
            return f"{self.origin} on a smooth face"
        return f"both faces as {self.origin}, unrelated"

    @property
    def fit(self) -> FractalFit | None:
        """D and G of the scan, or of the summed spectra where both faces were measured; None where there are none."""
        return self._fitted[0]

    @cached_property
    def _fitted(self) -> tuple[FractalFit | None, str]:
        """The fit, or why an areal scan has none: laws that do not ask for D and G can go on."""
        if isinstance(self.face, FractalSurface):
            return None, ""
        try:
            if isinstance(self.counter, Scan) and isinstance(self.face, Scan):
                return combine(self.face, self.counter).fit, ""
            return fit_fractal(self.face, method=self.method), ""
        except FayingError as fault:
            if not isinstance(self.face, Scan):
                raise
            usable(self.face)
            return None, f"no D and G: {fault}"

    @cached_property
    def unfitted(self) -> RoughSurface:
        """What laws are made from that take neither D nor G: both are NaN where they are not given.

        The heights are those of the sum: of the two scans, laid face to face, or of the scan and its mirror image,
        shifted by half a side.
        """
        if self.made is not None:
            return self.made
        if isinstance(self.face, FractalSurface):
            return RoughSurface(inputs=self.face)
        area = self.scan_area or (self.face.size[0] * self.face.size[1] if isinstance(self.face, Scan) else 0.0)
        fractal = {"D": self.D or nan, "G": self.G or nan, "scan_area": area}
        if not isinstance(self.face, Scan):
            return RoughSurface(inputs=FractalSurface(**fractal))
        ready = prepared(self.face)
        inputs, heights = _numbers(ready, fractal), ready.scan
        if isinstance(self.counter, Scan):
            other = prepared(self.counter)
            inputs, heights = _added(inputs, _numbers(other, fractal)), face_to_face(ready.scan, other.scan)
        elif self.counter == "same":
            inputs, heights = _added(inputs, inputs), _on_its_like(ready.scan)
        return RoughSurface(inputs=inputs, scan=heights, cache=self.cache)

    @cached_property
    def rough(self) -> RoughSurface:
        """What any law is made from, with D and G of both faces together; NaN where they cannot be fitted."""
        if self.made is not None or isinstance(self.face, FractalSurface):
            return self.unfitted
        fit, why = self._fitted
        dimension, roughness = self.D or (fit.D if fit else nan), self.G or nan
        if not self.G and fit:
            factor = 2.0 if self.counter == "same" else 1.0
            roughness = together(fit.surface_G, dimension, factor)
        inputs = replace(self.unfitted.inputs, D=dimension, G=roughness)
        return replace(self.unfitted, inputs=inputs, unfitted=why)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the fit of the scan warns of, and what its file says."""
        if self.fit is not None:
            return (*self.fit.warnings, *self._of_a_line(self.fit))
        return (self.rough.unfitted,) if self.rough.unfitted else ()

    def _of_a_line(self, fit: FractalFit) -> tuple[str, ...]:
        """What is assumed where G of a surface is taken from a line."""
        if fit.areal or self.G:
            return ()
        factor = fit.surface_G / fit.G
        return (f"G is {factor:.3g} times that of the line, which counts as a cut through an isotropic surface",)

    def with_numbers(self, **changes: float) -> "RoughPair":
        """The same faces with some of D, G [m] and scan_area [m2] of both together changed; nothing is fitted anew."""
        out = replace(self, made=replace(self.rough, inputs=replace(self.rough.inputs, **changes)))
        out.__dict__["_fitted"] = self._fitted
        return out


def together(G: float, D: float, factor: float = 2.0) -> float:
    """G [m] of two unrelated faces, from that of one of them.

    Args:
        G: of one face [m].
        D: of both [-]; above 2.
        factor: spectral density of both over that of the one; 2 where they are alike, 1 where the other is smooth.

    Returns:
        G of both: spectral densities add, and G^(2 D - 4) goes with them. Near D = 2 a fitted G underflows; it is at
        least 1e-300.
    """
    return float(max(G * factor ** (1 / (2 * D - 4)), MIN_G))


def faces_of(scan: Scan | Profile, counter: Counter = "same", **options: Any) -> RoughPair:
    """Return both faces of a joint from the scan of one and what the other is; options: those of `RoughPair`."""
    return RoughPair(face=scan, counter=counter, **options)


def _numbers(ready: Prepared, fractal: dict[str, float]) -> SurfaceInputs:
    # slopes and curvatures come from measured heights alone: points that were filled in would smooth them
    measured = np.where(ready.known, ready.scan.heights, np.nan)
    inputs = SurfaceInputs.from_heights(measured, ready.scan.spacing, D=fractal["D"], G=fractal["G"])
    return replace(inputs, **fractal)


def _added(one: SurfaceInputs, other: SurfaceInputs) -> SurfaceInputs:
    """Numbers of the sum of two unrelated surfaces: moments add."""
    return replace(
        one,
        m0=one.m0 + other.m0,
        m2=one.m2 + other.m2,
        m4=one.m4 + other.m4,
        slope=sqrt(one.slope**2 + other.slope**2),
        h_rms=sqrt(one.h_rms**2 + other.h_rms**2),
        shortest=max(one.shortest, other.shortest),
        mean_slope=sqrt(one.mean_slope**2 + other.mean_slope**2),
    )


def _on_its_like(scan: Scan) -> Scan:
    """A scan on its own mirror image, which is how a part lies on its like, shifted by half the side along y.

    A wave meets its mirror image, which is another wave of the scan unless it runs along x or y; the shift leaves no
    point that meets itself. Marks along x or y would cancel or double by where they end: then the nearest shift is
    taken at which both images are unrelated.
    """
    from scipy.fft import irfft2, rfft2

    z, mirrored, shift = scan.heights, scan.heights[:, ::-1], (scan.shape[0] // 2, 0)
    one, other, square = z - z.mean(), mirrored - z.mean(), float(z.var()) * z.size or 1.0
    if abs(np.vdot(one, np.roll(other, shift, axis=(0, 1)))) > RELATED * square:
        alike = np.abs(irfft2(rfft2(one) * rfft2(other).conj(), z.shape)) / square
        rows, columns = np.nonzero(alike <= max(UNRELATED, float(alike.min())))
        nearest = np.argmin((rows - shift[0]) ** 2 + np.minimum(columns, z.shape[1] - columns) ** 2)
        shift = int(rows[nearest]), int(columns[nearest])
    words = f"laid on its mirror image, shifted by {shift[0] / scan.shape[0]:.3g} of the side"
    return scan.with_heights(z + np.roll(mirrored, shift, axis=(0, 1)), words)


def face_to_face(first: Scan, second: Scan) -> Scan:
    """Return the sum of two height maps, the second turned over about its x axis as it lies on the first.

    Where spacings differ both are read at the finer one, by cubic splines; where sizes differ the common middle is
    taken, levelled anew. Raises InputError where less than 16 points a side are common.
    """
    step = min(first.spacing[0], second.spacing[0]), min(first.spacing[1], second.spacing[1])
    maps = [_at_spacing(scan, step) for scan in (first, second)]
    rows, columns = (min(m.shape[axis] for m in maps) for axis in (0, 1))
    if min(rows, columns) < 16:
        raise InputError(
            f"the faces share {rows} x {columns} points of {step[0]:.3g} m; at least 16 each way are needed: measure "
            "both over like sizes"
        )
    cut = []
    for heights in maps:
        top, left = (heights.shape[0] - rows) // 2, (heights.shape[1] - columns) // 2
        cut.append(heights[top : top + rows, left : left + columns])
    return levelled(Scan(heights=cut[0] + cut[1][::-1], spacing=step, source=f"{first.source} on {second.source}"))


def _at_spacing(scan: Scan, spacing: tuple[float, float]) -> Array:
    """Heights read at another spacing [m], by cubic splines."""
    from scipy.ndimage import map_coordinates

    if np.allclose(scan.spacing, spacing, rtol=1e-9):
        return scan.heights
    counts = [
        1 + int((n - 1) * old / new) for n, old, new in zip(scan.shape, scan.spacing[::-1], spacing[::-1], strict=True)
    ]
    y, x = (np.arange(n) * new / old for n, old, new in zip(counts, scan.spacing[::-1], spacing[::-1], strict=True))
    return np.asarray(map_coordinates(scan.heights, np.meshgrid(y, x, indexing="ij"), order=3, mode="nearest"))
