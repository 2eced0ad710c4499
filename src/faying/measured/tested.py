"""A hammer test from its file: modes, FRFs where there are some, and the frame it lies in."""

from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from faying.errors import InputError
from faying.measured.frf import FRF
from faying.measured.mapping import Transform, fit_transform, read_points
from faying.measured.modes import ModeSet


@dataclass(frozen=True, kw_only=True)
class Tested:
    """modes and frf (or None) of a test; identified: whether the modes come out of the FRFs; notes for a reader."""

    modes: ModeSet
    frf: FRF | None
    identified: bool
    notes: tuple[str, ...]

    def transform(self, frame: str | Path) -> Transform:
        """The motion that carries the test into the model, fitted to a table of points with their place there.

        Raises InputError for points whose position the test does not know, and as `fit_transform` does.
        """
        there = read_points(frame)
        unknown = [str(p) for p in there if p not in self.modes.positions]
        if unknown:
            raise InputError(
                f"{frame}: the test has no position of point {', '.join(unknown)}; it has those of "
                f"{', '.join(map(str, self.modes.positions)) or 'none'}"
            )
        return fit_transform([self.modes.positions[p] for p in there], list(there.values()))


def read_test(
    path: str | Path,
    *,
    points: str | Path | None = None,
    length_unit: str | None = None,
    direction: str | None = None,
    quantity: str | None = None,
) -> Tested:
    """Read a universal file: its mode shapes, or, where it holds none, those identified from its FRFs.

    points: table of positions; length_unit, direction, quantity: what the file does not say. Raises ReadError and
    InputError as `read_uff`, `read_points` and `identify_modes` do.
    """
    from faying.measured.identify import TURNED, identify_modes
    from faying.measured.uff import read_uff

    file = read_uff(path, length_unit=length_unit)
    frf = file.frf(quantity=quantity) if any(f.kind == "FRF" for f in file.functions) or not file.shapes else None
    if file.shapes or frf is None:
        modes = file.modes()
        with suppress(InputError):  # of FRFs that have no pole to tell the sign of time from
            if frf is not None and (identified := identify_modes(frf)).turned:
                frf = replace(frf, values=frf.values.conj(), warnings=(*frf.warnings, TURNED))
    else:
        identified = identify_modes(frf)
        modes, frf = identified.modes, identified.frf
    if points:
        there = read_points(points)
        modes = replace(modes, positions=there)
        frf = frf and replace(frf, positions=there)
    if direction:
        modes, frf = modes.directed(direction), frf and frf.directed(direction)
    return Tested(modes=modes, frf=frf, identified=not file.shapes, notes=tuple(frf.warnings if frf else file.warnings))
