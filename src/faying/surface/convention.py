"""D and G in one convention: what a power spectrum, a structure function and an rms height say of them.

D is the dimension of the surface (2 < D < 3), Ds = D - 1 that of its profiles, G the fractal roughness [m], f a
frequency in cycles per metre. The spectral density per radial frequency (for a surface the power of all directions
together, for a profile its one-sided spectrum) is

    S(f) = c G^(2Ds-2)/2 f^-(5-2Ds)

with c = 1 for the Weierstrass-Mandelbrot function of Yan and Komvopoulos (doi:10.1063/1.368536, eq. 5, the one of the
JK model) and c = 1/ln(gamma) for that of Majumdar and Bhushan (doi:10.1115/1.2920243), which lacks the factor
(ln gamma)^(1/2). A profile cut from an isotropic surface carries `cut_factor(D)` times the S of the surface.
"""

from math import cos, exp, gamma, lgamma, log, pi

from faying.checks import number, shown
from faying.errors import InputError

NAMES = ("yan-komvopoulos", "majumdar-bhushan")


def prefactor(convention: str, wm_gamma: float) -> float:
    """Return c of the module's formula. Raises InputError for an unknown convention or gamma <= 1."""
    if not isinstance(convention, str) or convention not in NAMES:
        raise InputError(
            f'convention = {shown(convention)}; allowed: "{NAMES[0]}" (c = 1), "{NAMES[1]}" (c = 1/ln gamma)'
        )
    if not number(wm_gamma, "gamma") > 1:
        raise InputError(f"gamma = {wm_gamma}: the ratio of neighbouring frequencies is greater than 1, usually 1.5")
    return 1.0 if convention == NAMES[0] else 1 / log(wm_gamma)


def check_dimension(D: float) -> float:
    """Return D, or raise InputError where it is not the dimension of a surface."""
    return number(D, "D, the dimension of a surface,", least=2, greatest=3)


def cut_factor(D: float) -> float:
    """Mean of |cos|^(4-2Ds) over all directions [-]: profile spectrum over radial spectrum of an isotropic surface."""
    p = 6 - 2 * D
    return exp(lgamma(p / 2 + 0.5) - lgamma(p / 2 + 1)) / float(pi**0.5)


def density(D: float, G: float, c: float = 1.0) -> float:
    """Return B of S(f) = B f^-(7-2D) [m^(2D-4)]."""
    return float(c * G ** (2 * D - 4) / 2)


def G_from_density(D: float, log_density: float, c: float = 1.0) -> float:
    """Return G [m] from ln B of S(f) = B f^-(7-2D); 0 or infinity where the number leaves the floating range."""
    exponent = (log_density + log(2 / c)) / (2 * D - 4)
    return exp(exponent) if -700 < exponent < 700 else (0.0 if exponent < 0 else float("inf"))


def structure_coefficient(D: float) -> float:
    """Return SF(tau) tau^-(6-2D) / (c G^(2D-4)) [-]: the integral of 2 (1 - cos(2 pi f tau)) S(f) over f.

    It equals (2 pi)^(4-2Ds) Gamma(2Ds-3) sin((2Ds-3) pi/2)/(4-2Ds); the pole of Gamma at Ds = 1.5 is removed by
    Gamma(s) sin(pi s/2) = pi / (2 Gamma(1-s) cos(pi s/2)).
    """
    s = 2 * D - 5
    return float((2 * pi) ** (1 - s) * pi / (2 * gamma(1 - s) * cos(pi * s / 2)) / (1 - s))


def implied_Rq(D: float, G: float, length: float, c: float = 1.0) -> float:
    """Rms height [m] of all wavelengths up to `length` [m]: Rq^2 = c G^(2Ds-2) L^(4-2Ds) / (2 (4-2Ds))."""
    return float((c * G ** (2 * D - 4) * length ** (6 - 2 * D) / (2 * (6 - 2 * D))) ** 0.5)


def G_from_Rq(D: float, Rq: float, length: float, c: float = 1.0) -> float:
    """Return the G [m] whose implied Rq over `length` is `Rq` [m] (both positive, InputError else)."""
    check_dimension(D)
    for name, value in (("Rq", Rq), ("length", length)):
        number(value, name, "m", least=0)
    return G_from_density(D, log(Rq**2 * (6 - 2 * D)) - (6 - 2 * D) * log(length), c)
