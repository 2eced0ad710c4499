"""Dowels: a pin in holes of several parts, beside closed forms and beside a pin that is meshed."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.sparse import csr_array

import faying
from faying.bolt.dowel import ORDER, pin_stiffness
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.interface import join
from faying.fe.mesh import Mesh
from faying.geometry.geometry import mesh_step
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.loads.table import terminal
from faying.numerics.modes import lowest_modes
from faying.numerics.solve import factorise
from tests.geometry.test_geometry import at, named, step
from tests.helpers.bars import even
from tests.helpers.sides import sides_on

STEEL = faying.CATALOGUE["45 steel"]
D, DEEP = 8e-3, 10e-3
PLACES = (12.0, 48.0)  # mm along x
HELD = (Support(face="lower.seat"), Support(face="upper.seat", directions=("z",)))
NAMES = [f"{part}.pin {k}" for part in ("lower", "upper") for k in (1, 2)]


def plates():
    """Two plates of 60 x 40 x 10 mm, one on the other, with two holes of 8 mm through both."""
    from netgen.occ import Box, Cylinder, Pnt, Z

    out = []
    for name, low in (("lower", -10), ("upper", 0)):
        solid = Box(Pnt(0, 0, low), Pnt(60, 40, low + 10))
        for x in PLACES:
            solid = solid - Cylinder(Pnt(x, 20, low), Z, r=4, h=10)
        walls = {
            f"{name}.pin {k}": lambda face, x=x, low=low: (
                abs(face.center.x - x) < 1 and abs(face.center.z - low - 5) < 1
            )
            for k, x in enumerate(PLACES, 1)
        }
        ends = {
            f"{name}.joint": at(0),
            f"{name}.seat": at(10 if low == 0 else -10),
            f"{name}.end": lambda f: f.center.x > 59,
        }
        out.append(named(solid, name, **walls, **ends))
    return out


@pytest.fixture(scope="module")
def mesh(tmp_path_factory):
    return mesh_step(step(tmp_path_factory.mktemp("plates"), *plates()), size=12e-3)


def dowels(pin=STEEL, **more):
    return [faying.Dowel(f"dowel {k}", (f"upper.pin {k}", f"lower.pin {k}"), material=pin, **more) for k in (1, 2)]


def joint(mesh):
    """A joint that presses and does not hold across."""
    faces = ("upper.joint", "lower.joint")
    return FittedJoint(name="joint", faces=faces, interface=join(mesh, *faces), law=even(2e13, 1.0))


def doweled(mesh, pin=STEEL, **more):
    """Plates whose joint does not hold across."""
    bolt = faying.Bolt("bolt", ("upper.seat", "lower.seat"))
    return faying.Structure(mesh, STEEL, [joint(mesh)], [bolt], dowels=dowels(pin), **more)


def pressed(structure):
    """Springs of its joints at an even pressure."""
    return structure.springs([np.full(len(one.interface.weights), 1e6) for one in structure.joints])


def energy(deep, order, material):
    """Compliance [m/N] of a pin between two rigid walls that slide, by the force per length of least energy.

    By antisymmetry the pin has no moment between the walls: over s = z/deep from there, forces q with
    int q = 1 and int q s = 0, of polynomials of an order; V = 1 - int q, M = int V.
    """
    E, nu = material.E, material.nu
    area, bending = pi / 4 * D**2, pi / 64 * D**4
    rigidity = 6 * (1 + nu) / (7 + 6 * nu) * E / (2 * (1 + nu)) * area
    powers = [Polynomial.basis(k) for k in range(order + 1)]
    forces = [-p.integ() for p in powers]
    moments = [v.integ() for v in forces]

    def product(one, other):
        """Twice the complementary energy that two shear forces with their moments share."""
        (v, m), (w, n) = one, other
        return deep * (v * w).integ()(1.0) / rigidity + deep**3 * (m * n).integ()(1.0) / (E * bending)

    sections = list(zip(forces, moments, strict=True))
    start = Polynomial([1.0]), Polynomial([0.0, 1.0])
    H = np.array([[product(one, other) for other in sections] for one in sections])
    h, rest = np.array([product(one, start) for one in sections]), product(start, start)
    C = np.array([[1 / (k + 1) for k in range(order + 1)], [1 / (k + 2) for k in range(order + 1)]])
    n = order + 1
    solved = np.linalg.solve(np.block([[H, C.T], [C, np.zeros((2, 2))]]), np.concatenate([-h, [1.0, 0.0]]))[:n]
    return 2 * (solved @ H @ solved + 2 * h @ solved + rest)


def slide(stiffness, counts, *, tilt=0.0):
    """Force between two walls that slide by 1."""
    motion = np.zeros(sum(counts) + 2)
    motion[0] = 1.0
    return float(motion @ stiffness @ motion)


@pytest.mark.parametrize("order", [1, 2, 4, ORDER])
def test_slide_of_rigid_plates_is_that_of_least_energy(order):
    depths = np.array([[-DEEP, 0.0], [0.0, DEEP]])
    found = slide(pin_stiffness(depths, [order, order], D, STEEL), [order, order])
    assert 1 / found == pytest.approx(energy(DEEP, order, STEEL), rel=1e-6)


def test_slide_with_forces_linear_in_depth_has_a_closed_form():
    """q = (4 - 6 s)/t: 2 (t^3/(105 E I) + 2 t/(15 kappa G A))."""
    depths = np.array([[-DEEP, 0.0], [0.0, DEEP]])
    bending, area, nu = pi / 64 * D**4, pi / 4 * D**2, STEEL.nu
    shear = 6 * (1 + nu) / (7 + 6 * nu) * STEEL.E / (2 * (1 + nu)) * area
    closed = 2 * (DEEP**3 / (105 * STEEL.E * bending) + 2 * DEEP / (15 * shear))
    assert 1 / slide(pin_stiffness(depths, [1, 1], D, STEEL), [1, 1]) == pytest.approx(closed, rel=1e-9)


def test_a_long_pin_between_walls_bends_as_a_beam_that_is_clamped():
    """12 E I/L^3 and shear in series, the nearer the longer the gap is beside the holes."""
    off = []
    for gap in (40 * D, 160 * D):
        depths = np.array([[-2 * D, 0.0], [gap, gap + 2 * D]])
        found = slide(pin_stiffness(depths, [ORDER, ORDER], D, STEEL), [ORDER, ORDER])
        shear = 6 * (1 + STEEL.nu) / (7 + 6 * STEEL.nu) * STEEL.E / (2 * (1 + STEEL.nu)) * pi / 4 * D**2
        beam = 1 / (gap**3 / (12 * STEEL.E * pi / 64 * D**4) + gap / shear)
        off.append(1 - found / beam)
    assert 0 < off[1] < 0.3 * off[0]
    assert off[1] < 0.02


def test_a_pin_through_three_parts_is_two_pins_side_by_side():
    """The middle part slides between two that are held: by symmetry the pin does not tilt, so twice one half of it."""
    t = DEEP
    depths = np.array([[-3 * t, -t], [-t, t], [t, 3 * t]])
    K = pin_stiffness(depths, [ORDER] * 3, D, STEEL)
    n = ORDER + 1
    motion = np.zeros(3 * n)
    motion[n] = 1.0
    forces = K @ motion
    assert forces[[0, n, 2 * n]].sum() == pytest.approx(0.0, abs=1e-9 * forces[n])
    assert forces[0] == pytest.approx(forces[2 * n], rel=1e-9)
    two = pin_stiffness(depths[:2], [ORDER] * 2, D, STEEL)
    assert motion[: 2 * n] @ two @ motion[: 2 * n] < motion @ K @ motion / 2


def test_rigid_motions_strain_no_dowel(mesh):
    for fitted in doweled(mesh).fitted_dowels:
        assert [wall.order for wall in fitted.walls] == [ORDER, ORDER]
        motions = rigid_motions(mesh.points)
        size = np.abs(motions).max(axis=0)
        forces = fitted.stiffness @ (motions / size)
        assert np.abs(forces).max() < 1e-9 * fitted.stiffness.diagonal().max()


def test_a_dowel_carries_no_force_along_its_axis_and_no_torque(mesh):
    fitted = doweled(mesh).fitted_dowels[0]
    upper = mesh.part_nodes("upper")
    lift, turn = np.zeros_like(mesh.points), np.zeros_like(mesh.points)
    lift[upper, 2] = 1.0
    arm = mesh.points[upper] - (12e-3, 20e-3, 0.0)
    turn[upper, 0], turn[upper, 1] = -arm[:, 1], arm[:, 0]
    across = np.zeros_like(mesh.points)
    across[upper, 0] = 1.0
    most = across.ravel() @ (fitted.stiffness @ across.ravel())
    assert lift.ravel() @ (fitted.stiffness @ lift.ravel()) < 1e-12 * most
    assert turn.ravel() @ (fitted.stiffness @ turn.ravel()) < 1e-12 * most * np.ptp(arm[:, 0]) ** 2


def test_even_heat_leaves_a_dowel_alone(mesh):
    fitted = doweled(mesh).fitted_dowels[0]
    grown = 1e-3 * mesh.points.ravel()
    across = np.zeros_like(mesh.points)
    across[mesh.part_nodes("upper"), 0] = 1e-3 * D
    assert fitted.shear(grown) < 1e-4 * fitted.shear(across.ravel())


def test_mass_of_a_pin_is_that_of_its_cylinder(mesh):
    fitted = doweled(mesh).fitted_dowels[0]
    for axis in range(3):
        motion = np.zeros_like(mesh.points)
        motion[:, axis] = 1.0
        assert motion.ravel() @ (fitted.mass @ motion.ravel()) == pytest.approx(
            STEEL.density * pi / 4 * D**2 * 2 * DEEP, rel=1e-5
        )


def test_slide_of_two_plates_has_the_frequency_of_their_masses_on_two_pins(mesh):
    """Pins a hundred thousand times softer than the plates, one of which is held and one slides, as rigid bodies."""
    pin = replace(STEEL, name="soft", E=STEEL.E / 1e5, density=1e-3)
    structure = doweled(mesh, pin, supports=HELD)
    K = structure.coupled(pressed(structure))[0]
    found = lowest_modes(K, structure.dynamic_matrices[1], 3, shift_frequency=50.0).frequencies
    stiffness = 2 / energy(DEEP, ORDER, pin)
    slides = np.sqrt(stiffness / structure.part_masses[list(mesh.parts).index("upper")]) / (2 * pi)
    # the other motion turns about the normal of the plates: both pins are 18 mm from the middle
    upper = mesh.part_nodes("upper")
    turn = np.zeros_like(mesh.points)
    arm = mesh.points[upper] - (30e-3, 20e-3, 0.0)
    turn[upper, 0], turn[upper, 1] = -arm[:, 1], arm[:, 0]
    inertia = turn.ravel() @ (structure.matrices[1] @ turn.ravel())
    turns = np.sqrt(stiffness * 18e-3**2 / inertia) / (2 * pi)
    assert found == pytest.approx(np.sort([slides, slides, turns]), rel=2e-3)


@pytest.mark.slow
def test_pins_share_a_force_evenly_and_carry_it_from_part_to_part(mesh):
    """1 kN along x on the upper plate, the lower one held; nothing but the pins holds it along x."""
    structure = doweled(mesh, supports=HELD)
    pull = np.zeros(mesh.unknowns)
    nodes = mesh.face_nodes("upper.seat")
    pull[3 * nodes] = 1e3 / len(nodes)
    pull[structure.fixed] = 0.0
    moved = factorise(structure.coupled(pressed(structure))[0]).solve(pull)
    for fitted in structure.fitted_dowels:
        forces = fitted.forces(moved)
        assert forces.sum(axis=0) == pytest.approx(0.0, abs=1e-6)
        assert np.abs(forces[:, 2]).max() < 1e-6 * np.abs(forces).max()
        assert fitted.shear(moved) == pytest.approx(np.linalg.norm(forces[0]), rel=1e-9)
        assert fitted.bearing(moved) == pytest.approx(fitted.shear(moved) / (D * DEEP), rel=1e-5)
    total = sum(
        fitted.forces(moved)[list(fitted.place.walls).index(f"upper.pin {k}")]
        for k, fitted in enumerate(structure.fitted_dowels, 1)
    )
    assert total[0] == pytest.approx(-1e3, rel=1e-6)


def sheared(mesh, K, parts, tied, map_of=None):
    """Twice the energy where the rim of the upper plate moves by 1, along x and y, and that of the lower is held."""
    out = []
    rim = {}
    for part in parts:
        nodes = mesh.part_nodes(part)
        x, y = mesh.points[nodes, 0], mesh.points[nodes, 1]
        rim[part] = nodes[(x < 1e-9) | (x > 60e-3 - 1e-9) | (y < 1e-9) | (y > 40e-3 - 1e-9)]
    for axis in (0, 1):
        held, moved = np.zeros(mesh.unknowns, dtype=bool), np.zeros(mesh.unknowns)
        for part in parts:
            held[3 * mesh.part_nodes(part) + 2] = True
            held[3 * rim[part]] = held[3 * rim[part] + 1] = True
        moved[3 * rim["upper"] + axis] = 1.0
        held[tied] = True
        if map_of is not None:
            few, where = np.zeros(K.shape[0], dtype=bool), np.zeros(K.shape[0])
            few[map_of[held]], where[map_of[held]] = True, moved[held]
            held, moved = few, where
        free = ~held
        matrix = K.tocsc()
        moved[free] = factorise(matrix[free][:, free].tocsr()).solve(-(matrix[free][:, held] @ moved[held]))
        out.append(moved @ (matrix @ moved))
    return np.array(out)


@pytest.mark.slow
def test_dowels_are_as_stiff_as_pins_that_are_meshed(mesh, tmp_path):
    """Meshed pins share the motion of the walls across their axes, and slide along them.

    The forces that a dowel spreads are polynomials, so it is the softer one.
    """
    from netgen.occ import Cylinder, Pnt, Z

    K, _ = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))
    ours = sheared(mesh, K + sum(one.stiffness for one in doweled(mesh).fitted_dowels), ("lower", "upper"), [])
    pins = [
        named(Cylinder(Pnt(x, 20, -10), Z, r=4, h=20), f"pin {k}", **{f"shank {k}": lambda f: abs(f.center.z) < 1e-6})
        for k, x in enumerate(PLACES, 1)
    ]
    solid = mesh_step(step(tmp_path, *plates(), *pins), size=12e-3)
    K, _ = assemble(solid, dict.fromkeys(solid.parts, STEEL))
    walls = np.unique(np.concatenate([solid.face_nodes(name) for name in NAMES]))
    shanks = np.unique(np.concatenate([solid.face_nodes(f"shank {k}") for k in (1, 2)]))
    apart = np.linalg.norm(solid.points[walls][:, None] - solid.points[shanks], axis=2)
    assert apart.min(axis=1).max() < 1e-9
    number = np.arange(solid.unknowns)
    for axis in (0, 1):
        number[3 * walls + axis] = 3 * shanks[apart.argmin(axis=1)] + axis
    _, column = np.unique(number, return_inverse=True)
    merge = csr_array((np.ones(len(column)), (np.arange(len(column)), column)))
    tied = [3 * solid.part_nodes(f"pin {k}")[0] + 2 for k in (1, 2)]  # or the pin would be free along its axis
    theirs = sheared(solid, (merge.T @ K @ merge).tocsr(), ("lower", "upper"), tied, column)
    assert np.all(ours < theirs)
    assert ours == pytest.approx(theirs, rel=0.05)


def rings(layers, around=16):
    """Two rings of bricks, one on the other: 8 mm inside, 24 mm outside, 10 mm thick."""
    angle = 2 * pi * np.arange(around) / around
    points, parts, faces = [], {}, {}
    for name, low in (("lower", -DEEP), ("upper", 0.0)):
        at = sum(map(len, points))
        heights = np.linspace(low, low + DEEP, layers + 1)
        points.append([(r * np.cos(a), r * np.sin(a), z) for z in heights for r in (4e-3, 12e-3) for a in angle])
        index = at + np.arange(2 * around * (layers + 1)).reshape(layers + 1, 2, around)
        turned = np.roll(index, -1, axis=2)
        inner, outer = (index[:, k] for k in (0, 1)), (turned[:, k] for k in (0, 1))
        (a, b), (d, c) = inner, outer
        cells = np.stack([a[:-1], b[:-1], c[:-1], d[:-1], a[1:], b[1:], c[1:], d[1:]], axis=-1).reshape(-1, 8)
        parts[name] = (cells,)
        flat = {f"{name}.pin": np.unique(index[:, 0]), f"{name}.joint": np.unique(index[-1 if low < 0 else 0])}
        faces |= {face: sides_on(nodes, (cells,), 2 * 2 * around * (layers + 1)) for face, nodes in flat.items()}
    owner = {face: face.partition(".")[0] for face in faces}
    return Mesh(points=np.concatenate(points), parts=parts, faces=faces, face_part=owner)


@pytest.mark.parametrize(("layers", "degree"), [(1, 1), (2, 3), (4, ORDER)])
def test_a_coarse_hole_has_a_lower_degree_and_a_note(layers, degree):
    """Two points over the depth of a brick; whatever the degree, rigid motions are free and slide is that of it."""
    mesh = rings(layers)
    pin = faying.Dowel("pin", ("lower.pin", "upper.pin"), material=STEEL)
    fitted = pin.fitted(mesh)
    assert [wall.order for wall in fitted.walls] == [degree, degree]
    motions = rigid_motions(mesh.points)
    assert np.abs(fitted.stiffness @ (motions / np.abs(motions).max(axis=0))).max() < 1e-8 * fitted.beam.max()
    slid = np.zeros_like(mesh.points)
    slid[mesh.part_nodes("upper"), 1] = 1.0
    assert slid.ravel() @ (fitted.stiffness @ slid.ravel()) == pytest.approx(1 / energy(DEEP, degree, STEEL), rel=1e-6)
    notes = faying.Structure(mesh, STEEL, [joint(mesh)], dowels=[pin]).notes
    said = [note.text for note in notes if note.code == "dowel-mesh"]
    assert len(said) == (degree < ORDER)
    assert all(f"pressures of degree {degree} over its depth" in text for text in said)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"walls": ("upper.pin 1", "lower.pin 2")}, "are not on one axis"),
        ({"walls": ("upper.pin 1", "upper.pin 2")}, "are not on one axis"),
        ({"walls": ("upper.pin 1", "lower.joint")}, "'lower.joint' is not the wall of a round hole"),
        ({"walls": ("upper.pin 1",)}, "name the walls of its holes"),
        ({"walls": ("upper.pin 1", "upper.pin 1")}, "names the wall 'upper.pin 1' twice"),
        ({"diameter": "7.5 mm"}, "7.5 mm thick, but the hole 'upper.pin 1' is 8 mm wide"),
        ({"ends": (("12 mm", "20 mm", "0 mm"), ("12 mm", "20 mm", "10 mm"))}, "does not reach the hole 'lower.pin 1'"),
        ({"material": "cheese"}, "cheese"),
        ({"diameter": "0 mm"}, "diameter"),
    ],
)
def test_what_is_no_dowel_is_refused(mesh, change, words):
    given = {"walls": ("upper.pin 1", "lower.pin 1"), "material": STEEL} | change
    with pytest.raises(faying.InputError, match=words):
        faying.Dowel("dowel", given.pop("walls"), **given).fitted(mesh)


def test_ends_cut_the_holes_to_what_holds_the_pin(mesh):
    ends = (("12 mm", "20 mm", "-6 mm"), ("12 mm", "20 mm", "10 mm"))
    short = faying.Dowel("short", ("upper.pin 1", "lower.pin 1"), material=STEEL, ends=ends).placed(mesh)
    assert np.sort(np.ptp(short.depths, axis=1)) == pytest.approx([6e-3, 10e-3])
    assert np.sort(short.seats[:, 2]) == pytest.approx([-6e-3, 10e-3])


def test_two_dowels_of_one_name_are_refused(mesh):
    with pytest.raises(faying.InputError, match="two dowels are called 'dowel 1'"):
        faying.Structure(mesh, STEEL, [joint(mesh)], dowels=[dowels()[0], dowels()[0]])


@pytest.mark.slow
def test_a_load_case_says_what_each_dowel_carries(mesh, tmp_path):
    """All of 1 kN along x, which the joint does not hold across."""
    structure = doweled(mesh, supports=[Support(face="lower.seat")])
    push = faying.Load("push", forces=[faying.Force("upper.end", force=(1e3, 0, 0))])
    found = faying.load_cases(structure.solve("5 kN", modes=1), [push], modes=False)
    assert found.dowels == ("dowel 1", "dowel 2")
    assert found.dowel_shear.sum() == pytest.approx(1e3, rel=1e-4)
    assert found.dowel_bearing == pytest.approx(found.dowel_shear / (D * DEEP), rel=1e-4)
    assert faying.load(found.save(tmp_path / "loads.nc")) == found
    assert "shear force by the load [N]" in terminal(found)
