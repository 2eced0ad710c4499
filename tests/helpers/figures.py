"""Every figure of the product, made small: what `tests/output/test_every_figure.py` walks, one entry a figure.

A key is module:function, of what draws the figure. A new function that draws and has no entry fails that test.
"""

from dataclasses import replace
from functools import cache

import numpy as np

import faying
from faying.contact.figure import curves as law_curves
from faying.distribution import Distribution
from faying.form.fit import figure as form
from faying.form.fit import fit_form
from faying.identify import prediction as predicting
from faying.identify.identification import figure as identification
from faying.identify.identify import identify_model
from faying.identify.noise import Losses
from faying.identify.prediction import Prediction
from faying.identify.sampling.ensemble import Inputs
from faying.loads import figure as load_cases_figure
from faying.measured.compare import compare_modes
from faying.measured.figure import identified
from faying.measured.frf import FRF
from faying.measured.identify import identify_modes
from faying.measured.model import ModelModes
from faying.measured.modes import ModeSet
from faying.measured.ring_down import MeasuredBackbone
from faying.output import report, report_measured
from faying.output.figures import sweep
from faying.result import Receptance, backbone, difference, vibration
from faying.result.backbone import QuasiStaticCheck
from faying.result.difference import compare_runs
from faying.result.groups import Alternatives, Levels
from faying.result.interval import Interval
from faying.result.run_record import MeasuredComparison
from faying.study.keys.uncertain import Input
from faying.surface import figure as surface
from faying.surface.form import prepared
from faying.surface.fractal import fit_fractal
from faying.surface.synthesize import spectral
from faying.sweeps.axes import axis_of
from faying.sweeps.files import Sweep
from tests.helpers.backbones import made as backbone_of
from tests.helpers.chain import LOADS, DampedChain
from tests.helpers.gallery import script
from tests.helpers.load_cases import made as made_cases
from tests.helpers.plates import LAW, stacked
from tests.helpers.scenes import two_boxes

LINES = np.arange(10.0, 900.0, 2.0)
MODES = 3
SOURCES = ("scan", "law", "k_t/k_n", "waves", "preload", "structure", "mode")


def receptance():
    """One mass on a spring at two loads."""
    square = (2 * np.pi * np.array([[100.0], [110.0]])) ** 2
    values = 1 / (3.0 * (square * (1 + 0.02j) - (2 * np.pi * LINES) ** 2))
    return Receptance(
        frequencies=LINES,
        values=values[:, :, None, None],
        error=np.zeros(2),
        input_points=np.zeros((1, 3)),
        input_directions=np.array([[0.0, 0.0, 1.0]]),
        output_points=np.array([[0.3, 0.02, 0.01]]),
        output_directions=np.array([[0.0, 0.0, -1.0]]),
    )


@cache
def hammer():
    """A test that is nearly the model of two boxes, with an FRF."""
    plain = two_boxes()
    model = replace(plain.modes_at(), title="two boxes")
    rng = np.random.default_rng(0)
    at = np.linspace(0, len(model.points) - 1, 8).astype(int)
    dofs = [(k, d) for k in range(len(at)) for d in "xyz"]
    test = ModeSet(
        frequencies=model.frequencies * (1.01, 0.98, 1.02),
        loss_factors=np.full(MODES, 0.012),
        dofs=dofs,
        lines=((0, 1), (1, 2)),
        shapes=1j * (model.shapes[:, at].reshape(MODES, -1) + 0.05 * rng.standard_normal((MODES, len(dofs)))),
        positions={k: tuple(model.points[node]) for k, node in enumerate(at)},
        source="hammer test of two boxes",
    )
    here = (at[:1], np.eye(3)[2:])
    frf = FRF(
        frequency=LINES,
        values=model.frf(LINES, here, here, "accelerance"),
        outputs=[(0, "z")],
        inputs=[(0, "z")],
        quantity="accelerance",
    )
    return compare_modes(test, model, frf=frf)


@cache
def curve():
    """A backbone with a static cycle, and points with standard errors."""
    points = np.geomspace(0.3, 15, 7)
    found = backbone_of(
        frequency=lambda a: 200 - 2 * np.log1p(a), damping=lambda a: 1e-3 * (1 + a), rest=1e-3, linear=200.0
    )
    cycle = QuasiStaticCheck(
        amplitude=points,
        acceleration=points,
        frequency=200 - 2.1 * np.log1p(points),
        damping=1.1e-3 * (1 + points),
        frequency_change=0 * points,
        damping_change=0 * points,
    )
    measured = measured_points()
    return replace(
        found,
        witness=cycle,
        measured_acceleration=measured.acceleration,
        measured_frequency=measured.frequency,
        measured_damping=measured.damping,
        measured_source=measured.source,
    )


def measured_points():
    """Measured points of a mode, with standard errors."""
    a = np.geomspace(0.3, 15, 7)
    return MeasuredBackbone(
        acceleration=a,
        frequency=199 - 2 * np.log1p(a),
        damping=1.2e-3 * (1 + a),
        frequency_error=np.full(7, 0.4),
        damping_error=1e-4 * (1 + a),
        time=np.full(7, np.nan),
        source="ring_down.csv",
    )


def other_law(frequencies):
    """JK beside the law of a result, without loss; frequencies (1, load, mode) [Hz]."""
    share = np.zeros(frequencies.shape[:2])
    return Alternatives(
        names=("JK",),
        frequencies=frequencies,
        loss_factors=np.full(frequencies.shape, np.nan),
        above_range_frequencies=frequencies,
        outside_share=share,
        above_range_share=share,
        reach=np.array([1e8]),
    )


@cache
def result():
    """Two boxes with all that a result can have."""
    f = np.array([[100.0, 250.0, 600.0], [110.0, 260.0, 610.0]])
    offsets = 0.01 * np.array([1.0, 2.0, 1.5, 0.5, 1.2, 1.5, 1.0])[:, None, None, None]
    ends = np.array([-1.0, 1.0])[None, :, None, None] * offsets * np.ones((1, 1, 2, MODES))
    interval = Interval.about(f, dict(zip(SOURCES, ends, strict=True)))
    damping = np.array([1e-3, 1.1e-3, 4e-3])[None, :, None] * np.ones((2, 3, MODES))
    test = np.array([[98.0, 252.0], [111.0, 290.0]])
    paired = np.array([[0, 1], [0, 1]])
    return two_boxes(
        names=("flange_1",),
        bonded=1.02 * f[-1],
        low=0.97 * f,
        high=1.01 * f,
        vibrations=tuple(shaken(load) for load in (5e3, 8e3)),
        interval=interval,
        levels=Levels(
            accelerations=np.array([0.1, 1.0, 10.0]),
            frequencies=np.repeat(f[:, None], 3, axis=1),
            damping=damping,
            low=0.6 * damping,
            high=2 * damping,
            slip=damping - 9e-4,
            error=0 * damping,
        ),
        alternatives=other_law(1.01 * f[None]),
        comparison=MeasuredComparison(
            source="hammer test",
            frequencies=test,
            predicted=np.take_along_axis(f, paired, axis=1),
            modes=paired,
            published=1.02 * test,
            published_name="JK_paper",
        ),
        response=receptance(),
        hammer=hammer(),
        backbones=(curve(),),
    )


@cache
def state():
    """A solved structure of two plates with a bolt."""
    structure = faying.Structure(
        stacked(),
        materials="45 steel",
        joints=[faying.Joint(("low.top", "high.bottom"), LAW)],
        bolts=[faying.Bolt("bolt", ("high.top", "low.bottom"))],
    )
    return structure.solve(preload="6 kN", modes=4)


@cache
def scan():
    """A rough surface that a fit of a moment reads."""
    return replace(spectral((96, 128), spacing=1e-6, D=2.5, G=1e-9, seed=1), source="my_scan.x3p")


def overview(of):
    """The figure of `faying surface`, with two of its estimators."""
    return surface.overview_figure(of, prepared(of), {name: fit_fractal(of, name) for name in ("psd", "structure")})


def whole(drawn):
    """The figure of axes, or of the first of a list of axes."""
    return (drawn[0] if isinstance(drawn, list) else drawn).figure


def mates():
    return faying.Mates(scan(), materials="45 steel")


def swept(*texts):
    """A sweep whose frequencies rise along each axis."""
    axes = tuple(axis_of(text) for text in texts)
    shape = tuple(len(a.values) for a in axes)
    place = sum(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"))
    f = np.multiply.outer(1 + 0.01 * place, 100.0 * np.arange(1, 5))
    none = np.zeros(shape)
    given = {"loss_factors": 0 * f, "estimate": none, "greatest_pressure": none, "open_share": none}
    given |= {
        "above_range_share": none,
        "reasons": {},
        "tolerance": 1e-6,
        "unknowns": 1,
        "basis": (1, 1),
        "path": "s.nc",
    }
    return Sweep(title="s", axes=axes, frequencies=f, **given)


@cache
def prediction():
    """Frequencies that depend on four numbers, at two loads, with a test."""
    rng = np.random.default_rng(0)
    units = {"bolt.preload": "N", "material.45 steel.E": "Pa", "joint.flange.tangential": "", "surface.fitted_D": ""}
    centres = np.array([8e3, 2.1e11, 0.5, 2.4])
    spread = {k: Distribution(kind="normal", centre=c, spread=0.1 * c) for k, c in zip(units, centres, strict=True)}
    x = rng.standard_normal((128, 4))
    f = np.array([100.0, 250.0, 600.0]) * np.exp(0.02 * x @ rng.uniform(0.2, 1, (4, MODES)))
    f = np.stack([f, 1.05 * f], axis=1)
    return Prediction(
        title="two boxes",
        inputs=Inputs(columns=tuple(Input(key=k, distribution=spread[k], unit=units[k]) for k in units)),
        seed=0,
        tolerance=1e-4,
        basis=(10, 10),
        loads=np.array([4e3, 8e3]),
        values=centres * (1 + 0.1 * x),
        frequencies=f,
        loss_factors=np.full(f.shape, np.nan),
        open_share=np.zeros((128, 2)),
        above_range_share=np.zeros((128, 2)),
        discrepancy=np.zeros(f.shape[1:]),
        paired=f[..., :2],
        discrepancy_of_test_mode=np.zeros((2, 2)),
        test=np.array([[101.0, 249.0], [108.0, 300.0]]),
        test_source="test",
    )


@cache
def found():
    """An identification of a chain of masses with damping, one load left out."""
    truth = np.array([[1.3e7, 0.35, 1.01, 0.02]])
    both = DampedChain().frequencies(truth)[0][0]
    return identify_model(
        DampedChain(), both[:, :4], LOADS, leave_out=[2], count=200, losses=Losses(values=both[:, 4:])
    )


def half_space_contact():
    steel = faying.Material(name="steel", E=200e9, nu=0.3, hardness=2e9)
    pair = faying.ContactPair(steel, steel)
    here = spectral((64, 64), spacing=1e-6, D=2.3, G=1e-11, seed=1)
    return faying.solve_half_space(
        here.heights, here.spacing, E_star=pair.E_star, pressure=50e6, hardness=pair.hardness, nu=0.3
    )


def form_map():
    x, y = np.meshgrid(np.linspace(0, 0.04, 20), np.linspace(0, 0.09, 30))
    heights = -6e-6 * ((y - 0.045) / 0.045) ** 2
    places = np.column_stack([x.ravel(), y.ravel()])
    return form(fit_form(places, heights.ravel()), "face_1.csv")


def of_report(name):
    """A figure of the report, by its name there."""
    return report.FIGURES[name].draw(result())


def of_test(name):
    """A figure of the hammer test."""
    return report_measured.figures(hammer())[name]


def stabilised():
    model = ModelModes(
        frequencies=np.array([120.0, 300.0]),
        loss_factors=np.full(2, 0.02),
        shapes=np.ones((2, 1, 3)),
        points=np.zeros((1, 3)),
    )
    here = (np.array([0]), np.eye(3)[2:])
    values = model.frf(LINES, here, here, "mobility")
    frf = FRF(frequency=LINES, values=values, outputs=[(0, "z")], inputs=[(0, "z")], quantity="mobility")
    return identified(identify_modes(frf))


def laws():
    """All laws of a fractal surface at once, as `faying law --all-models --plot` draws them."""
    mates = faying.Mates.of_fractal(D=2.39, G="1.53e-10 m", scan_area="16 mm^2", materials="45 steel")
    return law_curves(mates.comparison(None, None).responses)


def shaken(load=8e3, name="shaker"):
    """A structure on a shaker: two points, ten modes, four bolts, one of which lasts for ever."""
    f, modes = np.geomspace(20, 2000, 60), 40.0 * 1.5 ** np.arange(10)
    three = np.array([0.6, 1.0, 1.8])
    level = three[:, None] * 30 / np.arange(1, 11)
    peak = 0.4 + 30 / (1 + ((f - 300) / 20) ** 2)
    return faying.VibrationResponse(
        title="bracket",
        name=name,
        kind="random",
        unit="(m/s^2)^2/Hz",
        preload=load,
        base=1,
        times=1800.0,
        bolts=("left", "right"),
        joints=("foot",),
        parts=("bracket", "base"),
        part_stress=np.outer(three, [2e7, 1e7]),
        part_stress_place=np.zeros((2, 3)),
        direction=np.array([1.0, 0, 0]),
        input_frequency=np.array([20.0, 2000]),
        input_value=np.array([3.8, 3.8]),
        rest_frequency=modes,
        rest_damping=np.outer([3e-4, 1.6e-3, 9e-3], np.ones(10)),
        share=0.1 + 0 * modes,
        frequency=np.outer(np.ones(3), modes),
        damping=np.outer(three, 2e-3 + 0 * modes),
        level=level,
        reach=np.full(10, np.nan),
        curve_level=level[1][:, None] * np.geomspace(0.05, 3, 15),
        curve_damping=np.outer(1 + np.arange(10), np.geomspace(1e-3, 4e-3, 15)),
        points=np.array([[0.0, 0, 0.1], [0.1, 0, 0]]),
        acceleration=np.multiply.outer(three, np.ones((2, 3))),
        velocity=np.multiply.outer(three, np.ones((2, 3))),
        displacement=np.multiply.outer(three, 1e-5 * np.ones((2, 3))),
        line_frequency=f,
        curve=3.8 * np.multiply.outer(three, np.stack([peak, 0.5 * peak])),
        curve_motion=3.8 * np.multiply.outer(three, np.stack([peak, 0.5 * peak])) / (2 * np.pi * f) ** 4,
        bolt_force=np.outer(three, [50.0, 60]),
        bolt_moment=np.outer(three, [0.5, 0.6]),
        bolt_shear=np.outer(three, [10.0, 20]),
        stress=np.outer(three, [2e7, 3e7]),
        damage=np.outer(three**3, [0.0, 0.02 * (8e3 / load) ** 2]),
        head_motion=np.outer(three, [0.1, 0.2]),
        slide_motion=np.array([1e-4, 1e-4]),
        slip_margin=np.array([[0.9], [1.3], [1.9]]),
        slip_margin_worst=np.array([[0.8], [1.2], [1.8]]),
    )


def two_curves():
    return backbone.figure([curve(), replace(curve(), friction=(0.4,))], [measured_points()])


FIGURES = {
    **{f"output/report.py:{name}": (lambda name=name: of_report(name)) for name in report.FIGURES},
    **{f"output/report_measured.py:{name}": (lambda name=name: of_test(name)) for name in ("mac", "frf", "shapes")},
    "docs/gallery/front_page.py:draw": lambda: script("front_page").draw(result()),
    "result/figure.py:frequency_axes": lambda: whole(result().plot()),
    "result/backbone.py:figure": two_curves,
    "result/backbone.py:plot": lambda: whole(curve().plot()),
    "result/backbone.py:measured": lambda: backbone.measured(measured_points()),
    "result/vibration.py:plot": lambda: whole(shaken().plot()),
    "result/vibration.py:life_figure": lambda: vibration.life_figure(
        [shaken(load, name) for load in (5e3, 8e3) for name in ("shaker", "transport by road")]
    ),
    "result/difference.py:differences": lambda: difference.differences(
        compare_runs(result(), two_boxes(names=("flange_1",)))
    ),
    "loads/figure.py:figure": lambda: load_cases_figure.figure(made_cases()),
    "joint/figure.py:face_axes": lambda: whole(made_cases().plot("left_1", "flange_1")),
    "joint/figure.py:pressure_axes": lambda: whole(state().plot_pressure()),
    "joint/figure.py:structure_axes": lambda: whole(state().structure.plot()),
    "joint/figure.py:mode_axes": lambda: whole(state().modes.plot(1)),
    "form/fit.py:figure": form_map,
    "fe/figure.py:mesh_axes": lambda: whole(stacked().plot()),
    "contact/figure.py:curves": laws,
    "contact/law_figure.py:law_plot": lambda: whole(LAW.plot()),
    "contact/figure.py:comparison_plot": lambda: whole(mates().compare_plot(laws=("jk", "gw", "persson"))),
    "halfspace/solution.py:plot": lambda: whole(half_space_contact().plot()),
    "measured/figure.py:identified": stabilised,
    "output/figures/sweep.py:figure, one axis": lambda: sweep.figure(swept("bolt.left_1.preload=1 kN:5 kN:5")),
    "output/figures/sweep.py:figure, laws": lambda: sweep.figure(swept("law.model=jk,gw,power-law")),
    "output/figures/sweep.py:figure, two axes": lambda: sweep.figure(
        swept("surface.D=2.3:2.4:3", "joint.stiffness=.1:10:4:log")
    ),
    "surface/figure.py:overview_of": lambda: whole(scan().plot()),
    "surface/figure.py:overview_of, profile": lambda: whole(scan().profile("x", 3).plot()),
    "surface/figure.py:fit_plot": lambda: whole(scan().fractal().plot()),
    "surface/figure.py:overview_figure": lambda: overview(scan()),
    "surface/figure.py:overview_figure, profile": lambda: overview(scan().profile("x", 3)),
    "identify/prediction.py:intervals": lambda: predicting.intervals(prediction()),
    "identify/prediction.py:plot": lambda: whole(prediction().plot()),
    "identify/prediction.py:tornado": lambda: predicting.tornado(prediction()),
    "identify/identification.py:figure": lambda: identification(found()),
    "identify/identification.py:plot": lambda: whole(found().plot()),
}
