"""A contact law as the tables that other programs read: pressure over closure, friction, conductance of heat."""

from dataclasses import dataclass
from textwrap import wrap

import numpy as np

from faying.checks import choice, number
from faying.contact.conductance import heat_conductance
from faying.contact.law import ContactLaw
from faying.decks.deck import UnitSystem
from faying.joint.joint_law import JointLaw
from faying.typing import Array

PROGRAMS = ("abaqus", "calculix")
WIDTH = 76  # of a comment
POINTS = 40  # pressures of a table: CalculiX 2.20 crashes at 60; a straight line between two misses a closure by 1e-3
FIRST, LAST = 1e4, 1e8  # Pa, as far as the law covers them
METALS = "clean metal in vacuum; films hinder the flow, gas and grease help it"


@dataclass(frozen=True, kw_only=True)
class _Table:
    """What both programs get, in the units of the model: closure and conductance over pressure, and friction.

    secant, shear: pressure over closure, and k_t, at one pressure `at`.
    """

    pressure: Array
    closure: Array
    conductance: Array | None
    at: float
    secant: float
    shear: float
    friction: float | None


def law_tables(
    law: ContactLaw,
    program: str,
    *,
    unit: str,
    force_unit: str = "N",
    name: str = "JOINT",
    friction: float | None = None,
    pressure: float | str | None = None,
) -> str:
    """Write a contact law as the contact properties of another program.

    Pressure over closure is that of first loading, from first touch to 100 MPa or the end of the law. CalculiX 2.20
    reads such a table in contact from node to surface, where its conductance ignores the pressure; from surface to
    surface the table carries nothing. So heat has an interaction of its own there. Conductance follows from k_n where
    both materials have a conductivity, and is left out else.

    Args:
        law: The law.
        program: "abaqus" or "calculix", to be included before the steps.
        unit, force_unit: Of the model, such as "mm" and "N".
        name: Of the interaction.
        friction: Coefficient of friction [-], 0 to 10; that of the materials where None and they have one.
        pressure: Where what has one number in the deck is taken [Pa], or text with a unit: the stiffness of sticking,
            and the secant of the closure; within the table, its middle where None.

    Returns:
        The text.

    Raises:
        InputError: Another program or unit, a law without stiffness, a number out of range.

    Source:
        CalculiX CrunchiX 2.20, *SURFACE BEHAVIOR, *FRICTION and *GAP CONDUCTANCE; Abaqus keywords of the same names.
    """
    choice(program, "program", PROGRAMS)
    system = UnitSystem(unit, force_unit)
    if friction is not None:
        friction = number(friction, "friction", least=0, greatest=10, ends="[]")
    table = _table(law, system, friction, pressure)
    head = [
        f"{law.name}: {law.source}",
        f"on first loading; valid where: {law.validity}",
        system.describe(),
    ]
    if program == "calculix":
        head.append("*CONTACT PAIR needs TYPE=NODE TO SURFACE: from surface to surface such a table carries nothing")
    if table.conductance is not None:
        head.append(f"conductance: {METALS}")
    if table.friction is not None:
        head.append(f"friction sticks with k_t at {table.at:.4g} {force_unit}/{unit}2")
    return _keywords(table, head, name, program)


def _table(law: ContactLaw, system: UnitSystem, friction: float | None, pressure: float | str | None) -> _Table:
    joint = JointLaw(model=law)
    joint.check()
    last = min(LAST, law.greatest_pressure * (1 - 1e-12))
    p = np.geomspace(max(joint.least_pressure, min(FIRST, 1e-3 * last)), last, POINTS)
    k_n, _ = joint.stiffness(p, tabulated=True)
    wanted = float(p[len(p) // 2]) if pressure is None else pressure
    at = number(wanted, "pressure", "Pa", least=p[0], greatest=p[-1], ends="[]")
    pair = law.made_for
    conductance = None
    if pair is not None:
        conducts = all(not m.is_rigid and m.conductivity is not None for m in (pair.first, pair.second))
        # W/m2 is N/(m s): pressure times speed
        conductance = heat_conductance(k_n, pair) * system.pressure * system.metre if conducts else None
    return _Table(
        pressure=p * system.pressure,
        closure=np.array([joint.approach(float(one)) for one in p]) * system.metre,
        conductance=conductance,
        at=at * system.pressure,
        secant=at / joint.approach(at) * system.density,
        shear=float(joint.stiffness(np.array([at]))[1][0]) * system.density,
        friction=friction_of(law) if friction is None else friction,
    )


def friction_of(law: ContactLaw) -> float | None:
    """Coefficient of friction of the materials of a law; None where it has none, or they do not say it."""
    return None if law.made_for is None else law.made_for.known_friction


def _keywords(table: _Table, head: list[str], name: str, program: str) -> str:
    """*SURFACE INTERACTION of Abaqus and CalculiX."""
    lines = [f"** {line}" for text in head for line in wrap(text, WIDTH)]
    lines += [f"*SURFACE INTERACTION,NAME={name}", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR", "0.,0."]
    lines += [f"{p:.9e},{w:.9e}" for p, w in zip(table.pressure, table.closure, strict=True)]
    calculix = program == "calculix"
    if table.friction is not None:  # Abaqus has no stiffness of sticking, but the slip at which friction is reached
        slip = table.friction * table.at / table.shear
        lines.append("*FRICTION" if calculix else f"*FRICTION,ELASTIC SLIP={slip:.9e}")
        lines.append(f"{table.friction},{table.shear:.9e}" if calculix else f"{table.friction}")
    if table.conductance is None:
        return "\n".join(lines) + "\n"
    if calculix:
        lines += [f"** heat alone, with TYPE=SURFACE TO SURFACE: closure by its secant at {table.at:.4g}"]
        lines += [
            f"*SURFACE INTERACTION,NAME={name}_HEAT",
            "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR",
            f"{table.secant:.9e}",
        ]
    lines.append("*GAP CONDUCTANCE" if calculix else "*GAP CONDUCTANCE,PRESSURE")
    lines += [f"{h:.9e},{p:.9e}" for h, p in zip(table.conductance, table.pressure, strict=True)]
    return "\n".join(lines) + "\n"
