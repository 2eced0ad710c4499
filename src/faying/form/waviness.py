"""Waves of two faces between the side of a scan and the form of the face: a random gap with a self-affine spectrum."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, log2, pi, sqrt
from typing import Self, final

import numpy as np

from faying.contact.parameter import Parameter
from faying.errors import InputError
from faying.form.face_axes import FaceAxes
from faying.misuse import checked_call
from faying.typing import Array
from faying.units import show

# what is one number of the waves: read from the study, varied by sweeps and predictions
PARAMETERS = {
    "waviness": Parameter("m", "rms of the waves of each face, Wq; the gap of two faces has sqrt(2) times that", 0),
    "waviness_seed": Parameter("", "which waves are drawn", 0, 1e15, "[]", whole=True),
}
OF_WAVES = {
    "hurst": Parameter("", "Hurst exponent of the waves", 0, 1, "(]"),
    "shortest": Parameter("m", "shortest wave; the longer side of the scan where left out", 0),
    "longest": Parameter("m", "longest wave; half of the longer side of the face where left out", 0),
    "seed": PARAMETERS["waviness_seed"],
}
HURST = 0.8  # where nothing says another one
NO_SCAN = 4e-3  # m, shortest wave where there is no scan: five cut-offs of 0.8 mm, the length that Ra is taken over
NODES = 4  # of a face in one wave, so that its elements can bend along with it
BANDS, WAVES = 4, 16  # bands in an octave of wavelengths, and plane waves in each band
FORM = 0.5  # of the longer side of a face: longer waves are crown, twist and the like
FITS = 2.0  # longest over shortest wave from which there is room for waves


@final
@dataclass(frozen=True, kw_only=True)
class ScanWaves:
    """What a scan says of the waves that it does not hold.

    side: its longer side [m]. Rq: rms [m] that its fitted spectrum has over `length` [m], and hurst its Hurst exponent,
    3 - D; None where no D and G were fitted.
    """

    side: float
    Rq: float | None = None
    length: float = 0.0
    hurst: float | None = None

    def Wq(self, shortest: float, longest: float) -> float:
        """The rms [m] of the waves between two lengths, with the spectrum of the scan continued. Raises InputError."""
        if self.Rq is None or self.hurst is None:
            raise InputError('waviness from = "scan" needs a scan whose D and G can be fitted; give Wq, Wa or process')
        ends = (np.array([shortest, longest]) / self.length) ** (2 * self.hurst)
        return float(self.Rq * np.sqrt(ends[1] - ends[0]))


@checked_call
@final
@dataclass(frozen=True, kw_only=True)
class Waviness:
    """The waves of both faces, before the face is known.

    Args:
        Wq: rms height of the waves of each face over the face, its mean plane removed [m]. The faces are drawn apart,
            so that their gap has sqrt(2) Wq. None: the spectrum of `scan`, continued to longer waves.
        hurst: Hurst exponent of their spectrum [-], 0 < H <= 1; that of the scan where Wq is None, 0.8 otherwise.
        shortest: [m]; the longer side of `scan` where None, 4 mm without a scan.
        longest: [m]; half of the longer side of the face where None: what is longer is form, and has names of its own.
        seed: Which waves are drawn, a whole number of 0 or more.
        origin: Where the size comes from, in words.
        scan: The scan of the joint's surface.

    Raises:
        InputError: A value that is not allowed.
    """

    Wq: float | None = None
    hurst: float | None = None
    shortest: float | None = None
    longest: float | None = None
    seed: int = 0
    origin: str = "given"
    scan: ScanWaves | None = None

    def __post_init__(self) -> None:
        if self.Wq is not None:
            PARAMETERS["waviness"].check(self.Wq, "waviness.Wq")
        for name, parameter in OF_WAVES.items():
            if getattr(self, name) is not None:
                parameter.check(getattr(self, name), f"waviness.{name}")
        if self.shortest is not None and self.longest is not None:
            self._check_room(self.shortest, self.longest)

    @staticmethod
    def _check_room(shortest: float, longest: float) -> None:
        if longest < FITS * shortest:
            raise InputError(
                f"waviness from {show(shortest, 'm')} to {show(longest, 'm')}: the longest wave must be {FITS:g} times "
                "as long as the shortest, or longer; give shortest and longest"
            )

    def fits(self, axes: FaceAxes) -> bool:
        """Whether there is room for waves on a face with these axes."""
        shortest, longest = self._ends(axes)
        return axes.flat and longest >= FITS * shortest

    def _ends(self, axes: FaceAxes) -> tuple[float, float]:
        side = NO_SCAN if self.scan is None else self.scan.side
        return self.shortest or side, self.longest or FORM * max(axes.lengths)

    def on(self, axes: FaceAxes) -> "Waves":
        """The waves on a face with these axes. Raises InputError where the face has no room for them, or is curved."""
        if not axes.flat:
            raise InputError("waviness is a gap over a flat face, and this one is curved; give a measured map")
        shortest, longest = self._ends(axes)
        self._check_room(shortest, longest)
        Wq, hurst = self.Wq, self.hurst or HURST
        if Wq is None:
            if self.scan is None:
                raise InputError('waviness from = "scan" needs [surface] scan; give Wq, Wa or process')
            scan = replace(self.scan, hurst=self.hurst or self.scan.hurst)
            Wq, hurst = scan.Wq(shortest, longest), scan.hurst or HURST
        return Waves(Wq=Wq, hurst=hurst, shortest=shortest, longest=longest, seed=self.seed)


@final
@dataclass(frozen=True, kw_only=True)
class Waves:
    """Two faces with random waves, drawn apart.

    The spectrum of each face is isotropic and self-affine, C(q) ~ q^(-2 - 2 H) between the wave numbers of the longest
    and of the shortest wave, so that the waves longer than l hold the share
    (L^(2H) - l^(2H))/(L^(2H) - s^(2H)) of the variance. It is laid out in bands, a quarter of an octave of wavelengths
    each, from the longest wave down; a band is a sum of 16 plane waves with random directions, with lengths drawn from
    the spectrum within the band, and with normal amplitudes of sine and cosine. A draw is a function of the place
    alone, and its long waves stay the same where the shortest wave changes.

    Args:
        Wq: rms height of each face over the face [m]: a draw is scaled to that, its mean plane removed.
        hurst: Hurst exponent H [-].
        shortest, longest: waves s and L [m].
        seed: a whole number of 0 or more.

    Source:
        Sums of plane waves with random phases: Longuet-Higgins 1957, doi:10.1098/rsta.1957.0002. The spectrum: Persson
        et al. 2005, doi:10.1088/0953-8984/17/1/R01.
    """

    Wq: float
    hurst: float
    shortest: float
    longest: float
    seed: int

    @cached_property
    def lengths(self) -> Array:
        """Ends of the bands [m], falling from the longest to the shortest wave."""
        count = ceil(BANDS * log2(self.longest / self.shortest) - 1e-9)
        return np.append(self.longest * 2.0 ** (-np.arange(count) / BANDS), self.shortest)

    def share(self, least: float) -> float:
        """Share of the variance in waves longer than `least` [m]."""
        ends = np.array([self.shortest, np.clip(least, self.shortest, self.longest), self.longest]) ** (2 * self.hurst)
        return float((ends[2] - ends[1]) / (ends[2] - ends[0]))

    def waves(self, side: int, band: int) -> tuple[Array, Array]:
        """Wave vectors (w, 2) [1/m] of one band of one face, and amplitudes of cosine and sine (2, w) over Wq."""
        high, low = self.lengths[band : band + 2]
        generator = np.random.default_rng([self.seed, side, band])
        share = generator.random(WAVES)
        power = 2 * self.hurst
        length = (low**power + share * (high**power - low**power)) ** (1 / power)
        angle = generator.uniform(0, 2 * np.pi, WAVES)
        q = 2 * np.pi / length[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        variance = (self.share(low) - self.share(high)) / WAVES
        return q, generator.standard_normal((2, WAVES)) * sqrt(variance)

    def height(
        self, places: Array, weights: Array, side: int, carried: float = 0.0, moved: Array | None = None
    ) -> Array:
        """Height [m] (q,) of one face above its mean plane.

        Args:
            places: (q, 2) [m], in the plane of the face; three or more, not on one line.
            weights: share of the face that each stands for (q,), in any unit.
            side: 0 for the first face, 1 for the second.
            carried: waves shorter than this are left out [m]; the rest stays what it is with them.
            moved: (q, 2) [m], the places of a face that lies elsewhere in its plane; its size is that at `places`.
        """
        total, kept = self._sums(places, side, carried)
        root = np.sqrt(weights / weights.sum())
        plane = np.column_stack([np.ones(len(places)), places])
        scaled = plane * root[:, None]
        rest = total - plane @ np.linalg.lstsq(scaled, root * total, rcond=None)[0]
        size = float(np.linalg.norm(root * rest))
        if size <= 0:
            raise InputError(f"waviness on {len(places)} points: a face with waves needs four points or more")
        if moved is not None:
            _, kept = self._sums(moved, side, carried)
        kept -= plane @ np.linalg.lstsq(scaled, root * kept, rcond=None)[0]
        return np.asarray(kept * (self.Wq / size))

    def _sums(self, places: Array, side: int, carried: float) -> tuple[Array, Array]:
        """Sum (q,) of all waves of one face, and of those that are carried, before they are scaled."""
        total, kept = np.zeros(len(places)), np.zeros(len(places))
        for band in range(len(self.lengths) - 1):
            q, (a, b) = self.waves(side, band)
            phase = places @ q.T
            parts = np.cos(phase) * a + np.sin(phase) * b
            total += parts.sum(axis=1)
            kept += parts @ (2 * np.pi / np.linalg.norm(q, axis=1) >= carried)
        return total, kept

    def gap(self, places: Array, weights: Array, carried: float = 0.0, moved: Array | None = None) -> Array:
        """Gap [m] (q,) of both faces, zero where they are nearest; moved: places on the second. See `height`."""
        depth = self.height(places, weights, 0, carried) + self.height(places, weights, 1, carried, moved)
        return np.asarray(depth - depth.min())


def carried_by(axes: FaceAxes) -> float:
    """The shortest wave [m] that the mesh of faces carries."""
    return NODES * axes.spacing


@final
@dataclass(frozen=True, kw_only=True)
class LaidWaves:
    """Waves on the mesh of a joint: what they are, and the shortest wave that the mesh carries [m]."""

    waves: Waves
    carried: float

    @classmethod
    def of(cls, waviness: Waviness, axes: FaceAxes) -> Self:
        """Lay waves on a face. Raises InputError where it has no room for them."""
        return cls(waves=waviness.on(axes), carried=carried_by(axes))

    @property
    def missing_share(self) -> float:
        """Share of the variance [-] in waves that the mesh does not carry."""
        return 1.0 - self.waves.share(self.carried)

    def gap(self, positions: Array, axes: FaceAxes, weights: Array | None, moved: Array | None = None) -> Array:
        """Gap [m] (q,) at positions (q, 3) [m]; weights: area of each (q,), alike where None.

        moved: what lies there of the second face, by its positions (q, 3) [m] as modelled.
        """
        shares = np.ones(len(positions)) if weights is None else weights
        second = None if moved is None else axes.steady(moved)
        return self.waves.gap(axes.steady(positions), shares, self.carried, second)

    def words(self) -> str:
        """Which waves these are, for people."""
        w = self.waves
        return f"waves from {show(w.shortest, 'm')} to {show(w.longest, 'm')}, rms {show(w.Wq, 'm')} on each face"

    def mesh_limit(self) -> str:
        """What the mesh leaves out of the waves, for people."""
        least = show(self.carried, "m")
        return (
            f"the mesh carries waves longer than {least} ({NODES} nodes of the coarser face in a wave); the shorter, "
            f"{self.missing_share:.2g} of the variance, are left out. Finer elements on the faces include them"
        )


GAUSSIAN = sqrt(pi / 2)  # Wq over Wa of normal heights
# Of a flatness tolerance, two thirds are long waves (the mean of `faying.form.form.random_depth`). Waves take the
# last third with six times their rms, the range of 99.7 % of normal heights. A convention.
RMS_OF_FLATNESS = 1 / 18


@final
@dataclass(frozen=True, kw_only=True)
class Process:
    """Waviness that a process leaves on faces.

    least, greatest: range of Wa [m]; source: where it comes from; measured: whether both ends are measured, or one of
    them is a convention.
    """

    least: float
    greatest: float
    source: str
    measured: bool

    @property
    def Wa(self) -> float:
        """Value in the middle of the range, by its logarithm [m]."""
        return sqrt(self.least * self.greatest)


# Waves of height h from crest to trough have Wa = h/pi where they are sines.
PROCESSES = {
    "milled": Process(
        least=1.4e-6 / pi,
        greatest=6.0e-6 / pi,
        source="high-speed face milling: waves 1.4 to 6.0 um high, 1.6 to 5.2 mm long (handbook value on the terms of "
        "the recommendation SEV RS 3951-73, stanotex.ru/volnistost-poverhnosti)",
        measured=True,
    ),
    "turned": Process(least=1.4e-6 / pi, greatest=6.0e-6 / pi, source="convention: as milled", measured=False),
    "ground": Process(least=0.15e-6, greatest=0.6e-6, source="convention: a third of milled", measured=False),
    "lapped": Process(
        least=0.05e-6,
        greatest=0.59e-6 / GAUSSIAN,
        source="greatest: rms 0.59 um over a lapped face of 1050 x 130 mm, form included (doi:10.3390/s25175270); "
        "least: convention",
        measured=False,
    ),
}

# Both faces of a bolted lap of 120 x 25 mm, measured each 0.5 mm: the gap less all polynomials of degree up to 4,
# which are crown, twist and longer form, has an rms of 0.98 um (less degree 2: 3.4 um). Porter and Brake 2023,
# doi:10.1016/j.ymssp.2023.110210.
ASSUMED_GAP = 1.0e-6
ASSUMED = Waviness(Wq=ASSUMED_GAP / sqrt(2), origin="assumed")
