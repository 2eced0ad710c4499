"""A bolted structure about its preload as a superelement: stiffness, mass and loss on interfaces and modes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from faying.case.case import Case, Progress
from faying.checks import number
from faying.decks.deck import CondensedDeck, UnitSystem, write_condensed
from faying.decks.programs import IN_SI
from faying.errors import InputError
from faying.export.condense import under_preload
from faying.export.fmu import write_fmu
from faying.export.matrix_modes import Assembled
from faying.fe.attach import mean_motion
from faying.fe.sides import face_centre
from faying.joint.attachments import nearest_node
from faying.joint.bolted import BoltedStructure
from faying.joint.joint import known_face
from faying.joint.preload_case import preload_index
from faying.joint.support_check import check_motions
from faying.misuse import checked_call
from faying.numerics.constraint import constrain
from faying.numerics.held import Held
from faying.numerics.memory import check_modes
from faying.numerics.modes import Modes, lowest_modes
from faying.numerics.solve import factorise
from faying.progress import Report
from faying.result.fields import listed
from faying.study.declaration.reader import Faults, Table
from faying.study.keys.face import face_name, one_face
from faying.study.load import Vector, vector
from faying.study.study import Study
from faying.style import Summary
from faying.text import in_columns
from faying.typing import Array, Index
from faying.units import load_text, show

MODES_RETAINED = 1.5  # times the frequency asked for: fixed-interface modes up to there are retained
FIRST = 16  # fixed-interface modes that are looked for at first
DEPENDENT = 1e-10  # of a residual vector of size 1: what the others leave of it is rounding
STAGES = 4
Place = str | Mapping[str, Any] | Sequence[float | str] | Array


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Superelement(Summary):
    """A structure about its preload, reduced to its interfaces and its modes with these held.

    Args:
        study: title of the study.
        load: preload of the first bolt [N].
        names: faces and nodes of the interfaces (i,).
        points: where each interface is (i, 3) [m]: the centre of a face.
        dofs: interface, from 1, and direction, 1 to 6, of each row; of a mode a number of its own, and 0 (n, 2).
        stiffness, mass, loss: (n, n) [N/m, N, N m; kg, kg m, kg m2]; modes have a mass of 1. The loss is the imaginary
            part of the stiffness: of the springs at rest, and of the parts where the study gives them a loss.
        up_to: frequency that was asked for [Hz].
        frequencies, reduced: elastic modes of the full model up to there, and of these matrices, interfaces free
            (m,) [Hz].
    """

    study: str
    load: float
    names: tuple[str, ...]
    points: Array
    dofs: Index
    stiffness: Array
    mass: Array
    loss: Array
    up_to: float
    frequencies: Array
    reduced: Array

    @property
    def error(self) -> float:
        """Greatest relative error of these frequencies [-]; 0 where there are none."""
        return float(np.abs(self.reduced / self.frequencies - 1).max(initial=0.0))

    def write(
        self, program: str, folder: str | Path, *, unit: str = "m", force_unit: str = "N", node: int = 900_001
    ) -> list[Path]:
        """Write the superelement for another program.

        Args:
            program: "nastran", "abaqus", "market" (Matrix Market), "npz" (SciPy), or "fmu" (FMI 2.0, co-simulation);
                the last two are in SI units.
            folder: Where the files go; it is made where it does not exist.
            unit, force_unit: Units of length and force of that program's model.
            node: Number of the first interface's node; those of the others and of the modes follow.

        Returns:
            The files.

        Raises:
            InputError: Another program, wrong units or numbers, or a folder that cannot be used.
        """
        if node < 1:
            raise InputError(f"node {node}: give a number from 1 on")
        if program in IN_SI and (unit, force_unit) != ("m", "N"):
            raise InputError(f"{program} is written in SI units; leave out the units {unit} and {force_unit}")
        if program == "fmu":
            lowest, title = float(self.frequencies.min(initial=self.up_to)), f"{self.study} at {load_text(self.load)}"
            matrices = self.stiffness, self.mass, self.loss
            return write_fmu(Path(folder), title, self.names, self.dofs, *matrices, lowest=lowest)
        entries = self.dofs + np.array([node - 1, 0])
        if program == "npz":
            return Assembled(
                stiffness=self.stiffness,
                mass=self.mass,
                loss=self.loss,
                dofs=np.maximum(entries, 1),
                points=self.points,
                shift_frequency=self.up_to,
                source=self.study,
            ).write(Path(folder))
        system = UnitSystem(unit, force_unit)
        places = zip(self.names, (system.metre * self.points).tolist(), strict=True)
        deck = CondensedDeck(
            points=self.points,
            nodes=range(node, node + len(self.names)),
            element=node,
            entries=entries,
            stiffness=self.stiffness,
            loss=self.loss,
            mass=self.mass,
            system=system,
            facts=(
                f"{self.study!r} at {load_text(self.load)} as a superelement, written by Faying {version('faying')}",
                system.describe(),
                *(
                    f"node {k}: {name}, at ({x:.6g}, {y:.6g}, {z:.6g})"
                    for k, (name, (x, y, z)) in enumerate(places, node)
                ),
                "the node of a face follows its mean motion (RBE3), and leaves it free to deform",
                f"frequencies up to {self.up_to:.4g} Hz err by at most {self.error:.1e}, all interfaces free",
            ),
            name="superelement",
        )
        return write_condensed(deck, program, Path(folder))

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return its interfaces, its size, and its error."""
        modes = int(np.count_nonzero(self.dofs[:, 1] == 0))
        return f"Superelement of {self.study} at {load_text(self.load)}", {
            "interfaces": ", ".join(self.names),
            "unknowns": f"{len(self.dofs) - modes} of interfaces, {modes} modes",
            "error": f"{100 * self.error:.2g} % at most, up to {show(self.up_to, 'Hz')}, all interfaces free",
        }

    def rows(self) -> list[list[str]]:
        """One row per mode: the full model, and the superelement with its error."""
        return in_columns(
            ("mode", range(1, len(self.frequencies) + 1), ""),
            ("full [Hz]", self.frequencies, ".2f"),
            ("superelement [Hz]", self.reduced, ".2f"),
            ("error [%]", 100 * (self.reduced / self.frequencies - 1), "+.4f"),
        )

    def to_dict(self) -> dict[str, Any]:
        """Everything but the matrices, in SI units, for JSON."""
        return {
            "load": {"unit": "N", "values": self.load},
            "interfaces": list(self.names),
            "points": {"unit": "m", "values": self.points.tolist()},
            "up_to": {"unit": "Hz", "values": self.up_to},
            "frequencies": {"unit": "Hz", "values": listed(self.frequencies)},
            "superelement": {"unit": "Hz", "values": listed(self.reduced)},
        }


@checked_call
def superelement(
    study: Study | str | Path,
    interfaces: Sequence[Place],
    *,
    up_to: float | str | None = None,
    preload: str | None = None,
    report: Report | None = None,
) -> Superelement:
    """Solve a study at one preload and reduce it to interfaces and modes.

    Args:
        study: The study, or the path of its file.
        interfaces: Names of faces, selectors such as {"part": "upper", "normal": "+z"}, and points x, y, z [m] or text
            with units. A face gives six unknowns, its mean motion; a point the three of the node nearest to it.
        up_to: Frequency up to which the modes are right [Hz], or text with a unit; that of the study's last mode where
            None.
        preload: Which of the study's preloads, as text with a unit; the last where None.
        report: Called as each stage begins.

    Returns:
        The superelement, with its error.

    Raises:
        InputError, ReadError: What the study gives cannot be used, no such preload or face, an interface twice or on a
            support.
        NotConverged: An iteration stops short.

    Source:
        Craig and Bampton 1968, doi:10.2514/3.4741; its residual vectors are the first term that is left out of the
        response of the higher fixed-interface modes to motions of the interfaces.
    """
    limit = None if up_to is None else number(up_to, "up_to", "Hz", least=0, ends="()")
    study, places = _named(Study.read_bolted(study), interfaces)
    index = preload_index(study.loads, preload, names=study.load_names)
    progress = Progress(STAGES + index, report)
    case, springs = under_preload(Case.of(study, progress), index, progress)
    structure = case.structure
    names, points, rows, dofs = _interfaces(structure, places)
    progress.begin("modes")
    (K, loss), M = structure.coupled(springs), structure.dynamic_matrices[1]
    if study.parts_loss:
        loss = loss + study.parts_loss * constrain(structure.matrices[0], structure.fixed, 0.0)
    frequency, rigid = case.shift_frequency, case.rigid_count
    shift = (2 * np.pi * frequency) ** 2
    factor = factorise((K + shift * M).tocsr(), study.modes.solver)
    most = int(np.count_nonzero(M.diagonal() > 0))

    def modes(count: int, by: Any, greatest: int) -> Modes:
        check_modes(count, K.shape[0])
        return lowest_modes(K, M, min(count, greatest), shift_frequency=frequency, factor=by)

    full = _up_to(limit, rigid + study.modes.count, most, lambda count: modes(count, factor, most))
    check_motions(structure, full)
    limit = limit or float(full.frequencies[-1])
    progress.begin("modes with the interfaces held")
    held, most = Held(factor=factor, rows=rows), most - rows.shape[0]
    fixed = _up_to(MODES_RETAINED * limit, FIRST, most, lambda count: modes(count, held, most))
    shapes, squared = _basis(held, K, M, fixed.shapes[:, fixed.frequencies <= MODES_RETAINED * limit], shift)
    stiffness, mass, lost = (_symmetric(shapes.T @ (matrix @ shapes)) for matrix in (K, M, loss))
    inner = np.arange(len(dofs), len(dofs) + len(squared))
    # what the basis makes so, without its rounding
    stiffness[inner], stiffness[:, inner], mass[np.ix_(inner, inner)] = 0.0, 0.0, np.eye(len(inner))
    stiffness[inner, inner] = squared
    elastic = full.frequencies[rigid:][full.frequencies[rigid:] <= limit]
    return Superelement(
        study=study.title,
        load=study.loads[index],
        names=names,
        points=points,
        dofs=np.concatenate([dofs, np.column_stack([len(names) + 1 + np.arange(len(inner)), 0 * inner])]),
        stiffness=stiffness,
        mass=mass,
        loss=lost,
        up_to=limit,
        frequencies=elastic,
        reduced=_frequencies(stiffness, mass)[rigid : rigid + len(elastic)],
    )


def _named(study: Study, interfaces: Sequence[Place]) -> tuple[Study, list[str | Vector]]:
    """The study with the faces of selectors, and each interface as the name of a face or as a point [m]."""
    faults, out = Faults(), list[str | Vector]()
    for k, one in enumerate(interfaces, 1):
        label = f"interface {k}"
        if isinstance(one, str | Mapping):
            out.append(face_name(Table({"face": one}, label, faults, {"face": one_face("")}), label) or label)
        else:
            out.append(vector(list(one), "m", label))
    faults.raise_if_any("interfaces")
    if not out:
        raise InputError("a superelement needs an interface: give a face or a point")
    return replace(study, geometry=replace(study.geometry, face={**study.geometry.face, **faults.selectors})), out


def _interfaces(
    structure: BoltedStructure, places: Sequence[str | Vector]
) -> tuple[tuple[str, ...], Array, Any, Index]:
    """Names, points [m], what each unknown is of a displacement (k, unknowns), and its interface and direction."""
    from scipy.sparse import csr_array, vstack

    mesh = structure.mesh
    names, points, rows, dofs = [], [], [], []
    for k, place in enumerate(places, 1):
        if isinstance(place, str):
            known_face(mesh, place, f"interface {k}")
            name, (at, _, _) = place, face_centre(mesh.points, mesh.face(place))
            motion = mean_motion(mesh.points, mesh.face(place), at)
        else:
            node = nearest_node(mesh, place, f"interface {k}")
            name, at = f"node {mesh.numbers[node]}", mesh.points[node]
            motion = csr_array((np.ones(3), (range(3), 3 * node + np.arange(3))), shape=(3, mesh.unknowns))
        if name in names:
            raise InputError(f"{name!r} is an interface twice; give it once")
        if np.isin(motion.indices, structure.fixed).any():
            raise InputError(f"a support holds some of the interface {name!r}; leave out one of them")
        names.append(name)
        points.append(at)
        rows.append(motion)
        dofs += [(k, direction) for direction in range(1, motion.shape[0] + 1)]
    return tuple(names), np.array(points), vstack(rows).tocsr(), np.array(dofs)


def _up_to(limit: float | None, count: int, most: int, find: Callable[[int], Modes]) -> Modes:
    """The lowest modes, as many as it takes to pass a frequency [Hz]; `count` of them where that is None."""
    found = find(count)
    while limit is not None and count < most and found.frequencies[-1] <= limit:
        count *= 2
        found = find(count)
    return found


def _basis(held: Held, K: Any, M: Any, modes: Array, shift: float) -> tuple[Array, Array]:
    """Shapes (unknowns, k + m), and the squared frequencies [1/s2] (m,) of the last m.

    k static shapes, in each of which one interface moves by 1; then held modes and residual vectors: what the modes
    leave of the answer to the inertia of the static shapes. The last m have a mass of 1 and no stiffness in common.
    """
    still = held.shapes + held.beside(shift * (M @ held.shapes), modes, M, shift)
    rest = held.beside(M @ still, modes, M, shift)
    rest = rest / np.sqrt(np.maximum(np.einsum("ij,ij->j", rest, M @ rest), 1e-300))
    values, turn = np.linalg.eigh(_symmetric(rest.T @ (M @ rest)))
    keep = values > DEPENDENT
    inner = np.concatenate([modes, rest @ (turn[:, keep] / np.sqrt(values[keep]))], axis=1)
    squared, turn = np.linalg.eigh(_symmetric(inner.T @ (K @ inner)))
    inner, squared = inner @ turn, np.maximum(squared, 0.0)
    force = inner.T @ (K @ still)
    still -= inner @ np.divide(force, squared[:, None], out=np.zeros_like(force), where=squared[:, None] > 1e-6 * shift)
    return np.concatenate([still, inner], axis=1), squared


def _frequencies(stiffness: Array, mass: Array) -> Array:
    from scipy.linalg import eigh

    return np.asarray(np.sqrt(np.abs(eigh(stiffness, mass, eigvals_only=True))) / (2 * np.pi))


def _symmetric(matrix: Array) -> Array:
    return np.asarray((matrix + matrix.T) / 2)
