"""The model's side: modes at its nodes from plain arrays or a result file, and FRFs by their superposition."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from faying.errors import InputError
from faying.measured.frf import QUANTITIES
from faying.misuse import checked_call, numbers
from faying.style import Summary
from faying.text import listed
from faying.typing import Array, Complex, Index
from faying.units import load_text

SAME_DIRECTION = 0.9998  # cosine of a degree


@dataclass(frozen=True, kw_only=True)
class FullResponse:
    """Receptance (o, i, f) [m/N] that answers the model's full equations, at frequency [Hz] (f,).

    outputs, inputs: positions [m] (k, 3) and directions (k, 3).
    """

    frequency: Array
    receptance: Complex
    outputs: tuple[Array, Array]
    inputs: tuple[Array, Array]

    def __post_init__(self) -> None:
        shape = (len(self.outputs[0]), len(self.inputs[0]), len(self.frequency))
        if self.receptance.shape != shape:
            raise InputError(
                f"a full response of the shape {self.receptance.shape}; its outputs, inputs and frequencies need "
                f"{shape}"
            )


@checked_call
@dataclass(frozen=True, kw_only=True, repr=False)
class ModelModes(Summary):
    """Elastic modes of a model at the points of its outline.

    Args:
        frequencies: [Hz], shape (m,).
        loss_factors: [-] (m,).
        shapes: of unit modal mass [kg^-1/2], (m, n, 3).
        points: of the outline [m] (n, 3).
        triangles: of the outline (t, 3), between which shapes are interpolated; may be empty.
        load: the preload [N] that the modes belong to.
        title: of the study.
        source: the file.
        full: the full response at some points, where that is known.
        near: the outline's own point beside each point (n,), where points have been added; None for themselves.

    Raises:
        InputError: where the arrays do not fit together.
    """

    frequencies: Array
    loss_factors: Array
    shapes: Array
    points: Array
    triangles: Index = field(default_factory=lambda: np.zeros((0, 3), dtype=np.int64))
    load: float = 0.0
    title: str = ""
    source: str = ""
    full: FullResponse | None = None
    near: Index | None = None

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and the first frequencies."""
        shown = listed((f"{f:.2f}" for f in self.frequencies), 8)
        rows = {"frequencies": f"{shown} Hz", "points": str(len(self.points)), "source": self.source or "a run"}
        return f"{len(self.frequencies)} modes of {self.title or 'a model'!r} at {load_text(self.load)}", rows

    def __post_init__(self) -> None:
        m = len(numbers(self.frequencies, "frequencies", "modes"))
        n = len(numbers(self.points, "points", "points", 3))
        numbers(self.loss_factors, "loss_factors", m)
        if np.shape(self.shapes) != (m, n, 3):
            raise InputError(
                f"shapes of {np.shape(self.shapes)} for {m} frequencies at {n} points; they need ({m}, {n}, 3)"
            )

    def with_places(self, corners: Index, weights: Array, nearest: Index) -> Self:
        """The same modes, known at more points too: interpolated between corners (k, 3) by weights (k, 3).

        nearest (k,): the outline's own point beside each.
        """
        own = np.arange(len(self.points)) if self.near is None else self.near
        return replace(
            self,
            points=np.concatenate([self.points, np.einsum("kc,kcx->kx", weights, self.points[corners])]),
            shapes=np.concatenate([self.shapes, np.einsum("kc,mkcx->mkx", weights, self.shapes[:, corners])], axis=1),
            near=np.concatenate([own, nearest]),
        )

    def receptance(self, frequency: Array, outputs: tuple[Array, Array], inputs: tuple[Array, Array]) -> Complex:
        """Receptance [m/N] (o, i, f) by superposition of the elastic modes with hysteretic loss.

        outputs, inputs: nodes (k,) and directions (k, 3). H = sum phi_o phi_i / (w_r2 (1 + i eta_r) - w2) (Ewins, Modal
        Testing, 2nd ed. 2000, eq. (2.65)). Rigid motion and modes beyond the last are left out: far below the first
        mode and near the last, and between peaks, H is not to be trusted.
        """
        o, i = (np.einsum("mkx,kx->mk", self.shapes[:, nodes], axes) for nodes, axes in (outputs, inputs))
        square = (2 * np.pi * self.frequencies) ** 2 * (1 + 1j * self.loss_factors)
        w2 = (2 * np.pi * np.asarray(frequency)) ** 2
        return np.asarray(np.einsum("mo,mi,mf->oif", o, i, 1 / (square[:, None] - w2), optimize=True))

    def frf(
        self, frequency: Array, outputs: tuple[Array, Array], inputs: tuple[Array, Array], quantity: str
    ) -> Complex:
        """The same as another quantity (o, i, f)."""
        return (
            self.receptance(frequency, outputs, inputs) * (2j * np.pi * np.asarray(frequency)) ** QUANTITIES[quantity]
        )

    def full_frf(
        self, frequency: Array, outputs: tuple[Array, Array], inputs: tuple[Array, Array], quantity: str
    ) -> Complex:
        """FRFs (o, i, f) of the full response where it is known, NaN elsewhere; arguments as in `receptance`.

        Known is a pair whose two nodes are the nearest to the positions of the full response, in directions less than a
        degree apart, either way round (reciprocity), at spectral lines within its frequencies. Between its frequencies,
        what it has beyond the elastic modes is interpolated, as accelerance, in which rigid motion is constant.
        """
        frequency = np.asarray(frequency, float)
        out = np.full((len(outputs[0]), len(inputs[0]), len(frequency)), np.nan, dtype=complex)
        if self.full is None:
            return out
        full, ends = self.full, (self.full.outputs, self.full.inputs)
        there, here = ((self._nodes(points), axes) for points, axes in ends)
        sides = [(nodes if self.near is None else self.near[nodes], axes) for nodes, axes in (outputs, inputs)]
        found = [[_match(side, place) for place in (there, here)] for side in sides]
        rest = (full.receptance - self.receptance(full.frequency, there, here)) * (2j * np.pi * full.frequency) ** 2
        inside = (frequency >= full.frequency[0]) & (frequency <= full.frequency[-1]) & (frequency > 0)
        lines = frequency[inside]
        modal = self.receptance(lines, outputs, inputs)
        for o, i in np.ndindex(*out.shape[:2]):
            ways = ((found[0][0][o], found[1][1][i]), (found[1][0][i], found[0][1][o]))  # straight, and by reciprocity
            way = next((both for both in ways if None not in both), None)
            if way is None:
                continue
            (row, turned), (column, over) = way  # type: ignore[misc]
            known = rest[row, column] * turned * over
            more = np.interp(lines, full.frequency, known.real) + 1j * np.interp(lines, full.frequency, known.imag)
            omega = 2j * np.pi * lines
            out[o, i, inside] = (modal[o, i] + more / omega**2) * omega ** QUANTITIES[quantity]
        return out

    def _nodes(self, points: Array) -> Array:
        from scipy.spatial import KDTree

        own = self.points if self.near is None else self.points[: int(self.near.max()) + 1]
        return np.asarray(KDTree(own).query(points)[1])


def _match(wanted: tuple[Array, Array], known: tuple[Array, Array]) -> list[tuple[int, float] | None]:
    """For each node and direction, the known one that is the same, and 1 or -1 for its sense; None where none is."""
    out: list[tuple[int, float] | None] = []
    length = np.linalg.norm(known[1], axis=1)
    for node, axis in zip(*wanted, strict=True):
        along = known[1] @ axis / (length * np.linalg.norm(axis))
        same = np.flatnonzero((known[0] == node) & (np.abs(along) > SAME_DIRECTION))
        out.append((int(same[0]), float(np.sign(along[same[0]]))) if len(same) else None)
    return out
