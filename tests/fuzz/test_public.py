"""Misuse of the public API of surfaces, materials and contact: every wrong value is an InputError that says so.

Each public function, constructor and method is called with values that work, then with one of them replaced by each of
many wrong ones. A public name that is not listed here fails the first test.
"""

import inspect
from pathlib import Path

import numpy as np
import pytest

import faying
from faying import contact
from faying.contact.build import find
from faying.surface import synthesize

ROOMS = ("surface", "contact", "halfspace", "materials", "distribution")
STEEL = faying.CATALOGUE["45 steel"]
PAIR = faying.ContactPair("45 steel", "45 steel")
SCAN = synthesize.spectral((192, 160), spacing=1e-6, D=2.4, Rq=2e-7, seed=3)
LINE = SCAN.profile("x", 3)
HEIGHTS = np.array(SCAN.heights[:32, :24])
FIT = SCAN.fractal()
MATES = faying.Mates(SCAN, materials="45 steel")
JK = faying.JK(D=2.4, G=1e-10, pair=PAIR, scan_area=1e-8)
INPUTS = contact.SurfaceInputs.from_fractal(D=2.4, G=1e-10, scan_area=1e-8, shortest=1e-6)
ROUGH = contact.RoughSurface(inputs=INPUTS)
PROFILE = {"m0": 1e-14, "m2": 1e-3, "m4": 1e9}
P = np.array([1e6, 2e6, 5e6])
GAPS = np.linspace(0, 1e-6, 5)
WEIGHT = np.array([0.1, 1.0, 2.0, 1.0, 0.1])
COMPARISON = contact.compare({"JK": JK}, [1e5, 1e6])
CONTACT = faying.solve_half_space(HEIGHTS, 1e-6, E_star=1e11, pressure=1e7, tol=1e-3)
TABLE = contact.TabulatedLaw(pressure=P, k_n=P * 1e6)

# values that work: name -> (what is called, its arguments)
CALLS = {
    "Scan": (faying.Scan, {"heights": HEIGHTS, "spacing": (1e-6, 1e-6), "source": "x"}),
    "Scan.cropped": (SCAN.cropped, {"share": 0.5}),
    "Scan.fractal": (SCAN.fractal, {"method": "psd", "degree": 1, "spikes": True, "gamma": 1.5}),
    "Scan.levelled": (SCAN.levelled, {"degree": 1}),
    "Scan.plot": (SCAN.plot, {"axes": None, "degree": 1}),
    "Scan.profile": (SCAN.profile, {"along": "x", "index": 2}),
    "Scan.areal": (SCAN.areal, {"degree": 1, "spikes": True}),
    "Scan.roughness": (SCAN.roughness, {"degree": 1}),
    "Scan.with_heights": (SCAN.with_heights, {"heights": HEIGHTS, "note": "x"}),
    "Profile": (faying.Profile, {"heights": HEIGHTS[0], "spacing": 1e-6, "source": "x"}),
    "Profile.fractal": (SCAN.fractal, {"method": "psd", "degree": 1, "spikes": True, "convention": "yan-komvopoulos"}),
    "Profile.levelled": (LINE.levelled, {"degree": 1}),
    "Profile.plot": (LINE.plot, {"axes": None, "degree": 1}),
    "Profile.roughness": (LINE.roughness, {"degree": 1}),
    "Profile.with_heights": (LINE.with_heights, {"heights": HEIGHTS[0], "note": "x"}),
    "fit_fractal": (
        faying.fit_fractal,
        {"scan": SCAN, "method": "psd", "degree": 1, "spikes": True, "convention": "yan-komvopoulos", "gamma": 1.5},
    ),
    "FractalFit.plot": (FIT.plot, {"ax": None}),
    "combine": (
        faying.combine,
        {"scan_a": SCAN, "scan_b": SCAN, "degree": 1, "convention": "yan-komvopoulos", "gamma": 1.5},
    ),
    "synthesize.spectral": (
        synthesize.spectral,
        {"shape": (16, 16), "spacing": 1e-6, "D": 2.4, "Rq": 1e-7, "longest": 1e-5, "periodic": False, "gamma": 1.5}
        | {"shortest": 3e-6, "convention": "yan-komvopoulos", "seed": 1, "lay": (0.1, 2.0)},
    ),
    "read_scan": (faying.read_scan, {"path": "SCAN.csv", "z_unit": "um", "spacing": 1e-6}),
    "write_scan": (faying.write_scan, {"scan": SCAN, "path": "OUT.x3p", "precision": "D"}),
    "Material": (
        faying.Material,
        {"name": "x", "E": 2e11, "nu": 0.3, "density": 7800.0, "yield_strength": 3e8, "hardness": 1e9, "brinell": 2e9}
        | {"friction": 0.2, "conductivity": 50.0, "resistivity": 1e-7, "bearing_limit": 5e8, "source": "x"},
    ),
    "ContactPair": (faying.ContactPair, {"first": "45 steel", "second": STEEL}),
    "Distribution": (
        faying.Distribution,
        {"kind": "normal", "centre": 1.0, "spread": 0.1, "low": 0.5, "high": 2.0},
    ),
    "Distribution.read": (faying.Distribution.read, {"value": "0.1 to 0.3", "unit": "", "name": "x"}),
    "solve_half_space": (
        faying.solve_half_space,
        {"heights": HEIGHTS, "spacing": 1e-6, "E_star": 1e11, "pressure": 1e7, "hardness": 2e9, "nu": 0.3}
        | {"periodic": True, "tol": 1e-3, "workers": 1, "precision": "double"},
    ),
    "Contact.plot": (CONTACT.plot, {"axes": None}),
    "Mates": (
        faying.Mates,
        {"face": SCAN, "materials": "45 steel", "other": "same", "method": "psd", "D": 2.4, "G": 1e-10}
        | {"scan_area": 1e-8},
    ),
    "Mates.of_fractal": (
        faying.Mates.of_fractal,
        {"D": 2.4, "G": 1e-10, "scan_area": 1e-8, "materials": "45 steel", "of": "both faces"},
    ),
    "Mates.of_fit": (
        faying.Mates.of_fit,
        {"fit": FIT, "scan_area": 1e-8, "materials": "45 steel", "of": "both faces"},
    ),
    "Mates.of_surface": (faying.Mates.of_surface, {"surface": INPUTS, "materials": "45 steel"}),
    "Mates.law": (lambda name, alpha: MATES.law(name, alpha=alpha), {"name": "jk", "alpha": 0.3}),
    "Mates.choose": (MATES.choose, {"name": "jk", "given": {"alpha": 0.3}}),
    "Mates.laws": (MATES.laws, {"names": ["jk"]}),
    "Mates.compare": (MATES.compare, {"pressure": 1e5, "laws": ["jk"]}),
    "Mates.comparison": (MATES.comparison, {"pressure": 1e5, "laws": ["jk"]}),
    "Mates.compare_plot": (MATES.compare_plot, {"pressure": [1e5, 2e5], "laws": ["jk"], "quantity": "k_n", "ax": None}),
    "JK": (faying.JK, {"D": 2.4, "G": 1e-10, "pair": PAIR, "scan_area": 1e-8, "alpha": 0.3, "gamma": 1.5}),
    "JK.specific_damping": (JK.specific_damping, {"al": 1e-12}),
    "HalfSpace": (
        faying.HalfSpace,
        {"scan": SCAN, "pair": PAIR, "elastic": False, "stiffness": "unloading", "area": "corrected", "points": 8}
        | {"shear_ratio": 0.1, "periodic": True, "lowest": 1e5, "highest": 1e7, "tol": 1e-3},
    ),
    "CMY": (contact.CMY, {"h_rms": 1e-6, "mean_slope": 0.1, "pair": PAIR, "hardness": 2e9}),
    "Mikic": (contact.Mikic, {"h_rms": 1e-6, "mean_slope": 0.1, "pair": PAIR}),
    "GreenwoodWilliamson": (
        contact.GreenwoodWilliamson,
        {"density": 1e10, "radius": 1e-5, "sigma": 1e-7, "pair": PAIR, "asperity": "Hertz"},
    ),
    "JacksonStreator": (
        contact.JacksonStreator,
        {"G": 1e-10, "D": 2.4, "scan_area": 1e-8, "pair": PAIR, "shortest": 1e-6, "gamma": 1.5},
    ),
    "MajumdarBhushan": (contact.MajumdarBhushan, {"D": 2.4, "G": 1e-10, "pair": PAIR, "scan_area": 1e-8}),
    "MeasuredHeights": (
        contact.MeasuredHeights,
        {"gaps": GAPS, "probability": WEIGHT, "density": 1e9, "radius": 1e-5, "pair": PAIR, "tangent_ratio": 0.1},
    ),
    "MoragEtsion": (
        contact.MoragEtsion,
        {"D": 2.4, "G": 1e-10, "pair": PAIR, "scan_area": 1e-8, "wavelength": 1e-6},
    ),
    "Persson": (contact.Persson, {"slope": 0.1, "h_rms": 1e-6, "pair": PAIR}),
    "PowerLaw": (contact.PowerLaw, {"C": 1e-9, "m": 0.5}),
    "PowerLaw.measured": (contact.PowerLaw.measured, {"C": 0.5, "m": 0.5, "origin": "x"}),
    "TabulatedLaw": (contact.TabulatedLaw, {"pressure": P, "k_n": P * 1e6, "area": P * 1e-9, "origin": "x"}),
    "TabulatedLaw.from_approach": (contact.TabulatedLaw.from_approach, {"pressure": P, "approach": P * 1e-13}),
    "TabulatedLaw.from_csv": (contact.TabulatedLaw.from_csv, {"path": "LAW.csv"}),
    "WangKomvopoulos": (contact.WangKomvopoulos, {"D": 2.4, "G": 1e-10, "pair": PAIR, "scan_area": 1e-8}),
    "YanKomvopoulos": (contact.YanKomvopoulos, {"D": 2.4, "G": 1e-10, "pair": PAIR, "scan_area": 1e-8}),
    "ContactLaw.at_pressure": (JK.at_pressure, {"pressure": 1e5}),
    "ContactLaw.plot": (JK.plot, {"pressure": [1e5, 2e5], "axes": None}),
    "ContactLaw.with_": (JK.with_, {"D": 2.5, "pair": PAIR}),
    "Comparison.spread": (COMPARISON.spread, {"quantity": "k_n"}),
    "Comparison.ratios": (COMPARISON.ratios, {"quantity": "k_n"}),
    "Response.reshaped": (COMPARISON.responses["JK"].reshaped, {"shape": (2, 1)}),
    "FractalSurface": (contact.FractalSurface, {"D": 2.4, "G": 1e-10, "scan_area": 1e-8, "gamma": 1.5}),
    "SurfaceInputs": (
        contact.SurfaceInputs,
        {"D": 2.4, "G": 1e-10, "scan_area": 1e-8, "slope": 0.04, "h_rms": 1e-7, "shortest": 1e-6, **PROFILE},
    ),
    "SurfaceInputs.from_fractal": (
        contact.SurfaceInputs.from_fractal,
        {"D": 2.4, "G": 1e-10, "scan_area": 1e-8, "shortest": 1e-6, "gamma": 1.5},
    ),
    "SurfaceInputs.from_heights": (
        contact.SurfaceInputs.from_heights,
        {"heights": HEIGHTS, "spacing": (1e-6, 1e-6), "D": 2.4, "G": 1e-10},
    ),
    "RoughSurface": (contact.RoughSurface, {"inputs": INPUTS}),
    "build": (contact.build, {"name": "jk", "given": {}, "surface": ROUGH, "pair": PAIR}),
    "compare": (contact.compare, {"laws": {"JK": JK}, "pressure": 1e5}),
}
# public names that take nothing from a user, are made by the functions above, or are for those who write a model
MADE = {"FractalFit", "Combined", "Comparison", "Response", "ContactLaw", "Parameter", "RIGID", "CATALOGUE"}
MADE |= {"Roughness"}
MADE |= {"synthesize", "asperity", "laws", "contact"}
INNER = {"normal_stiffness", "slip", "at_closure", "from_entries", "from_surface"}
INNER |= {"rough_for", "watched", "closing", "contact_at", "resolution"}
INNER |= {"value", "stiffness_of_contact", "indented", "needed_for"}
INNER |= {"supplies", "check", "read", "text"}
INNER |= {"from_score", "from_standard", "log_density", "quantile", "score", "standardised", "within"}
OF_EVERY_LAW = {"at_pressure", "plot", "with_"}


def public():
    """Public functions and classes of these rooms by name, and the public methods of the classes."""
    found = {name: getattr(contact, name) for name in contact.__all__} | {n: getattr(faying, n) for n in dir(faying)}
    for name, value in found.items():
        module = getattr(value, "__module__", None) or getattr(value, "__name__", "")
        if module.split(".")[:1] != ["faying"] or module.split(".")[1:2] == [] or module.split(".")[1] not in ROOMS:
            continue
        yield name
        if not inspect.isclass(value):
            continue
        for method, function in inspect.getmembers(value, callable):
            if method.startswith("_") or not (set(inspect.signature(function).parameters) - {"self", "cls"}):
                continue
            if issubclass(value, contact.ContactLaw) and value is not contact.ContactLaw and method in OF_EVERY_LAW:
                continue
            yield f"{name}.{method}"
    for name, value in vars(synthesize).items():
        if inspect.isfunction(value) and value.__module__ == synthesize.__name__ and not name.startswith("_"):
            yield f"synthesize.{name}"


def test_every_public_name_is_misused_here():
    names = {n for n in public() if n not in MADE and n.rpartition(".")[2] not in INNER}
    names -= {"Parameter.read"}
    assert names - set(CALLS) == set()
    assert {n for n in CALLS if n.partition(".")[0] not in MADE | {"Contact"}} - set(public()) == set()


class Odd:
    """Something that no function takes."""


ODD = {
    "True": True,
    "nan": float("nan"),
    "kilograms": "5 kg",
    "no unit": "5",
    "empty text": "",
    "object": Odd(),
    "list": [],
    "dict": {},
    "array": np.zeros((2, 2)),
    "complex": 1 + 2j,
    "bytes": b"5",
    "huge": 10**400,
    "infinity": float("inf"),
    "minus one": -1.0,
    "None": None,
    "scan": SCAN,
    "profile": LINE,
    "law": JK,
    "fit": FIT,
    "material": STEEL,
    "pair": PAIR,
    "ragged": [[1.0, 2.0], [3.0]],
    "text in a list": ["x"],
}
FREE_TEXT = {"source", "note", "name of Material", "origin", "name of Distribution.read"}
# what some argument takes of the odd values, with the reason
GOOD = {
    # an array is in order where one is asked for, with any finite numbers
    "heights": {"array"},
    "E of Material": {"infinity"},  # the rigid plane
    "low": {"minus one", "None"},
    "high": {"infinity", "None"},
    "centre": {"minus one"},
    "unit of Distribution.read": {"empty text"},  # a plain number
    "other": {"scan"},
    "counter": {"scan"},
    # NaN stands for a surface without D and G
    **{f"{name} of {of}": {"nan"} for name in "DG" for of in ("FractalSurface", "SurfaceInputs")},
    **{f"{name} of SurfaceInputs.from_heights": {"nan"} for name in "DG"},
    # a material is in order where its name is
    "first": {"material"},
    "materials": {"material", "pair"},
}


def arguments():
    for call, (_, good) in CALLS.items():
        for argument in good:
            yield call, argument


def wrong(call, argument):
    """The odd values that are wrong for an argument, whatever it is; others may be taken or refused."""
    value = CALLS[call][1][argument]
    default = inspect.signature(CALLS[call][0]).parameters.get(argument)
    optional = default is not None and default.default is None
    out = set(ODD) - GOOD.get(argument, set()) - GOOD.get(f"{argument} of {call}", set())
    out -= {"None"} if optional else set()
    if isinstance(value, bool):
        return out - {"True"}
    if isinstance(value, int | float):
        # other signs and limits are judged by physics: a number may be below zero, and a bound may be infinite
        return (
            out - {"minus one", "infinity", "list"} - ({"array", "list"} if argument in ("pressure", "al") else set())
        )
    if isinstance(value, str):
        return out - (
            {"kilograms", "no unit", "empty text"} if {argument, f"{argument} of {call}"} & FREE_TEXT else set()
        )
    return {"True", "kilograms", "object", "complex", "bytes", "text in a list"} & out


def refused(call, argument, name):
    """What became of one call: its message where it is an InputError that reads well, else what is wrong."""
    function, good = CALLS[call]
    try:
        function(**(good | {argument: ODD[name]}))
    except faying.FayingError as fault:
        text = str(fault)
        if len(text) > 500 or "\n" in text or "object at 0x" in text:
            return f"{call}({argument} = {name}): message of {len(text)} characters: {text[:200]!r}"
        return ""
    except Exception as fault:
        return f"{call}({argument} = {name}): {type(fault).__name__}: {str(fault)[:120]}"
    return "taken"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """A folder with the files that the calls read."""
    monkeypatch.chdir(tmp_path)
    Path("SCAN.csv").write_text("\n".join(" ".join(f"{v * 1e6:.6f}" for v in row) for row in HEIGHTS))
    Path("LAW.csv").write_text("pressure [MPa],k_n [MPa/um]\n1,1\n2,2\n5,5\n")
    import matplotlib.pyplot as plt

    yield
    plt.close("all")


@pytest.mark.parametrize("call", CALLS)
def test_values_that_work_work(call):
    function, good = CALLS[call]
    function(**good)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("call", "argument"), list(arguments()), ids=lambda v: v)
def test_what_is_wrong_is_refused_and_nothing_else_fails(call, argument):
    must = wrong(call, argument)
    faults = []
    for name in ODD:
        outcome = refused(call, argument, name)
        if outcome == "taken":
            if name in must:
                faults.append(f"{call}({argument} = {name}) was taken")
        elif outcome:
            faults.append(outcome)
    assert not faults, "\n".join(faults)


NUMBERS = [
    (kind, name)
    for kind in ("jk", "gw", "persson", "cmy", "half-space")
    for name, parameter in find(kind).law.parameters.items()
    if parameter.is_number
]


@pytest.mark.parametrize(("kind", "name"), NUMBERS)
def test_numbers_that_laws_declare_refuse_what_is_no_number(kind, name):
    switch = find(kind).law.parameters[name].is_switch
    for odd in ("nan", "kilograms", "object", "array", "complex", *(() if switch else ("True",))):
        with pytest.raises(faying.InputError, match=name):
            MATES.law(kind, **{name: ODD[odd]})


def test_a_missing_material_names_the_nearest_and_is_a_key_error_too():
    with pytest.raises(faying.InputError, match='did you mean "45 steel"'):
        faying.CATALOGUE["45 stel"]
    with pytest.raises(KeyError, match="it has 45 steel, S355"):
        faying.CATALOGUE["wood"]
    assert faying.CATALOGUE.get("wood") is None
    assert "wood" not in faying.CATALOGUE


def test_text_with_a_unit_counts_as_the_number():
    text = faying.Material(name="x", E="200 GPa", nu=0.3, density="7.8e3 kg/m^3")
    assert (text.E, text.density) == (200e9, 7800.0)
    law = faying.JK(D=2.4, G="0.1 nm", pair=PAIR, scan_area="0.01 mm^2")
    assert (law.G, law.scan_area) == pytest.approx((1e-10, 1e-8))
    scan = faying.Scan(heights=HEIGHTS, spacing=("1 um", 2e-6))
    assert scan.spacing == pytest.approx((1e-6, 2e-6))
    contact_ = faying.solve_half_space(HEIGHTS, "1 um", E_star="110 GPa", pressure="10 MPa", tol=1e-3)
    assert contact_.pressure == pytest.approx(10e6, rel=1e-6)
