"""Steps R0 to R13 of VDI 2230 for one bolt, under a concentric working load."""

import re
from collections.abc import Callable
from dataclasses import replace
from inspect import signature
from math import pi, sqrt, tan

from faying.bolt.fatigue import endurance, rolled_after
from faying.bolt.vdi2230 import reduced_stress, thread_torque, tightening_torque
from faying.sheet.rows import Step

GUIDELINE = "VDI 2230 Part 1:2015"
STRIPPING = 0.897  # C_3 for a bolt that is stronger than the tapped part (Alexander 1977), the least that it can be
SHEAR = 0.6  # shear strength of a bolt over its tensile strength, at least (VDI 2230 Part 1:2015, section 5.5.6)


def working_stress(F: float, d_0: float, torque: float) -> float:
    """Von Mises stress [Pa] in service: half of the greatest elastic shear stress of tightening is left."""
    return sqrt((F / (pi / 4 * d_0**2)) ** 2 + 3 * (0.5 * torque / (pi / 16 * d_0**3)) ** 2)


def engagement(*, R_m: float, A_S: float, tau_B: float, d: float, d_2: float, P: float) -> float:
    """Length of engagement [m] at which the tapped thread strips when the bolt breaks."""
    ring = pi * d * (0.5 + (d - d_2) * tan(pi / 6) / P)
    return R_m * A_S / (STRIPPING * tau_B * ring)


def _step(head: str, formula: str, function: Callable[..., float], **given: str) -> Step:
    """A step whose function names its inputs, as symbols; head: "R1 symbol [unit]: name"; given: limit and source."""
    step, symbol, unit, name = re.fullmatch(r"(\w+) (\w+) \[(.+)\]: (.+)", head).groups()  # type: ignore[union-attr]
    return Step(
        step=step,
        symbol=symbol,
        name=name,
        unit="" if unit == "-" else unit,
        formula=formula,
        inputs=tuple(signature(function).parameters),
        function=function,
        **{"source": f"{GUIDELINE}, {step}"} | given,
    )


LOST = "embedding over the compliances of bolt and parts"
STEPS = (
    _step(
        "R0 A_req [m^2]: stress area that the greatest preload needs",
        "preload times (1 + scatter), over the stress under proof load",
        lambda F_V, s, S_p: F_V * (1 + s) / S_p,
        limit="A_S",
        source="ISO 898-1:2013, Table 3",
    ),
    _step(
        "R1 alpha_A [-]: tightening factor",
        "greatest over least preload: (1 + scatter) over (1 - scatter)",
        lambda s: (1 + s) / (1 - s),
    ),
    _step(
        "R2 F_KQ [N]: clamp load that friction needs",
        "transverse load over the friction of the joint",
        lambda F_Q, mu_T: F_Q / mu_T if F_Q else 0.0,
    ),
    _step(
        "R2 F_Kreq [N]: clamp load that is needed",
        "the greater of what friction needs and what is asked for",
        lambda F_KQ, F_KP: max(F_KQ, F_KP),
    ),
    _step(
        "R3 Phi [-]: load factor by finite elements",
        "load introduction factor times delta_P, over delta_S + delta_P",
        lambda n, delta_S, delta_P: n * delta_P / (delta_S + delta_P),
    ),
    _step(
        "R3 Phi_c [-]: load factor with the deformation cone",
        "the same with the guideline's delta_P",
        lambda n, delta_S, delta_Pc: n * delta_Pc / (delta_S + delta_Pc),
    ),
    _step(
        "R3 F_SAu [N]: least additional bolt force, at the least preload",
        "load factor times the least working load + what a load case adds",
        lambda Phi, F_Au, dF_u: Phi * F_Au + dF_u,
    ),
    _step(
        "R3 F_SAo [N]: greatest additional bolt force, at the least preload",
        "load factor times the greatest working load + what a load case adds",
        lambda Phi, F_Ao, dF_o: Phi * F_Ao + dF_o,
    ),
    _step(
        "R3 F_SAM [N]: greatest additional bolt force, at the greatest preload",
        "load factor times the greatest working load + what a load case adds",
        lambda Phi, F_Ao, dF_M: Phi * F_Ao + dF_M,
    ),
    _step("R4 F_Z [N]: loss by embedding, guide value", LOST, lambda f_Z, delta_S, delta_P: f_Z / (delta_S + delta_P)),
    _step(
        "R4 F_Zlaw [N]: loss by embedding, greatest by the contact law",
        f"{LOST}; thread and seats are not in it",
        lambda f_law, delta_S, delta_P: f_law / (delta_S + delta_P),
    ),
    _step(
        "R4 F_Zd [N]: loss that the sheet counts with",
        f"{LOST}: as given, or the guide value, or that of the contact law",
        lambda f_Zd, delta_S, delta_P: f_Zd / (delta_S + delta_P),
    ),
    _step(
        "R4 dF_th [N]: loss by temperature",
        "as given; where it is not, the rows below count with none",
        lambda F_th: F_th,
    ),
    _step("R5 F_Mmin [N]: least assembly preload", "preload times (1 - scatter)", lambda F_V, s: F_V * (1 - s)),
    _step(
        "R5 F_Mreq [N]: assembly preload that is needed",
        "clamp load + (1 - load factor) times the working load + what a load case adds + loss by embedding + "
        "loss by temperature",
        lambda F_Kreq, Phi, F_Ao, dF_P, F_Zd, F_thd: F_Kreq + (1 - Phi) * F_Ao + dF_P + F_Zd + F_thd,
        limit="F_Mmin",
    ),
    _step(
        "R6 F_Mmax [N]: greatest assembly preload",
        "tightening factor times the least assembly preload",
        lambda alpha_A, F_Mmin: alpha_A * F_Mmin,
    ),
    _step(
        "R7 M_G [N m]: torque in the shank",
        "preload times (0.16 pitch + 0.58 pitch diameter times friction in the thread)",
        lambda F_Mmax, P, d_2, mu_G: thread_torque(F_Mmax, P, d_2, mu_G),
    ),
    _step(
        "R7 sigma_redM [Pa]: stress at assembly, with torsion",
        "root of (tension squared + 3 times shear squared), over the least section of diameter d_0; "
        "shear = torque over pi d_0^3/12",
        lambda F_Mmax, d_0, M_G: reduced_stress(F_Mmax, d_0, M_G),
        limit="R_p09",
    ),
    _step(
        "R8 F_Smax [N]: greatest bolt force",
        "greatest assembly preload + greatest additional bolt force there + gain by temperature",
        lambda F_Mmax, F_SAM, F_thg: F_Mmax + F_SAM + F_thg,
    ),
    _step(
        "R8 sigma_redB [Pa]: stress in service, with half of the torsion",
        "root of (tension squared + 3 times half of the shear squared); shear = torque over pi d_0^3/16",
        lambda F_Smax, d_0, M_G: working_stress(F_Smax, d_0, M_G),
        limit="R_p",
    ),
    _step(
        "R9 sigma_ASV [Pa]: endurance limit, rolled before heat treatment",
        "0.85 (150 mm over the diameter + 45) MPa, for 2e6 cycles or more",
        endurance,
    ),
    _step(
        "R9 F_Sm [N]: mean bolt force",
        "greatest bolt force - half of the range of the additional bolt force at the least preload",
        lambda F_Smax, F_SAu, F_SAo: F_Smax - (F_SAo - F_SAu) / 2,
    ),
    _step(
        "R9 sigma_ASG [Pa]: endurance limit, rolled after heat treatment",
        "that before heat treatment times (2 - mean force over the force at yield)",
        lambda sigma_ASV, F_Sm, R_p, A_S: rolled_after(sigma_ASV, F_Sm / (R_p * A_S)),
    ),
    _step(
        "R9 sigma_a [Pa]: alternating stress",
        "half of the range of the additional bolt force, over the stress area + amplitude of the bending stress; heat "
        "counts in R4, R8 and D",
        lambda F_SAu, F_SAo, A_S, sigma_b: (F_SAo - F_SAu) / (2 * A_S) + sigma_b,
        limit="sigma_ASV",
    ),
    _step(
        "R9 D [-]: damage by cycles",
        "cycles over those to failure at the stress of force and bending, of all load cases (Palmgren, Miner), at that "
        "of the three preloads where it is greatest + that of vibration in its time",
        lambda D_c, D_v: D_c + D_v,
        limit="D_1",
        source=f"{GUIDELINE}, section 5.5.3",
    ),
    _step(
        "R10 p_M [Pa]: seat pressure at assembly",
        "greatest assembly preload over the area of the smaller seat",
        lambda F_Mmax, A_p: F_Mmax / A_p,
        limit="p_G",
    ),
    _step(
        "R10 p_B [Pa]: seat pressure in service",
        "greatest bolt force over the area of the smaller seat",
        lambda F_Smax, A_p: F_Smax / A_p,
        limit="p_G",
    ),
    _step(
        "R11 F_nut [N]: force on the nut",
        "greatest assembly preload; a nut of the bolt's class bears the bolt's proof load",
        lambda F_Mmax: F_Mmax,
        limit="F_p",
        source="ISO 898-2:2012",
    ),
    _step(
        "R11 m_req [m]: length of engagement that is needed",
        "tensile strength times stress area, over 0.897 times the shear strength of the tapped part times "
        "pi d (1/2 + (d - d_2) tan 30 degrees over the pitch)",
        lambda R_m, A_S, tau_B, d, d_2, P: engagement(R_m=R_m, A_S=A_S, tau_B=tau_B, d=d, d_2=d_2, P=P),
        limit="m",
        source=f"{GUIDELINE}, section 5.5.5",
    ),
    _step(
        "R12 F_Vmin [N]: least preload in service",
        "least assembly preload - loss by embedding - loss by temperature",
        lambda F_Mmin, F_Zd, F_thd: F_Mmin - F_Zd - F_thd,
    ),
    _step(
        "R12 F_PA [N]: what the working load takes from the joint",
        "(1 - load factor) times the greatest working load + what a load case adds at the least preload; the joint "
        "opens where it exceeds the preload",
        lambda Phi, F_Ao, dF_P: (1 - Phi) * F_Ao + dF_P,
        limit="F_Vmin",
    ),
    _step(
        "R12 F_KRmin [N]: least clamp load",
        "least preload in service - what the working load takes",
        lambda F_Vmin, F_PA: F_Vmin - F_PA,
    ),
    _step("R12 F_KQs [N]: clamp load that prevents slip", "as of R2", lambda F_KQ: F_KQ, limit="F_KRmin"),
    _step(
        "R12 tau_Q [Pa]: shear stress if the joint slips",
        "transverse load over the stress area; the limit is 0.6 times the tensile strength",
        lambda F_Q, A_S: F_Q / A_S,
        limit="tau_BS",
    ),
    _step(
        "R13 M_A [N m]: tightening torque",
        "preload times (0.16 pitch + 0.58 pitch diameter times friction in the thread + half of the mean diameter of "
        "the seat times friction under the head)",
        lambda F_V, P, d_2, mu_G, D_Km, mu_K: tightening_torque(F_V, P, d_2, mu_G, D_Km, mu_K),
    ),
)


def steps(*, tapped: bool, rolled_after: bool, cycles: bool = False, curve: str = "") -> tuple[Step, ...]:
    """Return the steps, in the order of the guideline.

    Args:
        tapped: The bolt is screwed into a tapped hole; else it has a nut.
        rolled_after: Its thread is rolled after heat treatment, so that another endurance limit holds.
        cycles: A load case says how often it comes and goes, or a vibration how long it lasts.
        curve: Where the curve of fatigue is from, in place of VDI 2230; "" for that.

    Source:
        VDI 2230 Part 1:2015, section 4, for concentric clamping and loading.
    """
    others = ("F_nut" if tapped else "m_req", *(() if rolled_after else ("F_Sm", "sigma_ASG")))
    others += () if cycles else ("D",)
    found = tuple(one for one in STEPS if one.symbol not in others)
    if curve:
        own = _step(
            f"R9 sigma_ASV [Pa]: endurance limit, {curve}", "stress amplitude at the knee", lambda sigma_K: sigma_K
        )
        found = tuple(replace(own, source=curve) if one.symbol == own.symbol else one for one in found)
    if not rolled_after:
        return found
    return tuple(replace(one, limit="sigma_ASG") if one.symbol == "sigma_a" else one for one in found)
