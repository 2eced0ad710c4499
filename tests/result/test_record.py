"""A record as a tree of named arrays: on disk, in xarray, as a table; what a file lacks is said when it is read."""

from dataclasses import replace

import h5netcdf
import numpy as np
import pytest

import faying
from faying.result import Result
from faying.result.fields import declared, load_texts
from tests.helpers.scenes import two_boxes


@pytest.fixture
def written(tmp_path):
    result = two_boxes()
    return result, result.save(tmp_path / "result.nc")


def test_any_saved_file_is_read_as_what_it_is(written):
    result, path = written
    assert faying.load(path) == result
    assert faying.load(str(path)) == Result.load(path)


def test_the_tree_has_groups_and_loads_by_their_names(written):
    result, path = written
    tree = faying.load(path).to_xarray()
    assert {"modes", "joints", "bolts", "points", "surface"} <= set(tree.children)
    name = load_texts(result.loads)[1]
    found = tree["modes"].frequency.sel(load=name)
    assert np.array_equal(found.values, result.frequencies[1])
    assert found.attrs["units"] == "Hz"
    assert float(found.preload) == result.loads[1]
    assert np.array_equal(tree["points"].pressure.sel(load=name), result.pressure[1])


def test_a_table_has_a_row_for_each_load_and_mode(written):
    result, _ = written
    table = result.to_dataframe("modes")
    assert list(table.index.names) == ["load", "mode"]
    assert len(table) == result.frequencies.size
    name = load_texts(result.loads)[-1]
    assert table.frequency[name, 2] == result.frequencies[-1, 1]
    assert table.bonded[name, 2] == result.bonded[1]
    assert table.preload[name, 1] == result.loads[-1]
    assert table.attrs["units"]["frequency"] == "Hz"
    with pytest.raises(faying.InputError, match="the groups are .*'modes'"):
        result.to_dataframe("mode")


@pytest.mark.parametrize(
    ("group", "name"), [("points", "pressure"), ("modes", "frequency"), ("surface", "shape"), ("", "preload")]
)
def test_a_file_without_a_variable_is_refused_when_it_is_read(written, group, name):
    """A result without its pressures would fail later, at the first picture."""
    _, path = written
    import h5py

    with h5py.File(path, "r+") as file:
        del file[f"{group}/{name}" if group else name]
    with pytest.raises(faying.ReadError, match=f"it lacks '{name}'"):
        faying.load(path)


def test_a_file_of_another_kind_is_refused(written, tmp_path):
    _, path = written
    with pytest.raises(faying.ReadError, match="has a result, not a backbone; read it with faying.load"):
        faying.Backbone.load(path)
    other = tmp_path / "other.nc"
    with h5netcdf.File(other, "w") as file:
        file.dimensions["x"] = 2
        file.create_variable("a", ("x",), data=np.zeros(2))
    with pytest.raises(faying.ReadError, match="has nothing that faying.load reads"):
        faying.load(other)
    (tmp_path / "text.nc").write_text("no file of this kind")
    with pytest.raises(faying.ReadError, match="not a NetCDF-4 file"):
        faying.load(tmp_path / "text.nc")
    with pytest.raises(faying.ReadError, match="no such file"):
        faying.load(tmp_path / "absent.nc")


def test_a_number_that_is_none_never_enters_a_result(written):
    """NaN stands only where a quantity declares gaps, and an infinite number nowhere."""
    result, _ = written
    for name, meta in declared(Result).items():
        values = getattr(result, name)
        if values is None or not values.size or values.dtype.kind not in "fc":
            continue
        for value in (np.nan, np.inf):
            bad = np.array(values)
            bad.flat[0] = value
            if meta.gaps and np.isnan(value):
                assert np.isnan(getattr(replace(result, **{name: bad}), name).flat[0])
            else:
                with pytest.raises(faying.InputError, match=f"NaN in {name};"):
                    replace(result, **{name: bad})


def test_labels_of_loads_differ():
    assert load_texts(np.array([4e3, 8e3, 12.5e3])) == ("4 kN", "8 kN", "12.5 kN")
    assert len(set(load_texts(np.array([8e3, 8e3 * (1 + 1e-9)])))) == 2


def test_equality_sees_every_array(written):
    result, _ = written
    assert replace(result, k_n=result.k_n * (1 + 1e-12)) != result
