"""Sweeps against full runs, and what they leave on disk when they are interrupted."""

import sys
from dataclasses import replace

import numpy as np
import pytest
import xarray

import faying
from faying.answer.run import run
from faying.case.case import surfaces_of
from faying.form.form import Form
from faying.form.waviness import Waviness
from faying.joint.modal import ModesChoice
from faying.joint.preload_case import PreloadCase
from faying.reduction.reduce import Reduction
from faying.study import Study, part_folder
from faying.study.keys.law import LawChoice
from faying.study.keys.varied import rooms, varied
from faying.sweeps import sweep as module
from faying.sweeps.axes import Axis, Grid, axis_of
from faying.sweeps.sweep import sweep
from faying.sweeps.variant_builder import VariantBuilder
from tests.helpers.preloads import pulled
from tests.helpers.studies import write


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "study.toml"
    write(path)
    study = Study.read(path)
    return replace(study, preloads=study.preloads[-1:], modes=ModesChoice(count=5), test=None)


AXES = ("surface.D=2.3:2.42:4", "bolt.preload=1 kN:3 kN:3")


def axes(*texts):
    return tuple(axis_of(text) for text in texts or AXES)


@pytest.fixture(scope="module")
def done(plan, tmp_path_factory):
    return sweep(plan, axes(), tmp_path_factory.mktemp("sweep") / "out.nc")


@pytest.mark.parametrize(
    "place",
    [(0, 0), *(pytest.param(place, marks=pytest.mark.slow) for place in ((1, 1), (3, 2), (2, 0)))],
)
def test_points_are_those_of_full_runs(plan, done, place):
    D, force = (axis.values[i] for axis, i in zip(done.axes, place, strict=True))
    full = run(replace(pulled(plan, force), surface=replace(plan.surface, D=D)))
    assert done.frequencies[place] == pytest.approx(full.frequencies[0], rel=1e-5)
    assert done.loss_factors[place] == pytest.approx(full.loss_factors[0], rel=1e-2)
    assert done.greatest_pressure[place] == pytest.approx(full.pressure.max(), rel=0.02)


def test_pressure_grows_with_preload(done):
    assert np.all(np.diff(done.greatest_pressure, axis=1) > 0)


def test_the_file_holds_axes_and_values_with_units(done):
    with xarray.open_dataset(done.path) as found:
        assert found.frequencies.dims == ("surface_D", "bolt_preload", "mode")
        assert np.array_equal(found.frequencies, done.frequencies, equal_nan=True)
        assert found.bolt_preload.attrs["units"] == "N"
        assert found.bolt_preload.values.tolist() == [1000.0, 2000.0, 3000.0]
    assert not done.path.with_name("out.nc.part").exists()


def test_an_interrupted_sweep_goes_on_where_it_stopped(plan, done, tmp_path, monkeypatch):
    out = tmp_path / "out.nc"
    monkeypatch.setattr(module, "CHUNK", 5)
    calls = []
    real = module.evaluate

    def stops(model, builder, indices):
        calls.append(list(indices))
        if len(calls) == 2:
            raise KeyboardInterrupt
        return real(model, builder, indices)

    monkeypatch.setattr(module, "evaluate", stops)
    with pytest.raises(KeyboardInterrupt):
        sweep(plan, axes(), out)
    assert not out.exists()
    monkeypatch.setattr(module, "evaluate", lambda *given: calls.append(list(given[2])) or real(*given))
    monkeypatch.setattr(Reduction, "of", None)  # the bases are not made again
    again = sweep(plan, axes(), out)
    assert again.frequencies == pytest.approx(done.frequencies, rel=1e-6)
    assert again.found == 5
    assert sorted(i for call in calls[2:] for i in call) == sorted(set(range(12)) - set(calls[0]))


@pytest.mark.slow
def test_what_an_interruption_changes(plan, tmp_path, monkeypatch):
    """Nothing, to the last bit: the chunks, and so the starts within them, are those of a sweep in one go."""
    monkeypatch.setattr(module, "CHUNK", 3)
    real, calls = module.evaluate, []
    whole = sweep(plan, axes(), tmp_path / "whole.nc")

    def stops(model, builder, indices):
        calls.append(list(indices))
        if len(calls) == 3:
            raise KeyboardInterrupt
        return real(model, builder, indices)

    monkeypatch.setattr(module, "evaluate", stops)
    with pytest.raises(KeyboardInterrupt):
        sweep(plan, axes(), tmp_path / "parts.nc")
    monkeypatch.setattr(module, "evaluate", real)
    # the first chunk is damaged: its points are evaluated again
    damaged = tmp_path / "parts.nc.part" / "chunk-000000.npz"
    damaged.write_bytes(damaged.read_bytes()[:-400])
    parts = sweep(plan, axes(), tmp_path / "parts.nc")
    assert parts.found == 3
    for name in ("frequencies", "loss_factors", "estimate", "greatest_pressure"):
        assert np.array_equal(getattr(parts, name), getattr(whole, name)), name


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="locks of POSIX")
def test_two_sweeps_into_one_file(plan, tmp_path, monkeypatch):
    def second(*given):
        raise faying.InputError("the other was not kept out")

    real = module.evaluate

    def meanwhile(model, builder, indices):
        monkeypatch.setattr(module, "evaluate", second)
        with pytest.raises(faying.InputError, match="writes to .*out.nc.part already; wait for it"):
            sweep(plan, axes(), tmp_path / "out.nc")
        monkeypatch.setattr(module, "evaluate", meanwhile)
        return real(model, builder, indices)

    monkeypatch.setattr(module, "evaluate", meanwhile)
    assert sweep(plan, axes(), tmp_path / "out.nc").path.is_file()


def test_leftovers_of_another_sweep_are_refused(plan, tmp_path):
    (tmp_path / "out.nc.part").mkdir()
    (tmp_path / "out.nc.part" / "chunk-0.npz").write_bytes(b"work")  # an empty folder has nothing to lose
    with pytest.raises(faying.InputError, match=r"out.nc.part is what another sweep has left"):
        sweep(plan, axes(), tmp_path / "out.nc")


def test_a_half_made_by_another_version_is_refused(plan, tmp_path, monkeypatch):
    """Its numbers may differ: the two halves of one sweep would come from two programs."""
    out = tmp_path / "out.nc"

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(module.Trainer, "of", stopped)
    monkeypatch.setattr(part_folder, "__version__", "0.0.9")
    with pytest.raises(KeyboardInterrupt):
        sweep(plan, axes(), out)
    with pytest.raises(KeyboardInterrupt):  # it goes on with the version that began it
        sweep(plan, axes(), out)
    monkeypatch.setattr(part_folder, "__version__", "0.1.0")
    with pytest.raises(faying.InputError, match=r"was begun by Faying 0.0.9, and this is 0.1.0, .* begin anew"):
        sweep(plan, axes(), out)
    assert (tmp_path / "out.nc.part").is_dir()  # it is not Faying's to throw away


@pytest.mark.slow
def test_processes_give_the_same(plan, done, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "CHUNK", 6)
    there = sweep(plan, axes(), tmp_path / "out.nc", jobs=2)
    assert there.frequencies == pytest.approx(done.frequencies, rel=1e-6)


@pytest.mark.slow
def test_points_beyond_the_law_are_held_there_and_counted(plan, tmp_path):
    found = sweep(plan, axes("bolt.preload=1 kN,2 kN,400 kN,800 kN"), tmp_path / "out.nc")
    assert np.isfinite(found.frequencies).all()
    assert found.above_range_share[1] == 0
    assert found.above_range_share[3] > 0.5
    assert found.to_dict()["beyond_law"] == np.count_nonzero(found.above_range_share > 0.1)
    assert found.frequencies[3] == pytest.approx(found.frequencies[2], rel=0.02)  # no law rises there any more


def test_an_axis_that_changes_nothing_is_named(plan, tmp_path):
    """Friction, under a law without slip and at levels that a sweep does not compute."""
    found = sweep(plan, axes("joint.friction=0.1,0.3", "bolt.preload=1 kN,3 kN"), tmp_path / "out.nc")
    assert found.unchanged_by() == ["joint.friction"]


def test_values_of_an_axis():
    assert axis_of("surface.D=2.2:2.6:5").values == pytest.approx((2.2, 2.3, 2.4, 2.5, 2.6))
    assert axis_of("surface.G=1e-12 m:1e-10 m:3:log").values == pytest.approx((1e-12, 1e-11, 1e-10))
    assert axis_of("bolt.left.preload=1 kN, 5 kN").values == (1000.0, 5000.0)
    assert axis_of("law.model=jk,gw").values == ("JK", "GW")
    assert axis_of("law.alpha=0.1:0.3:4").read() == "law.alpha = 0.1 to 0.3, 4 values"
    assert axis_of("bolt.preload=1 kN:20 kN:30").read() == "bolt.preload = 1 kN to 20 kN, 30 values"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("surface.D", "give key=first:last:count"),
        ("part.upper=1:2:3", "a sweep varies "),
        ("bolt.preload=1:20:30", "give the unit|unit"),
        ("surface.D=2.2:2.6:1", "whole number from 2 to"),
        ("surface.D=2.2:2.2:3", "ends must differ"),
        ("surface.D=a,b", "should be a plain finite number"),
        ("surface.D=2.2:2.6", "first:last:count"),
    ],
)
def test_faults_of_an_axis(text, message):
    with pytest.raises(faying.InputError, match=message):
        axis_of(text)


def test_faults_of_a_grid(plan):
    surfaces = surfaces_of(plan)
    for text, message in (
        ("bolt.nobody.preload=1 kN,2 kN", "no bolt is called 'nobody'"),
        ("surface.D=1.5:2.5:3", "must be between 2 and 3"),
        ("bolt.preload=-1 kN:2 kN:3", "must be positive"),
        ("joint.friction=-1:1:3", "friction = -1; it must be at least 0"),
        ("joint.friction=0:1e9:3", "friction = 1000000000; it must be at least 0 and at most 2"),
        ("law.model=nope,jk", "no contact law 'nope'"),
        ("law.counterbody=x", "counterbody = 'x'; allowed is"),
        ("law.cutoff=0:1:3", "cutoff = 0; it must be between 0 and 1"),
        ("surface.D=2.2:2.6:1000000000", "whole number from 2 to 1,000,000"),
    ):
        with pytest.raises(faying.InputError, match=message):
            Grid(study=plan, surfaces=surfaces, axes=axes(text))
    with pytest.raises(faying.InputError, match="each axis once"):
        Grid(study=plan, surfaces=surfaces, axes=axes("surface.D=2.2:2.6:3", "surface.D=2.2:2.6:3"))
    (bolt,) = plan.bolts
    with pytest.raises(faying.InputError, match="--set bolt.preload: each bolt has an axis of its own"):
        Grid(study=plan, surfaces=surfaces, axes=axes("bolt.preload=1 kN,2 kN", f"bolt.{bolt.name}.preload=3 kN,4 kN"))


def test_a_number_has_one_range_in_a_study_and_in_a_sweep(plan):
    """A fit may find a G of less than any length has; a modulus beyond that of any solid is a wrong unit."""
    given = {"D": 2.31, "G": "7.27e-15 m", "scan_area": "1 mm^2"}
    assert plan.with_("surface", given).surface.G == pytest.approx(7.27e-15)
    assert axis_of("surface.G=7.27e-15 m,1e-10 m").values[0] == pytest.approx(7.27e-15)
    stiff = {"E": "1.1e14 Pa", "nu": 0.3, "density": "7800 kg/m^3"}
    with pytest.raises(faying.InputError, match="beyond what a bolted structure has"):
        plan.with_("material.mine", stiff)
    with pytest.raises(faying.InputError, match="at most"):
        axis_of("material.mine.E=200 GPa,1.1e14 Pa")


def test_the_path_through_the_grid_meets_every_point_once_and_steps_to_neighbours(plan):
    grid = Grid(study=plan, surfaces=surfaces_of(plan), axes=axes("surface.D=2.2:2.6:3", "law.alpha=0.1:0.3:4"))
    path = grid.winding()
    assert sorted(path) == list(range(12))
    places = np.array(np.unravel_index(path, grid.shape)).T
    assert np.all(np.abs(np.diff(places, axis=0)).sum(axis=1) == 1)


def test_a_sweep_whose_middle_has_no_answer(plan, tmp_path, monkeypatch):
    """The bases begin where there is an answer; the rest is NaN and told."""
    made = VariantBuilder.laws

    def some(builder, index):
        if builder.design.point(index).forces[0] > 3e3:
            raise faying.InputError("no law here")
        return made(builder, index)

    monkeypatch.setattr(VariantBuilder, "laws", some)
    swept = sweep(plan, axes("bolt.preload=2 kN,4 kN"), tmp_path / "out.nc")
    assert np.all(np.isfinite(swept.frequencies[0]))
    assert np.all(np.isnan(swept.frequencies[1]))
    assert swept.reasons == {"no law here": 1}
    with pytest.raises(faying.InputError, match="no law here"):
        sweep(plan, axes("bolt.preload=4 kN,5 kN"), tmp_path / "none.nc")
    assert not list(tmp_path.glob("none*"))


def in_full(plan):
    """The plan with a law given in full and no surface."""
    options = {"density": 3e9, "radius": 60e-6, "sigma": 0.5e-6}
    joints = tuple(replace(joint, tangential="mindlin") for joint in plan.joints)
    return replace(plan, surface=None, joints=joints, law=LawChoice(model="gw-ke", given=options))


@pytest.mark.slow
def test_parameters_of_a_law_given_in_full(plan, tmp_path):
    given = in_full(plan)
    swept = sweep(given, axes("law.sigma=0.3 um:0.8 um:3", "bolt.preload=1 kN,3 kN"), tmp_path / "out.nc")
    assert swept.axes[0].values == pytest.approx((0.3e-6, 0.55e-6, 0.8e-6))
    law = replace(given.law, given={**given.law.given, "sigma": 0.55e-6})
    full = run(replace(pulled(given, 3e3), law=law))
    assert swept.frequencies[1, 1] == pytest.approx(full.frequencies[0], rel=1e-5)


def test_laws_take_their_own_parameters_alone(plan):
    given = in_full(plan)
    with pytest.raises(faying.InputError, match="GW-KE has no parameter 'cutoff'; it has density, radius, sigma"):
        Grid(study=given, surfaces=surfaces_of(given), axes=axes("law.cutoff=0.01,0.02"))
    with pytest.raises(faying.InputError, match=r"no joint takes its law from \[surface\]; it would change nothing"):
        Grid(study=given, surfaces=surfaces_of(given), axes=axes("surface.D=2.3,2.4"))
    with pytest.raises(faying.InputError, match='gives "gw-ke" in full; other laws would lack their surface'):
        Grid(study=given, surfaces=surfaces_of(given), axes=axes("law.model=jk,gw"))
    with pytest.raises(faying.InputError, match="JK has no parameter 'sigma'"):
        Grid(study=plan, surfaces=surfaces_of(plan), axes=axes("law.sigma=0.1 um,0.2 um"))


def test_what_a_sweep_cannot_do(plan, tmp_path):
    for changes, message in (
        ({"modes": ModesChoice(damping="viscous")}, "hysteretic loss"),
        ({"preloads": (PreloadCase((2e3,), order=(0, 1)),)}, "pulls all bolts at once"),
    ):
        with pytest.raises(faying.InputError, match=message):
            sweep(replace(plan, **changes), axes(), tmp_path / "out.nc")
    with pytest.raises(faying.InputError, match="should end in .nc"):
        sweep(plan, axes(), tmp_path / "out.csv")
    with pytest.raises(faying.InputError, match="between 1e-10 and 1e-2"):
        sweep(plan, axes(), tmp_path / "out.nc", tolerance=1.0)


@pytest.mark.slow
def test_a_sweep_over_the_crown_is_that_of_full_runs(plan, tmp_path):
    """Hollow to crowned: the same frequencies as full solutions at places that were not trained on."""
    key = "joint.form.crown_along"
    plan = replace(plan, modes=ModesChoice(count=4))
    swept = sweep(plan, axes(f"{key}=-6 um:20 um:27"), tmp_path / "out.nc")
    assert np.isfinite(swept.frequencies).all()
    assert np.abs(swept.frequencies[-1] / swept.frequencies[6] - 1).max() > 0.01  # 20 um beside flat
    for i in (2, 15):
        form = Form(crown_along=swept.axes[0].values[i])
        full = run(replace(plan, joints=tuple(replace(joint, form=form) for joint in plan.joints)))
        assert swept.frequencies[i] == pytest.approx(full.frequencies[0], rel=1e-5)
        # the error of the frequencies allows that of w^2 (1 + i eta) 2e-5 of itself, and eta as much
        assert swept.loss_factors[i] == pytest.approx(full.loss_factors[0], rel=1e-3, abs=5e-6)


def test_axes_of_a_form(plan):
    assert axis_of("joint.form.crown_along=0 um:30 um:31").values[10] == pytest.approx(1e-5)
    assert axis_of("joint.form.seed=1,2,3").values == (1.0, 2.0, 3.0)
    named = Grid(study=plan, surfaces=surfaces_of(plan), axes=axes(f"joint.{plan.joints[0].name}.form.twist=0 um,4 um"))
    assert [named.point(i).study.joints[0].form.twist for i in (0, 1)] == pytest.approx([0, 4e-6])
    with pytest.raises(faying.InputError, match="no joint is called 'x'; the joints are joint"):
        Grid(study=plan, surfaces=surfaces_of(plan), axes=axes("joint.x.form.twist=0 um,4 um"))
    with pytest.raises(faying.InputError, match=r"joint\.form\.\{crown_along, crown_across, twist"):
        axis_of("joint.form.bump=0 um:3 um:4")


TWO_VALUES = {  # of numbers whose range or unit leaves no room for those below
    "surface.D": (2.3, 2.4),
    "surface.G": (1e-10, 3e-10),
    "surface.scan_area": (1e-6, 4e-6),
    "law.counterbody": ("part", "rigid"),
    "law.alpha": (0.1, 0.3),
    "bolt.preload": (1e3, 3e3),
    "joint.form.wave_length": (0.01, 0.02),
    "joint.form.seed": (1, 2),
    "joint.form.waviness_seed": (1, 2),
}
PAIR = (faying.CATALOGUE["45 steel"], faying.CATALOGUE["45 steel"])


def acting(builder, index):
    """All by which one point of a design acts on the answer."""
    laws, forces, friction = builder.laws(index)
    p = np.array([1e6, 1e7])
    stiffness = [value for law in laws for value in (*law.stiffness(p), *law.loss(p))]
    forms = [joint.form for joint in builder.design.point(index).study.joints]
    return np.concatenate([*stiffness, forces]).tolist(), friction, forms, builder.scales(index)


@pytest.mark.parametrize(
    "key", [f"{room}.{name}" for room, one in rooms().items() if room != "law" for name in one.numbers] + ["law.alpha"]
)
def test_each_number_that_varies_acts_and_is_not_taken_for_another_value(plan, key):
    """Every declared number: two values act apart, and one builder of laws gives what two builders of their own do."""
    room, _, name = key.partition(".")
    waves = replace(plan.joints[0], form=Form(wave_length=0.03, waviness=Waviness(Wq=1e-6)))
    study = replace(plan, joints=(waves,)) if ".form." in key else plan
    one = {"part": "part.upper", "material": f"material.{study.parts['upper']}"}.get(room, room)
    unit = varied(f"{one}.{name}").parameter.unit
    values = TWO_VALUES.get(key, {"m": (1e-6, 3e-6), "Pa": (190e9, 210e9), "kg/m^3": (7e3, 8e3)}.get(unit, (0.3, 0.6)))
    axis = Axis(key=f"{one}.{name}", unit=unit, values=values)
    grid = Grid(study=study, surfaces=surfaces_of(study), axes=(axis,))
    shared = VariantBuilder(design=grid, pairs=(PAIR,))
    found = [acting(shared, index) for index in (0, 1, 0)]
    assert found[0] != found[1]
    for index, mine in zip((0, 1, 0), found, strict=True):
        assert mine == acting(VariantBuilder(design=grid, pairs=(PAIR,)), index)


def test_a_part_of_twice_the_mass_has_the_waves_of_one_of_half_the_stiffness():
    """E over the density says how fast they run."""
    steel = PAIR[0]
    for name, factor in (("mass", 2.0), ("stiffness", 0.5)):
        changed = varied(f"part.a.{name}").put(steel, factor)
        assert changed.E / changed.density == pytest.approx(0.5 * steel.E / steel.density)
