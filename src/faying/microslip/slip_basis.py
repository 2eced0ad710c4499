"""The basis in which a structure slips: its modes, those with softened joints, and what the slipping motion asks for.

All vectors come from the one factorisation that the modes have left. Softened joints stand for slip before anything has
slipped; what a computed cycle leaves in the full equations is the measure of the basis, and, sent through the
factorisation, what mends it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from faying.errors import InputError, NotConverged
from faying.fe.interface import Interface
from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import PreloadState
from faying.joint.springs import Springs
from faying.microslip.epmc import ALL_SLIDING, OTHER_MODES, Epmc, EpmcPoint
from faying.microslip.microslip import Microslip
from faying.microslip.slip_model import SlipJoint, SlipModel, slip_joints
from faying.numerics.basis import Basis
from faying.numerics.modal_reanalysis import nearby_modes
from faying.numerics.modes import Modes
from faying.numerics.product import product
from faying.typing import Array

TANGENTIAL = (0.3, 0.1, 0.03, 0.01)  # of k_t: joints that slip
NORMAL = (0.3, 0.1)  # of k_n: joints that open
NEIGHBOURS = 2  # modes above the one wanted that are trained with softened joints, too
ROUGH = 1e-3  # relative error of the squared frequencies of a softened joint: the residual sees to the rest
NEARBY = 1e-9  # the same of modes under another preload
SMALL = 1e-5  # of the energy of the vectors that a residual asks for: less is left out
GOOD = 0.003  # residual, in energy, at which a basis is good: it errs by the square of that in frequency
ENRICHMENTS = 10  # of one amplitude


@dataclass
class SlipBasis:
    """A structure under its preload, ready to slip.

    Args:
        structure: With the laws on its joints.
        preload: Its equilibrium.
        springs: Of its joints under that.
        modes: With these springs, rigid motions first, and their factorisation.
        mode: Elastic mode that is followed, from 1.

    Raises:
        InputError: There is no such mode, or a joint has springs per node.
    """

    structure: BoltedStructure
    preload: PreloadState
    springs: Sequence[Springs[Interface]]
    modes: Modes
    mode: int
    basis: Basis = field(init=False)

    def __post_init__(self) -> None:
        structure, rigid = self.structure, self.structure.rigid_count
        elastic = self.modes.shapes.shape[1] - rigid
        if not 1 <= self.mode <= elastic:
            raise InputError(f"mode {self.mode}: give one of the elastic modes 1 to {elastic}, counted from the lowest")
        for joint in structure.joints:
            if joint.per_node:
                raise InputError(
                    f'joint {joint.name!r} has springs = "per-node"; a backbone takes springs per area: leave it out'
                )
        self.stiffness, self.mass = structure.dynamic_matrices
        self.joined, _ = structure.coupled(self.springs)
        free = self.modes.shapes[:, :rigid]
        self.basis = Basis(
            reference=(self.joined + self.modes.shift * self.mass).tocsr(),
            operators=(self.stiffness, self.mass),
            interfaces=[joint.interface for joint in structure.joints],
            rigid=free,
            rigid_momentum=np.asarray(self.mass @ free),
        )

    @property
    def shape(self) -> Array:
        """Mode at rest (unknowns,) [kg^-1/2]."""
        return np.asarray(self.modes.shapes[:, self.structure.rigid_count + self.mode - 1])

    def begin(self, report: Callable[[str], None] | None = None) -> None:
        """Take the modes at rest and those with softened joints."""
        rigid = self.structure.rigid_count
        self.basis.add(self.modes.shapes[:, rigid:])
        kinds = [("k_t", factor) for factor in TANGENTIAL] + [("k_n", factor) for factor in NORMAL]
        found = None
        for name, factor in kinds:
            if report is not None:
                report(f"basis: {name} x {factor:g}")
            softened = [replace(s, **{name: factor * getattr(s, name)}) for s in self.springs]
            stiffness, _ = self.structure.coupled(softened)
            try:
                _, shapes = nearby_modes(
                    self.modes, stiffness, self.mass, rigid=rigid, count=self._trained, tolerance=ROUGH, more=found
                )
            except NotConverged:
                continue  # too soft for these modes to go by; the residual tells whether that matters
            found = shapes
            self.basis.add(shapes, least=SMALL * float(self._energy(self.shape)))

    def under(
        self, structure: BoltedStructure, preload: PreloadState, springs: Sequence[Springs[Interface]]
    ) -> "SlipBasis":
        """The structure under another preload or other laws on its joints, in the same basis."""
        other = replace(self, structure=structure, preload=preload, springs=springs)
        other.basis = self.basis
        return other

    def take_modes(self) -> None:
        """Take the modes under this preload and these laws, where the factorisation is that under others."""
        rigid = self.structure.rigid_count
        _, shapes = nearby_modes(self.modes, self.joined, self.mass, rigid=rigid, count=self._trained, tolerance=NEARBY)
        self.basis.add(shapes)

    def modes_here(self) -> Modes:
        """The modes under this preload and these laws, rigid motions first, with the factorisation that there is."""
        rigid = self.structure.rigid_count
        f, shapes = nearby_modes(self.modes, self.joined, self.mass, rigid=rigid, count=self.mode, tolerance=NEARBY)
        free = slice(0, rigid)
        return replace(
            self.modes,
            frequencies=np.concatenate([self.modes.frequencies[free], f]),
            shapes=np.concatenate([self.modes.shapes[:, free], shapes], axis=1),
        )

    @property
    def _trained(self) -> int:
        """Elastic modes that are followed into softened joints."""
        return min(self.mode + NEIGHBOURS, int(self.modes.shapes.shape[1]) - self.structure.rigid_count)

    def _energy(self, x: Array) -> Any:
        return np.einsum("i...,i...->...", x, self.basis.reference @ x)

    def model(self, laws: Sequence[Microslip]) -> SlipModel:
        """The structure in the basis, with a microslip law for each joint."""
        interfaces = [joint.interface for joint in self.structure.joints]
        joints = slip_joints(interfaces, self.preload.displacement, laws, self.basis.relative)
        return SlipModel(stiffness=self.basis.small[0], mass=self.basis.small[1], joints=joints)

    def epmc(self, laws: Sequence[Microslip], *, harmonics: int, samples: int, observer: Array | None = None) -> Epmc:
        """The curve of the mode; observer (unknowns,): what takes a displacement to the one observed [m]."""
        model = self.model(laws)
        _, shapes = model.modes
        at_rest = self.basis.vectors.T @ (self.mass @ self.shape)
        mode = int(np.argmax(np.abs(shapes.T @ at_rest)))
        row = None if observer is None else observer @ self.basis.vectors
        return Epmc(model=model, mode=mode, harmonics=harmonics, samples=samples, observer=row)

    def residual(self, epmc: Epmc, point: EpmcPoint) -> tuple[float, Array]:
        """What a cycle leaves in the full equations, in energy over that of its motion [-], and what mends it.

        The second (unknowns, 1 + 2H): one vector for each harmonic.
        """
        X = point.coordinates
        left = unbalanced_forces(
            self.structure,
            self.basis.vectors,
            epmc.model.joints,
            motion=X,
            traction=point.traction,
            speed=point.frequency,
            damping=point.damping,
        )
        correction = self.modes.factorisation.solve(np.asfortranarray(left))
        size = float(np.einsum("ij,jk,ik->", X, epmc.model.linear, X))
        return float(np.sqrt(max(np.einsum("ij,ij->", left, correction), 0.0) / size)), correction

    def train(
        self,
        laws: Sequence[Microslip],
        amplitudes: Callable[[Epmc], Sequence[float]],
        *,
        harmonics: int,
        samples: int,
        tolerance: float = GOOD,
        observer: Array | None = None,
        report: Callable[[str], None] | None = None,
    ) -> float:
        """Enrich until the cycles are right to `tolerance`; return the worst residual left.

        amplitudes: modal amplitudes that are looked at, from the curve at hand; where no motion is found, or nothing
        improves it, the training ends.
        """
        worst = 0.0
        known: list[EpmcPoint] = []
        first = self.epmc(laws, harmonics=harmonics, samples=samples, observer=observer)
        for amplitude in amplitudes(first):
            start = known[-2:]
            for turn in range(ENRICHMENTS + 1):
                epmc = self.epmc(laws, harmonics=harmonics, samples=samples, observer=observer)
                try:
                    here = epmc.solve(amplitude, [self._padded(point) for point in start])
                except NotConverged:
                    return worst
                error, correction = self.residual(epmc, here)
                if report is not None:
                    report(f"basis: {self.basis.vectors.shape[1]} vectors, residual {error:.1e}")
                if error < tolerance or turn == ENRICHMENTS:
                    break
                size = float(self._energy(self.basis.vectors @ here.coordinates[1:3].T).sum())
                if not self.basis.add(correction, least=(0.1 * tolerance) ** 2 * size):
                    break
                start = [here]
            worst = max(worst, error)
            if here.slipping > ALL_SLIDING or here.other_modes > OTHER_MODES:
                break
            known.append(here)
        return worst

    def _padded(self, point: EpmcPoint) -> EpmcPoint:
        """A point found with fewer vectors."""
        more = self.basis.vectors.shape[1] - point.coordinates.shape[1]
        return replace(point, coordinates=np.pad(point.coordinates, ((0, 0), (0, more))))


def unbalanced_forces(
    structure: BoltedStructure,
    vectors: Array,
    joints: Sequence[SlipJoint],
    *,
    motion: Array,
    traction: Sequence[Array],
    speed: float,
    damping: float,
) -> Array:
    """What a cycle in a basis leaves in the full equations, (unknowns, 1 + 2H) [N].

    K X_h - (h w)^2 M X_h - 2 zeta w^2 h M (i X_h) + B' t_h, with K of the parts and t_h the traction since the preload.

    Args:
        structure: the structure.
        vectors: the basis (unknowns, m).
        joints: its joints in that basis.
        motion: Fourier coefficients of the coordinates (1 + 2H, m) [m]: mean, cos 1, sin 1, ...
        traction: those of each joint (1 + 2H, q, 3) [Pa].
        speed: circular frequency w [rad/s].
        damping: ratio zeta [-], with which the cycle goes on for ever.
    """
    stiffness, mass = structure.dynamic_matrices
    moved = vectors @ motion.T
    left, inertia = product(stiffness, moved), product(mass, moved)
    for h in range(1, len(motion) // 2 + 1):
        c, s = 2 * h - 1, 2 * h
        left[:, c] -= (h * speed) ** 2 * inertia[:, c] + 2 * damping * h * speed**2 * inertia[:, s]
        left[:, s] -= (h * speed) ** 2 * inertia[:, s] - 2 * damping * h * speed**2 * inertia[:, c]
    for fitted, joint, found in zip(structure.joints, joints, traction, strict=True):
        since = found * joint.weights[:, None]
        since[0] -= joint.at_rest[0] * joint.weights[:, None]
        left += fitted.interface.relative.T @ since.reshape(len(motion), -1).T
    left[structure.fixed] = 0.0
    return left
