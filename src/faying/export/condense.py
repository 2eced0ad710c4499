"""One joint of a study as a 6 x 6 stiffness and loss between two points, with its error over frequency."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal

import numpy as np

from faying.case.case import Case, Progress
from faying.decks.deck import CondensedDeck
from faying.decks.system import UnitSystem
from faying.decks.write import write_condensed
from faying.errors import InputError
from faying.export.condensed import CondensedJoint, condensed_modes
from faying.joint.preload_case import preload_index
from faying.joint.shared_modes import modes_of
from faying.joint.support_check import check_motions, checked_preload
from faying.measured.mac import mac
from faying.misuse import checked_call
from faying.numerics.follow import partners
from faying.progress import Report
from faying.result.fields import listed
from faying.study.load import vector
from faying.study.study import Study
from faying.style import Summary
from faying.text import in_columns
from faying.typing import Array
from faying.units import load_text

LIKE = 0.5  # MAC by mass from which two modes are one
CLOSE = 0.01  # error of a frequency up to which the condensed joint counts as right
COUNTED = 2  # spare modes with the joint condensed, so that the last ones find a partner
STAGES = 6
Point = Sequence[float | str] | Array


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Condensed(Summary):
    """A joint of a study, condensed.

    Args:
        study: title of the study.
        name, load: the joint, and the preload of the first bolt [N].
        joint: the condensed joint.
        points (2, 3): the point of the first face and that of the second [m].
        frequencies [Hz] (m,), loss [-] (m,): of the elastic modes of the full model; loss to first order, of this
            joint.
        mean, rigid [Hz] (m,): of the same modes with the joint condensed and its points on the mean motions of the
            faces, or on rigid faces; NaN where no mode is like it.
        mean_loss [-] (m,): loss factors with mean ties.
        lossless: the law of the joint predicts no loss.
    """

    study: str
    name: str
    load: float
    joint: CondensedJoint
    points: Array
    frequencies: Array
    loss: Array
    mean: Array
    rigid: Array
    mean_loss: Array
    lossless: bool

    @property
    def reach(self) -> float:
        """Frequency [Hz] of the last mode of the full model up to which mean ties err by at most 1 %; 0 for none."""
        good = np.abs(self.mean / self.frequencies - 1) <= CLOSE
        count = len(good) if good.all() else int(np.argmin(good))
        return float(self.frequencies[count - 1]) if count else 0.0

    def deck(self, *, unit: str, force_unit: str = "N", nodes: tuple[int, int], element: int) -> CondensedDeck:
        """The joint in the units of a model, ready to be written. Raises InputError for wrong numbers."""
        if min(nodes) < 1 or nodes[0] == nodes[1] or element < 1:
            raise InputError(f"nodes {nodes[0]} and {nodes[1]}, element {element}: give two nodes, numbers from 1 on")
        system = UnitSystem(unit, force_unit)
        stiffness, loss = self.joint.between(*self.points)
        facts = (
            f"Joint {self.name!r} of {self.study!r} at {load_text(self.load)} as one 6 x 6 stiffness between two "
            f"points, written by Faying {version('faying')}",
            system.describe(),
            *(("the contact law predicts no loss: none is written",) if self.lossless else ()),
            f"tie node {nodes[0]} to the first face and node {nodes[1]} to the second: by their mean motion (RBE3, "
            "distributing coupling), right within 1 % "
            + (f"up to {self.reach:.4g} Hz in the study, " if self.reach else "in no mode of the study, ")
            + "too soft above; rigid ties (RBE2) are too stiff",
        )
        return CondensedDeck(
            points=self.points,
            nodes=nodes,
            element=element,
            stiffness=stiffness,
            loss=loss,
            system=system,
            facts=facts,
        )

    def write(
        self,
        program: str,
        folder: str | Path,
        *,
        unit: str,
        force_unit: str = "N",
        nodes: tuple[int, int] = (900_001, 900_002),
        element: int = 900_001,
    ) -> list[Path]:
        """Write the joint for another program.

        Args:
            program: "nastran", "mapdl" or "abaqus".
            folder: Where the files go; it is made where it does not exist.
            unit, force_unit: Units of length and force of that program's model.
            nodes: Numbers of the nodes at the two points.
            element: Number of the element and its property.

        Returns:
            The files.

        Raises:
            InputError: A program that has no matrix element, wrong units or numbers, or a folder that cannot be used.
        """
        deck = self.deck(unit=unit, force_unit=force_unit, nodes=nodes, element=element)
        return write_condensed(deck, program, Path(folder))

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return the joint, its stiffness along the axes and about them, and how far ties to it are right."""
        along = ", ".join(f"{k:.4g}" for k in np.diag(self.joint.stiffness))
        place = ", ".join(f"{x:.4g}" for x in (1e3 * self.joint.point).round(6) + 0.0)
        reach = f"up to {self.reach:.4g} Hz" if self.reach else "in no mode"
        return f"Joint {self.name} of {self.study} at {load_text(self.load)}", {
            "about": f"({place}) mm",
            "diagonal": f"{along} N/m and N m",
            "loss": "none is predicted" if self.lossless else "predicted",
            "mean ties": f"right within 1 % {reach}",
        }

    def rows(self) -> list[list[str]]:
        """One row per mode: the full model, and both ties with their errors; loss where the law predicts one."""
        f = self.frequencies
        loss = (("loss", self.loss, ".2e"), ("mean ties", self.mean_loss, ".2e"))
        return in_columns(
            ("mode", range(1, len(f) + 1), ""),
            ("full [Hz]", f, ".2f"),
            ("mean ties [Hz]", self.mean, ".2f"),
            ("error [%]", 100 * (self.mean / f - 1), "+.3f"),
            ("rigid ties [Hz]", self.rigid, ".2f"),
            ("error [%]", 100 * (self.rigid / f - 1), "+.3f"),
            *(() if self.lossless else loss),
        )

    def to_dict(self) -> dict[str, Any]:
        """Everything in SI units, for JSON; None in place of NaN."""

        return {
            "joint": self.name,
            "load": {"unit": "N", "values": self.load},
            "point": {"unit": "m", "values": self.joint.point.tolist()},
            "stiffness": {"unit": "N/m, N, N m", "values": self.joint.stiffness.tolist()},
            "loss": {"unit": "N/m, N, N m", "values": None if self.lossless else self.joint.loss.tolist()},
            "points": {"unit": "m", "values": self.points.tolist()},
            "frequencies": {"unit": "Hz", "values": listed(self.frequencies)},
            "mean_ties": {"unit": "Hz", "values": listed(self.mean)},
            "rigid_ties": {"unit": "Hz", "values": listed(self.rigid)},
            "loss_factors": {"unit": "1", "values": None if self.lossless else listed(self.loss)},
            "mean_ties_loss_factors": {"unit": "1", "values": None if self.lossless else listed(self.mean_loss)},
            "reach": {"unit": "Hz", "values": self.reach},
        }


@checked_call
def condense(
    study: Study | str | Path,
    *,
    joint: str | None = None,
    preload: str | None = None,
    points: tuple[Point | None, Point | None] = (None, None),
    report: Report | None = None,
) -> Condensed:
    """Solve a study at one preload and condense one of its joints to a 6 x 6 stiffness between two points.

    Args:
        study: The study, or the path of its file.
        joint: Name of the joint; the only one where None.
        preload: Which of the study's preloads, as text with a unit; the greatest where None.
        points: Of the first face and of the second, x, y, z [m] or text with units; the
            centre of the joint's normal springs where None.
        report: Called as each stage begins.

    Returns:
        The joint, condensed, and the modes with and without that.

    Raises:
        InputError, ReadError: What the study gives cannot be used, no such joint or preload, an open joint.
        NotConverged: An iteration stops short.
    """
    study = Study.read_bolted(study)
    number, index = _joint(study, joint), preload_index(study.loads, preload, names=study.load_names)
    progress = Progress(STAGES + index, report)
    case = Case.of(study, progress)
    structure = case.structure
    problem = structure.assembly(solver=study.modes.solver)
    for k in range(index + 1):
        progress.begin(f"preload {study.preloads[k].name}")
        state = checked_preload(structure, problem, case.study.preloads[k])
    structure = structure.under(state)
    springs = structure.springs(state.pressures)
    progress.begin("modes")
    modes, *_ = modes_of(case.modal, springs)
    check_motions(structure, modes)
    made = CondensedJoint.of(springs[number])
    elastic = slice(case.rigid_count, case.rigid_count + study.modes.count)
    shapes, frequencies = modes.shapes[:, elastic], modes.frequencies[elastic]
    lost = np.einsum("im,im->m", shapes, springs[number].loss() @ shapes)

    def tied(tie: Literal["mean", "rigid"]) -> tuple[Array, Array]:
        """Frequencies and loss factors of these modes with the joint condensed; NaN where none is like them."""
        progress.begin(f"modes with {tie} ties")
        other = condensed_modes(structure, springs, number, elastic.stop + COUNTED, tie=tie, solver=study.modes.solver)
        at = partners(mac(shapes.T, other.shapes.T, structure.dynamic_matrices[1]), LIKE)
        found, loss = (np.where(at < 0, np.nan, values[at]) for values in (other.frequencies, other.loss_factors))
        return found, loss

    mean, mean_loss = tied("mean")
    rigid, _ = tied("rigid")
    return Condensed(
        study=study.title,
        name=study.joints[number].name,
        load=study.loads[index],
        joint=made,
        points=np.array([made.point if p is None else vector(list(p), "m", "points") for p in points]),
        frequencies=frequencies,
        loss=lost / (2 * np.pi * frequencies) ** 2,
        mean=mean,
        rigid=rigid,
        mean_loss=mean_loss,
        lossless=not structure.joints[number].law.predicts_loss,
    )


def _joint(study: Study, name: str | None) -> int:
    names = [one.name for one in study.joints]
    if name is None and len(names) > 1:
        raise InputError(f"the study has the joints {', '.join(map(repr, names))}; say which by joint (--joint NAME)")
    if name is not None and name not in names:
        raise InputError(f"no joint {name!r}; the study has {', '.join(map(repr, names))}")
    return 0 if name is None else names.index(name)
