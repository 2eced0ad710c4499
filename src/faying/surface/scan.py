"""Scans and profiles: measured heights, and what is asked of them."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self, cast, final

from faying.checks import flag, shown, whole
from faying.errors import FayingError, InputError
from faying.style import Summary
from faying.surface.areal import ArealParameters
from faying.surface.figure import overview_of
from faying.surface.form import filled, levelled, prepared
from faying.surface.fractal import fit_fractal
from faying.surface.fractal_fit import FractalFit
from faying.surface.heights import AreaHeights, LineHeights
from faying.surface.roughness import Roughness, roughness
from faying.units import show

if TYPE_CHECKING:
    import matplotlib.axes


class Heights(Summary):
    """What a scan and a profile do alike: roughness, fractal dimension, levelling, figures."""

    @property
    def _self(self) -> AreaHeights | LineHeights:
        return cast("AreaHeights | LineHeights", self)

    @property
    def Sq(self) -> float:
        """Rms height of a scan, levelled [m], ISO 25178-2; InputError for a profile and heights without a statistic."""
        return self.roughness().Sq

    @property
    def Sa(self) -> float:
        """Mean absolute height of a scan, levelled [m], ISO 25178-2; InputError as for `Sq`."""
        return self.roughness().Sa

    @property
    def Rq(self) -> float:
        """Rms height of a profile, levelled [m], ISO 21920-2; InputError for a scan and heights without a statistic."""
        return self._of_a_line("Rq").Rq

    @property
    def Ra(self) -> float:
        """Mean absolute height of a profile, levelled [m], ISO 21920-2; InputError as for `Rq`."""
        return self._of_a_line("Ra").Ra

    def _of_a_line(self, name: str) -> Roughness:
        if self._self.heights.ndim == 2:
            raise InputError(
                f"{name} is a number of a profile; this is a scan, which has S{name[1:]}, or take a profile of it"
            )
        return self.roughness()

    def roughness(self, *, degree: int = 1) -> Roughness:
        """Return the roughness over the known points, levelled and without spikes.

        Args:
            degree: of the polynomial that levels the heights, 0 to 8.

        Returns:
            Sq, Sa, Sz, Ssk, Sku, Sdq, Sdr of a scan; Rq, Ra, Rz, Rsk, Rku, Rdq, Rdr of a profile.

        Raises:
            InputError: for another degree, and for heights that carry no statistic.

        Source:
            ISO 25178-2 and ISO 21920-2, without a filter.
        """
        return roughness(self._self, degree=degree)

    def fractal(
        self,
        method: str = "psd",
        *,
        band: "tuple[float, float] | tuple[str, str] | None" = None,
        degree: int = 1,
        spikes: bool = True,
        convention: str = "yan-komvopoulos",
        gamma: float = 1.5,
    ) -> FractalFit:
        """Return D and G with their intervals, and the band of wavelengths that they hold in.

        Args, Returns and Raises are those of `faying.fit_fractal`.
        """
        return fit_fractal(
            self._self,
            method,
            band=band,
            degree=degree,
            spikes=spikes,
            convention=convention,
            gamma=gamma,
        )

    def levelled(self, degree: int = 1) -> Self:
        """Return the heights less their least-squares polynomial of this degree (0 mean, 1 plane or line, 2 .. form).

        Missing points stay missing. Raises InputError for a degree outside 0 to 8 and for too few known points.
        """
        return cast("Self", levelled(self._self, degree))

    def filled(self) -> Self:
        """Return the heights with missing points filled in smoothly from their neighbours; InputError without any."""
        return cast("Self", filled(self._self))

    def plot(self, axes: Any = None, *, degree: int = 1) -> "list[matplotlib.axes.Axes]":
        """Draw the levelled heights, as a map or a line, and their power spectrum.

        Args:
            axes: two matplotlib axes to draw into; a new figure where None.
            degree: of the polynomial that levels the heights, 0 to 8.

        Returns:
            Both axes.

        Raises:
            InputError: for anything but two axes, and for heights that carry no statistic.
        """
        return overview_of(self._self, axes, degree=degree)

    def _statistics(self) -> tuple[str, str]:
        """Rms height as a line of the summary: its name and its text, or why there is none."""
        name = "Sq" if self._self.heights.ndim == 2 else "Rq"
        try:
            return name, f"{show(self.roughness().Rq, 'm')}, levelled by a {'plane' if name == 'Sq' else 'line'}"
        except FayingError as fault:
            return name, f"none: {fault}"

    def _origin(self) -> dict[str, str]:
        """Where the heights come from, and what was done to them since."""
        of = self._self
        rows = {"missing": f"{of.missing} of {of.heights.size} points", "source": of.source}
        if of.history:
            rows["history"] = "; ".join(of.history)
        if of.notes:
            rows["notes"] = "; ".join(of.notes)
        return rows


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Scan(Heights, AreaHeights):
    """An areal scan.

    Args:
        heights: heights[iy, ix] [m], shape (ny, nx), NaN where a point is missing; copied and made read-only.
        spacing: (dx, dy) [m], positive; each also as text with a unit, for example "5 um".
        source: the file or recipe.
        instrument: the limits that the file states.
        history: what was done to the heights since.
        notes: what a reader of the results should know of the file.

    Raises:
        InputError: for heights that are not two-dimensional or not finite, and spacings that are not positive.
    """

    def areal(self, *, degree: int = 1, spikes: bool = True) -> ArealParameters:
        """Return the areal parameters of ISO 25178-2, levelled and without a filter.

        Args:
            degree: of the polynomial that levels the heights, 0 to 8.
            spikes: whether single outlying points are taken out.

        Returns:
            Heights, slopes, bearing curve, volumes and autocorrelation.

        Raises:
            InputError: for another degree, and for heights that carry no statistic.

        Source:
            ISO 25178-2:2021.
        """
        return ArealParameters.of(prepared(self, degree=degree, spikes=flag(spikes, "spikes")))

    def summary(self) -> tuple[str, dict[str, str]]:
        """Size, points, spacing, Sq, missing points and source."""
        rows, columns = self.shape
        dx, dy = self.spacing
        step = show(dx, "m") if abs(dx - dy) <= 1e-9 * dx else f"{show(dx, 'm')} x {show(dy, 'm')}"
        name, words = self._statistics()
        return "Scan", {
            "size": " x ".join(show(side, "m") for side in self.size),
            "points": f"{columns} x {rows}",
            "spacing": step,
            name: words,
            **self._origin(),
        }

    def profile(self, along: str, index: int) -> "Profile":
        """Return one row (along="x") or one column (along="y") as a Profile."""
        if not isinstance(along, str) or along not in ("x", "y"):
            raise InputError(f'along = {shown(along)}: a profile runs along "x" or "y"')
        count = self.shape[0] if along == "x" else self.shape[1]
        if not -count <= whole(index, "index of a profile") < count:
            raise InputError(f"profile {index} along {along}: the scan has {count} of them")
        heights = self.heights[index] if along == "x" else self.heights[:, index]
        return Profile(
            heights=heights,
            spacing=self.spacing[0 if along == "x" else 1],
            source=self.source,
            instrument=self.instrument,
            history=(*self.history, f"profile {index} along {along}"),
            notes=self.notes,
        )


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Profile(Heights, LineHeights):
    """A line scan.

    Args:
        heights: [m], shape (n,), NaN where a point is missing; copied and made read-only.
        spacing: [m], positive; or text with a unit, for example "5 um".
        source: the file or recipe.
        instrument: the limits that the file states.
        history: what was done to the heights since.
        notes: what a reader of the results should know of the file.

    Raises:
        InputError: as for Scan.
    """

    def summary(self) -> tuple[str, dict[str, str]]:
        """Length, points, spacing, Rq, missing points and source."""
        name, words = self._statistics()
        return "Profile", {
            "length": show(self.length, "m"),
            "points": str(len(self.heights)),
            "spacing": show(self.spacing, "m"),
            name: words,
            **self._origin(),
        }
