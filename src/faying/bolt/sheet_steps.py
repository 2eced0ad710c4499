"""Steps R0 to R13 of VDI 2230 for one bolt, under a concentric working load."""

from math import pi, sqrt, tan

from faying.bolt.sheet import Step

GUIDELINE = "VDI 2230 Part 1:2015"
STRIPPING = 0.897  # C_3 for a bolt that is stronger than the tapped part (Alexander 1977), the least that it can be
SHEAR = 0.6  # shear strength of a bolt over its tensile strength, at least (VDI 2230 Part 1:2015, section 5.5.6)


def _lost_force(f: float, S: float, P: float) -> float:
    """Force that a stack of compliances S and P loses where it settles by f."""
    return f / (S + P)


def thread_torque(F: float, P: float, d_2: float, mu_G: float) -> float:
    """Torque [N m] in the shank while a bolt is tightened to F [N]."""
    return F * (0.16 * P + 0.58 * d_2 * mu_G)


def reduced_stress(F: float, d_0: float, torque: float) -> float:
    """Von Mises stress [Pa] at assembly, the shear stress even over the section of diameter d_0 [m]."""
    return sqrt((F / (pi / 4 * d_0**2)) ** 2 + 3 * (torque / (pi / 12 * d_0**3)) ** 2)


def working_stress(F: float, d_0: float, torque: float) -> float:
    """Von Mises stress [Pa] in service: half of the greatest elastic shear stress of tightening is left."""
    return sqrt((F / (pi / 4 * d_0**2)) ** 2 + 3 * (0.5 * torque / (pi / 16 * d_0**3)) ** 2)


def endurance(d: float) -> float:
    """Stress amplitude [Pa] that a thread rolled before heat treatment bears 2e6 times and more; d [m]."""
    return 0.85 * (150 / (1e3 * d) + 45) * 1e6


def engagement(*, R_m: float, A_S: float, tau_B: float, d: float, d_2: float, P: float) -> float:
    """Length of engagement [m] at which the tapped thread strips when the bolt breaks."""
    ring = pi * d * (0.5 + (d - d_2) * tan(pi / 6) / P)
    return R_m * A_S / (STRIPPING * tau_B * ring)


def _step(step: str, name: str, formula: str, inputs: str, **given: object) -> Step:
    """A step whose inputs stand in one text; `given`: symbol, unit, function, limit, source."""
    return Step(
        step=step,
        name=name,
        formula=formula,
        inputs=tuple(inputs.split()),
        **{"source": f"{GUIDELINE}, {step}", **given},  # type: ignore[arg-type]
    )


def steps(*, tapped: bool, rolled_after: bool) -> tuple[Step, ...]:
    """Return the steps, in the order of the guideline.

    Args:
        tapped: The bolt is screwed into a tapped hole; else it has a nut.
        rolled_after: Its thread is rolled after heat treatment.

    Source:
        VDI 2230 Part 1:2015, section 4, for concentric clamping and loading.
    """
    return (*_assembly(), *_shares(), *_losses(), *_preloads(), *_stresses(), *_fatigue(rolled_after), *_ends(tapped))


def _assembly() -> tuple[Step, ...]:
    return (
        _step(
            "R0",
            "stress area that the greatest preload needs",
            "preload times (1 + scatter), over the stress under proof load",
            "F_V s S_p",
            symbol="A_req",
            unit="m^2",
            function=lambda F, s, S: F * (1 + s) / S,
            limit="A_S",
            source="ISO 898-1:2013, Table 3",
        ),
        _step(
            "R1",
            "tightening factor",
            "greatest over least preload: (1 + scatter) over (1 - scatter)",
            "s",
            symbol="alpha_A",
            unit="",
            function=lambda s: (1 + s) / (1 - s),
        ),
        _step(
            "R2",
            "clamp load that friction needs",
            "transverse load over the friction of the joint",
            "F_Q mu_T",
            symbol="F_KQ",
            unit="N",
            function=lambda F, mu: F / mu if F else 0.0,
        ),
        _step(
            "R2",
            "clamp load that is needed",
            "the greater of what friction needs and what is asked for",
            "F_KQ F_KP",
            symbol="F_Kreq",
            unit="N",
            function=max,
        ),
    )


def _shares() -> tuple[Step, ...]:
    return (
        _step(
            "R3",
            "load factor by finite elements",
            "load introduction factor times delta_P, over delta_S + delta_P",
            "n delta_S delta_P",
            symbol="Phi",
            unit="",
            function=lambda n, S, P: n * P / (S + P),
        ),
        _step(
            "R3",
            "load factor with the deformation cone",
            "the same with the guideline's delta_P",
            "n delta_S delta_Pc",
            symbol="Phi_c",
            unit="",
            function=lambda n, S, P: n * P / (S + P),
        ),
        _step(
            "R3",
            "least additional bolt force",
            "load factor times the least working load + what a load case adds",
            "Phi F_Au dF_u",
            symbol="F_SAu",
            unit="N",
            function=lambda Phi, F, more: Phi * F + more,
        ),
        _step(
            "R3",
            "greatest additional bolt force",
            "load factor times the greatest working load + what a load case adds",
            "Phi F_Ao dF_o",
            symbol="F_SAo",
            unit="N",
            function=lambda Phi, F, more: Phi * F + more,
        ),
    )


def _losses() -> tuple[Step, ...]:
    lost = "embedding over the compliances of bolt and parts"
    return (
        _step(
            "R4",
            "loss by embedding, guide value",
            lost,
            "f_Z delta_S delta_P",
            symbol="F_Z",
            unit="N",
            function=_lost_force,
        ),
        _step(
            "R4",
            "loss by embedding, greatest by the contact law",
            f"{lost}; thread and seats are not in it",
            "f_law delta_S delta_P",
            symbol="F_Zlaw",
            unit="N",
            function=_lost_force,
        ),
        _step(
            "R4",
            "loss that the sheet counts with",
            f"{lost}: as given, or the guide value, or that of the contact law",
            "f_Zd delta_S delta_P",
            symbol="F_Zd",
            unit="N",
            function=_lost_force,
        ),
        _step(
            "R4",
            "loss by temperature",
            "as given; where it is not, the rows below count with none",
            "F_th",
            symbol="dF_th",
            unit="N",
            function=lambda F: F,
        ),
    )


def _preloads() -> tuple[Step, ...]:
    return (
        _step(
            "R5",
            "least assembly preload",
            "preload times (1 - scatter)",
            "F_V s",
            symbol="F_Mmin",
            unit="N",
            function=lambda F, s: F * (1 - s),
        ),
        _step(
            "R5",
            "assembly preload that is needed",
            "clamp load + (1 - load factor) times the working load + what a load case adds + loss by embedding + "
            "loss by temperature",
            "F_Kreq Phi F_Ao dF_P F_Zd F_thd",
            symbol="F_Mreq",
            unit="N",
            function=lambda K, Phi, A, more, Z, th: K + (1 - Phi) * A + more + Z + th,
            limit="F_Mmin",
        ),
        _step(
            "R6",
            "greatest assembly preload",
            "tightening factor times the least assembly preload",
            "alpha_A F_Mmin",
            symbol="F_Mmax",
            unit="N",
            function=lambda a, F: a * F,
        ),
    )


def _stresses() -> tuple[Step, ...]:
    return (
        _step(
            "R7",
            "torque in the shank",
            "preload times (0.16 pitch + 0.58 pitch diameter times friction in the thread)",
            "F_Mmax P d_2 mu_G",
            symbol="M_G",
            unit="N m",
            function=thread_torque,
        ),
        _step(
            "R7",
            "stress at assembly, with torsion",
            "root of (tension squared + 3 times shear squared), over the least section of diameter d_0; "
            "shear = torque over pi d_0^3/12",
            "F_Mmax d_0 M_G",
            symbol="sigma_redM",
            unit="Pa",
            function=reduced_stress,
            limit="R_p09",
        ),
        _step(
            "R8",
            "greatest bolt force",
            "greatest assembly preload + greatest additional bolt force + gain by temperature",
            "F_Mmax F_SAo F_thg",
            symbol="F_Smax",
            unit="N",
            function=lambda F, more, gain: F + more + gain,
        ),
        _step(
            "R8",
            "stress in service, with half of the torsion",
            "root of (tension squared + 3 times half of the shear squared); shear = torque over pi d_0^3/16",
            "F_Smax d_0 M_G",
            symbol="sigma_redB",
            unit="Pa",
            function=working_stress,
            limit="R_p",
        ),
    )


def _fatigue(rolled_after: bool) -> tuple[Step, ...]:
    before = _step(
        "R9",
        "endurance limit, rolled before heat treatment",
        "0.85 (150 mm over the diameter + 45) MPa, for 2e6 cycles or more",
        "d",
        symbol="sigma_ASV",
        unit="Pa",
        function=endurance,
    )
    after = (
        _step(
            "R9",
            "mean bolt force",
            "greatest assembly preload + mean of the least and the greatest additional bolt force",
            "F_Mmax F_SAu F_SAo",
            symbol="F_Sm",
            unit="N",
            function=lambda F, low, high: F + (low + high) / 2,
        ),
        _step(
            "R9",
            "endurance limit, rolled after heat treatment",
            "that before heat treatment times (2 - mean force over the force at yield)",
            "sigma_ASV F_Sm R_p A_S",
            symbol="sigma_ASG",
            unit="Pa",
            function=lambda sigma, F, R, A: sigma * max(2 - F / (R * A), 1.0),
        ),
    )
    amplitude = _step(
        "R9",
        "alternating stress",
        "half of the range of the additional bolt force, over the stress area",
        "F_SAu F_SAo A_S",
        symbol="sigma_a",
        unit="Pa",
        function=lambda low, high, A: (high - low) / (2 * A),
        limit="sigma_ASG" if rolled_after else "sigma_ASV",
    )
    return (before, *(after if rolled_after else ()), amplitude)


def _ends(tapped: bool) -> tuple[Step, ...]:
    seats = tuple(
        _step(
            "R10",
            f"seat pressure {when}",
            f"{force} over the area of the smaller seat",
            f"{symbol} A_p",
            symbol=out,
            unit="Pa",
            function=lambda F, A: F / A,
            limit="p_G",
        )
        for when, force, symbol, out in (
            ("at assembly", "greatest assembly preload", "F_Mmax", "p_M"),
            ("in service", "greatest bolt force", "F_Smax", "p_B"),
        )
    )
    return (*seats, _engaged(tapped), *_slip(), _torque())


def _engaged(tapped: bool) -> Step:
    if not tapped:
        return _step(
            "R11",
            "force on the nut",
            "greatest assembly preload; a nut of the bolt's class bears the bolt's proof load",
            "F_Mmax",
            symbol="F_nut",
            unit="N",
            function=lambda F: F,
            limit="F_p",
            source="ISO 898-2:2012",
        )
    return _step(
        "R11",
        "length of engagement that is needed",
        "tensile strength times stress area, over 0.897 times the shear strength of the tapped part times "
        "pi d (1/2 + (d - d_2) tan 30 degrees over the pitch)",
        "R_m A_S tau_B d d_2 P",
        symbol="m_req",
        unit="m",
        function=lambda R, A, tau, d, d_2, P: engagement(R_m=R, A_S=A, tau_B=tau, d=d, d_2=d_2, P=P),
        limit="m",
        source=f"{GUIDELINE}, section 5.5.5",
    )


def _slip() -> tuple[Step, ...]:
    return (
        _step(
            "R12",
            "least preload in service",
            "least assembly preload - loss by embedding - loss by temperature",
            "F_Mmin F_Zd F_thd",
            symbol="F_Vmin",
            unit="N",
            function=lambda F, Z, th: F - Z - th,
        ),
        _step(
            "R12",
            "what the working load takes from the joint",
            "(1 - load factor) times the greatest working load + what a load case adds; the joint opens where it "
            "exceeds the preload",
            "Phi F_Ao dF_P",
            symbol="F_PA",
            unit="N",
            function=lambda Phi, A, more: (1 - Phi) * A + more,
            limit="F_Vmin",
        ),
        _step(
            "R12",
            "least clamp load",
            "least preload in service - what the working load takes",
            "F_Vmin F_PA",
            symbol="F_KRmin",
            unit="N",
            function=lambda F, A: F - A,
        ),
        _step(
            "R12",
            "clamp load that prevents slip",
            "as of R2",
            "F_KQ",
            symbol="F_KQs",
            unit="N",
            function=lambda F: F,
            limit="F_KRmin",
        ),
        _step(
            "R12",
            "shear stress if the joint slips",
            "transverse load over the stress area; the limit is 0.6 times the tensile strength",
            "F_Q A_S",
            symbol="tau_Q",
            unit="Pa",
            function=lambda F, A: F / A,
            limit="tau_BS",
        ),
    )


def _torque() -> Step:
    return _step(
        "R13",
        "tightening torque",
        "preload times (0.16 pitch + 0.58 pitch diameter times friction in the thread + half of the mean diameter of "
        "the seat times friction under the head)",
        "F_V P d_2 mu_G D_Km mu_K",
        symbol="M_A",
        unit="N m",
        function=lambda F, P, d_2, G, D, K: thread_torque(F, P, d_2, G) + F * D * K / 2,
    )
