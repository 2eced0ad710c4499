"""A law cut into springs with sliders: its sums, its microslip curve, and sums of asperities made without it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import faying
from faying.joint.joint_law import JointLaw
from faying.microslip.microslip import Microslip
from tests.helpers.laws import Given

STEEL = faying.CATALOGUE["45 steel"]
MU = 0.3
HERTZ = {"k_n": lambda p: 1e10 * np.cbrt(p), "k_t": lambda p: 0.82e10 * np.cbrt(p)}  # p = c w^1.5
ROOT = {"k_n": lambda p: 1e9 * np.sqrt(p), "k_t": lambda p: 0.7e9 * np.sqrt(p)}  # p = c w^2
LAWS = {
    "JK": JointLaw(model=faying.JK(D=2.39, G=1.53e-10, pair=faying.ContactPair(STEEL, STEEL), scan_area=16e-6)),
    "Hertz": JointLaw(model=Given(**HERTZ)),
    "yielding": JointLaw(model=Given(**ROOT, k_load=lambda p: 3e8 * p**0.45)),
    "in proportion": JointLaw(model=Given(k_n=lambda p: p / 0.4e-6)),
    "softening": JointLaw(model=Given(k_n=lambda p: 1e12 * (1 + p / 1e5) / (1 + (p / 1e6) ** 2))),
    "shallow": JointLaw(model=Given(k_n=lambda p: 1e12 + 0 * p)),
}


def at_pressure(law, pressures, **options):
    """The cut of a law at pressures [Pa], and the approaches there."""
    approach = np.array([law.approach(p) for p in np.atleast_1d(pressures)])
    return Microslip.cut(law, approach, **({"friction": MU} | options)), approach


def pressed(approach, slip=(0.0, 0.0)):
    """Motion (q, 3) that closes points by `approach`."""
    approach = np.atleast_1d(approach)
    return np.column_stack([-approach, np.broadcast_to(slip, (len(approach), 2))])


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("springs", [2, 7, 32])
def test_the_springs_sum_to_the_law_at_the_preload(name, springs):
    """p, k_n and k_t at the preload are those of the linear modes, to rounding, also beyond the ends of the law."""
    law = LAWS[name]
    approach = np.array([-1e-7, 0.0, *(law.approach(p) for p in (1e3, 1e5, 3e6, 2e7)), 1.2 * law.approach(1e8)])
    p, _ = law.pressure(approach)
    k_n, k_t = (np.where(p > 0, k, 0.0) for k in law.stiffness(p))
    cut = Microslip.cut(law, approach, friction=MU, springs=springs)
    assert np.all(cut.k_n >= 0)
    _, traction, tangent = cut.advance(cut.start(pressed(approach)), pressed(approach))
    assert traction[:, 0] == pytest.approx(-p, rel=1e-12)
    assert np.all(traction[:, 1:] == 0)
    assert tangent[:, 0, 0] == pytest.approx(k_n, rel=1e-12)
    assert tangent[:, 1, 1] == pytest.approx(k_t, rel=1e-12)
    assert tangent[:, 2, 2] == pytest.approx(k_t, rel=1e-12)
    one = Microslip.coulomb(law, approach, friction=MU)
    _, traction, tangent = one.advance(one.start(pressed(approach)), pressed(approach))
    assert traction[approach > 0, 0] == pytest.approx(-p[approach > 0], rel=1e-12)
    assert tangent[approach > 0, 0, 0] == pytest.approx(k_n[approach > 0], rel=1e-12)
    assert tangent[approach > 0, 1, 1] == pytest.approx(k_t[approach > 0], rel=1e-12)


@pytest.mark.parametrize("name", ["JK", "Hertz", "in proportion"])
def test_the_springs_follow_the_law_as_it_opens_and_closes(name):
    """Tangents of a convex curve lie below it: here by at most 2 %, while the pressure changes by a factor of ten."""
    law = LAWS[name]
    cut, (here,) = at_pressure(law, 3e6)
    depth = 3e6 / law.stiffness(np.array([3e6]))[0][0]
    for approach in here + depth * np.linspace(-0.9, 1.0, 20):
        p = -cut.advance(cut.start(pressed(here)), pressed(approach))[1][0, 0]
        exact = law.pressure(np.array([approach]))[0][0]
        assert exact - 0.02 * max(exact, 3e6) <= p <= exact * (1 + 1e-6)


@pytest.mark.parametrize("name", ["JK", "Hertz", "in proportion"])
@pytest.mark.parametrize("share", [0.01, 0.03, 0.1, 0.3])
def test_a_normal_motion_to_and_fro_meets_the_stiffness_of_the_law(name, share):
    """What opening takes from a smooth law's stiffness closing gives back: the first harmonic is the law's."""
    law = LAWS[name]
    cut, (here,) = at_pressure(law, 3e6)
    k = law.stiffness(np.array([3e6]))[0][0]
    X = np.zeros((3, 1, 3))
    X[0, 0, 0], X[1, 0, 0] = -here, share * 3e6 / k
    found = cut.cycle(X, derivative=False, samples=256).traction[1, 0, 0]
    wave = np.cos(2 * np.pi * np.arange(256) / 256)
    exact = -2 * np.mean(law.pressure(here - X[1, 0, 0] * wave)[0] * wave)
    assert found == pytest.approx(exact, rel=2e-3)


def test_points_that_are_open_close_as_the_law_says():
    law = LAWS["JK"]
    top = law.approach(5e6)
    cut = Microslip.cut(law, np.array([top, -2e-7, -1e-9]), friction=MU, gap=np.array([0.0, 2e-7, 1e-9]))
    for share in (0.01, 0.1, 0.5, 1.0):
        motion = pressed(np.full(3, share * top) + cut.gap - [0.0, 2e-7, 1e-9])
        motion[1:, 0] = -share * top - cut.gap[1:]
        p = -cut.advance(cut.start(motion), motion)[1][1:, 0]
        exact = law.pressure(np.array([share * top]))[0][0]
        assert p == pytest.approx(np.full(2, exact), rel=0.02)


@pytest.mark.filterwarnings("error")
def test_no_spring_lies_beyond_the_end_of_the_law():
    """Where a law grows a thousandfold in a few nanometres, points that carry little would reach far beyond it."""
    law = JointLaw(model=Given(greatest_pressure=5e6, k_n=lambda p: p / 4e-9))
    cut, here = at_pressure(law, (10.0, 4e6))
    k_end = law.stiffness(np.array([5e6]))[0][0]
    far = here + 1e-6
    p, k = (a[:, 0, 0] if a.ndim == 3 else -a[:, 0] for a in cut.advance(cut.start(pressed(far)), pressed(far))[1:])
    assert k == pytest.approx(np.full(2, k_end), rel=0.02)
    assert np.all(p < 1.1 * k_end * 1e-6)


def test_a_law_that_yields_springs_back_by_its_own_stiffness():
    """After loading by k_load the pressure falls along the curve by k_n: p = (c w/2)^2 for k_n = c sqrt(p)."""
    law = LAWS["yielding"]
    cut, (here,) = at_pressure(law, 4e6, springs=200)
    elastic = 2 * np.sqrt(4e6) / 1e9
    for back in (0.1, 0.5, 0.9):
        p = -cut.advance(cut.start(pressed(here)), pressed(here - back * elastic))[1][0, 0]
        assert p == pytest.approx(4e6 * (1 - back) ** 2, rel=2e-3, abs=2e2)


@pytest.mark.parametrize("name", ["JK", "Hertz", "in proportion"])
@pytest.mark.parametrize(("springs", "close"), [(32, 5e-3), (300, 2e-4)])
def test_slip_at_constant_approach_is_the_curve_of_the_law(name, springs, close):
    """t(u) = mu [p(w) - p(w - u k_t/(mu k_n))] (Ciavarella, Jaeger), to a share of mu p that falls with the springs."""
    law = LAWS[name]
    cut, here = at_pressure(law, 3e6, springs=springs)
    k_n, k_t = (float(k[0]) for k in law.stiffness(np.array([3e6])))
    limit = MU * 3e6
    for u in limit / k_t * np.array([0.05, 0.3, 1.0, 2.0, 30.0]):
        t = cut.advance(cut.start(pressed(here)), pressed(here, (0.6 * u, 0.8 * u)))[1][0, 1:]
        exact = limit - MU * law.pressure(here - u * k_t / (MU * k_n))[0][0]
        assert t == pytest.approx(exact * np.array([0.6, 0.8]), abs=close * limit)


def test_the_tangent_of_one_asperity_is_that_of_jk():
    """k_t (1 - T/(mu F))^(1/3), eq. (A11) of the JK paper, is the slope of Hertz's curve cut into springs."""
    law = LAWS["Hertz"]
    cut, here = at_pressure(law, 3e6, springs=1000)
    k_t = float(law.stiffness(np.array([3e6]))[1][0])
    limit = MU * 3e6
    for share in (0.0, 0.2, 0.5, 0.8, 0.95):
        u = 1.5 * limit / k_t * (1 - (1 - share) ** (2 / 3))
        _, t, tangent = cut.advance(cut.start(pressed(here)), pressed(here, (u, 0.0)))
        assert t[0, 1] == pytest.approx(share * limit, abs=1e-4 * limit)
        assert tangent[0, 1, 1] == pytest.approx(k_t * (1 - share) ** (1 / 3), rel=0.02)


def harmonic(here, slip, opening=(0.0, 0.0)):
    """Coefficients (3, 1, 3): slip times the cosine along the first direction, opening (cos, sin)."""
    found = np.zeros((3, 1, 3))
    found[0, 0, 0] = -here
    found[1, 0, 1] = slip
    found[1:, 0, 0] = opening
    return found


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_mindlins_spheres_dissipate_what_the_closed_form_says(share, published):
    """Mindlin and Deresiewicz 1953 (doi:10.1115/1.4010702): energy per cycle at constant force, to 1e-4.

    The cosine's ends are instants of the cycle, so that only the springs are a sum: 1000 of them.
    """
    law = LAWS["Hertz"]
    cut, here = at_pressure(law, 3e6, springs=1000)
    k_t, limit = float(law.stiffness(np.array([3e6]))[1][0]), MU * 3e6
    u = 1.5 * limit / k_t * (1 - (1 - share) ** (2 / 3))
    cycle = cut.cycle(harmonic(here[0], u), samples=512, derivative=False)
    rest = 1 - share
    exact = 7.2 * limit**2 / k_t * (1 - rest ** (5 / 3) - 5 / 6 * share * (1 + rest ** (2 / 3)))
    published(
        f"energy per area and cycle of spheres whose shear reaches {share:g} of the limit",
        exact,
        cycle.dissipated[0],
        unit="J/m2",
        rel=1e-4,
        source="Mindlin and Deresiewicz 1953, doi:10.1115/1.4010702",
        why="1000 springs stand for the law's curve",
    )


SIGMA, RADIUS, DENSITY, E_STAR = 0.5e-6, 50e-6, 1e9, 1e11


class Summits:
    """Sphere tips with Gaussian heights, summed one by one, and the law of their p(w) [w from 4 sigma above]."""

    def __init__(self, count=4000):
        self.heights = SIGMA * np.linspace(-4, 4, count)
        self.share = np.exp(-((self.heights / SIGMA) ** 2) / 2)
        self.share *= DENSITY / self.share.sum()
        self.stiff = 4 / 3 * E_STAR * np.sqrt(RADIUS)

    def indentation(self, approach):
        return np.maximum(self.heights - 4 * SIGMA + np.asarray(approach)[..., None], 0.0)

    def pressure(self, approach):
        return self.stiff * self.indentation(approach) ** 1.5 @ self.share

    def k_n(self, approach):
        return 1.5 * self.stiff * self.indentation(approach) ** 0.5 @ self.share

    def law(self, ratio):
        """Stiffness as a function of pressure, from a fine table."""
        w = SIGMA * np.linspace(0.05, 6, 3000)
        p, k = self.pressure(w), self.k_n(w)
        good = p > 1.0
        k_n = lambda q: np.exp(np.interp(np.log(np.maximum(q, 1e-9)), np.log(p[good]), np.log(k[good])))  # noqa: E731
        return JointLaw(model=Given(greatest_pressure=p[-1], k_n=k_n, k_t=lambda q: ratio * k_n(q)))


def test_a_rough_face_slips_like_the_sum_of_its_summits():
    """Each summit by Mindlin's solution, T = mu F [1 - (1 - 2 k_t u/(3 mu F))^1.5]; 32 springs give 1e-3 of mu p.

    That is the mean over slips from .02 to 2 sigma; the tangents are exact at the cells' ends and worst between them.
    """
    summits, ratio = Summits(), 0.82
    law = summits.law(ratio)
    p = 2e6
    cut, here = at_pressure(law, p)
    wide = np.linspace(0, 6 * SIGMA, 60001)
    own = np.interp(p, summits.pressure(wide[::20]), wide[::20])  # approach in the summits' own measure
    depth = summits.indentation(own)
    force, k_t = summits.stiff * depth**1.5, ratio * 1.5 * summits.stiff * depth**0.5
    slips = SIGMA * np.geomspace(0.02, 2, 40)
    missing = []
    for u in slips:
        left = np.maximum(1 - 2 * k_t * u / (3 * MU * np.where(force > 0, force, 1.0)), 0.0) ** 1.5
        exact = float(MU * force * (1 - left) @ summits.share)
        t = cut.advance(cut.start(pressed(here)), pressed(here, (u, 0.0)))[1][0, 1]
        missing.append((t - exact) / (MU * p))
    assert abs(np.mean(missing)) < 1e-3
    assert np.max(np.abs(missing)) < 5e-3


@pytest.mark.parametrize(("turn", "slip"), [(np.pi / 2, 0.1), (np.pi / 2, 0.4), (0.0, 0.1), (1.0, 0.3)])
def test_a_normal_load_out_of_phase_against_summits_marched_one_by_one(turn, slip):
    """Slip U cos(a), approach w0 + .4 sigma cos(a - turn): each summit as 60 rings that slip by themselves.

    Rings of a summit carry what its Hertzian force gains as it closes; they are marched with 4000 small steps, without
    the sliders of the library. In phase, a load whose friction grows faster than the shear leaves no loss.
    """
    summits, ratio, p = Summits(count=400), 0.82, 2e6
    law = summits.law(ratio)
    cut, here = at_pressure(law, p, springs=64)
    wide = np.linspace(0, 6 * SIGMA, 6001)
    own = float(np.interp(p, summits.pressure(wide), wide))
    swing, slide = 0.4 * SIGMA, slip * SIGMA
    rings = np.linspace(0.0, 1.0, 60, endpoint=False) + 1 / 120
    reach = own + 1.1 * swing
    tips = 4 * SIGMA - summits.heights
    here_open = tips < reach
    tips, share = tips[here_open], summits.share[here_open]
    top = reach - tips
    onset = tips[:, None] + top[:, None] * rings**2  # equal rises of the stiffness, which grows as a root
    k = (1.5 * summits.stiff * np.sqrt(top) / 60 * share)[:, None] * np.ones(60)
    stretch, last = np.zeros_like(onset), 0.0
    phases = 2 * np.pi * np.arange(4000) / 2000
    shear = []
    for a in phases:
        u, w = slide * np.cos(a), own + swing * np.cos(a - turn)
        limit = MU / ratio * np.maximum(w - onset, 0.0)
        stretch = np.clip(stretch + u - last, -limit, limit)
        last = u
        shear.append(ratio * float(np.sum(k * stretch)))
    second = np.array(shear[2000:])
    exact = np.array([second @ np.cos(phases[:2000]), second @ np.sin(phases[:2000])]) / 1000
    motion = harmonic(here[0], slide, (-swing * np.cos(turn), -swing * np.sin(turn)))
    cycle = cut.cycle(motion, samples=256, derivative=False)
    size = np.hypot(*exact)
    assert cycle.traction[1:, 0, 1] == pytest.approx(exact, abs=4e-3 * size)
    loss = np.pi * slide * -exact[1]  # exact work of the shear on the slip
    assert cycle.dissipated[0] == pytest.approx(loss, abs=5e-3 * max(loss, MU * p * slide * 0.05))
    if turn == 0:
        assert slide < MU / ratio * swing
        assert cycle.dissipated[0] < 1e-6 * MU * p * slide


@pytest.mark.parametrize("make", [Microslip.cut, Microslip.coulomb])
def test_endless_friction_sticks_and_none_carries_no_shear(make):
    law = LAWS["JK"]
    here = np.array([law.approach(p) for p in (1e5, 3e6)])
    rng = np.random.default_rng(3)
    motion = rng.normal(size=(7, 2, 3)) * 1e-3 * here[:, None]
    motion[0, :, 0] = -here
    motion[1:, :, 0] = 0.0
    stuck = make(law, here, friction=1e9).cycle(motion)
    k_t = law.stiffness(law.pressure(here)[0])[1]
    assert stuck.traction[:, :, 1:] == pytest.approx(k_t[:, None] * motion[:, :, 1:], rel=1e-12)
    assert np.all(stuck.slipping == 0)
    assert stuck.dissipated == pytest.approx(0.0, abs=1e-12 * float(np.max(k_t) * np.max(np.abs(motion)) ** 2))
    free = make(law, here, friction=0.0).cycle(motion)
    assert np.all(free.traction[:, :, 1:] == 0)
    assert np.max(np.abs(free.derivative.reshape(2, 7, 3, 7, 3)[:, :, 1:])) < 1e-6 * np.min(k_t)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), share=st.floats(0.02, 0.6), law=st.sampled_from(["JK", "Hertz", "yielding"]))
def test_derivatives_are_those_of_finite_differences(seed, share, law):
    """Of a cycle and of a step, in two directions of slip, with points that open."""
    rng = np.random.default_rng(seed)
    law = LAWS[law]
    p = 10 ** rng.uniform(4, 7, 6)
    cut, here = at_pressure(law, p, springs=12)
    depth = p / law.stiffness(p)[0]
    x = rng.normal(size=(5, 6, 3)) * share * depth[:, None] * np.array([1, 1, 1, 0.4, 0.4])[:, None, None]
    x[0, :, 0] -= here
    along = rng.normal(size=x.shape) * depth[:, None]
    start = cut.start(pressed(here))
    cycle = cut.cycle(x, samples=32, start=start)
    flat = lambda y: np.moveaxis(y, 0, 1).reshape(6, -1)  # noqa: E731
    step = 1e-7
    ends = [cut.cycle(x + s * along, samples=32, start=start, derivative=False).traction for s in (step, -step)]
    change = flat(ends[0] - ends[1]) / (2 * step)
    found = np.einsum("qij,qj->qi", cycle.derivative, flat(along))
    # a slider that starts or ends to slip at an instant within the step is seen by the difference alone
    assert found == pytest.approx(change, abs=3e-3 * float(np.max(np.abs(change))))
    assert np.median(np.abs(found - change)) < 1e-6 * np.max(np.abs(change))

    state = cut.advance(start, pressed(here, (0.3 * depth[0], 0.1 * depth[0])))[0]
    to, by = x[0] + x[1], along[0]
    tangent = cut.advance(state, to)[2]
    ends = [cut.advance(state, to + s * by)[1] for s in (step, -step)]
    change = (ends[0] - ends[1]) / (2 * step)
    assert np.einsum("qij,qj->qi", tangent, by) == pytest.approx(change, abs=1e-4 * float(np.max(np.abs(change))))


@pytest.mark.parametrize("friction", [-0.1, np.nan, np.inf])
def test_a_friction_that_is_none_is_refused(friction):
    law = LAWS["Hertz"]
    with pytest.raises(faying.InputError, match="finite number of 0 or more"):
        Microslip.cut(law, np.array([law.approach(1e6)]), friction=friction)


def test_a_joint_that_is_wholly_open_is_refused():
    with pytest.raises(faying.InputError, match="no point of the joint is closed"):
        Microslip.cut(LAWS["Hertz"], np.array([-1e-6, 0.0]), friction=0.2)
    with pytest.raises(faying.InputError, match="give 2 or more"):
        Microslip.cut(LAWS["Hertz"], np.array([1e-6]), friction=0.2, springs=1)
