from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import faying
from faying.output.figures import sweep as drawing
from faying.style import save
from faying.sweeps.axes import axis_of
from faying.sweeps.files import Sweep


def made(*texts, modes=3):
    """A sweep whose mode m has (m + 1) 100 Hz times one plus a hundredth of the place on each axis."""
    axes = tuple(axis_of(text) for text in texts)
    shape = tuple(len(a.values) for a in axes)
    place = sum(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"))
    f = np.multiply.outer(1 + 0.01 * place, 100.0 * np.arange(1, modes + 1))
    nothing = np.zeros(shape)
    return Sweep(
        title="s",
        axes=axes,
        frequencies=f,
        loss_factors=0 * f,
        estimate=nothing,
        greatest_pressure=nothing,
        open_share=nothing,
        above_range_share=nothing,
        reasons={},
        tolerance=1e-6,
        unknowns=1,
        basis=(1, 1),
        path=Path("s.nc"),
    )


def ax():
    return Figure().add_subplot()


def test_change_along_one_axis_in_per_cent_with_units():
    axes = drawing.relative_change(ax(), made("bolt.preload=1 kN:5 kN:5"))
    assert len(axes.lines) == 3
    for line in axes.lines:
        np.testing.assert_allclose(line.get_xdata(), [1, 2, 3, 4, 5])
        np.testing.assert_allclose(line.get_ydata(), [0, 1, 2, 3, 4], atol=1e-9)
    assert axes.get_xlabel() == "preload [kN]"
    assert axes.get_xscale() == "linear"


def test_points_without_answer_are_left_out_and_do_not_serve_as_reference():
    sweep = made("surface.G=1e-12 m:1e-10 m:3:log")
    sweep.frequencies[0] = np.nan
    axes = drawing.relative_change(ax(), sweep)
    np.testing.assert_allclose(axes.lines[0].get_ydata(), [np.nan, 0, 100 * (1.02 / 1.01 - 1)], atol=1e-9)
    assert axes.get_xlabel() == "fractal roughness $G$ [pm]"
    assert axes.get_xscale() == "log"


def test_map_over_two_axes_has_the_first_along_x():
    sweep = made("surface.D=2.3:2.4:3", "law.model=jk,gw")
    axes = drawing.frequency_map(ax(), sweep, 1)
    values = axes.collections[0].get_array().reshape(2, 3)
    np.testing.assert_allclose(values, sweep.frequencies[..., 1].T)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("fractal dimension $D$", "contact law")
    assert [t.get_text() for t in axes.get_yticklabels()] == ["JK", "GW"]


@pytest.mark.parametrize("ending", ["svg", "png"])
def test_files(ending, tmp_path):
    for name, sweep in (
        ("one", made("bolt.preload=1 kN:5 kN:5")),
        ("two", made("surface.D=2.3:2.4:3", "law.alpha=.1:.2:2")),
    ):
        path = save(drawing.figure(sweep), tmp_path / f"{name}.{ending}")
        assert path.stat().st_size > 5000
    assert (
        len(drawing.figure(made("surface.D=2.3:2.4:3", "law.alpha=.1:.2:2", modes=6)).axes) == 2 * 4
    )  # with colour bars


def test_what_cannot_be_drawn_is_said_before_anything_is_computed(tmp_path):
    with pytest.raises(faying.InputError, match=r"figures can be written as"):
        drawing.check(tmp_path / "a.xyz", 1)
    with pytest.raises(faying.InputError, match="the sweep has 3; leave out --plot"):
        drawing.check(tmp_path / "a.svg", 3)
    with pytest.raises(faying.InputError, match="no folder"):
        drawing.check(tmp_path / "none" / "a.svg", 1)
