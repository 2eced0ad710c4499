"""Waves between a scan and a face: size, spectrum, what a mesh carries, and the pressure that closes one."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.sparse.linalg import spsolve

import faying
from faying.fe.elasticity import assemble
from faying.fe.interface import join
from faying.form.face_axes import FaceAxes
from faying.form.form import Form
from faying.form.waviness import ASSUMED, ASSUMED_GAP, GAUSSIAN, PROCESSES, LaidWaves, ScanWaves, Waves, Waviness
from tests.helpers.plates import plates, stacked

FACES = ("low.top", "high.bottom")
L, W = 0.12, 0.06
WAVES = Waves(Wq=1e-6, hurst=0.8, shortest=4e-3, longest=60e-3, seed=0)
GRID = np.stack(np.meshgrid(np.linspace(0, L, 25), np.linspace(0, W, 13), indexing="ij"), -1).reshape(-1, 2)
AREA = np.ones(len(GRID))


def in_plane(places):
    """The least-squares plane of a face's places."""
    return np.column_stack([np.ones(len(places)), places])


def test_each_face_has_the_rms_and_the_gap_of_both_has_root_two_of_it():
    heights = np.array([[replace(WAVES, seed=s).height(GRID, AREA, side) for side in (0, 1)] for s in range(100)])
    assert np.sqrt((heights**2).mean(axis=2)) == pytest.approx(1e-6, rel=1e-9)
    assert np.abs(heights @ in_plane(GRID)).max() < 1e-9 * 1e-6 * len(GRID)  # no mean, no tilt
    squares = heights.sum(axis=1).var(axis=1)
    assert squares.mean() == pytest.approx(2e-12, abs=3 * squares.std(ddof=1) / np.sqrt(100))
    assert replace(WAVES, seed=7).gap(GRID, AREA).var() == pytest.approx(squares[7])
    assert np.array([replace(WAVES, seed=s).gap(GRID, AREA).min() for s in range(5)]) == pytest.approx(0, abs=1e-30)


def test_wa_of_a_face_is_wq_over_the_factor_of_normal_heights():
    """Mean absolute height over many draws: (2/pi)^(1/2) of the rms, to its own scatter."""
    found = np.array([np.abs(replace(WAVES, seed=s).height(GRID, AREA, 0)).mean() for s in range(200)])
    assert found.mean() == pytest.approx(1e-6 / GAUSSIAN, rel=0.03)  # few long waves: not quite normal in one draw


@pytest.mark.parametrize("hurst", [pytest.param(0.5, marks=pytest.mark.slow), 0.9])
def test_the_spectrum_of_many_draws_falls_as_it_should(hurst):
    """The radial mean of periodograms over a patch of four longest waves, whose ends a Hann window takes away."""
    waves = Waves(Wq=1.0, hurst=hurst, shortest=1.0, longest=16.0, seed=0)
    count, side = 128, 64.0
    axis = np.arange(count) * side / count
    grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), -1).reshape(-1, 2)
    window = np.outer(*2 * (np.hanning(count),))
    power = np.zeros((count, count))
    for seed in range(12):
        heights = replace(waves, seed=seed).height(grid, np.ones(len(grid)), 0).reshape(count, count)
        power += np.abs(np.fft.fft2(heights * window)) ** 2
    q = np.hypot(*np.meshgrid(*2 * (np.fft.fftfreq(count, side / count),), indexing="ij"))
    edges = np.geomspace(1 / 12, 1 / 1.3, 9)
    means = [power[(q >= a) & (q < b)].mean() for a, b in pairwise(edges)]
    slope = np.polyfit(np.log(np.sqrt(edges[:-1] * edges[1:])), np.log(means), 1)[0]
    assert slope == pytest.approx(-2 - 2 * hurst, abs=0.15)
    outside = power[(q > 1.3) & (q < 2)].mean()
    assert outside < 1e-3 * means[-1]  # nothing shorter than the shortest wave


def test_the_share_of_long_waves_is_that_of_the_spectrum():
    """Variance of what a mesh carries over that of all waves, against the integral of q^(-1 - 2 H)."""
    waves = Waves(Wq=1.0, hurst=0.7, shortest=1.0, longest=8.0, seed=0)
    axis = np.linspace(0, 40, 60)
    grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), -1).reshape(-1, 2)
    kept = [replace(waves, seed=s).height(grid, np.ones(len(grid)), 0, carried=3.0).var() for s in range(60)]
    q = 2 * np.pi / np.array([8.0, 3.0, 1.0])
    whole, part = (quad(lambda x: x ** (-1 - 2 * 0.7), q[0], end)[0] for end in (q[2], q[1]))
    assert waves.share(3.0) == pytest.approx(part / whole, rel=1e-9)
    assert np.mean(kept) == pytest.approx(part / whole, abs=4 * np.std(kept) / np.sqrt(60))


def test_the_order_of_the_points_does_not_matter():
    order = np.random.default_rng(1).permutation(len(GRID))
    weights = np.random.default_rng(2).uniform(0.5, 2, len(GRID))
    assert WAVES.gap(GRID[order], weights[order]) == pytest.approx(WAVES.gap(GRID, weights)[order], abs=1e-18)
    assert np.array_equal(WAVES.gap(GRID, weights), WAVES.gap(GRID, weights))
    assert np.abs(replace(WAVES, seed=1).gap(GRID, weights) - WAVES.gap(GRID, weights)).max() > 1e-7


def test_two_meshes_have_the_same_waves():
    """Quadrature points of other elements: the same function of the place but for a plane, which only moves the parts,
    and the rms over the points, which differs by what the quadrature misses."""
    form, found = Form(waviness=Waviness(Wq=1e-6, shortest=30e-3, longest=60e-3, seed=3)), []
    for kind, counts in (("hex20", (12, 6, 1)), ("hex8", (14, 7, 1))):
        mesh = stacked(counts=counts, kind=kind)
        interface = plates(mesh).joints[0].interface
        axes = FaceAxes.of(mesh, FACES, interface)
        assert form.laid(axes).missing_share == 0
        gap = form.at(interface.positions, axes, interface.weights)
        exact = form.waviness.on(axes).gap(axes.local(interface.positions), interface.weights)
        assert gap == pytest.approx(exact, abs=1e-18)
        places = axes.local(interface.positions)
        waves = form.waviness.on(axes)
        pairs = [waves.waves(0, band) for band in range(len(waves.lengths) - 1)]
        raw = sum((np.cos(places @ q.T) * a + np.sin(places @ q.T) * b).sum(axis=1) for q, (a, b) in pairs)
        columns = np.column_stack([in_plane(places), raw])
        height = waves.height(places, interface.weights, 0)
        factors = np.linalg.lstsq(columns, height, rcond=None)[0]
        assert np.abs(columns @ factors - height).max() < 1e-9 * np.abs(height).max()
        found.append(factors[3])
    assert found[0] == pytest.approx(found[1], rel=0.03)


def test_a_mesh_cuts_the_waves_that_it_does_not_carry():
    """What is left is a sum of the waves that are long enough, and of a plane: nothing of the others is aliased."""
    mesh = stacked(counts=(6, 3, 1))
    interface = plates(mesh).joints[0].interface
    axes = FaceAxes.of(mesh, FACES, interface)
    assert axes.spacing == pytest.approx(0.08 / 12)  # quadratic elements 13.3 mm long
    waviness = Waviness(Wq=1e-6, shortest=4e-3, longest=70e-3, seed=5)
    laid = LaidWaves.of(waviness, axes)
    assert laid.carried == pytest.approx(4 * 0.08 / 12)
    gap, places = laid.gap(interface.positions, axes, interface.weights), axes.local(interface.positions)
    waves, columns = laid.waves, [in_plane(places)]
    total = [np.zeros(len(places)), np.zeros(len(places))]
    for side in (0, 1):
        for band in range(len(waves.lengths) - 1):
            q, (a, b) = waves.waves(side, band)
            parts = np.cos(places @ q.T) * a + np.sin(places @ q.T) * b
            total[side] += parts[:, 2 * np.pi / np.linalg.norm(q, axis=1) >= laid.carried].sum(axis=1)
    columns = np.column_stack([*columns, *total])
    rest = gap - columns @ np.linalg.lstsq(columns, gap, rcond=None)[0]
    assert np.abs(rest).max() < 1e-9 * gap.max()
    assert 0 < laid.missing_share < 1
    assert "waves longer than 26.67 mm (4 nodes of the coarser face in a wave)" in laid.mesh_limit()
    fine = LaidWaves.of(waviness, replace(axes, spacing=1e-3))
    assert fine.missing_share == 0


def test_long_waves_stay_where_the_shortest_changes():
    one, other = (replace(WAVES, shortest=s) for s in (4e-3, 10e-3))
    for band in range(8):
        assert np.array_equal(one.waves(0, band)[0], other.waves(0, band)[0])
    assert one.waves(0, 0)[1] != pytest.approx(one.waves(1, 0)[1])  # the faces are drawn apart


def test_a_round_face_has_waves_that_do_not_turn_with_its_mesh():
    mesh = stacked(size=(0.06, 0.06, 0.01), counts=(6, 6, 1))
    interface = plates(mesh).joints[0].interface
    axes = FaceAxes.of(mesh, FACES, interface)
    assert not axes.certain
    turned = replace(axes, x_axis=axes.y_axis, y_axis=-axes.x_axis)
    form = Form(waviness=Waviness(Wq=1e-6, shortest=5e-3, seed=2))
    one, other = (form.at(interface.positions, a, interface.weights) for a in (axes, turned))
    assert one == pytest.approx(other, abs=1e-18)
    ring = np.hypot(*(interface.positions[:, :2] - 0.03).T) > 0.02
    held = form.at(interface.positions[ring], axes, interface.weights[ring])
    assert held.min() == 0
    assert np.ptp(held) > 0.5e-6


@pytest.mark.parametrize("size", [(0.08, 0.04, 0.01), (0.06, 0.06, 0.01)])
def test_the_order_of_the_faces_does_not_mirror_the_waves(size):
    mesh = stacked(size=size, counts=(6, 6, 1))
    places, area = (getattr(plates(mesh).joints[0].interface, name) for name in ("positions", "weights"))
    form = Form(waviness=Waviness(Wq=1e-6, shortest=5e-3, seed=2))
    there, back = (FaceAxes.of(mesh, faces, join(mesh, *faces)) for faces in (FACES, FACES[::-1]))
    assert there.normal == pytest.approx(-back.normal)
    assert form.at(places, there, area) == pytest.approx(form.at(places, back, area), abs=1e-15)


def test_waves_add_to_other_shapes_and_vary_by_key():
    mesh = stacked(counts=(8, 4, 1))
    interface = plates(mesh).joints[0].interface
    axes = FaceAxes.of(mesh, FACES, interface)

    def gap(form):
        return form.at(interface.positions, axes, interface.weights)

    crown, waves = Form(crown_along=5e-6), Form(waviness=Waviness(Wq=1e-6, seed=4))
    both = replace(crown, waviness=waves.waviness)
    assert gap(both) == pytest.approx(gap(crown) + gap(waves), abs=1e-18)
    assert gap(waves.with_value("waviness", 3e-6)) == pytest.approx(3 * gap(waves), rel=1e-9, abs=1e-18)
    assert waves.with_value("waviness_seed", 7.9).waviness.seed == 7
    assert crown.with_value("waviness", 1e-6).waviness.Wq == 1e-6
    with pytest.raises(faying.InputError, match="waviness_seed draws waves of a form that has none"):
        crown.with_value("waviness_seed", 1)


def test_what_belongs_to_the_second_face_moves_with_it():
    """Moved by s, the second face has at x the height that it has at x - s; tilts do not count, and crowns stay."""
    shift = np.array([0.8e-3, -0.3e-3])
    moved, there = WAVES.height(GRID, AREA, 1, moved=GRID - shift), WAVES.height(GRID - shift, AREA, 1)
    size = float(moved @ there / (there @ there))
    assert size == pytest.approx(1, abs=0.05)  # `there` has the rms Wq over another piece of the face
    assert moved == pytest.approx(size * there, rel=1e-6, abs=1e-15)
    assert np.abs(moved - WAVES.height(GRID, AREA, 1)).max() > 0.3e-6
    mesh = stacked(counts=(8, 4, 1))
    interface = plates(mesh).joints[0].interface
    axes, places = FaceAxes.of(mesh, FACES, interface), interface.positions
    aside = shift[0] * axes.x_axis + shift[1] * axes.y_axis
    for form in (Form(crown_along=5e-6), Form(twist=2e-6), Form(wave=3e-6, wave_length=0.03)):
        assert not form.of_each_face
        assert np.array_equal(form.at(places, axes, shift=aside), form.at(places, axes))
    flat = Form(flatness=10e-6, seed=3)
    assert flat.of_each_face
    assert flat.at(places, axes, shift=0 * aside) == pytest.approx(flat.at(places, axes), abs=1e-18)
    both = flat.at(places, axes, shift=aside) + flat.at(places + aside, axes, shift=aside)
    first = flat.at(places + aside, axes, shift=2 * aside) + flat.at(places, axes)
    assert both == pytest.approx(first, abs=1e-15)  # each face once at each place


def test_the_spectrum_of_a_scan_is_continued():
    """A self-affine surface of Hurst exponent H: its rms grows as the side to the H, the waves hold what is added."""
    scan = ScanWaves(side=4e-3, Rq=0.8e-6, length=4e-3, hurst=0.7)
    waves = Waviness(scan=scan).on(FaceAxes.of(stacked(), FACES, plates().joints[0].interface))
    assert (waves.shortest, waves.longest, waves.hurst) == pytest.approx((4e-3, 40e-3, 0.7))
    assert np.hypot(waves.Wq, 0.8e-6) == pytest.approx(0.8e-6 * 10**0.7)
    assert scan.Wq(4e-3, 8e-3) ** 2 + scan.Wq(8e-3, 40e-3) ** 2 == pytest.approx(waves.Wq**2)


def test_the_default_is_a_gap_of_one_micrometre_and_processes_are_in_order():
    assert np.sqrt(2) * ASSUMED.Wq == pytest.approx(ASSUMED_GAP)
    middle = {name: process.Wa for name, process in PROCESSES.items()}
    assert middle["lapped"] < middle["ground"] < middle["milled"]
    assert all(p.least < p.Wa < p.greatest and p.source for p in PROCESSES.values())


def test_messages():
    interface, axes = plates().joints[0].interface, FaceAxes.of(stacked(), FACES, plates().joints[0].interface)
    with pytest.raises(faying.InputError, match=r"waviness\.hurst = 1\.2; it must be above 0 and at most 1"):
        Waviness(Wq=1e-6, hurst=1.2)
    with pytest.raises(faying.InputError, match=r"waviness\.Wq = -1e-06 m; it must be positive"):
        Waviness(Wq=-1e-6)
    with pytest.raises(faying.InputError, match="from 10 mm to 12 mm: the longest wave must be 2 times as long"):
        Waviness(Wq=1e-6, shortest=10e-3, longest=12e-3)
    with pytest.raises(faying.InputError, match="from 30 mm to 40 mm: the longest wave must be"):
        Form(waviness=Waviness(Wq=1e-6, shortest=30e-3)).at(interface.positions, axes)
    with pytest.raises(faying.InputError, match="this one is curved"):
        Waviness(Wq=1e-6).on(replace(axes, flat=False))
    with pytest.raises(faying.InputError, match='from = "scan" needs'):
        Waviness().on(axes)
    with pytest.raises(faying.InputError, match="D and G can be fitted"):
        Waviness(scan=ScanWaves(side=4e-3)).on(axes)
    assert not Waviness(Wq=1e-6, shortest=30e-3).fits(axes)
    assert Waviness(Wq=1e-6).fits(axes)


def test_a_single_wave_closes_at_westergaards_pressure():
    """Two thick blocks in plane strain, one wave z = D (1 - cos(2 pi x/l)) between them, held in contact everywhere by
    springs of k per area: the amplitude of the pressure is D/(1/k + l/(pi E*)), which for stiff springs is the mean
    pressure pi E* D/l that closes the wave (Westergaard 1939; Johnson, Contact Mechanics, eq. 13.8).
    """
    l, D, steel = 0.02, 1e-6, faying.CATALOGUE["45 steel"]
    mesh = stacked(counts=(8, 1, 8), size=(l / 2, 0.002, l))
    interface = join(mesh, *FACES)
    form = Form(wave=2 * D, wave_length=l, along=(1, 0, 0))
    # the middle of the rectangle is a quarter of the wave: shifted so that x = 0 is a crest
    axes = replace(FaceAxes.of(mesh, FACES, interface, (1, 0, 0)), origin=np.array([0.0, 0.001, l]))
    gap = form.at(interface.positions, axes)
    E = steel.E / (1 - steel.nu**2) / 2
    k = 1e3 * np.pi * E / l
    K = assemble(mesh, dict.fromkeys(mesh.parts, steel))[0]
    K = K + interface.springs(np.full(len(gap), k), np.zeros(len(gap)))
    force = interface.forces(-k * gap, np.zeros((len(gap), 2)))
    x, _, z = mesh.points.T
    fixed = np.zeros_like(mesh.points, dtype=bool)
    fixed[:, 1] = True
    fixed[(np.abs(x) < 1e-9) | (np.abs(x - l / 2) < 1e-9), 0] = True
    fixed[(np.abs(z) < 1e-9) | (np.abs(z - 2 * l) < 1e-9), 2] = True
    free = np.flatnonzero(~fixed.ravel())
    u = np.zeros(mesh.unknowns)
    u[free] = spsolve(K.tocsc()[free][:, free], force[free])
    pressure = -k * ((interface.relative @ u).reshape(-1, 3)[:, 0] + gap)
    wave = np.cos(2 * np.pi * interface.positions[:, 0] / l)
    amplitude = interface.weights @ (pressure * wave) / (interface.weights @ wave**2)
    assert amplitude == pytest.approx(D / (1 / k + l / (np.pi * E)), rel=2e-3)
    assert amplitude == pytest.approx(np.pi * E * D / l, rel=4e-3)
