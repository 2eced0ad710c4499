"""What a run is expected to need, before there is a mesh: unknowns, memory and time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying.geometry.face_facts import FaceFacts, GeometryFacts
from faying.geometry.geometry import ELEMENTS, GRADING, UNKNOWNS
from faying.numerics.memory import guessed, in_single
from faying.numerics.solve import BY_PARTS, chosen
from faying.study.study import Study

SEGMENTS = 2.0  # elements along a radius of curvature, as the mesher is told
CURVED = 3.0  # so much more than beside a curved face alone: its edges are fine on the planes around, too (counted)
# of the command with one load, on one thread: counted on assemblies of 17,000 to 370,000 unknowns
START, EACH, GROWTH = 5.0, 1.7e-4, 1.13  # CPU seconds: those of any run, and EACH n^GROWTH
LOAD, OTHER = 0.25, 0.5  # of that: what each further load takes, and each other law
LEVELS, WAVES = 0.2, 0.2  # of that: the shares of damping at levels, and of waves where no joint has a form
SOLID = 0.7  # of that: what the joints under head and nut take where a bolt is a part
SHAKEN = 7.0  # CPU seconds of a vibration at one preload (the bracket on a shaker: 6 to 12)
CURVE = 13.0  # CPU seconds of a curve over amplitude (docs/backbone.md)
BARE, VECTORS = 0.13e9, 24e3  # B: of any run, and for each unknown, with PARDISO's factor in single precision
ESTIMATED = "the unknowns are estimated from volume, size and curved faces, within a factor of 2.5"
COUNTED = "the unknowns are those of the mesh"
BASIS = (
    "memory is the greatest of the run, time that of one thread, as in runs of as many unknowns; the contact of a scan "
    "that has not been solved yet takes longer"
)


@dataclass(frozen=True, kw_only=True)
class Expected:
    """What a run is expected to need.

    Args:
        unknowns: of the mesh.
        memory: the greatest that the run takes [B].
        seconds: of the run on one thread [s].
        basis: where the numbers come from.
    """

    unknowns: int
    memory: float
    seconds: float
    basis: str = f"{COUNTED}; {BASIS}"

    @classmethod
    def of(cls, study: Study, unknowns: int, *, counted: bool = True) -> "Expected":
        """What the run of a study of so many unknowns needs: its loads, other laws, damping, waves and curves.

        counted: whether they are those of a mesh.
        """
        share = 1.0 + LOAD * (len(study.loads) - 1) + OTHER * len(study.alternatives)
        share += SOLID if any(bolt.part is not None for bolt in study.bolts) else 0.0
        share -= 0.0 if study.modes.levels and study.joints else LEVELS
        share -= WAVES if not study.joints or any(joint.form is not None for joint in study.joints) else 0.0
        seconds = START + share * EACH * unknowns**GROWTH
        if study.backbone is not None:
            seconds += CURVE * len(study.loads) * max(len(study.backbone.laws), 1)
        seconds += SHAKEN * len(study.loads) * len(study.vibrations)
        way = chosen(study.modes.solver)
        memory = memory_of_run(unknowns)
        memory += 0.0 if way in ("pardiso", BY_PARTS) else guessed(unknowns) - in_single(unknowns)
        basis = f"{COUNTED if counted else ESTIMATED}; {BASIS}"
        return cls(unknowns=unknowns, memory=memory, seconds=seconds, basis=basis)


def memory_of_run(unknowns: int) -> float:
    """The greatest memory that a run of so many unknowns takes [B], with PARDISO's factor in single precision."""
    return BARE + VECTORS * unknowns


def unknowns_of(
    facts: GeometryFacts,
    size: float,
    face_size: Mapping[str, float] | None = None,
    named: Mapping[str, Sequence[FaceFacts]] | None = None,
) -> int:
    """Unknowns of a mesh of a geometry: those of its volume, and more where curved and named faces are meshed finer.

    Args:
        facts: of the geometry.
        size: largest element [m].
        face_size: largest element [m] on named faces.
        named: the faces of each name.
    """
    elements = ELEMENTS * sum(part.volume for part in facts.parts) / size**3
    for face in facts.faces:
        if face.radius is not None and face.radius / SEGMENTS < size:
            most = face.radius if face.hole is False else np.inf  # the material of a shaft lies within its radius
            elements += CURVED * _finer(face.area, face.radius, face.radius / SEGMENTS, size, most=most)
    for name, fine in (face_size or {}).items():
        for face in (named or {}).get(name, ()):
            elements += _finer(face.area, np.inf, fine, size, most=np.inf)
    return int(UNKNOWNS * elements)


def _finer(area: float, radius: float, fine: float, size: float, *, most: float) -> float:
    """Elements beyond those of the largest size beside a face on which they are finer [m] and grow away from it."""
    if fine >= size:
        return 0.0
    depth = np.linspace(0.0, min((size - fine) / GRADING, most), 50)
    here = np.minimum(fine + GRADING * depth, size)
    sign = -1.0 if np.isfinite(most) else 1.0
    spread = np.maximum(1 + sign * depth / radius, 0.0) if np.isfinite(radius) else np.ones_like(depth)
    return float(np.trapezoid(ELEMENTS * area * spread * (here**-3 - size**-3), depth))
