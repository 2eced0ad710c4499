"""Between a cap of radius R and height h_a and the fractal surface that has it: one equation for two unknowns.

With r_a = sqrt(2 R h_a), eq. (4) of the JK paper, h_a = 2^(3-D) G^(D-2) sqrt(ln gamma) r_a^(3-D), holds along a curve
of (D, G); eq. (6) adds nothing, since R = r_a^2/(2 h_a). Give one of D and G. doi:10.3390/fractalfract8100611.
"""

from math import exp, inf, log, sqrt

from faying.errors import InputError


def _cap(R: float, height: float, gamma: float) -> tuple[float, float]:
    if not (0 < R < inf and 0 < height < inf):
        raise InputError(f"R = {R:.6g} m, height = {height:.6g} m; both must be positive")
    if not gamma > 1:
        raise InputError(f"gamma = {gamma}; it must be above 1, for example 1.5")
    return log(2 * R * height) / 2, log(log(gamma)) / 2


def roughness_of_cap(R: float, height: float, *, D: float, gamma: float = 1.5) -> float:
    """Return G [m] of the surface of dimension D whose cap has radius R [m] and height h_a [m]. InputError outside."""
    log_r, half = _cap(R, height, gamma)
    if not 2 < D < 3:
        raise InputError(f"D = {D}; the dimension of a surface is between 2 and 3, for example 2.4")
    return exp((log(height) - (3 - D) * (log(2) + log_r) - half) / (D - 2))


def dimension_of_cap(R: float, height: float, *, G: float, gamma: float = 1.5) -> float:
    """Return D of the surface of roughness G [m] whose cap has radius R [m] and height h_a [m].

    Raises InputError where no D between 2 and 3 has it.
    """
    log_r, half = _cap(R, height, gamma)
    if not 0 < G < inf:
        raise InputError(f"G = {G:.6g} m; it must be positive, for example 1.5e-10")
    # ln h = (3-D) ln(2 r) + (D-2) ln G + ln(ln gamma)/2 is linear in D
    D = (3 * (log(2) + log_r) - 2 * log(G) + half - log(height)) / (log(2) + log_r - log(G))
    if not 2 < D < 3:
        raise InputError(
            f"R = {R:.6g} m, height = {height:.6g} m and G = {G:.6g} m give D = {D:.4g}, outside 2 to 3; "
            "change G, or give D in its place"
        )
    return D


def cap_of_fractal(D: float, G: float, radius: float, *, gamma: float = 1.5) -> tuple[float, float]:
    """Return R and h_a [m] of the cap of base radius r_a [m] on the surface of D and G [m], eqs. (4), (6)."""
    if not 2 < D < 3:
        raise InputError(f"D = {D}; the dimension of a surface is between 2 and 3, for example 2.4")
    if not (0 < G < inf and 0 < radius < inf and gamma > 1):
        raise InputError(
            f"G = {G:.6g} m, radius = {radius:.6g} m, gamma = {gamma}; need positive lengths and gamma above 1"
        )
    height = 2 ** (3 - D) * G ** (D - 2) * sqrt(log(gamma)) * radius ** (3 - D)
    return radius**2 / (2 * height), height
