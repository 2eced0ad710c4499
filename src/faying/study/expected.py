"""What a run is expected to need, before there is a mesh: unknowns, memory and time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying.fe.face_facts import FaceFacts, GeometryFacts
from faying.fe.geometry import ELEMENTS, GRADING, UNKNOWNS
from faying.fe.memory import guessed, in_single
from faying.fe.solve import BY_PARTS, chosen, is_mpi
from faying.study.study import Study

SEGMENTS = 2.0  # elements along a radius of curvature, as the mesher is told
CURVED = 3.0  # so much more than beside a curved face alone: its edges are fine on the planes around, too (counted)
# CPU seconds from the mesh to the modes of one load, by unknowns: the T-specimen on one thread (docs/speed.md)
MEASURED = ((38_517, 3.4), (55_032, 4.1), (142_605, 14.0), (502_002, 98.3), (674_781, 137.0), (1_078_110, 514.0))
OVER_MPI = 11e3  # B for each unknown that the processes of mpiexec take (docs/speed.md)
MESHED = 1e-4  # CPU seconds per tetrahedron that the mesher takes, about
BASIS = (
    "unknowns from volume, size and curved faces, within a factor of two; time as a T-specimen of as many took on one "
    "thread, times loads and laws; the contact of a scan comes on top where it has not been solved yet"
)


@dataclass(frozen=True, kw_only=True)
class Expected:
    """What a run is expected to need.

    Args:
        unknowns: of the mesh.
        memory: of a factorisation [B].
        seconds: of all loads on one thread [s].
        basis: where the numbers come from.
    """

    unknowns: int
    memory: float
    seconds: float
    basis: str = BASIS

    @classmethod
    def of(cls, study: Study, unknowns: int) -> "Expected":
        """What a study of so many unknowns needs: the load at hand and the bounds, each once, and other laws again."""
        solved = len(study.loads) * (1 + len(study.beside)) + 2 / 3
        at, took = np.array(MEASURED).T
        one = float(np.exp(np.interp(np.log(unknowns), np.log(at), np.log(took))))
        if unknowns < at[0]:
            one = took[0] * unknowns / at[0]
        elif unknowns > at[-1]:
            one = took[-1] * (unknowns / at[-1]) ** 2
        seconds = one * solved + (MESHED * unknowns / UNKNOWNS if study.geometry.step is not None else 0.0)
        way = chosen(study.modes.solver)
        if is_mpi(way):
            memory = OVER_MPI * unknowns
        else:
            memory = in_single(unknowns) if way in ("pardiso", BY_PARTS) else guessed(unknowns)
        return cls(unknowns=unknowns, memory=memory, seconds=float(seconds))


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
