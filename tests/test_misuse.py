"""Wrong calls are compared with the signature: what was given, what is allowed."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from faying.errors import InputError
from faying.misuse import checked_call, described, matches, numbers


class Pair(NamedTuple):
    point: int
    axis: str


@pytest.mark.parametrize(
    ("hint", "good", "bad"),
    [
        (float, (1, 2.5, np.float64(3)), (True, "1", None, 1j, np.zeros(2))),
        (int, (1, np.int64(3)), (1.5, True, "1")),
        (bool, (True, np.True_), (1, "yes", None)),
        (str | Path, ("a", Path("a")), (1, b"a", None)),
        (float | None, (None, 1.0), ("1",)),
        (Literal["H1", 2], ("H1", 2), ("h1", 2.0, True)),
        (tuple[str, str], (("a", "b"), ["a", "b"]), ("ab", ("a",), ("a", 1))),
        (tuple[float, ...], ((), (1, 2.0)), ((True,), "12", 1.0)),
        (Sequence[str], (["a"], ()), ("a", [1], None)),
        (Mapping[str, float | str], ({}, {"a": 1, "b": "2"}), ({1: 2}, {"a": None}, [])),
        (NDArray[np.float64], (np.zeros(3), [1, 2], 3.0), ("1", None, ["a"], {}, Path("a"))),
        (ArrayLike, (np.zeros(3), [1, 2]), ("1", None, object())),
        (Pair, (Pair(1, "x"), (1, "x")), ((1,), "ab", 3)),
        (Any, (None, 1, object()), ()),
    ],
)
def test_values_are_compared_with_types(hint, good, bad):
    assert all(matches(value, hint) for value in good)
    assert not any(matches(value, hint) for value in bad)
    assert described(hint)


@checked_call
def shift(length: float, *, along: Literal["x", "y"] = "x", names: Sequence[str] = ()) -> float:
    """Return the length."""
    return length


def test_a_right_call_is_passed_on():
    assert shift(2.0, along="y") == 2.0
    assert shift.__doc__ == "Return the length."


@pytest.mark.parametrize(
    ("args", "given", "text"),
    [
        ((), {}, "shift: missing a required argument: 'length'; it needs length, and takes length, along, names"),
        ((1.0,), {"alon": "x"}, "shift takes no alon; did you mean along"),
        ((1.0, 2.0), {}, "shift: too many positional arguments"),
        (("far",), {}, "shift: length = 'far'; give a number"),
        ((1.0,), {"along": "z"}, """shift: along = 'z'; give "x" or "y\""""),
        ((1.0,), {"names": "ab"}, "shift: names = 'ab'; give a list of text"),
        ((np.zeros((9, 9)),), {}, r"shift: length = an array of shape \(9, 9\); give a number"),
    ],
)
def test_a_wrong_call_is_answered_in_words(args, given, text):
    with pytest.raises(InputError, match=text):
        shift(*args, **given)


def test_numbers_have_a_shape():
    assert numbers([[1, 2]], "places", "points", 2).dtype == float
    for value, text in (
        ([1, 2], r"places has the shape \(2,\); give \(points, 2\)"),
        ("ab", r"places = 'ab'; give an array of numbers of the shape \(points, 2\)"),
        ([[1j, 2]], "give an array of numbers"),
    ):
        with pytest.raises(InputError, match=text):
            numbers(value, "places", "points", 2)
