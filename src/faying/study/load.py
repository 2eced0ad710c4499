"""Load cases: what acts on a preloaded structure."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from faying.checks import number
from faying.errors import InputError
from faying.misuse import checked_call, shortened

MAX_INCREMENTS = 1000  # of one case
MAX_FACTOR = 1000.0  # on another case, either way
MAX_CYCLES = 1e12  # a hundred years at 300 Hz
COLDEST, WARMEST = -473.0, 2000.0  # K, change of temperature: from 200 degrees Celsius to absolute zero at most
Vector = tuple[float, float, float]
NOTHING: Vector = (0.0, 0.0, 0.0)


@checked_call
@dataclass(frozen=True, init=False)
class Force:
    """A force and a moment on a face or at a point; components as SI numbers or as text with a unit.

    On a face they are spread as a traction that is linear over the face, which does not stiffen it.

    Args:
        face: Name of the face; None for a node.
        force: Components [N] along x, y, z.
        moment: Components [N m]; on a face alone.
        point: Point (3,) [m] that the force goes through and the moment turns about, also apart from the face; its
            centre where None. Without a face: the node nearest to it.

    Raises:
        InputError: Neither face nor point, a moment at a node, or nothing that acts.
    """

    face: str | None
    force: Vector
    moment: Vector
    point: Vector | None

    def __init__(
        self,
        face: str | None = None,
        *,
        force: Sequence[float | str] = NOTHING,
        moment: Sequence[float | str] = NOTHING,
        point: Sequence[float | str] | None = None,
    ) -> None:
        where = f"force on {face!r}" if face else "force at a point"
        values = {
            "face": face,
            "force": vector(force, "N", f"{where}: force"),
            "moment": vector(moment, "N*m", f"{where}: moment"),
            "point": None if point is None else vector(point, "m", f"{where}: point"),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if face is None and point is None:
            raise InputError("a force needs a face, or a point whose nearest node it acts on; give one of the two")
        if face is None and any(self.moment):
            raise InputError("a moment needs a face, over which it is spread; a node has no rotation. Give face")
        if not any(self.force) and not any(self.moment):
            raise InputError(f"{where}: neither force nor moment is given; give one of them")


@checked_call
@dataclass(frozen=True, init=False)
class Pressure:
    """An even pressure on a face.

    Args:
        face: Name of the face.
        pressure: [Pa], or text with a unit; above 0 it presses on the face, below 0 it pulls.
    """

    face: str
    pressure: float

    def __init__(self, face: str, pressure: float | str) -> None:
        object.__setattr__(self, "face", face)
        object.__setattr__(self, "pressure", number(pressure, f"pressure on {face!r}", "Pa"))


@checked_call
@dataclass(frozen=True, init=False)
class Displacement:
    """A displacement of a face that a rigid support holds.

    Args:
        face: Name of the face.
        displacement: Components [m] along x, y, z, or text with a unit; 0 along directions that the support leaves
            free.
    """

    face: str
    displacement: Vector

    def __init__(self, face: str, displacement: Sequence[float | str]) -> None:
        object.__setattr__(self, "face", face)
        object.__setattr__(self, "displacement", vector(displacement, "m", f"displacement of {face!r}"))


def not_there(what: str, name: str, known: Iterable[str]) -> str:
    """That something is heated which is neither a part nor a bolt."""
    listed = ", ".join(map(repr, known))
    return f"{what}: temperature of {name!r}, which is neither a part nor a bolt; give one of {listed}"


def no_expansion(what: str, material: str) -> str:
    """That something is heated whose material says no expansion."""
    return (
        f"{what} changes its temperature, and its material {material!r} has no expansion; give the material one, such "
        'as "12e-6 1/K" for steel'
    )


def not_held(load: str, face: str, axis: str) -> str:
    """That a load moves a face along an axis in which no rigid support holds it."""
    return (
        f"load {load!r} moves the face {face!r} along {axis}, in which no rigid support holds it; give it a "
        "[[support]] without stiffness in that direction, or a force in place of the displacement"
    )


@checked_call
@dataclass(frozen=True, init=False)
class Load:
    """One load case on a preloaded structure. All that is given acts together.

    Args:
        name: What messages and results call the case.
        forces: Forces and moments.
        pressures: Pressures on faces.
        acceleration: Of the whole structure (3,) [m/s2], or text with a unit; the inertia of parts, bolts and point
            masses pulls the other way.
        temperature: Part or bolt -> change of its temperature since the bolts were tightened [K], -1000 to 2000, or
            text with a unit.
        displacements: Displacements of supported faces.
        combine: Other cases by name, with the factor on what acts in them, -1000 to 1000; it acts here too.
        after: Case whose state this one starts from: its load gives way to that of this case. The preload where None.
        increments: Into how many parts the way to this load is cut, 1 to 1000; friction depends on the way.
        cycles: How often this load comes and goes, from the state that it starts from, for the fatigue of the bolts; 0
            or more.

    Raises:
        InputError: Nothing acts, or a value has no meaning.
    """

    name: str
    forces: tuple[Force, ...]
    pressures: tuple[Pressure, ...]
    acceleration: Vector
    temperature: Mapping[str, float]
    displacements: tuple[Displacement, ...]
    combine: Mapping[str, float]
    after: str | None
    increments: int
    cycles: float

    def __init__(
        self,
        name: str,
        *,
        forces: Sequence[Force] = (),
        pressures: Sequence[Pressure] = (),
        acceleration: Sequence[float | str] = NOTHING,
        temperature: Mapping[str, float | str] | None = None,
        displacements: Sequence[Displacement] = (),
        combine: Mapping[str, float] | None = None,
        after: str | None = None,
        increments: int = 4,
        cycles: float = 0.0,
    ) -> None:
        what = f"load {name!r}"
        values = {
            "name": name,
            "forces": tuple(forces),
            "pressures": tuple(pressures),
            "acceleration": vector(acceleration, "m/s^2", f"{what}: acceleration"),
            "temperature": {
                key: number(change, f"{what}: temperature of {key!r}", "K")
                for key, change in (temperature or {}).items()
            },
            "displacements": tuple(displacements),
            "combine": {key: number(factor, f"{what}: combine") for key, factor in (combine or {}).items()},
            "after": after,
            "increments": increments,
            "cycles": number(cycles, f"{what}: cycles", least=0, greatest=MAX_CYCLES, ends="[]"),
        }
        for key, value in values.items():
            object.__setattr__(self, key, value)
        if not name.strip():
            raise InputError("a load has an empty name; give it one, by which results call it")
        if not 1 <= increments <= MAX_INCREMENTS:
            raise InputError(f"{what}: increments = {increments}; give a whole number from 1 to {MAX_INCREMENTS}")
        for part, change in self.temperature.items():
            if not COLDEST <= change <= WARMEST:
                raise InputError(
                    f"{what}: temperature of {part!r} changes by {change:g} K; give a change since the bolts were "
                    f"tightened, {COLDEST:g} to {WARMEST:g} K"
                )
        for other, factor in self.combine.items():
            if not abs(factor) <= MAX_FACTOR:
                raise InputError(
                    f"{what}: combine takes {other!r} {factor:g} times; give a factor from {-MAX_FACTOR:g} to "
                    f"{MAX_FACTOR:g}"
                )
        if not self.acts and after is None:
            raise InputError(
                f"{what}: nothing acts; give forces, pressures, an acceleration, temperatures or displacements, or "
                "combine other cases"
            )

    @property
    def acts(self) -> bool:
        """Whether anything acts; a case after another may let go of its load."""
        given = (self.forces, self.pressures, any(self.acceleration), self.temperature, self.displacements)
        return any(map(bool, (*given, self.combine)))

    @property
    def needs(self) -> tuple[str, ...]:
        """Names of the cases that it refers to."""
        return (*self.combine, *(() if self.after is None else (self.after,)))


def vector(values: Sequence[float | str], unit: str, name: str) -> Vector:
    """Return three SI components of numbers or text with a unit. Raises InputError for anything else."""
    if isinstance(values, str) or len(values) != 3:
        raise InputError(f"{name} = {shortened(values)}; give three components, along x, y and z")
    x, y, z = (number(value, name, unit) for value in values)
    return x, y, z


def in_order(loads: Sequence[Load]) -> list[Load]:
    """Return load cases so that each comes after those that it names.

    Raises:
        InputError: Two share a name, one names a case that is not there, or they name each other in a circle.
    """
    by_name: dict[str, Load] = {}
    for load in loads:
        if load.name in by_name:
            raise InputError(f"two loads are called {load.name!r}; give each a name of its own")
        by_name[load.name] = load
    for load in loads:
        for other in load.needs:
            if other not in by_name:
                known = ", ".join(map(repr, by_name))
                raise InputError(
                    f"load {load.name!r} names the load {other!r}, which is not there; give one of {known}"
                )
    out: list[Load] = []
    left = list(loads)
    while left:
        done = {load.name for load in out}
        ready = [load for load in left if done.issuperset(load.needs)]
        if not ready:
            raise InputError(f"loads {', '.join(repr(load.name) for load in left)} name each other in a circle")
        out += ready
        left = [load for load in left if load not in ready]
    return out
