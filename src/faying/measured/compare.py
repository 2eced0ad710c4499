"""A hammer test against a model: MAC, paired modes, frequencies, damping, FRFs."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from faying.measured.frf import FRF, Dof
from faying.measured.mac import frac, mac
from faying.measured.mapping import PointMap, Transform, map_points
from faying.measured.model import ModelModes
from faying.measured.modes import ModeSet
from faying.measured.pairing import pair_modes
from faying.misuse import checked_call
from faying.style import Summary
from faying.text import csv_text
from faying.typing import Array, Complex, Index, Mask

ALIKE = 0.9
HEAD = "test mode,test [Hz],model mode,model [Hz],difference [%],MAC,test loss,interval,model loss"
CSV_HEAD = (
    "test mode,test frequency [Hz],test loss factor [-],loss low [-],loss high [-],model mode,model frequency [Hz],"
    "model loss factor [-],frequency difference [-],MAC [-]"
)


@dataclass(frozen=True, kw_only=True, repr=False)
class ModalComparison(Summary):
    """A test against a model.

    Args:
        test: its modes.
        model: its modes, with a point of its own wherever the test has one between nodes.
        dofs: degrees of freedom of the test that lie on the model (d,).
        nodes: where they are in the model (d,).
        axes: along what in the model (d, 3).
        mac: MAC (t, m) [-].
        pairs: indices (test, model), (k, 2).
        point_map: nodes, distances, points that were left out.
        frf: the measured FRFs between such degrees of freedom, or None.
        predicted: the model's (o, i, f), NaN at spectral lines that it does not cover.
        frac: (o, i) [-].
        full: (o, i), whether the model's is its full response or its elastic modes superposed.
        notes: sentences for the reader.
    """

    test: ModeSet
    model: ModelModes
    dofs: tuple[Dof, ...]
    nodes: Index
    axes: Array
    mac: Array
    pairs: Index
    point_map: PointMap
    frf: FRF | None = None
    predicted: Complex | None = None
    frac: Array | None = None
    full: Mask | None = None
    notes: tuple[str, ...] = ()

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and frequency, difference and MAC of the first pairs."""
        rows = {}
        for (test, model), difference in list(zip(self.pairs, self.frequency_difference, strict=True))[:9]:
            rows[f"test {test + 1}, model {model + 1}"] = (
                f"{self.test.frequencies[test]:.1f} Hz, model {difference:+.2%}, MAC {self.mac[test, model]:.2f}"
            )
        counts = f"{len(self.pairs)} pairs of {len(self.test.frequencies)} test and {len(self.model.frequencies)} model"
        rows["notes"] = f"{len(self.notes)}, in .notes" if self.notes else "none"
        return f"Test against model: {counts} modes", rows

    @property
    def places(self) -> dict[int, int]:
        """Where each point of the test is among the model's points."""
        return {dof.point: int(node) for dof, node in zip(self.dofs, self.nodes, strict=True)}

    @property
    def frequency_difference(self) -> Array:
        """Model over test minus one (k,)."""
        t, m = self.pairs.T
        return np.asarray(self.model.frequencies[m] / self.test.frequencies[t] - 1)

    @property
    def _partner(self) -> dict[int, int]:
        """Mode of the model with which a mode of the test is paired."""
        return {int(t): int(m) for t, m in self.pairs}

    def model_shapes(self) -> Array:
        """The model's shapes along the test's degrees of freedom (m, d)."""
        return np.asarray(np.einsum("mdx,dx->md", self.model.shapes[:, self.nodes], self.axes))

    def rows(self) -> list[list[str]]:
        """One row per mode of the test, with its partner where there is one; then the model's modes without."""
        out = [HEAD.split(",")]
        for t, (f, loss) in enumerate(zip(self.test.frequencies, self.test.loss_factors, strict=True)):
            span = self.test.loss_interval
            interval = "-" if span is None else f"{span[t, 0]:.1e} .. {span[t, 1]:.1e}"
            m = self._partner.get(t)
            if m is None:
                found, model_loss = ["-", "-", "-", f"{self.mac[t].max():.2f} at best"], "-"
            else:
                frequency, model_loss = self.model.frequencies[m], f"{self.model.loss_factors[m]:.2e}"
                difference = f"{100 * (frequency / f - 1):+.2f}"
                found = [str(m + 1), f"{frequency:.2f}", difference, f"{self.mac[t, m]:.3f}"]
            out.append([str(t + 1), f"{f:.2f}", *found, f"{loss:.2e}", interval, model_loss])
        return out

    def csv_text(self) -> str:
        """The pairs as CSV, SI, units in the heading; a mode of the test without partner has empty cells."""
        rows: list[list[Any]] = [CSV_HEAD.split(",")]
        for t, (f, loss) in enumerate(zip(self.test.frequencies, self.test.loss_factors, strict=True)):
            span = ["", ""] if self.test.loss_interval is None else [f"{v:.8g}" for v in self.test.loss_interval[t]]
            row = [t + 1, f"{f:.8g}", f"{loss:.8g}", *span]
            m = self._partner.get(t)
            if m is not None:
                frequency, model_loss = self.model.frequencies[m], self.model.loss_factors[m]
                values = frequency, model_loss, frequency / f - 1, self.mac[t, m]
                row += [m + 1, *(f"{v:.8g}" for v in values)]
            rows.append(row + [""] * (10 - len(row)))
        return csv_text(rows)

    def to_dict(self) -> dict[str, Any]:
        """Everything but maps and FRFs, ready for JSON."""
        return {
            "test": {
                "source": self.test.source,
                "frequencies": self.test.frequencies.tolist(),
                "loss_factors": self.test.loss_factors.tolist(),
                "loss_interval": None if self.test.loss_interval is None else self.test.loss_interval.tolist(),
            },
            "model": {
                "source": self.model.source,
                "title": self.model.title,
                "preload": self.model.load,
                "frequencies": self.model.frequencies.tolist(),
                "loss_factors": self.model.loss_factors.tolist(),
            },
            "mac": self.mac.tolist(),
            "pairs": [
                {"test": int(t), "model": int(m), "frequency_difference": float(d), "mac": float(self.mac[t, m])}
                for (t, m), d in zip(self.pairs, self.frequency_difference, strict=True)
            ],
            "points": {
                "nodes": {str(k): v for k, v in self.point_map.nodes.items()},
                "distance": {str(k): v for k, v in self.point_map.distance.items()},
                "without_partner": {str(k): v for k, v in self.point_map.missing.items()},
                "tolerance": self.point_map.tolerance,
            },
            "frac": None
            if self.frac is None or self.frf is None
            else [
                {
                    "output": str(self.frf.outputs[o]),
                    "input": str(self.frf.inputs[i]),
                    "frac": float(self.frac[o, i]),
                    "model": "full response" if self.full is not None and self.full[o, i] else "elastic modes",
                }
                for o, i in self.frf.measured
            ],
            "units": "SI: Hz, m, N; loss factors, MAC and FRAC without unit; modes count from 0",
            "notes": list(self.notes),
        }


@checked_call
def compare_modes(
    test: ModeSet,
    model: ModelModes,
    *,
    transform: Transform | None = None,
    tolerance: float | None = None,
    frf: FRF | None = None,
    least_mac: float = 0.5,
    greatest_shift: float = 0.3,
) -> ModalComparison:
    """Compare a test with a model: map its points, compute MAC at what both know, pair the modes, predict the FRFs.

    An FRF is predicted by the full response of the model where that is known, else by its elastic modes.

    Args:
        test: modes of the test, with positions of its points.
        model: modes of the model.
        transform: from the frame of the test to that of the model (default: the same frame).
        tolerance: largest distance between a point and the model [m] (default: 2 % of the model's diagonal).
        frf: the measured FRFs, to set the model's beside.
        least_mac: smallest MAC of a pair, in (0, 1].
        greatest_shift: largest relative difference in frequency of a pair, positive.

    Returns:
        ModalComparison.

    Raises:
        InputError: where no point lies on the model, or a direction is not a translation.

    Source:
        Allemang 2003, Sound and Vibration 37(8) (MAC); Heylen and Lammens 1996 (FRAC).
    """
    known = {d.point for d in test.dofs}
    positions = {p: x for p, x in test.positions.items() if p in known}
    points = map_points(positions, model.points, triangles=model.triangles, transform=transform, tolerance=tolerance)
    notes = _left_out(test, points)
    used = tuple(d for d in test.dofs if d.point in points.nodes)
    model, places = _with_places(model, points)
    nodes = np.array([places[d.point] for d in used])
    axes = points.transform.directions([d.axis() for d in used])
    theirs = np.einsum("mdx,dx->md", model.shapes[:, nodes], axes)
    table = mac(test.at(used), theirs)
    pairs = pair_modes(table, test.frequencies, model.frequencies, least_mac=least_mac, greatest_shift=greatest_shift)
    notes += _alike(theirs, pairs, len(used))
    shared, predicted, full, score = _overlay(frf, model, points, places, notes)
    return ModalComparison(
        test=test,
        model=model,
        dofs=used,
        nodes=nodes,
        axes=axes,
        mac=table,
        pairs=pairs,
        point_map=points,
        frf=shared,
        predicted=predicted,
        full=full,
        frac=score,
        notes=tuple(notes),
    )


def _left_out(test: ModeSet, points: PointMap) -> list[str]:
    """Say which points of the test are not compared, and which are on a joint."""
    notes = []
    nowhere = sorted({d.point for d in test.dofs} - set(test.positions))
    if test.positions and nowhere:
        notes.append(f"points {', '.join(map(str, nowhere))} have modes but no position; they are left out")
    if points.seams:
        on = ", ".join(map(str, points.seams))
        notes.append(
            f"points {on} lie on nodes of two parts, of which one is taken; MAC suffers where the other is meant"
        )
    if points.missing:
        far = ", ".join(f"{p} ({d * 1e3:.3g} mm away)" for p, d in points.missing.items())
        notes.append(f"points farther than {points.tolerance * 1e3:.3g} mm from the model, left out: {far}")
    return notes


def _with_places(model: ModelModes, points: PointMap) -> tuple[ModelModes, dict[int, int]]:
    """The model with a point of its own wherever the test has one between nodes, and the index of each test point."""
    between = [p for p in points.nodes if max(points.weights[p]) < 1 - 1e-9]
    places = {p: points.corners[p][int(np.argmax(points.weights[p]))] for p in points.nodes}
    if not between:
        return model, places
    corners, weights, nearest = (
        np.array([of[p] for p in between]) for of in (points.corners, points.weights, points.nodes)
    )
    places |= {p: len(model.points) + k for k, p in enumerate(between)}
    return model.with_places(corners, weights, nearest), places


def _alike(shapes: Array, pairs: Index, count: int) -> list[str]:
    """Say which of the paired model modes the points of the test cannot tell from another."""
    own = mac(shapes, shapes)
    words = []
    for m in pairs[:, 1]:
        same = [k for k in np.flatnonzero(own[m] > ALIKE) if k != m]
        if same:
            others = ", ".join(str(k + 1) for k in same)
            words.append(
                f"at the {count} degrees of freedom of the test, model mode {m + 1} looks like {others} (MAC above "
                f"{ALIKE}); the pair rests on frequency"
            )
    return words


def _overlay(
    frf: FRF | None, model: ModelModes, points: PointMap, places: dict[int, int], notes: list[str]
) -> tuple[FRF | None, Complex | None, Mask | None, Array | None]:
    """The FRFs between mapped degrees of freedom, the model's, which of these are its full response, and their FRAC."""
    if frf is None:
        return None, None, None, None
    o = [k for k, d in enumerate(frf.outputs) if d.point in points.nodes]
    i = [k for k, d in enumerate(frf.inputs) if d.point in points.nodes]
    if not o or not i or not np.isfinite(frf.values[np.ix_(o, i)]).any():
        notes.append("no FRF is between points that have a node; FRFs are not compared")
        return None, None, None, None
    outputs, inputs = tuple(frf.outputs[k] for k in o), tuple(frf.inputs[k] for k in i)
    kept = replace(frf, values=frf.values[np.ix_(o, i)], outputs=outputs, inputs=inputs, coherence=None)
    shared = replace(kept, window_decay=0.0, warnings=())
    ends = [
        (np.array([places[d.point] for d in side]), points.transform.directions([d.axis() for d in side]))
        for side in (outputs, inputs)
    ]
    predicted = model.frf(shared.frequency, ends[0], ends[1], shared.quantity)
    known = model.full_frf(shared.frequency, ends[0], ends[1], shared.quantity)
    full = np.isfinite(known).sum(axis=2) >= 2
    predicted[full] = known[full]
    score = np.full(predicted.shape[:2], np.nan)
    for pair in shared.measured:
        there = np.isfinite(predicted[pair])
        score[pair] = frac(shared.values[pair][there], predicted[pair][there])
    notes += _kind_of_response(shared, predicted, full)
    return shared, predicted, full, score


def _kind_of_response(frf: FRF, predicted: Complex, full: Mask) -> list[str]:
    """Say which of the model's FRFs are its full response, and where that ends."""
    measured = frf.measured
    count = sum(bool(full[pair]) for pair in measured)
    superposed = "its elastic modes superposed: rigid motion and higher modes are not in them"
    if not count:
        return [f"the model's FRFs are {superposed}"]
    out = ["the model's FRFs are its full response, with rigid motion and the static part of higher modes"]
    if count < len(measured):
        out = [f"the model's FRFs: {count} of {len(measured)} are its full response; the others are {superposed}"]
    pair = next(p for p in measured if full[p])
    lines = frf.frequency[np.isfinite(predicted[pair])]
    if lines[0] > frf.frequency[frf.frequency > 0][0] or lines[-1] < frf.frequency[-1]:
        out.append(
            f"the full response reaches from {lines[0]:g} to {lines[-1]:g} Hz; the other spectral lines do not count "
            "in FRAC"
        )
    return out
