"""A bolted structure under one preload: pressures, springs of the joints, modes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from faying.checks import number
from faying.errors import InputError
from faying.fe.interface import Interface
from faying.joint.bolted import BoltedStructure
from faying.joint.direct import Direct
from faying.joint.equilibrium import PreloadState
from faying.joint.figure import mode_axes, pressure_axes
from faying.joint.modal import MAX_MODES, SOLVERS, Engine, ModalProblem, ModesChoice, Vibration
from faying.joint.preload_case import PreloadCase, with_history
from faying.joint.shared_modes import Reanalysis
from faying.joint.springs import Springs
from faying.joint.strength import bolt_notes, material_notes, pressure_notes
from faying.joint.support_check import open_joints
from faying.misuse import checked_call, shortened
from faying.notes import Note, percent
from faying.style import Summary
from faying.text import notes_row, titled
from faying.typing import Array
from faying.units import load_text, show

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_ROWS = 10  # of a summary


ENGINES: dict[str, Callable[[ModalProblem, Sequence[PreloadCase]], Engine]] = {
    "reanalysis": Reanalysis,
    "direct": Direct,
}


def engine_for(name: str, problem: ModalProblem, preloads: Sequence[PreloadCase]) -> Engine:
    """The engine of a name, for a structure at its preloads. Raises InputError for another name than `ENGINES` has."""
    if name not in ENGINES:
        raise InputError(f"engine = {shortened(name)}; allowed: {', '.join(ENGINES)}")
    return ENGINES[name](problem, preloads)


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class VibrationModes(Summary):
    """Elastic modes of a structure in rising order.

    Args:
        frequencies: [Hz] (m,).
        loss_factors: Modal loss factors [-] (m,); NaN where no law of a joint predicts a loss.
        shapes: Motion of each node (m, nodes, 3) [kg^-1/2], mass-normalised; the greatest component of each is
            positive.
        structure: What moves.
        load: Preload in words.
    """

    frequencies: Array
    loss_factors: Array
    shapes: Array
    structure: BoltedStructure
    load: str = ""

    @property
    def damping(self) -> Array:
        """Damping ratios [-] (m,): half of the loss factors."""
        return self.loss_factors / 2

    def __len__(self) -> int:
        return len(self.frequencies)

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading and the first modes."""
        count = len(self)
        head = f"{count} elastic mode{'s' * (count > 1)}{f' at {self.load}' if self.load else ''}"
        return head, self.rows(MAX_ROWS)

    def rows(self, most: int) -> dict[str, str]:
        """The first modes in words, by their number."""
        shown = len(self) if len(self) <= most else most - 1
        rows = enumerate(zip(self.frequencies[:shown], self.damping, strict=False), start=1)
        out = {f"mode {k}": f"{f:10.2f} Hz{_ratio(zeta)}" for k, (f, zeta) in rows}
        if len(self) > shown:
            out[f"{len(self) - shown} more"] = f"up to {self.frequencies[-1]:.2f} Hz"
        return out

    @checked_call
    def plot(self, mode: int = 1, ax: "Axes | None" = None) -> "Axes":
        """Draw the shape of a mode on the structure, coloured by the size of its motion.

        Args:
            mode: Number of the mode, from 1.
            ax: Matplotlib axes with three dimensions to draw into; new ones where None.

        Returns:
            The axes.

        Raises:
            InputError: There is no such mode.
        """
        k, (nodes, triangles) = self.number(mode), self.structure.outline()
        title = f"mode {k + 1}: {show(self.frequencies[k], 'Hz')}{_ratio(self.damping[k])}"
        return mode_axes(self.structure.mesh.points[nodes], triangles, self.shapes[k][nodes], title, ax)

    def number(self, mode: int) -> int:
        """Index of a mode, counted from 0. Raises InputError where there is none of this number."""
        if not 1 <= mode <= len(self):
            raise InputError(f"mode = {shortened(mode)}; the modes are numbered from 1 to {len(self)}")
        return int(mode) - 1


def _ratio(value: float) -> str:
    return "" if np.isnan(value) else f", damping ratio {value:.3g}"


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class State(Summary):
    """A structure under one preload.

    Args:
        structure: The structure.
        forces: Force that each bolt is tightened to [N] (b,).
        preload: The equilibrium of the joints: displacement [m], pressures [Pa], forces that are left in the bolts.
        springs: Stiffness and loss of each joint at its points.
        vibration: Real and complex modes with the matrices that they belong to.
        notes: Where a law leaves its validity range, and the like.
    """

    structure: BoltedStructure
    forces: tuple[float, ...]
    preload: PreloadState
    springs: tuple[Springs[Interface], ...]
    vibration: Vibration
    notes: tuple[Note, ...]

    @cached_property
    def modes(self) -> VibrationModes:
        """The elastic modes."""
        damped = self.vibration.damped
        shapes = damped.real_shapes(self.structure.dynamic_matrices[1])
        lossless = not self.structure.predicts_loss
        return VibrationModes(
            frequencies=damped.frequencies,
            loss_factors=np.full_like(damped.loss_factors, np.nan) if lossless else damped.loss_factors,
            shapes=shapes.T.reshape(len(damped.frequencies), -1, 3),
            structure=self.structure,
            load=self.load,
        )

    @property
    def frequencies(self) -> Array:
        """Frequencies of the elastic modes [Hz] (m,)."""
        return self.vibration.damped.frequencies

    @property
    def load(self) -> str:
        """The preload in words."""
        values = sorted(set(self.forces))
        if len(values) < 2:
            return f"{show(values[0], 'N')} per bolt" if values else load_text(0.0)
        return f"{show(values[0], 'N')} to {show(values[-1], 'N')} per bolt"

    @property
    def pressures(self) -> dict[str, Array]:
        """Pressure [Pa] (q,) at the points of the springs of each joint, by its name."""
        return {joint.name: s.pressure for joint, s in zip(self.structure.joints, self.springs, strict=True)}

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, the pressures of the joints and the first modes."""
        head = f"State at {self.load}: {self.structure.mesh.unknowns:,} unknowns, {len(self.modes)} elastic modes"
        rows = {}
        joints = list(zip(self.structure.joints, self.springs, strict=True))
        for joint, s in joints[:2]:
            area = s.interface.weights
            shut = float(area @ (s.pressure <= 0) / area.sum())
            rows[titled("joint", joint.name)] = (
                f"mean pressure {show(float(area @ s.pressure / area.sum()), 'Pa')}, greatest "
                f"{show(float(s.pressure.max()), 'Pa')}, open on {shut:.0%}"
            )
        if len(joints) > 2:
            rows["more joints"] = str(len(joints) - 2)
        return head, rows | self.modes.rows(7) | notes_row(self.notes)

    @checked_call
    def plot(self, joint: str | None = None, ax: "Axes | None" = None) -> "Axes":
        """Draw the pressure on a joint, as `plot_pressure` does."""
        return self.plot_pressure(joint, ax)

    @checked_call
    def plot_pressure(self, joint: str | None = None, ax: "Axes | None" = None) -> "Axes":
        """Draw the pressure on a joint along the axes of the model; where there is no contact stays pale.

        Args:
            joint: Name of the joint; the first one where None.
            ax: Matplotlib axes to draw into; new ones where None.

        Returns:
            The axes.

        Raises:
            InputError: There is no joint of this name.
        """
        names = [one.name for one in self.structure.joints]
        if not names or (joint is not None and joint not in names):
            raise InputError(f"joint = {shortened(joint)}; the joints are {', '.join(map(repr, names)) or 'none'}")
        number = 0 if joint is None else names.index(joint)
        return pressure_axes(
            self.structure.surface(),
            self.structure.mesh.points,
            self.structure.joints[number].faces,
            self.springs[number],
            most=max(float(one.pressure.max()) for one in self.springs),
            title=f"{names[number]}, {self.load}",
            ax=ax,
        )


def solve_structure(
    structure: BoltedStructure,
    preloads: Sequence[float | str | Mapping[str, float | str] | None],
    *,
    modes: int,
    damping: Literal["hysteretic", "viscous"],
    order: Sequence[str] | None,
    solver: str | None,
    engine: str,
) -> tuple[State, ...]:
    """Solve a structure under preloads, one after another; see `Structure.solve`."""
    if not 1 <= modes <= MAX_MODES:
        raise InputError(f"modes = {shortened(modes)}; give how many elastic modes, 1 to {MAX_MODES:,}")
    if solver is not None and solver not in SOLVERS:
        raise InputError(f"solver = {shortened(solver)}; the solvers are {', '.join(map(repr, SOLVERS))}")
    choice = ModesChoice(count=int(modes), damping=damping, solver=solver)
    structure = structure.loaded_before(())
    cases = with_history([preload_case(structure, one, order) for one in preloads])
    solving = engine_for(engine, ModalProblem(structure=structure, choice=choice), cases)
    return tuple(_state(structure, case, solving, number) for number, case in enumerate(cases))


def _state(structure: BoltedStructure, case: PreloadCase, solving: Engine, number: int) -> State:
    """A structure under one of the preloads of an engine."""
    found = solving.preload(number)
    structure = structure.under(found)
    springs = structure.springs(found.pressures)
    vibration = solving.vibrate(springs)
    notes = [
        *structure.notes,
        *(note for joint in structure.joints for note in joint.assumptions),
        *material_notes(structure),
        *bolt_notes(structure, {bolt.name: (force,) for bolt, force in zip(structure.bolts, case.forces, strict=True)}),
        *law_notes(structure, found, case.preload),
        *end_notes(structure, springs, case.preload),
        *pressure_notes(structure, found.pressures, case.preload),
    ]
    return State(
        structure=structure,
        forces=case.forces,
        preload=found,
        springs=springs,
        vibration=vibration,
        notes=tuple(dict.fromkeys(notes)),
    )


def preload_case(
    structure: BoltedStructure, preload: float | str | Mapping[str, float | str] | None, order: Sequence[str] | None
) -> PreloadCase:
    """One preload of a structure, from what a user gives. Raises InputError where it is incomplete."""
    return PreloadCase(forces=bolt_forces(structure, preload), order=_order(structure, order))


def bolt_forces(
    structure: BoltedStructure, preload: float | str | Mapping[str, float | str] | None
) -> tuple[float, ...]:
    """Force of each bolt [N]. Raises InputError where one is missing, unknown or not positive."""
    names = [bolt.name for bolt in structure.bolts]
    if not names and structure.joints:
        raise InputError("the structure has no bolts, so nothing pulls its joints together; give it bolts=[Bolt(...)]")
    if bool(names) is (preload is None):
        raise InputError(f"preload = {shortened(preload)}; the bolts are {', '.join(map(repr, names)) or 'none'}")
    if preload is None:
        return ()
    if not isinstance(preload, Mapping):
        return (number(preload, "preload", "N", least=0),) * len(names)
    unknown = [name for name in preload if name not in names]
    lacking = [name for name in names if name not in preload]
    if unknown or lacking:
        wrong = f"names bolt {unknown[0]!r}, which is not there" if unknown else f"misses bolt {lacking[0]!r}"
        raise InputError(f"preload {wrong}; the bolts are {', '.join(map(repr, names))}")
    return tuple(number(preload[name], f"preload of bolt {name!r}", "N", least=0) for name in names)


def _order(structure: BoltedStructure, order: Sequence[str] | None) -> tuple[int, ...] | None:
    if order is None:
        return None
    names = [bolt.name for bolt in structure.bolts]
    if isinstance(order, str) or set(order) != set(names):
        raise InputError(f"order = {shortened(order)} should name every bolt: {', '.join(map(repr, names))}")
    return tuple(names.index(name) for name in order)


def law_notes(structure: BoltedStructure, preload: PreloadState, load: float) -> list[Note]:
    """Say where contact is lost, and how much of a joint's stiffness lies outside the validity range of its law."""
    kilo = load_text(load)
    out = [
        Note(
            code="open",
            severity="wrong",
            joint=name,
            load=load,
            text=f"{name}, {kilo}: no contact is left; the joint carries nothing",
        )
        for name in open_joints(structure, preload.pressures)
    ]
    for joint, pressure in zip(structure.joints, preload.pressures, strict=True):
        if preload.carried and joint.law.model.memory is None:
            text = (
                f"{joint.name}, {kilo}: {joint.law.model.name} says nothing of unloading, so that its stiffness is as "
                "on first loading; shear that friction holds stays. The half-space law of a scan knows what it carried"
            )
            out.append(Note(code="no-memory", joint=joint.name, load=load, text=text))
        for reason, share in joint.law.outside_validity(pressure, joint.interface.weights).items():
            where = f"outside its validity range for {percent(share)} of the joint's stiffness"
            text = f"{joint.name}, {kilo}: {joint.law.model.name} is {where}: {reason}"
            out.append(
                Note(code="outside-validity", severity="limit", joint=joint.name, load=load, share=share, text=text)
            )
    return out


def end_notes(structure: BoltedStructure, springs: Sequence[Springs[Interface]], load: float) -> list[Note]:
    """Say where the pressure exceeds the end of a law, with the share of the joint's area."""
    out = []
    for joint, s in zip(structure.joints, springs, strict=True):
        share = float(s.interface.weights @ joint.above_range(s) / s.interface.weights.sum())
        if share > 0:
            model = joint.law.model
            text = (
                f"{joint.name}, {load_text(load)}: on {percent(share)} of the joint the pressure exceeds the "
                f"{model.greatest_pressure / 1e6:.3g} MPa at which {model.name} ends; stiffness stays constant there"
            )
            out.append(Note(code="beyond-law", severity="limit", joint=joint.name, load=load, share=share, text=text))
    return out
