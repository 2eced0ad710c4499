"""What a universal file of a modal test holds, as FRFs and as mode shapes."""

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faying.errors import ReadError
from faying.measured.frf import FRF, Dof, Position, without_static
from faying.measured.modes import ModeSet
from faying.measured.uff_units import FileUnits, frf_scale, hertz
from faying.style import Summary
from faying.typing import Array

WINDOW = r"exponential window of decay (\S+) 1/s"  # as `write_uff` says it


@dataclass(frozen=True, kw_only=True)
class Function:
    """One function of a data set 58 as it stands in the file: kind, abscissa, values, places, label of its unit."""

    kind: str
    x: Array
    values: NDArray[Any]
    output: Dof
    input: Dof
    unit: str
    header: Mapping[str, Any]
    where: str


@dataclass(frozen=True, kw_only=True, repr=False)
class UniversalFile(Summary):
    """What a universal file holds. positions [m]; lines: pairs of points to draw; kinds: numbers
    of the data sets; warnings: sentences for the reader."""

    source: str
    title: str = ""
    units: FileUnits | None = None
    functions: tuple[Function, ...] = ()
    shapes: tuple[Mapping[str, Any], ...] = ()
    positions: Mapping[int, Position] = field(default_factory=dict)
    rotations: Mapping[int, Array] = field(default_factory=dict)
    lines: tuple[tuple[int, int], ...] = ()
    kinds: tuple[int, ...] = ()
    warnings: tuple[str, ...] = ()

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and what the file holds."""
        kinds = Counter(one.kind for one in self.functions)
        rows = {
            "functions": ", ".join(f"{count} {kind}" for kind, count in kinds.items()) or "none",
            "shapes": str(len(self.shapes)),
            "points": str(len(self.positions)),
            "data sets": ", ".join(map(str, sorted(set(self.kinds)))) or "none",
            "warnings": f"{len(self.warnings)}, in .warnings" if self.warnings else "none",
        }
        return f"Universal file {Path(self.source).name}" + (f": {self.title}" if self.title else ""), rows

    @property
    def _frfs(self) -> list[Function]:
        return [f for f in self.functions if f.kind == "FRF"]

    def frf(self, *, quantity: str | None = None) -> FRF:
        """All FRFs as one object in SI, with the coherence of the same pairs.

        quantity: what was measured, where the file does not say it. Raises ReadError where there is no FRF, the
        quantities or the spectral lines differ, or the directions of a point are turned against the axes.
        """
        found = self._frfs
        if not found:
            kinds = (
                ", ".join(sorted({f.kind for f in self.functions})) or f"data sets {', '.join(map(str, self.kinds))}"
            )
            raise ReadError(f"{self.source}: no FRF (function type 4) in it, only {kinds}; export the FRFs of the test")
        notes: list[str] = list(self.warnings)
        if self._nameless:
            notes.append(f"{self.source}: the FRFs name no points; they are numbered in their order")
        pairs: dict[tuple[Dof, Dof], tuple[str, NDArray[Any]]] = {}
        lines: Array | None = None
        for f, pair in zip(found, self.pairs, strict=True):
            kind, factor, note = frf_scale(dict(f.header), self.units, quantity, f.where)
            x = f.x * hertz(dict(f.header), f.where)
            if note and note.partition(": ")[2] not in {w.partition(": ")[2] for w in notes}:
                notes.append(note)
            lines = x if lines is None else lines
            if not np.array_equal(x, lines):
                raise ReadError(
                    f"{f.where}: its spectral lines are not those of the first FRF; split the file into tests of one "
                    "set of lines"
                )
            if pair in pairs:
                notes.append(f"{f.where}: {pair[0]} / {pair[1]} appears twice; the first is taken")
            else:
                pairs[pair] = (kind, np.asarray(f.values, complex) * factor)
        quantities = {kind for kind, _ in pairs.values()}
        if len(quantities) > 1:
            raise ReadError(
                f"{self.source}: {' and '.join(sorted(quantities))} are in one file; split the file, or convert them"
            )
        outputs = tuple(dict.fromkeys(o for o, _ in pairs))
        inputs = tuple(dict.fromkeys(i for _, i in pairs))
        values = np.full((len(outputs), len(inputs), len(found[0].x)), np.nan + 0j)
        for (o, i), (_, data) in pairs.items():
            values[outputs.index(o), inputs.index(i)] = data
        assert lines is not None
        decays = {float(of[1]) if (of := re.fullmatch(WINDOW, f.header.get("id2", "").strip())) else 0.0 for f in found}
        if len(decays) > 1:
            raise ReadError(f"{self.source}: its FRFs have exponential windows of decay {decays}; split the file")
        used, static = without_static(lines, np.array([data for _, data in pairs.values()]), self.source)
        coherence = self._coherence(outputs, inputs, values.shape)
        return FRF(
            frequency=lines[used],
            values=values[:, :, used],
            outputs=outputs,
            inputs=inputs,
            quantity=quantities.pop(),
            coherence=None if coherence is None else coherence[:, :, used],
            positions=self.positions,
            window_decay=decays.pop(),
            source=self.source,
            warnings=(*dict.fromkeys(notes), *static),
        )

    @property
    def pairs(self) -> tuple[tuple[Dof, Dof], ...]:
        """Output and input of each FRF, as the file has them one after the other."""
        nameless = self._nameless
        return tuple(
            (Dof(n, f.output.direction) if nameless else self._straight(f.output), self._straight(f.input))
            for n, f in enumerate(self._frfs, start=1)
        )

    @property
    def _nameless(self) -> bool:
        """Whether the FRFs are numbered, since they name no points."""
        found = self._frfs
        return len({(f.output, f.input) for f in found}) < len(found) and all(f.output.point == 0 for f in found)

    def _coherence(self, outputs: tuple[Dof, ...], inputs: tuple[Dof, ...], shape: tuple[int, ...]) -> Array | None:
        out = np.full(shape, np.nan)
        for f in self.functions:
            if f.kind == "coherence" and f.output in outputs and f.input in inputs and f.values.size == shape[2]:
                out[outputs.index(f.output), inputs.index(f.input)] = f.values.real
        return None if np.isnan(out).all() else out

    def _straight(self, dof: Dof) -> Dof:
        """The degree of freedom in the file's own axes, which is possible where the point's axes are a permutation."""
        turn = self.rotations.get(dof.point)
        if turn is None or dof.direction == "" or dof.direction.startswith(("r", "-r")):
            return dof
        axis = dof.axis() @ turn
        if np.abs(axis).max() < 1 - 1e-6:
            raise ReadError(
                f"{self.source}: the directions of point {dof.point} are turned against the axes of the file "
                "(data sets 18 and 2420); export the FRFs in global directions"
            )
        k = int(np.abs(axis).argmax())
        return Dof(dof.point, ("-" if axis[k] < 0 else "") + "xyz"[k])

    def modes(self) -> ModeSet:
        """The mode shapes of data sets 55, at the degrees of freedom that move in at least one mode.

        Real modes carry a viscous damping ratio (loss factor twice that) or a hysteretic one (taken as the loss
        factor); complex modes their pole. Raises ReadError where there is no mode shape or the modes are known at
        different points.
        """
        if not self.shapes:
            raise ReadError(
                f"{self.source}: no mode shape (data set 55 or 2414) in it; identify the modes first: "
                f"faying test {self.source}"
            )
        shapes = sorted(self.shapes, key=lambda s: float(s["frequency"]))
        points = shapes[0]["points"]
        if any(not np.array_equal(s["points"], points) for s in shapes):
            raise ReadError(
                f"{self.source}: its mode shapes are known at different points; export all modes at the same points"
            )
        values = np.stack([s["values"] for s in shapes])  # (m, p, 3)
        for row, point in enumerate(points):
            if int(point) in self.rotations:
                values[:, row] = values[:, row] @ self.rotations[int(point)]
        size = np.abs(values).max(axis=(1, 2), keepdims=True)
        moves = np.argwhere((np.abs(values) > 1e-9 * size).any(axis=0))
        if not len(moves):
            raise ReadError(f"{self.source}: nothing moves in its mode shapes; export them again")
        return ModeSet(
            frequencies=np.array([s["frequency"] for s in shapes]),
            loss_factors=np.array([s["loss"] for s in shapes]),
            shapes=values[:, moves[:, 0], moves[:, 1]],
            dofs=tuple(Dof(int(points[p]), "xyz"[k]) for p, k in moves),
            frequency_interval=_spans(shapes, "frequency_interval"),
            loss_interval=_spans(shapes, "loss_interval"),
            lines=self.lines,
            positions=self.positions,
            source=self.source,
        )


def _spans(shapes: list[Mapping[str, Any]], name: str) -> Array | None:
    """Intervals of all modes (m, 2), or None where one of them states none."""
    spans = np.array([s[name] for s in shapes], float)
    return spans if np.all(np.isfinite(spans)) else None
