"""Groups of fields of a result that belong together: a result has all of a group, or None."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from faying.fe.outline import Outline
from faying.misuse import checked_call
from faying.result.fields import Arrays, optional, variable
from faying.result.vtk import grid_text, write_collection
from faying.typing import Array, Index

STRESSES = {
    "von_mises": "von Mises stress [Pa]",
    "tension": "greatest principal stress [Pa]",
    "compression": "least principal stress [Pa]",
}


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Levels(Arrays):
    """Modes at levels of acceleration.

    Frequencies are those at the friction of the study or at the median of its prior. Damping is that of slip and of
    rest together, with both ends; `error` is that of the slip alone, by the iteration.
    """

    accelerations: Array = variable(
        "level", "m/s2", "peak acceleration of the point that moves most", "modes/level_acceleration"
    )
    frequencies: Array = variable("load level mode", "Hz", "frequency at a level", "modes/level_frequencies", gaps=True)
    damping: Array = variable(
        "load level mode", "1", "damping ratio at a level", "modes/level_damping", shown="damping ratio", gaps=True
    )
    low: Array = variable("load level mode", "1", "lower end of damping at a level", "modes/level_low", gaps=True)
    high: Array = variable("load level mode", "1", "upper end of damping at a level", "modes/level_high", gaps=True)
    slip: Array = variable("load level mode", "1", "damping by slip at a level", "modes/level_slip", gaps=True)
    error: Array = variable("load level mode", "1", "error of damping by slip", "modes/level_error", gaps=True)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class OuterStress(Arrays):
    """The outer surface with the stress in some states: load cases, or 1 and 3 sigma of a vibration; see `save_vtu`."""

    states: tuple[str, ...]
    outline: Array = variable("node axis", "m", "nodes of the outer surface", "surface/position")
    triangles: Index = variable("triangle corner", "1", "triangles between them", "surface/", dtype="i8")
    part_of_triangle: Index = variable("triangle", "1", "part of each triangle, from 0", "surface/", dtype="i8")
    von_mises: Array = variable("state node", "Pa", "stress of von Mises", "surface/", dtype="f4")
    tension: Array | None = optional("state node", "Pa", "greatest principal stress", "surface/", dtype="f4")
    compression: Array | None = optional("state node", "Pa", "least principal stress", "surface/", dtype="f4")
    motion: Array | None = optional("state node axis", "m", "displacement by the load", "surface/", dtype="f4")

    @classmethod
    def on(cls, outer: Outline, points: Array, **fields: Any) -> "OuterStress":
        """The stress on an outer surface; points: nodes of the mesh (n, 3) [m]; fields: states, and what they are."""
        at, of = outer.triangles, outer.part_of_triangle
        return cls(outline=points[outer.nodes], triangles=at, part_of_triangle=of, **fields)

    def fields(self, state: int) -> dict[str, Array]:
        """What is known of one state at the nodes, by name and unit."""
        names = {"motion": "displacement [m]", **STRESSES}
        return {
            text: np.asarray(every[state], float)
            for name, text in names.items()
            if (every := getattr(self, name)) is not None
        }

    @checked_call
    def save_vtu(self, path: str | Path) -> list[Path]:
        """Write files for ParaView: NAME.pvd, and one .vtu for each state with its displacement and stress.

        Args:
            path: NAME.pvd or NAME.vtu; a folder that is not there is made.

        Returns:
            The paths of all files, the .pvd first; ParaView's time is the number of the state, from 1.

        Raises:
            InputError: The name ends in something else, or a file cannot be written.
        """

        def grid(k: int) -> str:
            cells = {"part": self.part_of_triangle}
            return grid_text(self.states[k], self.outline, self.triangles, self.fields(k), cells, {})

        return write_collection(path, range(1, len(self.states) + 1), grid)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class WaveDraws(Arrays):
    """Frequencies under several draws of waves on the faces; `slopes` only with several preloads."""

    seeds: Index = variable("draw", "1", "draws of waves on the faces, by their seed", "waves/seed", dtype="i8")
    frequencies: Array = variable("draw load mode", "Hz", "frequency with waves on the faces", "waves/frequency")
    slopes: Array | None = optional("draw mode", "Hz/N", "change of frequency with preload with waves", "waves/slope")
    rms: Array = variable(
        "joint", "m", "rms of the waves of each face, NaN where none are drawn", "waves/rms", gaps=True
    )
    lengths: Array = variable(
        "joint end", "m", "shortest and longest wave that is drawn, NaN where none are", "waves/wave_length", gaps=True
    )


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class BondedAboveRange(Arrays):
    """Modes with what is above the end of a law bonded, where anything is at any preload."""

    frequencies: Array = variable(
        "load mode", "Hz", "frequency with what is above the law's end bonded", "modes/frequency_bonded_above"
    )
    loss_factors: Array = variable(
        "load mode",
        "1",
        "loss factor with what is above the law's end bonded",
        "modes/loss_factor_bonded_above",
        gaps=True,
    )


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Alternatives(Arrays):
    """The modes under other laws, by their names; NaN where a law has no answer."""

    names: tuple[str, ...]
    frequencies: Array = variable("law load mode", "Hz", "frequency under another law", "laws/frequency", gaps=True)
    loss_factors: Array = variable("law load mode", "1", "loss factor under another law", "laws/loss_factor", gaps=True)
    above_range_frequencies: Array = variable(
        "law load mode",
        "Hz",
        "frequency under another law with what is above its end bonded",
        "laws/frequency_bonded_above",
        gaps=True,
    )
    outside_share: Array = variable(
        "law load",
        "1",
        "share of the joints' stiffness where another law is outside its validity range",
        "laws/outside_share",
        gaps=True,
    )
    above_range_share: Array = variable(
        "law load", "1", "share of the joints above the end of another law", "laws/above_range_share", gaps=True
    )
    reach: Array = variable("law", "Pa", "pressure at which another law ends", "laws/end_pressure", gaps=True)
