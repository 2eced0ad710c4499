"""A bolted structure: meshed parts, the joints between them, the bolts that hold them, and its states."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, overload

from faying.joint.bolted import BoltedStructure
from faying.joint.state import State, solve_structure
from faying.misuse import checked_call


@checked_call
@dataclass(frozen=True, init=False, repr=False)
class Structure(BoltedStructure):
    """A bolted structure.

    What does not depend on the laws of the joints is assembled once, when it is first asked for, and shared with a
    structure that `dataclasses.replace` makes with other laws on the same faces.

    Args:
        mesh: Parts and faces.
        materials: One material for all parts, or part -> its material; a `Material`, or the name of one in the
            catalogue. They need a density.
        joints: The joints between the parts; none for one part, or for parts that are bonded or supported.
        bolts: Bolts as beams, forces or meshed parts.
        supports: Faces that are fixed or on springs.
        masses: Point masses.
        dowels: Dowels, which carry shear alone.

    Raises:
        InputError: A part has neither material, joint nor support, or is two solid bolts; a solid bolt's face is in no
            joint; a face does not exist; two joints, bolts or dowels share a name.
    """

    @overload
    def solve(
        self,
        preload: float | str | Mapping[str, float | str] | None = None,
        *,
        modes: int = 10,
        damping: Literal["hysteretic", "viscous"] = "hysteretic",
        order: Sequence[str] | None = None,
        solver: str | None = None,
        engine: Literal["reanalysis", "direct"] = "reanalysis",
    ) -> State: ...

    @overload
    def solve(
        self,
        preload: list[str] | list[float] | list[Mapping[str, float | str]],
        *,
        modes: int = 10,
        damping: Literal["hysteretic", "viscous"] = "hysteretic",
        order: Sequence[str] | None = None,
        solver: str | None = None,
        engine: Literal["reanalysis", "direct"] = "reanalysis",
    ) -> tuple[State, ...]: ...

    @checked_call
    def solve(
        self,
        preload: float | str | Mapping[str, float | str] | list[Any] | None = None,
        *,
        modes: int = 10,
        damping: Literal["hysteretic", "viscous"] = "hysteretic",
        order: Sequence[str] | None = None,
        solver: str | None = None,
        engine: Literal["reanalysis", "direct"] = "reanalysis",
    ) -> State | tuple[State, ...]:
        """Tighten the bolts and find the modes, as a study does.

        Args:
            preload: Force of each bolt [N], or text with a unit such as "8 kN"; bolt -> force where they differ; None
                for a structure without bolts. A list of them is gone through in its order, in place: ["4 kN", "12 kN",
                "4 kN"]. Where a force falls, each point unloads from the greatest pressure that it has carried.
            modes: How many elastic modes, 1 to 10,000.
            damping: Kind of loss of the joints.
            order: Names of the bolts in the order of tightening, any of them more than once; None pulls all at once.
            solver: What factorises the matrices, by the names of a study; chosen where None.
            engine: "reanalysis", one factorisation for preload and modes; or "direct", one for each Newton step and
                for the modes, to check the other by.

        Returns:
            The state: pressures, springs of the joints, modes; of a list of preloads one for each.

        Raises:
            InputError: A preload is missing or not positive, or a part is free to move.
            NotConverged: An iteration stops short.
        """
        states = solve_structure(
            self,
            preload if isinstance(preload, list) else [preload],
            modes=modes,
            damping=damping,
            order=order,
            solver=solver,
            engine=engine,
        )
        return states if isinstance(preload, list) else states[0]
