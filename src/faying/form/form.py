"""The form of two faces that meet: measured maps, named shapes, waves, or a random form within a flatness tolerance.

A form is a gap between the faces before any load. Its constant part and its tilt only move the parts as wholes; every
shape here is zero where it is nearest and positive elsewhere.
"""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from faying.contact.parameter import Parameter
from faying.errors import InputError
from faying.fe.interface import Interface
from faying.fe.mesh import Mesh
from faying.form.face_axes import FaceAxes
from faying.form.fit import minimum_zone
from faying.form.gap_map import FaceMap, GapMap
from faying.form.waviness import PARAMETERS as OF_WAVINESS
from faying.form.waviness import LaidWaves, ScanWaves, Waviness
from faying.misuse import checked_call
from faying.typing import Array

# what is one number: read from the study, varied by sweeps
PARAMETERS = {
    "crown_along": Parameter("m", "gap c (2x/L)^2 along the longer side of the face; negative is hollow"),
    "crown_across": Parameter("m", "gap c (2y/W)^2 along the shorter side; negative is hollow"),
    "twist": Parameter("m", "gap t (2x/L)(2y/W), so t at two corners and -t at the others"),
    "wave": Parameter("m", "wave along the longer side, from trough to crest; nearest in the middle where positive"),
    "wave_length": Parameter("m", "length of the wave", 0),
    "flatness": Parameter("m", "flatness tolerance of each face, of which a random form is drawn", 0, ends="[)"),
    "seed": Parameter("", "which random form is drawn", 0, 1e15, "[]", whole=True),
}
VARIED = PARAMETERS | OF_WAVINESS  # what sweeps and predictions know of a form
TOLERANCE_SHARE = 2 / 3, 1 / 6  # mean and sd of the flatness drawn over the tolerance, a normal cut off at 2 sd
SHAPES = ("crown_along", "crown_across", "twist", "wave", "flatness")
ACROSS = ("crown_across", "twist", "waviness")  # what the shorter side of the face limits
STEEPEST = 0.1  # of the side of the face, that a shape may have as height
DEGREES = 2, 3, 4  # total degrees of the polynomials of a random form: crowns and twist, and two orders above
GRID = 33  # points along each side of the rectangle at which the flatness of a random form is taken


@checked_call
@dataclass(frozen=True, kw_only=True)
class Form:
    """The form of both faces of a joint together, a sum of what is given.

    Args:
        crown_along, crown_across: Gap c (2x/L)^2 [m] at the ends of the longer and of the shorter side of the face,
            0 in the middle; negative for hollow faces, which meet at their ends first.
        twist: Gap [m] at two opposite corners, its negative at the other two; positive where x and y have the same
            sign, x along the longer side towards the positive axis of the model, y = normal x x with the normal from
            the first face to the second.
        wave, wave_length: Height from trough to crest and length [m] of a wave along the longer side; the faces are
            nearest in the middle where positive, farthest there where negative.
        flatness: Flatness tolerance [m] of each face; a form of each is drawn at random, see `random_depth`.
        seed: Which form is drawn, a whole number of 0 or more.
        along: Direction (3,) of x in place of the longer side, for faces as long as wide.
        gap: Measured gap between the faces.
        first, second: Measured heights of the first and of the second face.
        waviness: Random waves between the side of a scan and that of the face.

    Raises:
        InputError: A wave without a length, or a value that is not allowed.
    """

    crown_along: float = 0.0
    crown_across: float = 0.0
    twist: float = 0.0
    wave: float = 0.0
    wave_length: float | None = None
    flatness: float = 0.0
    seed: int = 0
    along: tuple[float, float, float] | None = None
    gap: GapMap | None = None
    first: FaceMap | None = None
    second: FaceMap | None = None
    waviness: Waviness | None = None

    def __post_init__(self) -> None:
        for name, parameter in PARAMETERS.items():
            if getattr(self, name) is not None:
                parameter.check(getattr(self, name), name)
        if self.wave and self.wave_length is None:
            raise InputError('wave needs its length; add wave_length, for example "40 mm"')

    def with_value(self, name: str, value: float) -> Self:
        """Return the same form with one of `VARIED` changed."""
        new = int(value) if VARIED[name].whole else value
        if name == "waviness_seed" and self.waviness is None:
            raise InputError("waviness_seed draws waves of a form that has none; give joint.form.waviness")
        if name in OF_WAVINESS:
            waves: dict[str, Any] = {"Wq" if name == "waviness" else "seed": new}
            return replace(self, waviness=replace(self.waviness or Waviness(), **waves))
        changed: dict[str, Any] = {name: new}
        return replace(self, **changed)

    def with_scan(self, scan: ScanWaves | None) -> Self:
        """Return the same form with what the scan of the joint says of waves that it does not hold."""
        return self if self.waviness is None else replace(self, waviness=replace(self.waviness, scan=scan))

    def laid(self, axes: FaceAxes) -> LaidWaves | None:
        """Return the waves on a face with these axes, if there are any.

        Raises InputError where the form does not fit the face: a shape without a longer side or on a curved face, one
        that is too high for it, waves that have no room.
        """
        for name in SHAPES:
            if getattr(self, name):
                axes.check(name)
        long, short = axes.lengths
        waves = None if self.waviness is None else LaidWaves.of(self.waviness, axes)
        heights = {name: abs(getattr(self, name)) for name in SHAPES} | {"waviness": waves.waves.Wq if waves else 0.0}
        for name, height in heights.items():
            side = short if name in ACROSS else long
            if height > STEEPEST * side:
                raise InputError(
                    f"{name} = {1e3 * height:.4g} mm on a face that is {1e3 * side:.4g} mm long there; it is at most "
                    f"{STEEPEST:.0%} of that: check its unit"
                )
        return waves

    @property
    def of_each_face(self) -> bool:
        """Whether anything of it belongs to the second face alone and moves with that face: see `at`."""
        return self.waviness is not None or self.flatness > 0 or self.second is not None

    def at(self, positions: Array, axes: FaceAxes, weights: Array | None = None, shift: Array | None = None) -> Array:
        """Gap [m] (q,) at positions (q, 3) [m] of a joint with these axes.

        weights: area of each position (q,), which the mean plane of waves is fitted with; alike where None. shift:
        displacement (3,) [m] of the second face in its plane. Its waves, its random form and its map move with it; a
        gap that was measured or given as one number is that of both faces together, and stays. Crowns and twist would
        only tilt the face. Raises InputError where the form does not fit.
        """
        waves = self.laid(axes)
        moved = positions if shift is None else positions - shift
        gap = np.zeros(len(positions))
        place = 2 * axes.local(positions) / np.array(axes.lengths)
        x, y = place.T
        for c, s in ((self.crown_along, x), (self.crown_across, y)):
            gap += c * s**2 - min(c, 0.0)
        gap += self.twist * x * y + abs(self.twist)
        if self.wave and self.wave_length:
            phase = np.pi * axes.lengths[0] * x / self.wave_length
            gap += abs(self.wave) / 2 - self.wave / 2 * np.cos(phase)
        if self.flatness:
            for side, lies in enumerate((place, 2 * axes.local(moved) / np.array(axes.lengths))):
                gap += random_depth(lies, self.flatness, self.seed, side)
        if waves is not None:
            gap += waves.gap(positions, axes, weights, None if shift is None else moved)
        if self.gap is not None:
            gap += self.gap.at(positions)
        for face, outward, lies in ((self.first, axes.normal, positions), (self.second, -axes.normal, moved)):
            if face is not None:
                gap += face.placed(axes, outward).at(lies)
        return gap

    def on(self, interface: Interface, mesh: Mesh, faces: tuple[str, str]) -> Interface:
        """Return a joint of two named faces with this form added to the gap of its geometry."""
        axes = FaceAxes.of(mesh, faces, interface, self.along)
        return replace(interface, gap=interface.gap + self.at(interface.positions, axes, interface.weights))


def random_depth(places: Array, tolerance: float, seed: int, side: int) -> Array:
    """Depth [m] (q,) of one face below the plane that touches its form from outside, drawn at random.

    A sum of products of Legendre polynomials P_i(x) P_j(y) with i + j = 2, 3 and 4, whose coefficients are normal with
    an rms that falls with the square of i + j. It is smooth and a function of the place alone, so that it does not
    depend on the mesh. Its flatness over the rectangle, as the minimum zone, is f times the tolerance, with f normal of
    mean 2/3 and sd 1/6, cut off at two sd: between a third of the tolerance and all of it.

    Args:
        places: (q, 2) [-], from -1 to 1 along both sides of the face.
        tolerance: Flatness tolerance [m].
        seed: A whole number of 0 or more; the same number gives the same form.
        side: 0 for the first face, 1 for the second.

    Returns:
        Depths, from about 0 to the flatness.

    Source:
        Flatness of a drawing: ISO 1101. The spectrum is a convention: machined faces bend more in long waves.
    """
    generator = np.random.default_rng([seed, side])
    terms = [(i, n - i) for n in DEGREES for i in range(n + 1)]
    factors = generator.standard_normal(len(terms)) / np.array([(i + j) ** 2 for i, j in terms])
    mean, sd = TOLERANCE_SHARE
    draw = generator.standard_normal()
    while abs(draw) > 2:
        draw = generator.standard_normal()
    axis = np.linspace(-1, 1, GRID)
    grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    zone = minimum_zone(grid, _legendre(grid, terms, factors))
    depth = zone.depth(places, _legendre(places, terms, factors))
    return np.asarray(depth * (mean + sd * draw) * tolerance / zone.flatness)


def _legendre(places: Array, terms: list[tuple[int, int]], factors: Array) -> Array:
    from numpy.polynomial import legendre

    highest = max(DEGREES)
    table = np.zeros((highest + 1, highest + 1))
    for (i, j), factor in zip(terms, factors, strict=True):
        table[i, j] = factor * np.sqrt((2 * i + 1) * (2 * j + 1))  # each product with an rms of 1 over the rectangle
    return np.asarray(legendre.legval2d(places[:, 0], places[:, 1], table))
