"""One joint of a study as a 6 x 6 stiffness and loss between two points, with its error over frequency."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from faying.case.case import Case, Progress
from faying.decks.deck import CondensedDeck, UnitSystem, six_each, write_condensed
from faying.errors import InputError
from faying.fe.elasticity import unit_motions
from faying.fe.interface import Interface
from faying.joint.preload_case import preload_index
from faying.joint.shared_modes import modes_of
from faying.joint.springs import Springs
from faying.joint.structure import Structure
from faying.joint.support_check import check_motions, checked_preload
from faying.measured.mac import mac
from faying.misuse import checked_call
from faying.numerics.constraint import constrain
from faying.numerics.follow import partners
from faying.numerics.held import Held
from faying.numerics.modes import lowest_modes
from faying.numerics.solve import factorise
from faying.progress import Report
from faying.result.fields import listed
from faying.study.load import vector
from faying.study.study import Study
from faying.style import Summary
from faying.text import in_columns
from faying.typing import Array
from faying.units import load_text

OPEN = 1e-12  # of its greatest: a stiffness below it leaves the joint free to move


@dataclass(frozen=True, kw_only=True, eq=False)
class CondensedJoint:
    """A joint whose faces move as rigid bodies: six forces on six relative motions at a point.

    Args:
        springs: Springs of the joint at its preload.
        point: The point (3,) [m] that forces, moments and motions belong to.

    The motion is that of the second face less that of the first, three translations [m] and three rotations [rad] in
    the axes of the model. `stiffness` (6, 6) sums R' D R over the springs, with R the opening and slips at each under
    the six motions and D their stiffness; `loss` (6, 6) is its imaginary part.
    """

    springs: Springs[Interface]
    point: Array

    @classmethod
    def of(cls, springs: Springs[Interface], point: Array | None = None) -> "CondensedJoint":
        """Condense a joint about a point, by default the centre of its normal springs.

        Raises InputError where the joint carries nothing, or all of its springs lie on one line.
        """
        weight = springs.interface.weights * springs.k_n
        if not weight.sum() > 0:
            raise InputError("the joint is open: it has no stiffness that could be condensed")
        centre = weight @ springs.interface.positions / weight.sum()
        size = np.sqrt(float(weight @ np.sum((springs.interface.positions - centre) ** 2, axis=1) / weight.sum()))
        about = cls(springs=springs, point=centre)
        scale = np.repeat([1.0, 1 / size], 3) if size > 0 else np.repeat([1.0, 0.0], 3)
        values = np.linalg.eigvalsh(about.stiffness * np.outer(scale, scale))
        if values[0] < OPEN * values[-1]:
            raise InputError("the springs of the joint are on one line or at one point, so that its faces can turn")
        return about if point is None else cls(springs=springs, point=np.asarray(point, dtype=float))

    @cached_property
    def _motions(self) -> Array:
        """Opening and slips (q, 3, 6) of each spring under the six motions."""
        i = self.springs.interface
        return np.asarray(np.einsum("qij,qjk->qik", i.frames, unit_motions(i.positions - self.point)))

    @cached_property
    def _share(self) -> Array:
        """Stiffness [N/m] of each spring along normal and tangents (q, 3)."""
        s = self.springs
        return np.asarray(s.interface.weights[:, None] * np.stack([s.k_n, s.k_t, s.k_t], axis=1))

    @cached_property
    def stiffness(self) -> Array:
        """Stiffness (6, 6) [N/m, N, N m]."""
        return np.asarray(np.einsum("qij,qi,qik->jk", self._motions, self._share, self._motions))

    @cached_property
    def loss(self) -> Array:
        """Imaginary part of the stiffness (6, 6) [N/m, N, N m]."""
        s = self.springs
        lost = self._share * np.stack([s.loss_n, s.loss_t, s.loss_t], axis=1)
        return np.asarray(np.einsum("qij,qi,qik->jk", self._motions, lost, self._motions))

    def between(self, first: Array, second: Array) -> tuple[Array, Array]:
        """Stiffness and loss (12, 12) between a point (3,) [m] of the first face and one of the second.

        Rows and columns: three translations and three rotations of the first point, then of the second.
        """
        turn = np.zeros((6, 12))
        for columns, at, sign in ((slice(0, 6), first, -1.0), (slice(6, 12), second, 1.0)):
            block = np.eye(6)
            block[:3] = unit_motions(self.point - np.asarray(at, dtype=float))
            turn[:, columns] = sign * block
        return turn.T @ self.stiffness @ turn, turn.T @ self.loss @ turn

    @cached_property
    def mean(self) -> Array:
        """Forces (unknowns, 6) of unit motions: their mean over the faces, weighted by the springs, is K^-1 of this' u.

        The mean motion of each face is the rigid one nearest to its own in the energy of the springs (RBE3 with the
        springs as weights); with it the condensed joint stores what the springs store, less what is left beside it.
        """
        spread = (self._share[:, :, None] * self._motions).reshape(-1, 6)
        return np.asarray(self.springs.interface.relative.T @ spread)


@dataclass(frozen=True, kw_only=True)
class CondensedModes:
    """Modes with a joint condensed: frequencies [Hz] and loss factors of that joint [-] (m,), shapes (unknowns, m)."""

    frequencies: Array
    loss_factors: Array
    shapes: Array


def condensed_modes(
    structure: Structure,
    springs: Sequence[Springs[Interface]],
    number: int,
    count: int,
    *,
    solver: str | None = None,
) -> CondensedModes:
    """Find the modes of a structure with one of its joints condensed, its points on the mean motions of the faces.

    Such ties (RBE3) leave the faces free to deform, and are too soft.

    Args:
        structure: the structure.
        springs: of each joint, at its preload.
        number: of the joint that is condensed, from 0; the others stay as they are.
        count: of modes, rigid ones included.
        solver: factorisation, the fastest one found where None.

    Raises:
        NotConverged: the modes are not found.
    """
    from scipy.sparse import block_diag

    joint = CondensedJoint.of(springs[number])
    K, M = structure.dynamic_matrices
    others = [s.stiffness() for k, s in enumerate(springs) if k != number]
    K = sum((constrain(other, structure.fixed, 0.0) for other in others), K)
    # six unknowns more, without mass: the relative motions, whose sums with those of the faces are held
    spread = joint.mean.copy()
    spread[structure.fixed] = 0.0
    K, M = block_diag([K, joint.stiffness]).tocsr(), block_diag([M, np.zeros((6, 6))]).tocsr()
    rows = np.concatenate([spread.T, -joint.stiffness], axis=1)
    held = Held(factor=factorise((K + (2 * np.pi * structure.shift_frequency) ** 2 * M).tocsr(), solver), rows=rows)
    modes = lowest_modes(K, M, count, shift_frequency=structure.shift_frequency, factor=held)
    shapes, motion = modes.shapes[:-6], modes.shapes[-6:]
    # to first order, of mass-normalised modes
    lost, squared = np.einsum("im,ij,jm->m", motion, joint.loss, motion), (2 * np.pi * modes.frequencies) ** 2
    factors = np.divide(lost, squared, out=np.zeros_like(lost), where=squared > 0)
    return CondensedModes(frequencies=modes.frequencies, loss_factors=factors, shapes=shapes)


LIKE = 0.5  # MAC by mass from which two modes are one
CLOSE = 0.01  # error of a frequency up to which the condensed joint counts as right
COUNTED = 2  # spare modes with the joint condensed, so that the last ones find a partner
STAGES = 5
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
        mean [Hz] (m,): of the same modes with the joint condensed and its points on the mean motions of the faces; NaN
            where no mode is like it.
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
            entries=six_each(nodes),
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
        """One row per mode: the full model, and mean ties with their error; loss where the law predicts one."""
        f = self.frequencies
        loss = (("loss", self.loss, ".2e"), ("mean ties", self.mean_loss, ".2e"))
        return in_columns(
            ("mode", range(1, len(f) + 1), ""),
            ("full [Hz]", f, ".2f"),
            ("mean ties [Hz]", self.mean, ".2f"),
            ("error [%]", 100 * (self.mean / f - 1), "+.3f"),
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
        preload: Which of the study's preloads, as text with a unit; the last where None.
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
    case, springs = under_preload(Case.of(study, progress), index, progress)
    structure = case.structure
    progress.begin("modes")
    modes, *_ = modes_of(case.modal, springs)
    check_motions(structure, modes)
    made = CondensedJoint.of(springs[number])
    elastic = slice(case.rigid_count, case.rigid_count + study.modes.count)
    shapes, frequencies = modes.shapes[:, elastic], modes.frequencies[elastic]
    lost = np.einsum("im,im->m", shapes, springs[number].loss() @ shapes)

    progress.begin("modes with mean ties")
    other = condensed_modes(structure, springs, number, elastic.stop + COUNTED, solver=study.modes.solver)
    at = partners(mac(shapes.T, other.shapes.T, structure.dynamic_matrices[1]), LIKE)
    mean, mean_loss = (np.where(at < 0, np.nan, values[at]) for values in (other.frequencies, other.loss_factors))
    return Condensed(
        study=study.title,
        name=study.joints[number].name,
        load=study.loads[index],
        joint=made,
        points=np.array([made.point if p is None else vector(list(p), "m", "points") for p in points]),
        frequencies=frequencies,
        loss=lost / (2 * np.pi * frequencies) ** 2,
        mean=mean,
        mean_loss=mean_loss,
        lossless=not structure.joints[number].law.predicts_loss,
    )


def under_preload(case: Case, index: int, progress: Progress) -> tuple[Case, tuple[Springs[Interface], ...]]:
    """A case under one of its preloads, after those before it, and the springs of its joints there."""
    problem = case.structure.assembly(solver=case.study.modes.solver)
    for preload in case.study.preloads[: index + 1]:
        progress.begin(f"preload {preload.name}")
        state = checked_preload(case.structure, problem, preload)
    case = case.under(state)
    return case, case.structure.springs(state.pressures)


def _joint(study: Study, name: str | None) -> int:
    names = [one.name for one in study.joints]
    if name is None and len(names) > 1:
        raise InputError(f"the study has the joints {', '.join(map(repr, names))}; say which by joint (--joint NAME)")
    if name is not None and name not in names:
        raise InputError(f"no joint {name!r}; the study has {', '.join(map(repr, names))}")
    return 0 if name is None else names.index(name)
