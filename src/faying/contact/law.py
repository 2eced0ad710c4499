"""How any contact law is asked for a pressure."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, replace
from functools import cache, cached_property
from importlib import import_module
from inspect import isabstract, isclass
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.inputs import FractalSurface, RoughSurface
from faying.contact.law_figure import law_plot
from faying.contact.measured_range import MeasuredRange
from faying.contact.memory import Memory
from faying.contact.parameter import FILE, Parameter, checked, checked_all
from faying.contact.response import Response
from faying.errors import FayingError, InputError, NotConverged, shown
from faying.materials import ContactPair
from faying.style import Summary
from faying.typing import Array
from faying.units import show

if TYPE_CHECKING:
    import matplotlib.axes

__all__ = ["ContactLaw", "Parameter", "Response", "checked", "found_in", "require"]

Kind = TypeVar("Kind")

TABLE_POINTS = 500
# from this many pressures on, at_pressure reads the checked table unless asked to be exact


def require(law: str, good: bool, text: str) -> None:
    """Raise InputError with the law's name before the text unless good."""
    if not good:
        raise InputError(f"{law}: {text}")


def _entry(name: str, value: object, parameter: Parameter) -> str:
    """One parameter of a law as text; empty where it is not given or is neither a number nor a word."""
    if isinstance(value, bool) or not isinstance(value, int | float | str) or value == "":
        return ""
    if isinstance(value, str):
        return f"{name} {value}"
    return f"{name} {show(float(value), parameter.unit)}" if parameter.unit else f"{name} {value:.4g}"


class ContactLaw(Summary, ABC):
    """A law of rough contact. A model states its equations along its own closure variable; this class inverts them.

    A model gives `at_closure`, `closure_range` (the closures of the least and of the greatest load that it covers,
    between which pressure grows strictly) and says by `geometric` whether that variable wants a logarithmic scale.
    It declares its `source`, its `validity` range in words and its `parameters` (all but the pair of materials). Study
    keys, command-line settings, sweep axes, checks and `faying models` follow from `parameters`. `variants` are further
    names of the model, each with parameters that it fixes. The `name` of a law that is one of them is that name.
    `measured_ranges` says by name how far measured stiffness lies from the law; a name without entry was not compared.
    """

    name: ClassVar[str]
    source: ClassVar[str]
    parameters: ClassVar[Mapping[str, Parameter]]
    validity: ClassVar[str]
    variants: ClassVar[Mapping[str, Mapping[str, object]]] = {}
    measured_ranges: ClassVar[Mapping[str, MeasuredRange]] = {}
    geometric: ClassVar[bool] = True
    plastic_summits: ClassVar[bool] = False  # whether a surface gives it the hardness that its small spots have

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "__repr__" not in vars(cls):  # else a dataclass writes its own, with every point of a scan
            cls.__repr__ = Summary.__repr__  # type: ignore[method-assign]

    @abstractmethod
    def at_closure(self, closure: ArrayLike) -> Response:
        """Return the response at given values of the model's own closure variable (any shape)."""

    @property
    @abstractmethod
    def closure_range(self) -> tuple[float, float]:
        """Closures at the least and at the greatest load that the law covers."""

    def with_(self, **changes: object) -> Self:
        """Return the same law with some parameters changed; InputError where there is no such parameter."""
        own = [f.name for f in fields(self) if f.init]  # type: ignore[arg-type]
        unknown = sorted(set(changes) - set(own))
        if unknown:
            raise InputError(f"{self.name} has no parameter {', '.join(unknown)}; it has {', '.join(own)}")
        return replace(self, **changes)  # type: ignore[type-var]

    def __post_init__(self) -> None:
        for label, fixed in self.variants.items():
            if all(isinstance(own := getattr(self, key), type(value)) and own == value for key, value in fixed.items()):
                object.__setattr__(self, "name", label)
        if self._has("pair") and not isinstance(pair := vars(self).get("pair"), ContactPair):
            raise InputError(
                f'{self.name}: pair = {shown(pair)}; give the materials that meet, ContactPair("45 steel", "45 steel")'
            )
        for key, value in checked_all(self.name, self.parameters, vars(self), self._optional()).items():
            object.__setattr__(self, key, value)

    @classmethod
    def entries(cls) -> Mapping[str, Parameter]:
        """What a user writes to give the law: its parameters, unless it is given by a file."""
        return cls.parameters

    @classmethod
    def from_entries(cls, given: Mapping[str, object], pair: ContactPair) -> Self:
        """Return the law from values of `entries` in SI units; InputError where they do not fit."""
        own: dict[str, Any] = dict(given)
        if cls.takes_materials():
            own["pair"] = pair
        return cls(**own)

    @classmethod
    def _optional(cls) -> frozenset[str]:
        """Parameters that are None where nobody gives them."""
        return frozenset(f.name for f in fields(cls) if f.default is None)  # type: ignore[arg-type]

    @classmethod
    def _has(cls, name: str) -> bool:
        return any(f.name == name for f in fields(cls))  # type: ignore[arg-type]

    @classmethod
    def takes_materials(cls) -> bool:
        """Whether the law is made from the materials that meet; one that was measured is not."""
        return cls._has("pair")

    @property
    def made_for(self) -> ContactPair | None:
        """The materials that the law was made from; None of one that was measured."""
        return vars(self).get("pair")

    @classmethod
    def required(cls) -> tuple[str, ...]:
        """The entries without which there is no law."""
        optional = {
            f.name
            for f in fields(cls)  # type: ignore[arg-type]
            if f.default is not MISSING or f.default_factory is not MISSING
        }
        return tuple(name for name in cls.entries() if name not in optional)

    @classmethod
    def takes(cls) -> str:
        """What the law is made from: a fractal surface, its moments, the scan itself, a file, or nothing measured."""
        if any(p.unit == FILE for p in cls.entries().values()):
            return "file"
        return RoughSurface.needed_for(p.surface for p in cls.parameters.values())

    @classmethod
    def from_surface(cls, surface: RoughSurface | FractalSurface, pair: ContactPair) -> Self:
        """Return the law of a measured surface; InputError where the model cannot take its inputs from it."""
        if isinstance(surface, FractalSurface):
            surface = RoughSurface(inputs=surface)
        found = surface.supplies(cls.parameters)
        missing = [name for name in cls.required() if name not in found]
        if missing:
            raise InputError(
                f"{cls.name} takes no {', '.join(missing)} from this surface; give {' and '.join(missing)}"
            )
        return cls.from_entries(found, surface.indented(pair) if cls.plastic_summits else pair)

    def facts(self) -> dict[str, Any]:
        """Parameters of the law and what it derives from them, by name with unit, for a result."""
        own = {name: getattr(self, name) for name in self.parameters}
        numbers = {name: value for name, value in own.items() if isinstance(value, float | int | str)}
        return {"name": self.name, "source": self.source, **numbers, "greatest_pressure [Pa]": self.greatest_pressure}

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What the law assumes that nobody measured, each beginning with the number that rests on it."""
        return ()

    @property
    def memory(self) -> Memory | None:
        """What contact that has carried more before is, over first loading; None where the law says nothing of it."""
        return None

    @property
    def branch(self) -> str:
        """The branch of k_n where no k_load is stated; with k_load, k_n is that of unloading."""
        return "loading and unloading"

    def _reach(self) -> str:
        """Pressures that the law covers, in words."""
        try:
            return f"from {show(self.least_pressure, 'Pa')} to {show(self.greatest_pressure, 'Pa')}"
        except FayingError as fault:
            return f"none: {fault}"

    def summary(self) -> tuple[str, dict[str, str]]:
        """Parameters, materials, source, the pressures that the law covers, what it assumes and where it is valid."""
        rows = {"source": self.source}
        numbers = [_entry(name, getattr(self, name, None), p) for name, p in self.parameters.items()]
        rows["parameters"] = ", ".join(filter(None, numbers)) or "none"
        if self.made_for is not None:
            rows["materials"] = f"{self.made_for.first.name} on {self.made_for.second.name}"
        rows["covers"] = self._reach()
        rows["valid for"] = self.validity
        rows["assumes"] = "; ".join(self._assumed()) or "nothing but its parameters"
        return f"Contact law {self.name}", rows

    def _assumed(self) -> tuple[str, ...]:
        return self.assumptions

    def plot(
        self, pressure: ArrayLike | None = None, *, after: float | str | None = None, axes: Any = None
    ) -> "list[matplotlib.axes.Axes]":
        """Draw stiffness, and real area where the law has one, against pressure; dotted where the law is not valid.

        Args:
            pressure: nominal, numbers in Pa or text with a unit; 0.1 to 50 MPa where None, as far as the law covers.
            after: greatest pressure that the faces have carried before, as of `at_pressure`: what they do below it is
                drawn beside first loading.
            axes: matplotlib axes to draw into, one for a law without an area, else two; a new figure where None.

        Returns:
            The axes.

        Raises:
            InputError: for pressures outside what the law covers, and for another number of axes.
        """
        return law_plot(self, pressure, axes, after)

    def _pressure_at(self, closure: Array) -> Array:
        """Pressure alone; a model overrides this where it is quicker than the whole response."""
        return self.at_closure(closure).pressure

    def _from_parameter(self, u: Array) -> Array:
        """Closure from the parameter u in [0, 1] that runs from the least to the greatest load."""
        first, last = self.closure_range
        if self.geometric:
            return np.asarray(first * np.exp(u * np.log(last / first)))
        return np.asarray(first + u * (last - first))

    @cached_property
    def _grid(self) -> tuple[Array, Array]:
        """Parameter and ln(pressure) on a grid fine enough to bracket any root."""
        u = np.linspace(0.0, 1.0, TABLE_POINTS)
        try:
            log_p = np.log(self._pressure_at(self._from_parameter(u)))
        except ArithmeticError:  # powers of 1 / (D - 2) and the like leave the range of floating point
            raise NotConverged(
                f"{self.name}: its numbers leave the range of floating point with these parameters; D near 2 or 3 does "
                "that, take one between"
            ) from None
        if not np.all(np.isfinite(log_p)) or np.any(np.diff(log_p) <= 0):
            raise NotConverged(
                f"{self.name}: pressure does not grow with closure over {self.closure_range}; "
                "the parameters leave the validity range of the model"
            )
        return u, log_p

    @property
    def greatest_pressure(self) -> float:
        """The pressure at which the law ends [Pa]."""
        return float(np.exp(self._grid[1][-1]))

    @property
    def least_pressure(self) -> float:
        """The least pressure above 0 that the law resolves [Pa]."""
        return float(np.exp(self._grid[1][0]))

    def at_pressure(self, pressure: ArrayLike, *, after: ArrayLike | None = None) -> Response:
        """Return the response at nominal pressures.

        At zero pressure nothing touches: every quantity is 0.

        Args:
            pressure: any shape, numbers in Pa, or text such as "5 MPa"; 0 to `greatest_pressure`.
            after: the greatest pressure that the faces have carried before, in place, such as "40 MPa"; any shape that
                fits. Below it they unload and load again along one elastic curve. First loading where None.

        Raises:
            InputError: for NaN or negative pressures and for those above `greatest_pressure` or below the least that
                the law resolves; for `after` where the law says nothing of unloading.
        """
        response = self._first(pressure)
        if after is None:
            return response
        most = checked(after, name="after", unit="Pa", zero=True)
        require(self.name, most.max() <= self.greatest_pressure, f"after = {most.max():.4g} Pa is beyond its end")
        found: dict[str, Any] = dict(self.remembered().after(response, np.broadcast_to(most, response.pressure.shape)))
        return replace(response, **found)

    def remembered(self) -> Memory:
        """`memory`. Raises InputError where the law says nothing of unloading."""
        if self.memory is None:
            raise InputError(
                f"{self.name} says nothing of contact that has carried more before; half-space on a scan does, and "
                "GW-KE and GW-JG by the unloading of their summits"
            )
        return self.memory

    def _first(self, pressure: ArrayLike) -> Response:
        """Response on first loading."""
        p = checked(pressure, name="pressure", unit="Pa", zero=True)
        if p.size and p.max() > self.greatest_pressure * (1 + 1e-12):
            raise InputError(
                f"pressure {p.max():.4g} Pa is more than {self.name} covers with these parameters: at most "
                f"{self.greatest_pressure:.4g} Pa; lower the load or widen the joint"
            )
        flat = p.ravel()
        open_points = flat == 0
        if not open_points.any():
            return self._exact(flat).reshaped(p.shape)
        at = self._exact(np.where(open_points, self.greatest_pressure, flat))
        arrays = {name: np.where(open_points, 0.0, value) for name, value in at.quantities().items()}
        reasons = {name: mask & ~open_points for name, mask in at.reasons.items()}
        return replace(at, reasons=reasons, **arrays).reshaped(p.shape)

    def _exact(self, pressure: Array) -> Response:
        """Response at flat positive pressures within the law, each inverted."""
        return replace(self.at_closure(self._closure_at(pressure)), pressure=pressure.copy())

    def _closure_at(self, pressure: Array) -> Array:
        """Invert pressures (flat, positive, within the law) for the closure variable."""
        from scipy.optimize.elementwise import find_root

        u, log_p = self._grid
        target = np.clip(np.log(pressure), log_p[0], log_p[-1])
        if pressure.size and np.log(pressure.min()) < log_p[0] - 1e-9:
            raise InputError(
                f"pressure {pressure.min():.4g} Pa is below the least that {self.name} resolves with these parameters, "
                f"{np.exp(log_p[0]):.4g} Pa; use 0 for an open point"
            )
        cell = np.clip(np.searchsorted(log_p, target, side="right") - 1, 0, u.size - 2)
        miss: Callable[[Array, Array], Array] = lambda v, t: (  # noqa: E731
            np.log(self._pressure_at(self._from_parameter(v))) - t
        )
        # the ends of the grid are exact roots up to rounding: give the bracket that much room
        low, high = u[cell], u[cell + 1]
        root = find_root(
            miss,
            (low - 1e-13, high + 1e-13),
            args=(target,),
            tolerances={"xatol": 1e-16, "xrtol": 1e-15, "fatol": 1e-14, "frtol": 0.0},
        )
        if not np.all(root.success | (np.abs(root.f_x) < 1e-11)):
            worst = float(np.nanmax(np.abs(root.f_x)))
            raise NotConverged(f"{self.name}: inversion for pressure stopped {worst:.1e} short (relative)")
        return self._from_parameter(np.asarray(root.x))


@cache
def found_in(package: str, kind: type[Kind]) -> Mapping[str, type[Kind]]:
    """Classes of a kind that have a name of their own, in the files of a package, by class in alphabetical order."""
    found: dict[str, type[Kind]] = {}
    for entry in iter_modules(import_module(package).__path__):
        module = import_module(f"{package}.{entry.name}")
        for name, value in vars(module).items():
            own = isclass(value) and issubclass(value, kind) and value.__module__ == module.__name__
            if own and not isabstract(value) and "name" in vars(value):
                found[name] = value
    return dict(sorted(found.items()))
