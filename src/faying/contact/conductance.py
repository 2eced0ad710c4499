"""Conductance of heat and of current across a contact, from its stiffness."""

import numpy as np
from numpy.typing import ArrayLike

from faying.errors import InputError
from faying.materials import ContactPair
from faying.typing import Array


def contact_conductance(k_n: ArrayLike, *, E_star: float, resistivities: tuple[float, float]) -> Array:
    """Return the conductance of a contact per nominal area from its normal stiffness: 2 k_n/(E* (r_1 + r_2)).

    The potential of a steady flow between two half-spaces obeys the same equations as the normal displacement under
    further load, whatever the shape and number of the spots that touch. It holds for clean metal in vacuum: films of
    oxide or dirt hinder the flow, gas or grease in the gaps help it, and neither is part of it. k_n is the elastic
    stiffness against a small change of load, with the contact that the load has made, flattened or not.

    Args:
        k_n: normal stiffness per area [Pa/m], any shape, or of a whole contact [N/m].
        E_star: contact modulus of the pair [Pa], greater than 0.
        resistivities: of both bodies, greater than 0 in sum: 1/K [m K/W] for heat, rho [ohm m] for current.

    Returns:
        h [W/(m2 K)] or [S/m2], of the shape of k_n; [W/K] or [S] for a whole contact.

    Raises:
        InputError: the modulus or the resistivities are not positive.

    Source:
        Barber 2003, doi:10.1098/rspa.2002.1038.
    """
    total = sum(resistivities)
    if not (E_star > 0 and min(resistivities) >= 0 and total > 0 and np.isfinite(E_star + total)):
        raise InputError(
            f"a conductance needs a positive modulus and positive resistivities; got E* = {E_star:g} Pa and "
            f"{resistivities[0]:g}, {resistivities[1]:g}"
        )
    return np.asarray(2 * np.asarray(k_n, dtype=float) / (E_star * total))


def heat_conductance(k_n: ArrayLike, pair: ContactPair) -> Array:
    """Return the conductance of heat of a contact per nominal area from its normal stiffness, for a pair of materials.

    Args:
        k_n: normal stiffness per area [Pa/m] against a small change of load, not the slope of first loading; any shape.
        pair: the materials, both with their conductivity [W/(m K)].

    Returns:
        h [W/(m2 K)], of the shape of k_n; see `contact_conductance` for what it holds for.

    Raises:
        InputError: a material has no conductivity, or one is the rigid plane.

    Source:
        Barber 2003, doi:10.1098/rspa.2002.1038.
    """
    if pair.first.is_rigid or pair.second.is_rigid:
        raise InputError(
            "conductance of heat needs two bodies that conduct; the rigid plane does not: name the material of the "
            'other face, for example against "same"'
        )
    without = sorted({m.name for m in (pair.first, pair.second) if m.conductivity is None})
    if without:
        raise InputError(
            f"conductance of heat needs the conductivity of both materials; {' and '.join(map(repr, without))} "
            f"{'has' if len(without) == 1 else 'have'} none: give conductivity, for example 50 W/(m K)"
        )
    first, second = (1 / (m.conductivity or 1.0) for m in (pair.first, pair.second))
    return contact_conductance(k_n, E_star=pair.E_star, resistivities=(first, second))
