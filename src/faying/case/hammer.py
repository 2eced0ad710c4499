"""The hammer test of a study: read before anything is solved, set beside the result at one preload."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faying.case.response import LoadedStructure
from faying.joint.structure import Structure
from faying.measured.compare import ModalComparison, compare_modes
from faying.measured.frf import Dof
from faying.measured.mapping import PointMap, Transform, map_points
from faying.measured.model import FullResponse
from faying.measured.tested import Tested, read_test
from faying.notes import Note
from faying.result import Result
from faying.study.keys.test import HammerChoice
from faying.typing import Array, Index

Places = tuple[NDArray[Any], Array]


@dataclass(frozen=True, kw_only=True)
class Hammer:
    """What a study knows of its test before it is solved. tested: modes and FRFs; transform: test frame to model
    frame."""

    choice: HammerChoice
    tested: Tested
    transform: Transform | None

    @classmethod
    def read(cls, choice: HammerChoice) -> "Hammer":
        """Read the file, identify where it holds FRFs alone, fit the frame. Raises ReadError and InputError."""
        tested = read_test(
            choice.file,
            points=choice.points,
            length_unit=choice.length_unit,
            direction=choice.direction,
            quantity=choice.quantity,
        )
        if choice.source:
            tested = replace(tested, modes=replace(tested.modes, source=choice.source))
        return cls(choice=choice, tested=tested, transform=tested.transform(choice.frame) if choice.frame else None)

    def points(self, structure: Structure) -> PointMap:
        """Where the test's points lie on the outline. InputError where none of them does."""
        nodes, triangles = structure.outline()
        known = {d.point for d in self.tested.modes.dofs}
        positions = {p: x for p, x in self.tested.modes.positions.items() if p in known}
        return map_points(
            positions,
            structure.mesh.points[nodes],
            triangles=triangles,
            transform=self.transform,
            tolerance=self.choice.tolerance,
        )

    def response(self, solved: LoadedStructure, points: PointMap) -> tuple[FullResponse | None, list[Note]]:
        """The full response at the test's own points, directions and lines, None where its FRFs meet no point;
        notes."""
        frf = self.tested.frf
        if frf is None:
            return None, []
        nodes, _ = solved.structure.outline()
        outputs, inputs = (self._places(side, points, nodes) for side in (frf.outputs, frf.inputs))
        lines = frf.frequency[frf.frequency > 0]
        if not len(outputs[0]) or not len(inputs[0]) or not len(lines):
            return None, []
        return solved.at_test(lines, outputs, inputs)

    @staticmethod
    def _places(side: tuple[Dof, ...], points: PointMap, nodes: Index) -> Places:
        used = [d for d in side if d.point in points.nodes]
        at = np.array([nodes[points.nodes[d.point]] for d in used], dtype=np.int64)
        return at, points.transform.directions(np.array([d.axis() for d in used]).reshape(-1, 3))

    def compared(self, result: Result, full: FullResponse | None) -> ModalComparison:
        """The comparison at the preload of the test."""
        model = result.modes_at(float(result.loads[self.choice.load]))
        found = compare_modes(
            self.tested.modes,
            replace(model, full=full),
            transform=self.transform,
            tolerance=self.choice.tolerance,
            frf=self.tested.frf,
            least_mac=self.choice.least_mac,
            greatest_shift=self.choice.greatest_shift,
        )
        first = ("the test's modes are identified from its FRFs",) if self.tested.identified else ()
        return replace(found, notes=(*first, *self.tested.notes, *found.notes))
