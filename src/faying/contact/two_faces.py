"""What the two faces of a joint make together: the rough surface whose gap to a plane is the gap between the two."""

from dataclasses import dataclass, replace
from math import nan, sqrt
from pathlib import Path
from typing import final

import numpy as np

from faying.contact.inputs import FractalSurface, RoughSurface, SurfaceInputs
from faying.errors import FayingError, InputError
from faying.surface.combine import combine
from faying.surface.estimators.table import METHODS
from faying.surface.form import Prepared, levelled, prepared
from faying.surface.fractal import FractalFit, fit_fractal
from faying.surface.scan import Profile, Scan, usable
from faying.typing import Array

LEAST_G = 1e-300  # m
Counter = Scan | str  # the other face: its scan, "same" or "smooth"
COUNTERS = ("same", "smooth")
MEANING = {
    "same": "the other face is taken as statistically alike, unrelated to this one",
    "smooth": "the other face is taken as smooth",
}


@final
@dataclass(frozen=True, kw_only=True)
class Faces:
    """Two faces as one rough surface, with the fit of D and G.

    Args:
        rough: what laws are made from.
        fit: D and G of the scan, or of the summed spectra where both faces were measured; None where there is no fit.
        counter: what the other face is, in words.
    """

    rough: RoughSurface
    fit: FractalFit | None
    counter: str


def faces_of(
    scan: Scan | Profile,
    counter: Counter = "same",
    *,
    method: str = "psd",
    D: float | None = None,
    G: float | None = None,
    scan_area: float | None = None,
    cache: Path | None = None,
    fitted: bool = True,
) -> Faces:
    """Return the rough surface of two faces.

    Args:
        scan: of one face.
        counter: the scan of the other face; "same", alike in its statistics but unrelated point by point; or "smooth".
        method: estimator of D and G; with two scans the spectrum is taken.
        D, G: of both faces together [-], [m], in place of those that are fitted.
        scan_area: [m2], in place of that of the scan; needed for a line scan.
        cache: folder that keeps solved contacts of the surface.
        fitted: whether D and G are fitted; they are NaN where neither fitted nor given.

    Returns:
        Faces. The heights are those of the sum: of the two scans, laid face to face, or of the scan and its mirror
        image, shifted by half a side.

    Raises:
        InputError: for another counter, a line scan without scan_area or a fit, and scans without usable heights.
    """
    if isinstance(counter, str) and counter not in COUNTERS:
        raise InputError(f'counter = "{counter}"; give the file of a scan, "same" or "smooth"')
    if not isinstance(scan, Scan) and scan_area is None:
        raise InputError(f"{scan.source} is a line scan, which covers no area; give surface.scan_area as well")
    if isinstance(counter, Scan) and not isinstance(scan, Scan):
        raise InputError(f"{scan.source} is a line scan; two faces need two areal scans")
    words = f"the other face is {Path(counter.source).name}" if isinstance(counter, Scan) else MEANING[counter]
    fit, unfitted = _fit(scan, counter, method) if fitted else (None, "")
    factor = 2.0 if counter == "same" else 1.0
    area = scan_area or (scan.size[0] * scan.size[1] if isinstance(scan, Scan) else 0.0)
    dimension, roughness = D or (fit.D if fit else nan), G or nan
    if not G and fit:  # twice the spectral density: G^(2 D - 4) doubles; near D = 2 the fitted G underflows
        roughness = max(fit.G * factor ** (1 / (2 * dimension - 4)), LEAST_G)
    fractal = {"D": dimension, "G": roughness, "scan_area": area}
    rough = RoughSurface(inputs=FractalSurface(**fractal))
    if isinstance(scan, Scan):
        ready = prepared(scan)
        inputs = _numbers(ready, fractal)
        if isinstance(counter, Scan):
            other = prepared(counter)
            inputs = _added(inputs, _numbers(other, fractal))
            heights = face_to_face(ready.scan, other.scan)
        elif counter == "same":
            inputs = _added(inputs, inputs)
            heights = _on_its_like(ready.scan)
        else:
            heights = ready.scan
        rough = RoughSurface(inputs=inputs, scan=heights, cache=cache, unfitted=unfitted)
    return Faces(rough=rough, fit=fit, counter=words)


def _fit(scan: Scan | Profile, counter: Counter, method: str) -> tuple[FractalFit | None, str]:
    """D and G, or why an areal scan has none: laws that do not ask for them can go on."""
    if method not in METHODS:
        raise InputError(f"method = {method!r}; allowed: {', '.join(METHODS)}")
    try:
        if isinstance(counter, Scan) and isinstance(scan, Scan):
            return combine(scan, counter).fit, ""
        return fit_fractal(scan, method=method), ""
    except FayingError as fault:
        if not isinstance(scan, Scan):
            raise
        usable(scan)
        return None, f"no D and G: {fault}"


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
    point that meets itself.
    """
    other = np.roll(scan.heights[:, ::-1], scan.shape[0] // 2, axis=0)
    return scan.with_heights(scan.heights + other, "laid on its mirror image, shifted by half the side")


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
