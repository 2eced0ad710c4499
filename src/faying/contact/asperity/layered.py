"""The modulus of a layer on a substrate, as an indenter of contact radius a feels it through the thickness t."""

import numpy as np
from numpy.typing import ArrayLike

from faying.errors import InputError
from faying.typing import Array


def _need(layer: float, substrate: float) -> None:
    if not (0 < layer < np.inf and 0 < substrate < np.inf):
        raise InputError(f"moduli of layer and substrate = {layer}, {substrate} Pa; both must be positive")


def mixed_modulus(layer: float, substrate: float, share: ArrayLike) -> Array:
    """Return E [Pa] of 1/E = x/layer + (1 - x)/substrate, compliances mixed by the layer's share x, 0 to 1."""
    _need(layer, substrate)
    x = np.asarray(share, float)
    if np.any((x < 0) | (x > 1) | np.isnan(x)):
        raise InputError(f"share = {share!r}; the layer's share of the compliance is between 0 and 1")
    return np.asarray(1 / (x / layer + (1 - x) / substrate))


def king_modulus(layer: float, substrate: float, thickness_ratio: ArrayLike, alpha: float = 1.0) -> Array:
    """Return E [Pa] with the share x = 1 - exp(-alpha t/a). Doerner and Nix 1986, doi:10.1557/JMR.1986.0601; King 1987.

    thickness_ratio t/a, 0 or more; alpha the fit to indenter and layer. Raises InputError outside.
    """
    t = np.asarray(thickness_ratio, float)
    if np.any((t < 0) | np.isnan(t)) or alpha <= 0:
        raise InputError(f"thickness_ratio = {thickness_ratio!r}, alpha = {alpha}; t/a is 0 or more and alpha positive")
    return mixed_modulus(layer, substrate, 1 - np.exp(-alpha * t))


def gao_modulus(layer: float, substrate: float, thickness_ratio: ArrayLike, nu: float = 0.3) -> Array:
    """Return E [Pa] = Eb + (Ea - Eb) I0(t/a). Gao, Chiu and Lee 1992, doi:10.1016/0020-7683(92)90004-D.

    I0 = (2/pi) atan xi + {(1 - 2 nu) xi ln[(1 + xi^2)/xi^2] - xi/(1 + xi^2)}/[2 pi (1 - nu)], xi = t/a; nu of both.
    First order in the difference of the moduli. Raises InputError for t/a below 0 or nu outside (-1, 0.5].
    """
    _need(layer, substrate)
    xi = np.asarray(thickness_ratio, float)
    if np.any((xi < 0) | np.isnan(xi)) or not -1 < nu <= 0.5:
        raise InputError(f"thickness_ratio = {thickness_ratio!r}, nu = {nu}; t/a is 0 or more and nu in (-1, 0.5]")
    safe = np.where(xi > 0, xi, 1.0)
    logs = np.where(xi > 0, xi * np.log1p(1 / safe**2), 0.0)
    weight = 2 / np.pi * np.arctan(xi) + ((1 - 2 * nu) * logs - xi / (1 + xi**2)) / (2 * np.pi * (1 - nu))
    return np.asarray(substrate + (layer - substrate) * weight)
