"""What a scan and a profile do alike: roughness, fractal dimension, levelling, figures."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np

from faying.checks import text
from faying.errors import FayingError, InputError
from faying.style import Summary

if TYPE_CHECKING:
    import matplotlib.axes

    from faying.surface.fractal import FractalFit
    from faying.surface.roughness import Roughness
    from faying.surface.scan import Profile, Scan


class Heights(Summary):
    """Measured heights; `Scan` and `Profile` are the two kinds of them."""

    @property
    def _self(self) -> "Scan | Profile":
        return cast("Scan | Profile", self)

    @property
    def missing(self) -> int:
        """How many points have no height."""
        return int(np.isnan(self._self.heights).sum())

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

    def _of_a_line(self, name: str) -> "Roughness":
        if self._self.heights.ndim == 2:
            raise InputError(
                f"{name} is a number of a profile; this is a scan, which has S{name[1:]}, or take a profile of it"
            )
        return self.roughness()

    def roughness(self, *, degree: int = 1) -> "Roughness":
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
        from faying.surface.roughness import roughness

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
        self_test: bool = False,
    ) -> "FractalFit":
        """Return D and G with their intervals, and the band of wavelengths that they hold in.

        Args, Returns and Raises are those of `faying.fit_fractal`.
        """
        from faying.surface.fractal import fit_fractal

        return fit_fractal(
            self._self,
            method,
            band=band,
            degree=degree,
            spikes=spikes,
            convention=convention,
            gamma=gamma,
            self_test=self_test,
        )

    def levelled(self, degree: int = 1) -> Self:
        """Return the heights less their least-squares polynomial of this degree (0 mean, 1 plane or line, 2 .. form).

        Missing points stay missing. Raises InputError for a degree outside 0 to 8 and for too few known points.
        """
        from faying.surface.form import levelled

        return cast("Self", levelled(self._self, degree))

    def without_spikes(self) -> Self:
        """Return the heights with single outlying points marked as missing; judged on levelled heights.

        Raises InputError as `levelled`.
        """
        from faying.surface.form import find_spikes, levelled

        spikes = find_spikes(levelled(self._self))
        note = f"{int(spikes.sum())} spikes taken out"
        return cast("Self", self._self.with_heights(np.where(spikes, np.nan, self._self.heights), note))

    def filled(self) -> Self:
        """Return the heights with missing points filled in smoothly from their neighbours; InputError without any."""
        from faying.surface.form import filled

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
        from faying.surface.figure import overview_of

        return overview_of(self._self, axes, degree=degree)

    def with_heights(self, heights: Any, note: str = "") -> Self:
        """Return the same scan or profile with other heights [m] and one more line of history."""
        of = self._self
        history = (*of.history, note) if text(note, "note") else of.history
        return cast("Self", replace(of, heights=heights, history=history))

    def _statistics(self) -> tuple[str, str]:
        """Rms height as a line of the summary: its name and its text, or why there is none."""
        name = "Sq" if self._self.heights.ndim == 2 else "Rq"
        from faying.units import show

        try:
            return name, f"{show(self.roughness().Rq, 'm')}, levelled by a {'plane' if name == 'Sq' else 'line'}"
        except FayingError as fault:
            return name, f"none: {fault}"

    def _origin(self) -> dict[str, str]:
        """Where the heights come from, and what was done to them since."""
        of = self._self
        rows = {"missing": f"{self.missing} of {of.heights.size} points", "source": of.source}
        if of.history:
            rows["history"] = "; ".join(of.history)
        if of.notes:
            rows["notes"] = "; ".join(of.notes)
        return rows
