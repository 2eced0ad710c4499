"""Two rough surfaces in contact as one: the surface whose gap to a plane is the gap between the two."""

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from faying.errors import InputError, NotConverged
from faying.surface.convention import prefactor
from faying.surface.estimators.spectral import clean_spectrum, of_law
from faying.surface.form import Prepared, prepared
from faying.surface.fractal_fit import Facts, FractalFit, result
from faying.surface.powerlaw import fit, fit_band, smearing, supported_band
from faying.surface.scan import Scan
from faying.surface.spectrum import Spectrum
from faying.typing import Array


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Combined:
    """The equivalent surface of two unrelated rough surfaces.

    Args:
        fit: D and G with intervals, from the sum of the two spectra over the wavelengths that both scans cover.
        Rq: root of the sum of the squares of the rms heights [m].
        m0: sum of the mean square heights [m2].
        m2: sum of the mean square slopes [-], each at the shortest wavelength of its scan.
        m4: sum of the mean square curvatures [1/m2], in the same way.
        frequency: of the summed spectrum [1/m].
        density: of the summed spectrum [m3].
    """

    fit: FractalFit
    Rq: float
    m0: float
    m2: float
    m4: float
    frequency: Array
    density: Array


def _whole(ready: Prepared) -> tuple[Spectrum, Array]:
    """Spectrum, and its densities freed of the window's smearing by the slope fitted to it."""
    s, _ = clean_spectrum(ready.scan)
    law = fit(s, *supported_band(s))
    return s, s.density / smearing(s, s.frequency, law.slope)[0]


def _summed(a: tuple[Spectrum, Array], b: tuple[Spectrum, Array]) -> Spectrum:
    """The sum of two spectra on the bins of the first, where the second reaches too."""
    (sa, da), (sb, db) = a, b
    inside = (sa.frequency >= sb.frequency[0]) & (sa.frequency <= sb.frequency[-1])
    f = sa.frequency[inside]
    other = np.exp(np.interp(np.log(f), np.log(sb.frequency), np.log(np.maximum(db, 1e-300))))
    total = da[inside] + other
    spread_b = np.interp(f, sb.frequency, sb.spread)
    return replace(
        sa,
        frequency=f,
        density=total,
        count=sa.count[inside],
        uneven=sa.uneven[inside],
        width=sa.width[inside],
        # variances of the two parts, relative to the sum
        spread=np.sqrt((sa.spread[inside] * da[inside]) ** 2 + (spread_b * other) ** 2) / total,
        curvature=0.0,
    )


def _moments(ready: Prepared) -> Array:
    """Mean squares of height [m2], slope [-] and curvature [1/m2] of the profiles along x and y (3,)."""
    z, (dx, dy) = ready.scan.heights, ready.scan.spacing
    bends = [(np.diff(z, order, axis=1) / dx**order, np.diff(z, order, axis=0) / dy**order) for order in (1, 2)]
    return np.array([z.var(), *(np.mean([np.mean(bend**2) for bend in both]) for both in bends)])


def combine(
    scan_a: Scan, scan_b: Scan, *, degree: int = 1, convention: str = "yan-komvopoulos", gamma: float = 1.5
) -> Combined:
    """Return the equivalent rough surface of two scans in contact: spectra and moments add, heights being unrelated.

    Args:
        scan_a: one surface; levelled, freed of spikes and filled in first.
        scan_b: the other; its size and spacing may differ.
        degree: of the polynomial that levels both, 0 to 8.
        convention: of D and G, as in `fit_fractal`.
        gamma: ratio of neighbouring frequencies in that series, above 1.

    Returns:
        Combined; D and G from the wavelengths that both scans cover.

    Raises:
        InputError: for anything but two areal scans, and where the bands of wavelength do not overlap by a factor of 4.
    """
    for name, scan in (("scan_a", scan_a), ("scan_b", scan_b)):
        if not isinstance(scan, Scan):
            raise InputError(f"{name} is a {type(scan).__name__}: two areal scans (faying.Scan) can be combined")
    c = prefactor(convention, gamma)
    ready = prepared(scan_a, degree=degree), prepared(scan_b, degree=degree)
    wholes = _whole(ready[0]), _whole(ready[1])
    bands = [
        supported_band(s, resolution=r.scan.instrument.resolution) for (s, _), r in zip(wholes, ready, strict=True)
    ]
    low, high = max(b[0] for b in bands), min(b[1] for b in bands)
    if high < 4 * low:
        raise InputError(
            f"the scans share no band of wavelengths ({1 / high:.3g} .. {1 / low:.3g} m); measure both over like sizes"
        )
    joint = _summed(*wholes)
    try:
        law, notes = fit_band(joint, low, high)
    except NotConverged as fault:
        raise InputError(f"the scans share too few wavelengths ({fault})") from fault
    m0, m2, m4 = (float(moment) for moment in _moments(ready[0]) + _moments(ready[1]))
    # heights add as squares, lengths are those of the larger
    facts = Facts(
        Rq=m0**0.5,
        Ra=float((2 / np.pi * m0) ** 0.5),
        length=max(min(scan_a.size), min(scan_b.size)),
        missing=sum(r.missing for r in ready),
        spikes=sum(r.spikes for r in ready),
        areal=True,
        notes=scan_a.notes + scan_b.notes,
    )
    return Combined(
        fit=result(of_law(law, c, notes=notes), facts, method="psd", convention=convention, gamma=gamma, drawn=joint),
        Rq=m0**0.5,
        m0=m0,
        m2=m2,
        m4=m4,
        frequency=joint.frequency,
        density=joint.density,
    )
