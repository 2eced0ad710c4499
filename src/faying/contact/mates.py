"""Mates: the two faces of a joint, their geometry and their materials, from which every law is made."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np
from numpy.typing import ArrayLike

from faying.checks import instance, number, real
from faying.contact.auto import Choice, pick
from faying.contact.build import AUTO, NAMED, LawKind, find, kinds
from faying.contact.compare import Comparison, compare
from faying.contact.inputs import FractalSurface, RoughSurface
from faying.contact.law import ContactLaw, checked
from faying.contact.models.half_space import HalfSpace
from faying.contact.parameter import TABLE
from faying.contact.two_faces import GIVEN, Counter, RoughPair, together
from faying.errors import FayingError, InputError, shown
from faying.materials import ContactPair, Material, material_of
from faying.style import Summary
from faying.surface.convention import NAMES
from faying.surface.fractal_fit import FractalFit
from faying.surface.scan import Profile, Scan
from faying.units import show

if TYPE_CHECKING:
    import matplotlib.axes
    import xarray

Materials = str | Material | ContactPair | Sequence[str | Material]
OF_FACES = ("D", "G", "G_majumdar_bhushan")  # numbers of a surface that take a fit
ONE, BOTH = "one face", "both faces"
COMPARED = (0.1e6, 50e6, 28)  # Pa: pressures of a comparison where none are given, ten a decade


@final
@dataclass(frozen=True, init=False, eq=False, repr=False)
class Mates(Summary):
    """The two faces of a joint: what was measured of both, and their materials.

    Laws, tables and commands take both faces from here, so that one question has one answer. The default is the same
    everywhere: the other face is alike in its statistics, unrelated point by point, and of the same material. A scan is
    levelled once; D and G are fitted where a law asks for them, and contacts are solved when a law is asked.

    Args:
        face: the scan of one face; or `RoughPair`, where both have been put together already.
        materials: of both faces where one is given, else of the face with the scan and of the other one: names of the
            catalogue or "rigid", `Material`, or a `ContactPair`.
        other: the other face: "same", alike but unrelated; "smooth"; or its scan.
        method: estimator of D and G, as in `fit_fractal`.
        D, G: of both faces together [-], [m], in place of those that are fitted.
        scan_area: [m2], in place of that of the scan; needed for a line scan. G and area also as text with a unit.
        cache: folder that keeps solved contacts; None keeps nothing.

    Raises:
        InputError: for what is not a scan, unknown materials, two rigid faces, and a line scan without scan_area.

    `Mates.of_fractal` and `Mates.of_fit` take D and G in place of a scan, `Mates.of_surface` other numbers.
    """

    faces: RoughPair
    pair: ContactPair
    progress: Callable[[int, int], object] | None
    _made: dict[Any, Choice] = field(compare=False)

    def __init__(
        self,
        face: Scan | Profile | RoughPair,
        *,
        materials: Materials,
        other: Counter = "same",
        method: str = "psd",
        D: float | None = None,
        G: float | str | None = None,
        scan_area: float | str | None = None,
        cache: str | Path | None = None,
    ) -> None:
        if isinstance(face, RoughPair):
            given = (other, method, D, G, scan_area, cache)
            if given != ("same", "psd", None, None, None, None):
                raise InputError("these faces are put together already; give nothing but their materials")
            faces = face
        else:
            faces = _faces(face, other=other, method=method, D=D, G=G, scan_area=scan_area, cache=cache)
        self._set(faces, pair_of(materials), None, {})

    def _set(
        self,
        faces: RoughPair,
        pair: ContactPair,
        progress: Callable[[int, int], object] | None,
        made: dict[Any, Choice],
    ) -> None:
        for name, value in {"faces": faces, "pair": pair, "progress": progress, "_made": made}.items():
            object.__setattr__(self, name, value)

    @classmethod
    def of_fractal(
        cls, *, D: float, G: float | str, scan_area: float | str, materials: Materials, of: str = BOTH
    ) -> "Mates":
        """Return the mates of given numbers.

        Args:
            D: fractal dimension [-], between 2 and 3.
            G: fractal roughness [m] in the convention of Yan and Komvopoulos, or text with a unit.
            scan_area: area that the numbers belong to [m2], or text with a unit.
            materials: as in `Mates`.
            of: "both faces": D and G are those of both faces together, as in a study; or "one face": the other one is
                alike but unrelated, so that G^(2 D - 4) doubles.

        Returns:
            The mates.

        Raises:
            InputError: for numbers out of range, unknown materials, and another word for `of`.
        """
        if not isinstance(of, str) or of not in (ONE, BOTH):
            raise InputError(f'of = {shown(of)}; D and G are those of "{BOTH}" together, or of "{ONE}"')
        dimension, roughness = real(D, "D"), number(G, "G", "m")
        if not 2 < dimension < 3:
            raise InputError(f"D = {dimension}: the dimension of a surface is between 2 and 3, for example 2.4")
        if roughness <= 0:
            raise InputError(f"G = {roughness:.6g} m; it must be positive")
        stated = GIVEN
        if of == ONE:
            stated = f"from G {show(roughness, 'm')} of one face, the other alike and unrelated"
            roughness = together(roughness, dimension)
        area = number(scan_area, "scan_area", "m^2")
        numbers = FractalSurface(D=dimension, G=roughness, scan_area=area)
        return cls(RoughPair(face=numbers, stated=stated), materials=materials)

    @classmethod
    def of_surface(cls, surface: RoughSurface | FractalSurface, *, materials: Materials) -> "Mates":
        """Return the mates of the rough surface that both faces make together.

        Args:
            surface: its numbers, `FractalSurface` or `SurfaceInputs`; or a `RoughSurface`, maybe with heights.
            materials: as in `Mates`.

        Returns:
            The mates.

        Raises:
            InputError: for anything else, and for unknown materials.
        """
        if isinstance(surface, FractalSurface):
            surface = RoughSurface(inputs=surface)
        remedy = "give FractalSurface, SurfaceInputs or RoughSurface; for a scan call Mates itself"
        made = instance(surface, RoughSurface, "surface", remedy)
        return cls(RoughPair(face=made.inputs, made=made), materials=materials)

    @classmethod
    def of_fit(cls, fit: FractalFit, *, scan_area: float | str, materials: Materials, of: str = ONE) -> "Mates":
        """Return the mates of a fit; of: "one face" for that of `fit_fractal`, "both faces" for that of `combine`.

        scan_area [m2], materials: as in `of_fractal`. The fit of a profile counts as that of the isotropic surface that
        it is cut from (`FractalFit.surface_G`). Raises InputError as it does, and for a fit in another
        convention than that of Yan and Komvopoulos.
        """
        if not isinstance(fit, FractalFit):
            raise InputError(f"a fit is given as {type(fit).__name__}; give what faying.fit_fractal returns")
        if not fit.convention.startswith("Yan-Komvopoulos"):
            raise InputError(f'this fit has the convention "{fit.convention}"; fit with convention = "{NAMES[0]}"')
        return cls.of_fractal(D=fit.D, G=fit.surface_G, scan_area=scan_area, materials=materials, of=of)

    def watched(self, progress: Callable[[int, int], object]) -> "Mates":
        """The same mates, which call progress(contacts solved, contacts in all) while contacts are solved."""
        out = object.__new__(Mates)
        out._set(self.faces, self.pair, progress, {})
        return out

    @property
    def line(self) -> str:
        """Both faces and both materials in one line."""
        return line_of(self.faces, self.pair)

    def summary(self) -> tuple[str, dict[str, str]]:
        """Both faces, both materials, and where D and G come from."""
        faces, pair = self.faces, self.pair
        rows: dict[str, str] = {}
        if isinstance(faces.face, Scan):
            rows["one face"] = _size(faces.face)
        elif isinstance(faces.face, Profile):
            rows["one face"] = f"{faces.face.heights.size} points on {show(faces.face.length, 'm')}"
        if isinstance(faces.counter, Scan):
            rows["other face"] = _size(faces.counter)
        elif isinstance(faces.face, Scan | Profile):
            words = {"same": "alike in its statistics, unrelated point by point", "smooth": "smooth"}
            rows["other face"] = words[faces.counter]
        rows["materials"] = _material(pair.first)
        rows["on"] = f"{_material(pair.second)}; E* {show(pair.E_star, 'Pa')}"
        if not isinstance(faces.face, FractalSurface):
            rows["numbers"] = self._source_of_numbers()
        return f"Mates: {self.line}", rows

    def _source_of_numbers(self) -> str:
        """Where D and G come from; they are not fitted for this."""
        faces = self.faces
        if faces.D is not None and faces.G is not None:
            return f"D {faces.D:.4g}, G {show(faces.G, 'm')} of both faces together, {GIVEN}"
        fitted = " and ".join(name for name in ("D", "G") if getattr(faces, name) is None)
        how = f"to {faces.origin} by {faces.method}"
        if isinstance(faces.counter, Scan):
            how = "to the sum of both spectra"
        elif faces.counter == "same":
            how += ", then G of both (G^(2 D - 4) doubles)"
        return f"{fitted} of both faces: fitted {how}, once a law asks"

    def rough_for(self, kind: LawKind, given: Mapping[str, object] | None = None) -> RoughSurface:
        """What a law is made from where these entries are given: with D and G only where it takes them."""
        faces = self.faces
        surface = faces.rough if takes_fit(kind, given or {}, faces) else faces.unfitted
        return surface if self.progress is None else replace(surface, progress=self.progress)

    def choose(self, name: str | LawKind = AUTO, given: Mapping[str, object] | None = None) -> Choice:
        """Return a law of these faces, and why it was taken.

        Args:
            name: label or class of the law in any spelling, its kind, or "auto".
            given: values of its entries, in SI units or as text with a unit; they count before what the faces give.

        Returns:
            The choice; the same one where the same is asked again.

        Raises:
            InputError: as `faying.contact.auto.pick`.
        """
        kind = find(name) if not isinstance(name, LawKind) else name
        values = read_entries(kind, instance({} if given is None else given, Mapping, "given", NAMED))
        key = kind.label, tuple(sorted(values.items(), key=lambda item: item[0]))
        plain = all(isinstance(value, str | int | float | Path) for value in values.values())
        if plain and key in self._made:
            return self._made[key]
        exact: ContactLaw | None = None
        if kind.label == AUTO and isinstance(self.faces.face, Scan):
            exact = self.choose(HalfSpace.name).law
        surface = self.rough_for(kind, values)
        choice = pick(kind, values, surface, self.pair, exact=exact if isinstance(exact, HalfSpace) else None)
        choice = replace(choice, mates=self.line)
        if plain:
            self._made[key] = choice
        return choice

    def law(self, name: str = AUTO, /, **given: object) -> ContactLaw:
        """Return a contact law of these faces.

        Args:
            name: any law in any spelling, "jk" or "gw-ke" say; "auto" is what `faying run` takes: the half-space
                contact of the scan where it resolves the contact, else the analytic law nearest to it.
            given: parameters of the law, in SI units or as text with a unit; they count before what the faces give.

        Returns:
            The law.

        Raises:
            InputError: for unknown laws and parameters, values out of range, and what these faces cannot supply.
        """
        return self.choose(name, given).law

    def laws(self, names: Sequence[str] | None = None) -> tuple[dict[str, ContactLaw], dict[str, str]]:
        """Return the laws of these faces by name, and why others are left out; InputError for unknown names.

        names: the laws to take, in any spelling; None takes all that the faces feed.
        """
        if names is None:
            scanned = isinstance(self.faces.face, Scan) or self.faces.unfitted.scan is not None
            fed = ("fractal", "moments", *(("scan",) if scanned else ()))
            named = [kind for kind in kinds().values() if kind.label != AUTO and kind.law.takes() in fed]
        elif isinstance(names, str) or not isinstance(names, Sequence):  # one text would be read letter by letter
            raise InputError(f'laws = {shown(names)}; give a list of names, for example ["jk", "persson"]')
        else:
            named = [find(name) for name in names]
        made: dict[str, ContactLaw] = {}
        left_out: dict[str, str] = {}
        for kind in named:
            try:
                law = self.choose(kind).law
                made[law.name] = law
            except FayingError as fault:
                left_out[kind.label] = str(fault)
        return made, left_out

    def comparison(self, pressure: ArrayLike | None = None, laws: Sequence[str] | None = None) -> Comparison:
        """Return the laws of these faces and their responses, as `compare` does, before they are put into a table."""
        made, left_out = self.laws(laws)
        if pressure is None:
            return compare(made, np.geomspace(*COMPARED), left_out)
        return compare(made, np.atleast_1d(checked(pressure, name="pressure", unit="Pa", zero=False)), left_out)

    def compare(self, pressure: ArrayLike | None = None, *, laws: Sequence[str] | None = None) -> "xarray.Dataset":
        """Return every law that these faces feed, with the contact that is solved on the scan among them.

        Args:
            pressure: nominal, numbers in Pa or text with a unit; 0.1 to 50 MPa where None.
            laws: names of the laws to take; all that the faces feed where None.

        Returns:
            xarray.Dataset over (law, pressure) with area [-], k_n, k_t, k_load [Pa/m], loss_n, loss_t [-], the range
            k_n_low and k_n_high [Pa/m], `valid`, and `over_half_space`, k_n over that of the solved contact [-]. NaN
            where a law says nothing or does not reach. Units are in the attributes of each variable; the mates and the
            laws that were left out, each with its reason, in those of the table.

        Raises:
            InputError: for unknown laws and pressures that are not positive.
        """
        from faying.contact.comparison_table import dataset

        return dataset(self.comparison(pressure, laws), mates=self.line)

    def compare_plot(
        self,
        pressure: ArrayLike | None = None,
        *,
        laws: Sequence[str] | None = None,
        quantity: str = "k_n",
        ax: "matplotlib.axes.Axes | None" = None,
    ) -> "matplotlib.axes.Axes":
        """Draw a quantity of every law against pressure; dotted where a law leaves its validity range.

        Args:
            pressure, laws: as in `compare`.
            quantity: of `Response`: "k_n", "k_t", "area", "loss_n" and so on.
            ax: matplotlib axes to draw into; new ones where None.

        Returns:
            The axes.

        Raises:
            InputError: as `compare`, and for an unknown quantity.
        """
        from faying.contact.figure import comparison_plot
        from faying.contact.response import label_and_scale
        from faying.style import axes_of

        label_and_scale(quantity)  # faults are reported before contacts are solved
        if ax is not None:
            axes_of(ax, 1)
        return comparison_plot(self.comparison(pressure, laws), quantity, title=self.line, ax=ax)


def pair_of(materials: object) -> ContactPair:
    """The pair of one material for both faces, of two, or as it is; InputError for anything else."""
    if isinstance(materials, ContactPair):
        return materials
    if isinstance(materials, list | tuple):
        if len(materials) != 2:
            raise InputError(f"materials: {len(materials)} of them; give one for both faces, or two")
        return ContactPair(materials[0], materials[1])
    one = material_of(materials)
    return ContactPair(one, one)


def takes_fit(kind: LawKind, given: Mapping[str, object], faces: RoughPair) -> bool:
    """Whether a law takes D and G from faces; "auto" solves the contact of a scan, or takes a law of its summits."""
    return kind.takes(OF_FACES, given) and not (kind.label == AUTO and isinstance(faces.face, Scan))


def line_of(faces: RoughPair, pair: ContactPair) -> str:
    """Both faces and both materials in one line, for commands and notes."""
    return f"{faces.words}; {pair.first.name} on {pair.second.name}"


def read_entries(kind: LawKind, given: Mapping[str, object]) -> dict[str, object]:
    """Values of a law's entries in SI units; text is read with its unit. Raises InputError for unknown ones."""
    from faying.contact.build import check_entries

    check_entries(kind, given)
    entries, out = kind.law.entries(), {}
    for name, value in given.items():
        parameter = entries[name]
        if isinstance(value, str) and parameter.unit != TABLE:
            out[name] = parameter.read(value, name)
        elif parameter.unit == TABLE or isinstance(value, Path):
            out[name] = value
        else:
            out[name] = parameter.value(value, name)
    return out


def _faces(face: object, **given: Any) -> RoughPair:
    """Faces from what a user gives, text with units read."""
    for name, unit in (("G", "m"), ("scan_area", "m^2")):
        if given[name] is not None:
            given[name] = number(given[name], name, unit)
    if given["D"] is not None:
        given["D"] = real(given["D"], "D")
    cache = given.pop("cache")
    if cache is not None and not isinstance(cache, str | Path):
        raise InputError(f"cache = {shown(cache)}; give the folder as text or a Path")
    other = given.pop("other")
    return RoughPair(face=face, counter=other, cache=None if cache is None else Path(cache), **given)  # type: ignore[arg-type]


def _size(scan: Scan) -> str:
    rows, columns = scan.shape
    (width, height), (dx, dy) = scan.size, scan.spacing
    step = show(dx, "m") if abs(dx - dy) <= 1e-9 * dx else f"{show(dx, 'm')} x {show(dy, 'm')}"
    return f"{columns} x {rows} points on {show(width, 'm')} x {show(height, 'm')}, spacing {step}"


def _material(material: Material) -> str:
    if material.is_rigid:
        return "rigid"
    hard = "" if material.hardness is None else f", hardness {show(material.hardness, 'Pa')}"
    if material.brinell is not None and material.brinell != material.hardness:
        hard += f", Brinell {show(material.brinell, 'Pa')}"
    return f"{material.name}, E {show(material.E, 'Pa')}, nu {material.nu:g}{hard}"
