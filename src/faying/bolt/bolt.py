"""Bolts: the force they pull with, and the shank, head, nut and washers that move with the structure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isclose, pi
from typing import Any, ClassVar

import numpy as np

from faying.bolt.seat import Seat
from faying.bolt.tapped import INSIDE, RoundHole, engaged_length, round_hole
from faying.bolt.threads import THICKEST, THINNEST, Fastener, Thread
from faying.bolt.vdi2230 import HEADS, BoltSection, Head, bolt_sections, tightening_torque
from faying.checks import number
from faying.errors import InputError
from faying.fe.attach import DepthBand, Ring, mean_motion
from faying.fe.elasticity import Solid
from faying.fe.holes import Hole, holes
from faying.fe.line import Line, across
from faying.fe.mesh import Mesh
from faying.fe.sides import NamedFaces, face_centre
from faying.materials import material_of
from faying.misuse import checked_call, shortened
from faying.notes import Note
from faying.typing import Array
from faying.units import in_mm, show

# proportions of hexagon heads and nuts, of the thread's diameter: width across flats, heights (ISO 4014, ISO 4032)
ACROSS_FLATS, HEAD_HEIGHT, NUT_HEIGHT = 1.5, 0.64, 0.85
CLEARANCE = 1.1  # diameter of a clearance hole over that of its bolt (ISO 273, medium)
BOLT_FRICTION = (0.02, 0.8)  # in the thread and under the head: soft films, and steel that galls
NUT_FACTOR = (0.02, 1.0)  # about 0.2 for dry steel
AXIS_OFFSET = 0.2  # of a hole's radius: farther from its centre, an axis misses it
HEXAGON = 3**0.5 / 2  # area of a hexagon over the square of its width across flats


def torque_to_preload(
    torque: float,
    diameter: float,
    *,
    nut_factor: float | None = None,
    pitch: float | None = None,
    thread_friction: float | None = None,
    head_friction: float | None = None,
    bearing: float | None = None,
) -> float:
    """Return the preload [N] that a tightening torque [N m] gives a metric thread.

    diameter of the thread [m]; either nut_factor K [-], F = T/(K d), or pitch [m] and both friction coefficients [-]:
    F = T/(0.16 P + 0.58 d2 mu_thread + D_Km/2 mu_head), d2 = d - 0.6495 P; bearing: D_Km, the mean diameter of the seat
    [m], 1.3 d where None (VDI 2230, R13; Bickford, doi:10.1201/9780849381898, for K). Raises InputError where neither
    set is complete.
    """
    if torque <= 0 or diameter <= 0:
        raise InputError(f"torque {torque:g} N m and diameter {diameter:g} m must both be positive")
    if nut_factor is not None:
        return torque / (_between(nut_factor, "nut_factor", NUT_FACTOR) * diameter)
    if pitch is None or thread_friction is None or head_friction is None:
        raise InputError(
            "a torque gives no preload by itself; add nut_factor (about 0.2 for dry steel), or pitch, "
            "thread_friction and head_friction"
        )
    for name, friction in (("thread_friction", thread_friction), ("head_friction", head_friction)):
        _between(friction, name, BOLT_FRICTION)
    thread = Thread(diameter=diameter, pitch=pitch)
    bearing = (ACROSS_FLATS + CLEARANCE) / 2 * diameter if bearing is None else bearing
    return torque / tightening_torque(1.0, thread.pitch, thread.pitch_diameter, thread_friction, bearing, head_friction)


def _between(value: float, name: str, ends: tuple[float, float]) -> float:
    return number(value, name, least=ends[0], greatest=ends[1], ends="[]")


@checked_call
@dataclass(frozen=True, init=False)
class Washer:
    """A washer under the head or the nut of a bolt; lengths [m], or text with a unit.

    Args:
        outer: Outer diameter.
        inner: Inner diameter.
        thickness: Thickness.
        material: E [Pa], nu [-], density [kg/m3], or the name of a material in the catalogue.

    Raises:
        InputError: A length is not positive, the ring has no width, or the material is unknown.
    """

    outer: float
    inner: float
    thickness: float
    material: Solid

    def __init__(
        self, *, outer: float | str, inner: float | str, thickness: float | str, material: Solid | str
    ) -> None:
        for name, length in (("outer", outer), ("inner", inner), ("thickness", thickness)):
            object.__setattr__(self, name, number(length, f"washer: {name}", "m", least=0))
        object.__setattr__(self, "material", solid_of(material, "washer"))
        if self.inner >= self.outer:
            raise InputError(
                f"washer: inner diameter {show(self.inner, 'm')} must be less than the outer {show(self.outer, 'm')}"
            )

    @property
    def area(self) -> float:
        """Area of its flat side [m2]."""
        return pi / 4 * (self.outer**2 - self.inner**2)

    @property
    def compliance(self) -> float:
        """Axial compliance [m/N] under even pressure."""
        return self.thickness / (self.material.E * self.area)

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return (self.material.density or 0.0) * self.area * self.thickness


@checked_call
@dataclass(frozen=True, init=False)
class Bolt:
    """A bolt between two seats that look away from each other; lengths and masses also as text with a unit.

    Without a diameter it is a pair of forces on its seats: it has no stiffness and no mass.

    Args:
        name: What messages and results call the bolt.
        faces: Faces that head and nut press on; or the face under the head and the wall of the tapped hole that the
            bolt is screwed into.
        at: A point (3,) [m] on the axis; the middle between the faces where None.
        diameter: Diameter [m] of the shank, greater than 0; None for a bolt that is a force and nothing else.
        material: Material of the shank, or its name in the catalogue; given together with the diameter.
        seat: Inner and outer diameter [m] of the ring that head and nut press on. Where None: that of a washer; else,
            with `at`, from the hole to the width across flats of a hexagon head; else the whole faces.
        washers: Washers under head and nut together.
        head_mass: Mass of the head [kg]; that of a hexagon head where None.
        nut_mass: Mass of the nut [kg]; that of a hexagon nut where None.
        fastener: Thread and property class, from which its proof load follows; None where they are not known.
        engaged: Length [m] of the thread in a tapped hole; 1.5 diameters, or its depth if that is less, where None.
        thread: Metric thread, or its name, such as "M8x1"; that of the fastener, or else the coarse one of the
            diameter, where None.
        shank: Length [m] of the plain shank under the head, 0 for a bolt that is threaded up to its head. Where None: 0
            for a shank as thick as the thread; else, for a reduced shank, up to where the thread engages.
        head: "hexagon" or "socket".
        friction: Coefficients of friction in the thread and under the head; for sheet and loosening alone.

    Raises:
        InputError: Diameter without material or the other way round, a diameter of 0 or less, a ring without width,
            two different threads; when it is fitted, an axis beside its hole, `at` without a hole, a diameter or a
            ring, or a shank longer than what it clamps.

    Source:
        Head and nut: ISO 4014, ISO 4032. Stretch inside a tapped hole: half a diameter, VDI 2230 (l_G).
    """

    name: str
    faces: tuple[str, str]
    at: tuple[float, float, float] | None
    diameter: float | None
    material: Solid | None
    seat: tuple[float, float] | None
    washers: tuple[Washer, ...]
    head_mass: float | None
    nut_mass: float | None
    fastener: Fastener | None
    engaged: float | None
    thread: Thread | None
    shank: float | None
    head: Head
    friction: tuple[float | None, float | None] | None
    part: ClassVar[None] = None  # it is not a part of the mesh

    def __init__(
        self,
        name: str,
        faces: tuple[str, str],
        *,
        at: Sequence[float | str] | None = None,
        diameter: float | str | None = None,
        material: Solid | str | None = None,
        seat: tuple[float | str, float | str] | None = None,
        washers: Sequence[Washer] = (),
        head_mass: float | str | None = None,
        nut_mass: float | str | None = None,
        fastener: Fastener | None = None,
        engaged: float | str | None = None,
        thread: Thread | str | None = None,
        shank: float | str | None = None,
        head: Head = "hexagon",
        friction: tuple[float | None, float | None] | None = None,
    ) -> None:
        what = f"bolt {name!r}"
        if (diameter is None) != (material is None):
            raise InputError(f"{what} needs both diameter and material, or neither (a bolt without stiffness)")
        if faces[0] == faces[1]:
            raise InputError(f"{what}: both faces are {faces[0]!r}; give the seats of its head and of its nut")
        if at is not None and len(at) != 3:
            raise InputError(f"{what}: at = {shortened(at)}; give the three coordinates of a point on its axis")
        values = {
            "name": name,
            "faces": (faces[0], faces[1]),
            "at": None if at is None else tuple(number(x, f"{what}: at", "m") for x in at),
            "diameter": None if diameter is None else number(diameter, f"{what}: diameter", "m", least=0),
            "material": None if material is None else solid_of(material, what),
            "seat": None if seat is None else tuple(number(d, f"{what}: seat", "m") for d in seat),
            "washers": tuple(washers),
            "head_mass": None if head_mass is None else _mass(head_mass, f"{what}: head_mass"),
            "nut_mass": None if nut_mass is None else _mass(nut_mass, f"{what}: nut_mass"),
            "fastener": fastener,
            "engaged": None if engaged is None else number(engaged, f"{what}: engaged", "m", least=0),
            "thread": Thread.parse(thread) if isinstance(thread, str) else thread,
            "shank": None if shank is None else number(shank, f"{what}: shank", "m"),
            "head": head,
            "friction": friction,
        }
        for key, value in values.items():
            object.__setattr__(self, key, value)
        if self.seat is not None and not 0 <= self.seat[0] < self.seat[1]:
            raise InputError(f"{what}: the seat's inner diameter must be less than its outer")
        self._check_shape(what)

    def _check_shape(self, what: str) -> None:
        """Raise InputError where thread, shank and head do not go together."""
        if self.head not in HEADS:
            raise InputError(f'{what}: head = {shortened(self.head)}; give "hexagon" or "socket"')
        if self.shank is not None and self.shank < 0:
            raise InputError(f"{what}: shank = {show(self.shank, 'm')}; give 0 or more")
        if self.thread is not None and self.fastener is not None and self.thread != self.fastener.thread:
            raise InputError(f"{what}: thread {self.thread} is not that of its fastener, {self.fastener.thread}")

    @property
    def metric(self) -> Thread | None:
        """The thread: as given, or else the coarse one of the diameter; None where neither says it, or beyond M300."""
        if self.fastener is not None or self.thread is not None:
            return self.thread if self.fastener is None else self.fastener.thread
        covered = self.diameter is not None and THINNEST <= self.diameter <= THICKEST
        return Thread.near(self.diameter) if covered and self.diameter is not None else None

    @property
    def size(self) -> float | None:
        """Diameter [m] of the thread, by which heads and nuts are made; that of the shank where there is none."""
        return self.diameter if self.metric is None else self.metric.diameter

    def fitted(self, mesh: Mesh, materials: Mapping[str, Solid] | None = None) -> "FittedBolt":
        """Return the bolt in its place on a mesh.

        Its ends are the mean motions of its seats.

        Args:
            mesh: The mesh.
            materials: Part -> its material; the part that is tapped counts as of the bolt's material where None.

        Raises:
            InputError: As `placed`; no element lies in its ring; its shank is longer than what it clamps.
        """
        place = self.placed(mesh)
        point, end = place.point, place.point + place.length * place.axis
        across = place.length * place.axis
        seat = place.ring
        ring = None if seat is None else Ring(point=point, axis=across, inner=seat[0] / 2, outer=seat[1] / 2)
        ends = tuple(
            mean_motion(mesh.points, mesh.face(name), centre, region)
            for name, centre, region in zip(self.faces, (point, end), (ring, place.thread or ring), strict=True)
        )
        tapped = None
        if place.thread is not None and self.material is not None:
            tapped = (materials or {}).get(mesh.face_part[self.faces[1]], self.material).E
        if self.diameter is not None and self.shank is not None and self.shank > place.free * (1 + 1e-6):
            raise InputError(
                f"bolt {self.name!r}: its shank is {show(self.shank, 'm')} long, but its thread begins to engage "
                f"{show(place.free, 'm')} below its head; give a length from 0 to that"
            )
        return FittedBolt(**vars(place), ends=ends, E_tapped=tapped)

    def placed(self, mesh: NamedFaces) -> "BoltPlace":
        """Return where the bolt lies.

        Raises InputError where its faces do not look away from each other, no axis joins them, or it misses its hole.
        """
        first, second = self.faces
        walls = [round_hole(mesh.points, mesh.face(face)) for face in self.faces]
        if walls[0] is not None:
            raise InputError(
                f"bolt {self.name!r}: {first!r} is the wall of a hole; give the face under the head first, and "
                "the wall of a tapped hole second"
            )
        if walls[1] is not None:
            return self._screwed(mesh, walls[1])
        if self.engaged is not None:
            raise InputError(
                f"bolt {self.name!r}: engaged is for a tapped hole, and {second!r} is not the wall of one; leave it "
                "out, or name that wall as the second face"
            )
        if mesh.face_part[first] == mesh.face_part[second] and self.diameter is None:
            raise InputError(
                f"the bolt's faces {first!r} and {second!r} are both on part {mesh.face_part[first]!r}; a bolt "
                "pulls two parts together"
            )
        centre_a, normal_a, _ = face_centre(mesh.points, mesh.face(first))
        centre_b, normal_b, _ = face_centre(mesh.points, mesh.face(second))
        if self.at is not None:  # along the normal of the first seat, through the point given
            axis = -normal_a
            point = np.array(self.at)
            centre_a = point + ((centre_a - point) @ axis) * axis
            centre_b = point + ((centre_b - point) @ axis) * axis
        axis = centre_b - centre_a
        length = float(np.linalg.norm(axis))
        if length < 1e-6 * mesh.size or normal_a @ axis > -0.5 * length or normal_b @ axis < 0.5 * length:
            apart = min(-normal_a @ axis, normal_b @ axis)
            if normal_a @ normal_b < -0.5 and apart > 1e-6 * mesh.size:
                raise InputError(
                    f"the bolt's faces {first!r} and {second!r} look away from each other, but no axis joins their "
                    f"centres, which are {show(float(np.linalg.norm(axis - (axis @ normal_a) * normal_a)), 'm')} "
                    "apart across the normal; give at (a point on the bolt's axis) and seat (the ring that head and "
                    "nut press on)"
                )
            raise InputError(
                f"the bolt's faces {first!r} and {second!r} do not look away from each other; name the two seats "
                "that head and nut press on"
            )
        hole = self._hole(mesh, self.faces, centre_a, axis / length)
        ring = self._seat(hole, alone=self.at is None)
        line = Line(point=centre_a, axis=axis / length)
        pressed = tuple(Seat.of(mesh, face, line, ring) for face in self.faces)
        return BoltPlace(bolt=self, point=line.point, axis=line.axis, length=length, ring=ring, pressed=pressed)

    def _screwed(self, mesh: NamedFaces, wall: RoundHole) -> "BoltPlace":
        """Where a bolt lies that is screwed into a tapped hole: on the axis of the hole."""
        first, second = self.faces
        centre, normal, _ = face_centre(mesh.points, mesh.face(first))
        hole = wall.seen_from(centre)
        if normal @ hole.axis > -0.9:
            raise InputError(
                f"bolt {self.name!r}: the face {first!r} does not look away from the tapped hole {second!r} along its "
                "axis; name the face under the head first"
            )
        free = float((hole.point - centre) @ hole.axis)
        if free <= 0:
            raise InputError(
                f"bolt {self.name!r}: the face {first!r} under its head is {show(-free, 'm')} below the mouth of the "
                f"tapped hole {second!r}; check which faces they are"
            )
        diameter = self.size or 2 * hole.radius
        engaged = engaged_length(self.engaged, hole, diameter, self.name)
        ring = self._seat(self._hole(mesh, (first,), hole.point, hole.axis), alone=False)
        return BoltPlace(
            bolt=self,
            point=hole.point - free * hole.axis,
            axis=hole.axis,
            length=free + min(INSIDE * diameter, engaged),
            inside=min(INSIDE * diameter, engaged),
            ring=ring,
            pressed=(Seat.of(mesh, first, Line(point=hole.point, axis=hole.axis), ring),),
            thread=DepthBand(point=hole.point, axis=hole.axis, low=0.0, high=engaged),
        )

    def _hole(self, mesh: NamedFaces, faces: Sequence[str], point: Array, axis: Array) -> Hole | None:
        """The hole of these faces that the axis runs through, None where there is none.

        Raises InputError where the axis lies beside it. Other holes of the face, such as that of a pipe that stands on
        it, are wider than what a head covers, and count only where the axis runs inside them.
        """
        near: list[tuple[float, Hole, str]] = []
        for face in faces:
            for hole in holes(mesh.points, mesh.face(face)):
                offset = Line(point=point, axis=axis).aside(hole.centre)
                if offset <= AXIS_OFFSET * hole.radius:
                    return hole
                # the hole of another bolt is farther away than the width of a head, since two heads do not overlap
                head = self._covered if self._covered < np.inf else 2 * hole.radius
                if offset <= (head if 2 * hole.radius <= head else hole.radius):
                    near.append((offset, hole, face))
        if near:
            offset, hole, face = min(near, key=lambda one: one[0])
            raise InputError(
                f"bolt {self.name!r}: its axis is {show(offset, 'm')} away from the centre of the hole of "
                f"{show(2 * hole.radius, 'm')} in {face!r}, at {in_mm(hole.centre)}; give that point as `at`"
            )
        return None

    @property
    def _covered(self) -> float:
        """The widest hole [m] that head and nut can lie on; infinite where neither seat nor diameter says it."""
        if self.seat is not None:
            return self.seat[1]
        return ACROSS_FLATS * self.size if self.size else np.inf

    @property
    def stated_ring(self) -> tuple[float, float] | None:
        """Inner and outer diameter [m] of the seat or else of the washers; None where neither is given."""
        if self.seat is None and self.washers:
            return self.washers[0].inner, self.washers[0].outer
        return self.seat

    def _seat(self, hole: Hole | None, *, alone: bool) -> tuple[float, float] | None:
        """Inner and outer diameter [m] of the ring, None for the whole faces.

        alone: whether nothing but the faces says where the bolt is.
        """
        if self.stated_ring is not None:
            return self.stated_ring
        if alone:
            return None
        inner = 0.0 if hole is None else 2 * hole.radius
        size = self.size or inner / CLEARANCE
        if inner and inner >= ACROSS_FLATS * size:
            raise InputError(
                f"bolt {self.name!r}: a head of {show(ACROSS_FLATS * size, 'm')} across flats falls through its hole "
                f"of {show(inner, 'm')}; give seat, or a washer"
            )
        if not size:
            raise InputError(
                f"bolt {self.name!r} has a point on its axis, but neither seat, washer, diameter nor a round hole "
                "says how much of its faces it presses; give seat (inner and outer diameter)"
            )
        return inner, ACROSS_FLATS * size


def solid_of(given: Solid | str, what: str) -> Solid:
    """A material, or that of the catalogue under a name. Raises InputError for what is neither."""
    if isinstance(given, str):
        return material_of(given)
    if all(hasattr(given, key) for key in ("E", "nu", "density")):
        return given
    raise InputError(
        f'{what}: material = {shortened(given)}; give the name of one in the catalogue, "45 steel" say, or a Material'
    )


def _mass(given: float | str, name: str) -> float:
    value = number(given, name, "kg")
    if value < 0:
        raise InputError(f"{name} = {shortened(given)}; it must be 0 or more")
    return value


def frame_about(axis: Array) -> Array:
    """Unit vectors (3, 3): an axis, and two across it."""
    return np.stack([axis, *across(axis).T])


@dataclass(frozen=True, kw_only=True)
class BoltPlace:
    """Where a bolt lies.

    point [m] and axis (3,): from head to nut; length [m]: clamped; ring: inner and outer diameter [m] of head and nut,
    None for whole faces; pressed: the seats, that under the head first, one alone where there is no nut; thread: what
    the bolt engages of a tapped hole, None where it has a nut; inside: how much of the length lies in a tapped hole
    [m].
    """

    bolt: Bolt
    point: Array
    axis: Array
    length: float
    ring: tuple[float, float] | None
    pressed: tuple[Seat, ...]
    thread: DepthBand | None = None
    inside: float = 0.0

    @property
    def seats(self) -> Array:
        """Points (2, 3) [m] where the axis meets the seats of head and nut."""
        return np.stack([self.point, self.point + self.length * self.axis])

    @property
    def free(self) -> float:
        """Length [m] from under the head to where the thread engages, washers included."""
        return self.length - self.inside + sum(washer.thickness for washer in self.bolt.washers)

    @property
    def notes(self) -> tuple[Note, ...]:
        """What was chosen for want of a seat, and of the length of its thread."""
        bolt, notes = self.bolt, []
        if self.ring is not None and bolt.seat is None and not bolt.washers:
            ring = " to ".join(show(d, "m") for d in self.ring)
            text = f"bolt {bolt.name!r} has no seat: it presses a ring of {ring}, from its hole and its size"
            notes.append(Note(code="bolt-seat", text=text))
        wide = [f"bolt {bolt.name!r}: {seat.overhang}" for seat in self.pressed if seat.overhang]
        notes += [Note(code="seat-beyond-face", severity="limit", text=text) for text in wide]
        if self.thread is not None and bolt.engaged is None:
            length = show(self.thread.high, "m", digits=3)
            text = f"bolt {bolt.name!r}: its thread engages {length} of its tapped hole; engaged gives another length"
            notes.append(Note(code="bolt-thread", text=text))
        if bolt.diameter is not None and bolt.fastener is None and bolt.thread is None:
            notes += _thread_notes(bolt, bolt.metric)
        return tuple(notes)


def _meet(one: BoltPlace, other: BoltPlace) -> bool:
    """Whether two bolts run through one place: parallel, on a common face, closer than their shanks are thick.

    Not where two screws end in one thread from either side, one before the other.
    """
    screwed = one.thread is not None and other.thread is not None
    if screwed and ((other.seats - one.point) @ one.axis).min() > one.length * (1 - 1e-6):
        return False
    apart = Line(point=one.point, axis=one.axis).aside(other.point)
    thick = ((one.bolt.diameter or 0.0) + (other.bolt.diameter or 0.0)) / 2 or 1e-3 * one.length
    parallel = abs(float(one.axis @ other.axis)) > 0.9
    return apart < thick and parallel and bool({*one.bolt.faces} & {*other.bolt.faces})


def each_in_its_place(bolts: Sequence[BoltPlace]) -> None:
    """Raise InputError where two bolts run through one place."""
    for k, one in enumerate(bolts):
        for other in bolts[:k]:
            if _meet(one, other):
                raise InputError(
                    f"bolts {other.bolt.name!r} and {one.bolt.name!r} run through one place; give each a point on "
                    "its own axis as `at`, or leave one out"
                )


def _thread_notes(bolt: Bolt, metric: Thread | None) -> list[Note]:
    """What was assumed of a thread that is not given."""
    if metric is not None and metric.is_coarse:
        return []
    text = f"bolt {bolt.name!r}: no coarse thread has a diameter of {show(bolt.diameter or 0.0, 'm')}"
    if metric is None:
        text += "; it counts as a plain cylinder, without head, thread and nut"
    else:
        text += f'; a pitch of {show(metric.pitch, "m", digits=3)} is taken; thread, such as "M8x1", gives another'
    return [Note(code="bolt-pitch", text=text)]


@dataclass(frozen=True, kw_only=True)
class FittedBolt(BoltPlace):
    """A bolt in its place on a mesh.

    ends: mean motions (6, unknowns) of both seats; E_tapped: Young's modulus [Pa] of the part that is tapped, None
    where the bolt has a nut.
    """

    ends: tuple[Any, ...]
    E_tapped: float | None = None

    @cached_property
    def motion(self) -> Any:
        """Sparse operator (12, unknowns): translation and rotation at the head, then at the nut, in the bolt's axes."""
        from scipy.sparse import block_diag, csr_array, vstack

        return csr_array(block_diag([csr_array(frame_about(self.axis))] * 4) @ vstack(self.ends))

    @cached_property
    def load(self) -> Array:
        """Nodal forces [N] (unknowns,) that pull the two seats towards each other with 1 N."""
        pull = np.zeros(12)
        pull[0], pull[6] = 1.0, -1.0
        return np.asarray(self.motion.T @ pull)

    @cached_property
    def stiffness(self) -> Any | None:
        """Sparse stiffness [N/m] between the seats; None without a shank.

        A beam with shear, whose axial stiffness is that of bolt, nut and washers.
        """
        from scipy.sparse import csr_array

        beam = self._beam()
        return None if beam is None else (self.motion.T @ csr_array(beam) @ self.motion).tocsr()

    @cached_property
    def mass(self) -> Any | None:
        """Sparse mass [kg]: half of the shank, and head or nut with its washers, at each seat; None without a shank."""
        from scipy.sparse import diags_array

        bolt = self.bolt
        if bolt.diameter is None or bolt.material is None:
            return None
        density, d = bolt.material.density or 0.0, bolt.size or bolt.diameter
        shank = density * pi / 4 * bolt.diameter**2 * self.length
        hexagon = density * HEXAGON * (ACROSS_FLATS * d) ** 2
        head = hexagon * HEAD_HEIGHT * d if bolt.head_mass is None else bolt.head_mass
        # the part of the bolt in the nut fills its thread, so the nut counts as solid
        nut = hexagon * NUT_HEIGHT * d if bolt.nut_mass is None and self.thread is None else bolt.nut_mass or 0.0
        washers = sum(w.mass for w in bolt.washers) / 2
        lumps = np.repeat([shank / 2 + head + washers, 0.0, shank / 2 + nut + washers, 0.0], 3)
        return (self.motion.T @ diags_array(lumps) @ self.motion).tocsr()

    @property
    def released(self) -> None:
        """None: what the parts lose while the bolt's force is given, since the shank is none of them."""
        return None

    @cached_property
    def sections(self) -> tuple[BoltSection, ...]:
        """Cylinders in series that stand for the bolt, washers aside (VDI 2230); none without a shank."""
        bolt, thread = self.bolt, self.bolt.metric
        if bolt.diameter is None or bolt.material is None:
            return ()
        if thread is None:
            area = pi / 4 * bolt.diameter**2
            return (BoltSection(name="shank", length=self.length, area=area, E=bolt.material.E),)
        reduced = not isclose(bolt.diameter, thread.diameter, rel_tol=1e-6)
        default = self.free if reduced else 0.0
        return bolt_sections(
            thread,
            free=self.free,
            E=bolt.material.E,
            diameter=bolt.diameter,
            shank=default if bolt.shank is None else min(bolt.shank, self.free),
            head=bolt.head,
            engaged=None if self.thread is None else self.thread.high - self.thread.low,
            E_tapped=self.E_tapped,
        )

    @property
    def axial_stiffness(self) -> float:
        """Stiffness of bolt, nut and washers in series [N/m], 1/delta_S of VDI 2230; 0 without a shank."""
        if not self.sections:
            return 0.0
        washers = sum(w.compliance for w in self.bolt.washers)
        return 1 / (sum(section.compliance for section in self.sections) + washers)

    @property
    def rigidity(self) -> float:
        """What the shank gives the structure along `load` [N/m]; 0 without a shank."""
        return self.axial_stiffness

    @property
    def pull(self) -> Array:
        """What a displacement (unknowns,) adds to the bolt's force [N/m]: pull.u, by the stretch of the shank."""
        return -self.axial_stiffness * self.load

    def tension(self, displacement: Array) -> float:
        """What the shank's stretch adds to the bolt's force [N] under a displacement (unknowns,)."""
        return float(self.pull @ displacement)

    def end_forces(self, displacement: Array) -> Array | None:
        """Forces [N] and moments [N m] (12,) on the shank at head and nut, in the bolt's axes; None without a shank.

        By a displacement (unknowns,) since the bolt was tightened: at each end the force along the axis and two across
        it, then the torque and two bending moments.
        """
        beam = self._beam()
        return None if beam is None else np.asarray(beam @ (self.motion @ displacement))

    @property
    def guided_compliance(self) -> float:
        """Motion of the head across the bolt over the force that it takes [m/N]; NaN without a shank.

        Head and nut keep their direction, as faces of parts do that slide on each other: a guided cantilever.
        """
        beam = self._beam()
        return float("nan") if beam is None else 1 / float(beam[1, 1])

    def _beam(self) -> Array | None:
        """Stiffness (12, 12) of a round beam with shear along the first axis (Przemieniecki 1968, section 5.6)."""
        bolt = self.bolt
        if bolt.diameter is None or bolt.material is None:
            return None
        E, nu, d, length = bolt.material.E, bolt.material.nu, bolt.diameter, self.length
        area, bending = pi / 4 * d**2, pi / 64 * d**4
        shear_modulus = E / (2 * (1 + nu))
        kappa = 6 * (1 + nu) / (7 + 6 * nu)  # Cowper 1966, doi:10.1115/1.3625046
        phi = 12 * E * bending / (kappa * shear_modulus * area * length**2)
        beam = np.zeros((12, 12))
        for row, value in ((0, self.axial_stiffness), (3, shear_modulus * 2 * bending / length)):
            beam[np.ix_([row, row + 6], [row, row + 6])] = value * np.array([[1, -1], [-1, 1]])
        c = E * bending / ((1 + phi) * length**3)
        L = length
        block = c * np.array(
            [
                [12, 6 * L, -12, 6 * L],
                [6 * L, (4 + phi) * L**2, -6 * L, (2 - phi) * L**2],
                [-12, -6 * L, 12, -6 * L],
                [6 * L, (2 - phi) * L**2, -6 * L, (4 + phi) * L**2],
            ]
        )
        beam[np.ix_([1, 5, 7, 11], [1, 5, 7, 11])] += block
        turn = np.array([1, -1, 1, -1])  # in the other plane a positive rotation lowers the deflection
        beam[np.ix_([2, 4, 8, 10], [2, 4, 8, 10])] += block * np.outer(turn, turn)
        return beam


def fatigue_area(fitted: object) -> float:
    """The area [m2] of a bolt that fatigue looks at: the stress area of its thread, or its shank; NaN without one."""
    if not isinstance(fitted, FittedBolt) or fitted.bolt.diameter is None:
        return float("nan")
    thread = fitted.bolt.metric
    return pi / 4 * fitted.bolt.diameter**2 if thread is None else thread.stress_area
