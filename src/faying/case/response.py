"""Frequency response of a study's structure at one preload, at points of the study or of its hammer test."""

from dataclasses import dataclass

import numpy as np

from faying.fe.response import ForcedVibration, FrequencyResponse, frequency_response
from faying.joint.attachments import nearest_node
from faying.joint.modal import Vibration
from faying.joint.structure import Structure
from faying.measured.model import FullResponse
from faying.notes import Note
from faying.numerics.constraint import constrain
from faying.study.keys.solution import ResponseChoice
from faying.study.study import Study
from faying.typing import Array, Complex

POOR = 0.02  # residual beyond which a note is due


@dataclass(frozen=True, kw_only=True)
class ResponseAtLoad:
    """Receptance [m/N] (frequency, output, input) at frequencies [Hz]; error: the largest residual checked [-].

    bolt_forces (frequency, bolt, input): force in each bolt per force [-], 0 for a bolt without a shank.
    """

    frequencies: Array
    values: Complex
    error: float
    bolt_forces: Complex


@dataclass(frozen=True, kw_only=True)
class LoadedStructure:
    """A structure at one preload: its modes, and the matrices that they belong to."""

    study: Study
    structure: Structure
    found: Vibration

    def response(self, choice: ResponseChoice) -> tuple[ResponseAtLoad, list[Note]]:
        """The response that [response] of the study asks for, and a note where its residual is large."""
        mesh = self.structure.mesh
        inputs, outputs = (
            (
                np.array([nearest_node(mesh, place, "point of the response") for place, _ in side]),
                np.array([np.array(axis) / np.linalg.norm(axis) for _, axis in side]),
            )
            for side in (choice.inputs, choice.outputs)
        )
        lines = np.linspace(choice.first, choice.last, choice.points)
        found = self._at(lines, outputs, inputs, self.structure.bolt_force_operator.T)
        count = len(outputs[0])
        answer = ResponseAtLoad(
            frequencies=found.frequencies,
            values=found.receptance[:, :count],
            error=float(found.error.max()),
            bolt_forces=found.receptance[:, count:],
        )
        return answer, poor(found.checked, found.error, "of the study")

    def at_test(
        self, frequencies: Array, outputs: tuple[Array, Array], inputs: tuple[Array, Array]
    ) -> tuple[FullResponse, list[Note]]:
        """The full response between nodes of the mesh and directions, and a note where its residual is large.

        The matrices are symmetric: the fewer of inputs and outputs are solved for.
        """
        turned = len(inputs[0]) > len(outputs[0])
        found = self._at(frequencies, *((inputs, outputs) if turned else (outputs, inputs)))
        points = self.structure.mesh.points
        full = FullResponse(
            frequency=found.frequencies,
            receptance=found.receptance.transpose((2, 1, 0) if turned else (1, 2, 0)),
            outputs=(points[outputs[0]], outputs[1]),
            inputs=(points[inputs[0]], inputs[1]),
        )
        return full, poor(found.checked, found.error, "at the points of the test")

    def _at(
        self, frequencies: Array, outputs: tuple[Array, Array], inputs: tuple[Array, Array], more: Array | None = None
    ) -> FrequencyResponse:
        """The response at points, and of what the columns of `more` (unknowns, k) read of a displacement."""
        eta, own = self.study.parts_loss, self.found
        vibration = ForcedVibration(
            stiffness=own.stiffness,
            mass=self.structure.dynamic_matrices[1],
            loss=own.loss,
            rigid=self.structure.rigid_count,
            kind=self.study.modes.damping,
            structural_loss=eta,
            parts=constrain(self.structure.matrices[0], self.structure.fixed, 0.0) if eta else None,
        )
        forces, read = self._columns(*inputs), self._columns(*outputs)
        read = read if more is None else np.concatenate([read, more], axis=1)
        return frequency_response(
            vibration, own.modes, own.damped, forces=forces, outputs=read, frequencies=frequencies
        )

    def _columns(self, nodes: Array, axes: Array) -> Array:
        """Unit forces (unknowns, k) at nodes along axes; nothing where a support holds."""
        columns = np.zeros((self.structure.mesh.unknowns, len(nodes)))
        for k, (node, axis) in enumerate(zip(nodes, axes, strict=True)):
            columns[3 * node : 3 * node + 3, k] = axis
        columns[self.structure.fixed] = 0.0
        return columns


def poor(frequencies: Array, error: Array, which: str) -> list[Note]:
    """Say where a response leaves more than POOR of the full equations unanswered."""
    worst = int(np.argmax(error))
    if error[worst] <= POOR:
        return []
    text = (
        f"the frequency response {which} leaves a residual of {error[worst]:.1%} at {frequencies[worst]:g} Hz, where "
        "modes that were not computed count; raise modes.count, or end at a lower frequency"
    )
    return [Note(code="response-residual", text=text)]
