"""Materials and the pair of them that meets in a joint."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property
from math import inf, isnan

from faying.checks import instance, number, real, text
from faying.errors import InputError, shown
from faying.hardness import BRINELL_RANGE, VickersHardness

MOST_FRICTION = 2.0  # coefficient of friction: clean metals in air reach 1.4
STIFFEST = 0.495  # Poisson's ratio from which displacements alone cannot describe a solid
MAX_EXPANSION = 1e-3  # 1/K: beyond it a power of ten is wrong
UNITS = {
    "E": "Pa",
    "nu": "",
    "density": "kg/m^3",
    "yield_strength": "Pa",
    "hardness": "Pa",
    "brinell": "Pa",
    "friction": "",
    "conductivity": "W/(m*K)",
    "resistivity": "ohm*m",
    "bearing_limit": "Pa",
    "expansion": "1/K",
}


@dataclass(frozen=True, kw_only=True)
class Material:
    """One isotropic material.

    Args:
        name: what messages and tables call it.
        E: Young's modulus [Pa].
        nu: Poisson's ratio [-].
        density: [kg/m3].
        yield_strength: [Pa].
        hardness: flow pressure of the analytic laws of asperities [Pa]; 2.8 times the yield strength where not given
            (Tabor 1951). Without `brinell` or `vickers` it is the hardness of every law and of spots of every size.
        brinell: measured Brinell hardness [Pa]; HB 170 is 1.67e9 Pa. From 1.3e9 to 7.6e9 Pa it gives `vickers`.
        vickers: hardness over the size of an indentation, for contact solved on a scan and for laws of conductance.
        friction: static coefficient of friction [-].
        conductivity: of heat [W/(m K)].
        resistivity: electrical [ohm m].
        bearing_limit: pressure [Pa] that it bears under the head of a bolt (p_G of VDI 2230).
        expansion: coefficient of linear thermal expansion [1/K].
        source: where the numbers come from.

    Quantities may also be text with a unit, for example "210 GPa". `dataclasses.replace` keeps a hardness and a vickers
    that followed from the numbers before: replace them with the yield strength, or with brinell.

    Raises:
        InputError: for values that no isotropic material can have.
    """

    name: str
    E: float
    nu: float
    density: float | None = None
    yield_strength: float | None = None
    hardness: float | None = None
    brinell: float | None = None
    vickers: VickersHardness | None = None
    friction: float | None = None
    conductivity: float | None = None
    resistivity: float | None = None
    bearing_limit: float | None = None
    expansion: float | None = None
    source: str = ""

    def __post_init__(self) -> None:
        text(self.name, "name of a material")
        text(self.source, f"material {self.name!r}: source")
        for name, unit in UNITS.items():
            value = getattr(self, name)
            if value is not None or name in ("E", "nu"):
                object.__setattr__(self, name, real(value, f"material {self.name!r}: {name}", unit))
        if self.vickers is not None:
            instance(self.vickers, VickersHardness, f"material {self.name!r}: vickers", "give a VickersHardness")
        if isnan(self.E) or self.E <= 0:
            raise InputError(f"material {self.name!r}: E = {self.E:.6g} Pa; it must be positive, for example 200e9")
        if not -1 < self.nu <= 0.5:
            raise InputError(f"material {self.name!r}: nu = {self.nu}; it must be in (-1, 0.5], for example 0.3")
        strengths = ("yield_strength", "hardness", "brinell", "bearing_limit")
        for field in ("density", *strengths, "conductivity", "resistivity"):
            value = getattr(self, field)
            endless = field in ("density", "conductivity", "resistivity", "bearing_limit") and value == inf
            if value is not None and (isnan(value) or value <= 0 or endless):
                raise InputError(f"material {self.name!r}: {field} = {value}; it must be positive, or left out")
        if self.expansion is not None and not abs(self.expansion) < MAX_EXPANSION:
            raise InputError(
                f"material {self.name!r}: expansion = {self.expansion} 1/K; no solid reaches {MAX_EXPANSION:g} 1/K, "
                "steel has 12e-6 1/K"
            )
        if self.friction is not None:
            number(self.friction, f"material {self.name!r}: friction", least=0, greatest=MOST_FRICTION, ends="[]")
        if self.hardness is None and self.yield_strength is not None:
            object.__setattr__(self, "hardness", 2.8 * self.yield_strength)
        if self.hardness is None and self.brinell is not None:
            object.__setattr__(self, "hardness", self.brinell)
        if self.vickers is None and self.brinell is not None:
            low, high = BRINELL_RANGE
            sized = low <= self.brinell <= high
            law = VickersHardness.from_brinell(self.brinell) if sized else VickersHardness(c1=self.brinell, c2=0.0)
            object.__setattr__(self, "vickers", law)

    @property
    def bulk_hardness(self) -> float | None:
        """Hardness against large indentations [Pa]: Brinell's where it is known, else `hardness`."""
        if self.brinell is not None:
            return self.brinell
        return self.vickers.least if self.vickers is not None and self.vickers.least else self.hardness

    @property
    def G(self) -> float:
        """Shear modulus [Pa]."""
        return self.E / (2 * (1 + self.nu))

    @property
    def is_rigid(self) -> bool:
        """Whether this is the rigid plane."""
        return inf == self.E


RIGID = Material(name="rigid", E=inf, nu=0.0)


@dataclass(frozen=True, init=False)
class ContactPair:
    """The two materials that meet; hardness is that of the softer one.

    Args:
        first, second: the materials, or their names: those of the catalogue, or "rigid"; not both rigid.

    Raises:
        InputError: for two rigid bodies, names that the catalogue lacks, and what is not a material.
    """

    first: Material
    second: Material

    def __init__(self, first: Material | str, second: Material | str) -> None:
        object.__setattr__(self, "first", material_of(first))
        object.__setattr__(self, "second", material_of(second))
        if self.first.is_rigid and self.second.is_rigid:
            raise InputError("both materials of the pair are rigid; at least one must be deformable")

    @cached_property
    def E_star(self) -> float:
        """Contact modulus [Pa]: 1/E* = sum (1 - nu^2)/E."""
        return 1 / sum((1 - m.nu**2) / m.E for m in (self.first, self.second))

    @cached_property
    def G_star(self) -> float:
        """Contact shear modulus [Pa]: 1/G* = sum (2 - nu)/G."""
        return 1 / sum((2 - m.nu) / m.G for m in (self.first, self.second))

    @cached_property
    def softer(self) -> Material:
        """The body that yields first: the one of lower hardness."""
        known = [m for m in (self.first, self.second) if m.hardness is not None]
        if not known:
            names = " and ".join(repr(m.name) for m in (self.first, self.second) if not m.is_rigid)
            raise InputError(f"neither hardness nor yield_strength is known for {names}; give one of them")
        return min(known, key=lambda m: m.hardness or inf)

    @property
    def hardness(self) -> float:
        """Hardness H of the softer body [Pa]."""
        return self.softer.hardness or inf

    @cached_property
    def _first_indented(self) -> Material | None:
        known = [m for m in (self.first, self.second) if m.bulk_hardness is not None]
        return min(known, key=lambda m: m.bulk_hardness or inf, default=None)

    @property
    def vickers(self) -> VickersHardness | None:
        """Hardness over the size of an indentation, of the body of lower bulk hardness; None where it has none."""
        return None if self._first_indented is None else self._first_indented.vickers

    @property
    def bulk_hardness(self) -> float:
        """The lower hardness of the two bodies against large indentations [Pa]; infinite where neither is known."""
        return inf if self._first_indented is None else self._first_indented.bulk_hardness or inf

    @property
    def hardness_coefficient(self) -> float:
        """K = 0.454 + 0.41 nu of the softer body [-]."""
        return 0.454 + 0.41 * self.softer.nu

    @property
    def known_friction(self) -> float | None:
        """Static friction coefficient [-]: the smaller of those given; None where none is."""
        return min((m.friction for m in (self.first, self.second) if m.friction is not None), default=None)

    @property
    def friction(self) -> float:
        """The same. Raises InputError where none is given."""
        if (found := self.known_friction) is None:
            raise InputError("no friction coefficient is known for the pair; give one to either material")
        return found


class Catalogue(Mapping[str, Material]):
    """Materials by name. A name that is not there is an `InputError`, and a KeyError too, that lists the nearest."""

    def __init__(self, *materials: Material) -> None:
        self._of = {material.name: material for material in materials}

    def __getitem__(self, name: str) -> Material:
        if not isinstance(name, str) or name not in self._of:
            raise MissingMaterial(_missing(name, self._of))
        return self._of[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._of)

    def __len__(self) -> int:
        return len(self._of)

    def __repr__(self) -> str:
        return "\n".join(("Catalogue of materials", *(f"  {name}" for name in self._of)))


class MissingMaterial(InputError, KeyError):
    """A name that the catalogue lacks."""

    __str__ = Exception.__str__  # that of KeyError would quote the sentence


def _missing(given: object, known: Iterable[str]) -> str:
    """That there is no such material, the nearest name, and all of them."""
    names = list(known)
    near = get_close_matches(given, names, n=1, cutoff=0.5) if isinstance(given, str) else []
    hint = f'; did you mean "{near[0]}"?' if near else ""
    called = repr(given) if isinstance(given, str) and len(given) <= 60 else shown(given)
    listed = ", ".join(name for name in names if name != RIGID.name)
    return f"no material {called} in the catalogue{hint}; it has {listed}; make your own with Material"


CATALOGUE = Catalogue(
    Material(
        name="45 steel",
        E=200e9,
        nu=0.3,
        density=7800.0,
        yield_strength=355e6,
        hardness=994e6,
        brinell=1.67e9,
        friction=0.25,
        expansion=11.6e-6,
        source="Zhang et al. 2024, doi:10.3390/fractalfract8100611, Table 2; Brinell hardness: HB 170, the lower "
        "end of 170 to 210 that producers state for C45 (AISI 1045), hot rolled or normalised; expansion: AISI 1045, "
        "annealed, 0 to 100 degrees C, as handbooks list it",
    ),
    Material(
        name="S355",
        E=210e9,
        nu=0.3,
        density=7850.0,
        yield_strength=355e6,
        brinell=1.59e9,
        conductivity=53.3,
        bearing_limit=760e6,
        expansion=12e-6,
        source="EN 1993-1-1, 3.2.6 (expansion too) and Table 3.1; EN 1991-1-1, Table A.4; conductivity at 20 degrees "
        "C: EN 1993-1-2, 3.4.1.3; bearing limit: VDI 2230:2003, Table A9; Brinell hardness: HB 162, from the "
        "tensile strength 470 to 630 MPa of EN 10025-2 over 3.4",
    ),
    Material(
        name="EN AW-6082 T6",
        E=70e9,
        nu=0.3,
        density=2700.0,
        yield_strength=260e6,
        brinell=0.93e9,
        conductivity=191.4,
        expansion=23e-6,
        source="EN 1999-1-1, 3.2.5 (expansion too) and Table 3.2b (extrusions, 5 < t <= 15 mm); conductivity at 20 "
        "degrees C: EN 1999-1-2, 3.3.3; Brinell hardness: HB 95, typical of the temper",
    ),
)
"""A few materials with their sources. Friction depends on the pair and its finish: give your own."""


def material_of(given: object) -> Material:
    """Return a material, or the one that the catalogue holds under a name; "rigid" is the rigid plane.

    Raises InputError that lists the names, the nearest first.
    """
    if isinstance(given, Material):
        return given
    if not isinstance(given, str):
        raise InputError(f'material = {shown(given)}; give a name in the catalogue, "45 steel" say, or a Material')
    if given == RIGID.name:
        return RIGID
    if given not in CATALOGUE:
        raise InputError(_missing(given, (*CATALOGUE, RIGID.name)))
    return CATALOGUE[given]
