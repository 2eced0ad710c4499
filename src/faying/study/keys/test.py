"""The hammer test of a study: a list of frequencies, or a file of modes or FRFs."""

from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np

from faying.errors import InputError
from faying.joint.preload_case import preload_index
from faying.study.declaration.declared import QUANTITY, REQUIRED, WORDS, Declared, Key, listed
from faying.study.declaration.reader import Table
from faying.study.declaration.values import direction as read_direction
from faying.study.declaration.values import point, text
from faying.study.declaration.values import quantity as read_quantity
from faying.typing import Array, Index

CROSSED = 0.9  # of the frequency before it: modes that cross with preload may stand in the order of another load
QUANTITIES = ("receptance", "mobility", "accelerance")


@dataclass(frozen=True, kw_only=True)
class TestChoice:
    """Frequencies [Hz] per load, the published model's where there is one, and what the test can see.

    kind: "test" where they were measured, "model" where they are those of somebody's model.

    losses: measured loss factors [-] per load, NaN where there is none; None where the test has none.

    A mode is seen where its motion along `direction` at one of `points` [m] is at least `threshold` of the largest
    among the modes.
    """

    source: str
    frequencies: tuple[tuple[float, ...], ...]
    published: tuple[tuple[float, ...], ...] | None
    published_name: str
    kind: Literal["test", "model"]
    direction: tuple[float, float, float]
    points: tuple[tuple[float, float, float], ...]
    threshold: float = 0.1
    losses: tuple[tuple[float, ...], ...] | None = None

    def seen(self, points: Array) -> tuple[Index, Array]:
        """Of nodes (n, 3) [m] those nearest to the points of the test, and the unit vector of its direction."""
        axis = np.array(self.direction)
        near = [int(np.argmin(np.linalg.norm(points - np.array(p), axis=1))) for p in self.points]
        return np.array(near, dtype=np.int64), axis / np.linalg.norm(axis)


@dataclass(frozen=True, kw_only=True)
class HammerChoice:
    """A universal file of modes or FRFs, and what `faying compare` takes with it.

    points, frame: tables of positions; length_unit, direction (x, y or z), quantity: what the file does not say;
    tolerance [m] between point and node, None for its default; least_mac, greatest_shift [-]: what a pair must have;
    load: index of the preload to compare at.
    """

    file: Path
    load: int
    source: str = ""
    points: Path | None = None
    frame: Path | None = None
    length_unit: str | None = None
    direction: str | None = None
    quantity: str | None = None
    tolerance: float | None = None
    least_mac: float = 0.5
    greatest_shift: float = 0.3


def read_test(top: Table, loads: tuple[float, ...]) -> tuple[TestChoice | None, HammerChoice | None]:
    """Read [test]: frequencies for each of `loads` [N], or a file; whichever it is, the other is None."""
    table = top.table("test")
    if table is None:
        return None, None
    if "file" in table.data and "frequencies" in table.data:
        top.faults.add("test has both file and frequencies; give one of them")
    listed, hammer = (None, _file(table, loads)) if "file" in table.data else (_listed(table, len(loads)), None)
    return listed, hammer


def _listed(table: Table, loads: int) -> TestChoice:
    def rows(value: Any, name: str) -> tuple[tuple[float, ...], ...]:
        if not isinstance(value, list) or not all(isinstance(row, list) for row in value):
            raise InputError(f"{name} should be one list of frequencies for each preload")
        if len(value) != loads:
            raise InputError(f"{name} has {len(value)} rows for {loads} preloads; give one list for each")
        counts = sorted({len(row) for row in value})
        if len(counts) > 1 or counts == [0]:
            some = " and ".join(map(str, counts))
            raise InputError(
                f"{name} has rows of {some} frequencies; give the same modes, one or more, at each preload"
            )
        found = tuple(tuple(read_quantity(v, "Hz", name) for v in row) for row in value)
        for row in found:
            for low, high in pairwise(row):
                if high < CROSSED * low:
                    raise InputError(
                        f"{name}: {high:g} Hz stands after {low:g} Hz; give the modes in the order they have"
                    )
        return found

    frequencies = table.take("frequencies", rows) or ()
    return TestChoice(
        source=table.get("source"),
        frequencies=frequencies,
        losses=_losses(table, [len(row) for row in frequencies]),
        published=table.take("published", rows),
        published_name=table.get("published_name"),
        kind=table.get("kind"),
        direction=table.get("direction") or (1.0, 0.0, 0.0),
        points=table.take("points", _points, REQUIRED) or (),
        threshold=table.get("threshold"),
    )


def _losses(table: Table, modes: list[int]) -> tuple[tuple[float, ...], ...] | None:
    """Loss factors, or damping ratios, which are half of them: a number for each frequency, nan for none."""

    def rows(value: Any, name: str) -> tuple[tuple[float, ...], ...]:
        shape = [len(row) if isinstance(row, list) else -1 for row in value] if isinstance(value, list) else None
        if shape != modes:
            raise InputError(f"{name} should have a number for each of the frequencies, one list for each preload")
        found = tuple(tuple(_share(v, name) for v in row) for row in value)
        return tuple(tuple(2 * v for v in row) for row in found) if name.endswith("damping_ratios") else found

    if "loss_factors" in table.data and "damping_ratios" in table.data:
        table.faults.add("test has both loss_factors and damping_ratios; give one of them")
    given = table.take("loss_factors", rows, None), table.take("damping_ratios", rows, None)
    return next((one for one in given if one), None)


def _share(value: Any, name: str) -> float:
    """A positive share as a plain number or in percent; nan where nothing was measured."""
    found = read_quantity(value, "", name) if isinstance(value, str) else value
    if isinstance(found, bool) or not isinstance(found, int | float) or not (0 < found < 2 or found != found):
        raise InputError(
            f'{name} has {value!r}; give a plain number above 0, for example 2e-3, or "0.2 %"; nan for none'
        )
    return float(found)


def _file(table: Table, loads: tuple[float, ...]) -> HammerChoice:
    def load(value: Any, name: str) -> int:
        return preload_index(loads, read_quantity(value, "N", name), name=name)

    table.take("frequencies", lambda _value, _name: None, None)
    return HammerChoice(
        file=table.get("file") or Path(),
        load=table.take("load", load, len(loads) - 1),
        source=table.get("source"),
        points=table.existing("points"),
        frame=table.get("frame"),
        length_unit=table.get("length_unit"),
        direction=table.take("direction", partial(text, choices=("x", "y", "z")), None),
        **{key: table.get(key) for key in ("quantity", "tolerance", "least_mac", "greatest_shift")},
    )


def _points(value: Any, name: str) -> tuple[tuple[float, float, float], ...]:
    if not isinstance(value, list) or not value:
        raise InputError(f"{name} should be a list of points, each three lengths")
    return tuple(point(one, name) for one in value)


FREQUENCIES = "one list of frequencies for each preload"
NUMBERS = "one list for each preload, a number for each frequency"
EACH = listed(listed(QUANTITY, 1), 1)
LOSSES = listed(listed({"type": ["number", "string"]}, 1), 1)
TEST: Declared = {
    "frequencies": Key(FREQUENCIES, EACH, "Measured frequencies, a list for each preload.", REQUIRED, unit="Hz"),
    "source": Key.text("Words for the report.", ""),
    "loss_factors": Key(
        NUMBERS,
        LOSSES,
        "Measured loss factors, a number for each frequency, nan for none: `faying identify` uses them.",
    ),
    "damping_ratios": Key(
        NUMBERS, LOSSES, "Measured damping ratios, in place of loss factors, which are twice as much."
    ),
    "published": Key(FREQUENCIES, EACH, "Frequencies of a published model, a list for each preload.", unit="Hz"),
    "published_name": Key.text("What tables call that model.", "published"),
    "kind": Key.text("Whether the frequencies were measured or are those of a model.", "test", ("test", "model")),
    "direction": Key(
        'three numbers, for example [1, 0, 0]; with file "x", "y" or "z"',
        {"anyOf": [listed({"type": "number"}, 3, 3), {"enum": ["x", "y", "z"]}]},
        "Direction of the hammer or sensor.",
        REQUIRED,
        read=read_direction,
    ),
    "points": Key(
        "a list of points, each three lengths; with file the name of a table of them",
        {"anyOf": [listed(listed(QUANTITY, 3, 3), 1), WORDS]},
        "Where the hammer hits or the sensor sits.",
        unit="m",
    ),
    "threshold": Key.within(0, 1, "Share of the largest motion from which the test sees a mode.", 0.1),
    "file": Key.file("Universal file of modes or FRFs, in place of frequencies.", REQUIRED),
    "load": Key("quantity [N]", QUANTITY, "The preload to compare at; the last where left out.", unit="N"),
    "frame": Key.file("Table of points of the test with their place in the model."),
    "length_unit": Key.text("Unit of the positions, where the file states none."),
    "quantity": Key.text("What the FRFs are, where the file does not say.", None, QUANTITIES),
    "tolerance": Key.quantity("m", "Largest distance between a point of the test and the outline."),
    "least_mac": Key.within(0.01, 1, "Least MAC of a pair of modes.", 0.5),
    "greatest_shift": Key.within(1e-6, 10, "Greatest relative difference of frequency in a pair.", 0.3),
}
