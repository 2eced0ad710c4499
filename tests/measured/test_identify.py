from dataclasses import replace

import numpy as np
import pytest

from faying import FRF, InputError, identify_modes
from faying.measured.lsfd import compressed, refine, residues
from faying.measured.mac import mac
from faying.measured.poles import Rule, poles_by_order, tracks
from faying.measured.text import read_frf_text
from faying.measured.uff import read_uff
from tests.helpers.hits import frf_of_hit

MODES = ((60.0, 0.01), (180.0, 0.005), (420.0, 0.004), (620.0, 0.01), (870.0, 0.002))
CLOSE = ((300.0, 0.004), (303.0, 0.006), (620.0, 0.01))  # 3 Hz apart, 2.4 and 3.6 Hz wide


def poles_of(modes):
    f, z = np.array(modes).T
    return 2 * np.pi * f * (-z + 1j * np.sqrt(1 - z**2))


@pytest.mark.parametrize("quantity", ["receptance", "mobility", "accelerance"])
def test_without_noise_the_modes_come_out_exactly(synthetic, quantity):
    frf, shapes = synthetic(MODES, quantity=quantity)
    found = identify_modes(frf)
    np.testing.assert_allclose(found.modes.frequencies, [f for f, _ in MODES], rtol=1e-7)
    np.testing.assert_allclose(found.modes.loss_factors, [2 * z for _, z in MODES], rtol=1e-5)
    np.testing.assert_allclose(np.diag(mac(found.modes.shapes, shapes)), 1, atol=1e-9)
    assert found.misfit < 1e-6


def test_residues_of_proportional_damping_are_the_shapes_over_twice_the_frequency(synthetic):
    """A = phi_o phi_i / (2 i w_d) (Ewins 2000, section 2.4)."""
    frf, shapes = synthetic(MODES, quantity="receptance")
    used = frf.band(1, 1000)
    s = poles_of(MODES)
    found, fit = residues(s, used.frequency, used.rows(), "receptance")
    np.testing.assert_allclose(found, shapes * shapes[:, :1] / (2j * s.imag[:, None]), rtol=1e-7)
    np.testing.assert_allclose(fit, used.rows(), rtol=1e-8)


def test_residuals_stand_for_what_lies_outside_the_band(synthetic):
    """Of five modes only those in the band are found, and a fit with residuals is far better than the modes alone."""
    frf, _ = synthetic(MODES)
    found = identify_modes(frf, band=(120, 700))
    np.testing.assert_allclose(found.modes.frequencies, [180, 420, 620], rtol=2e-4)
    assert found.misfit < 0.02


def test_close_modes_with_noise(synthetic):
    frf, shapes = synthetic(CLOSE, outputs=12, noise=0.002)
    modes = identify_modes(frf).modes
    np.testing.assert_allclose(modes.frequencies, [f for f, _ in CLOSE], rtol=3e-4)
    np.testing.assert_allclose(modes.loss_factors, [2 * z for _, z in CLOSE], rtol=0.02)
    assert np.diag(mac(modes.shapes, shapes)).min() > 0.99


@pytest.mark.parametrize("noise", [0.01, 0.05])
@pytest.mark.parametrize("seed", range(4))
def test_noise_bias_of_the_linear_estimate_is_gone_after_refinement(synthetic, noise, seed):
    """Noise of 1 and 5 % of the rms: damping within 5 % (its intervals hold it), nothing found that is not there."""
    frf, _ = synthetic(MODES, noise=noise, seed=seed)
    modes = identify_modes(frf).modes
    true = np.array(MODES)
    for f, loss, (low, high) in zip(modes.frequencies, modes.loss_factors, modes.loss_interval, strict=True):
        k = int(np.argmin(np.abs(true[:, 0] - f)))
        assert abs(f / true[k, 0] - 1) < 5e-4
        strong = true[k, 0] > 100
        assert loss == pytest.approx(2 * true[k, 1], rel=0.05 if strong else 0.25)
        assert low <= 2 * true[k, 1] * 1.02
        assert high >= 2 * true[k, 1] * 0.98
    assert len(modes.frequencies) >= 3


def test_the_standard_errors_are_those_of_repeated_tests(synthetic):
    """Over 40 tests of the same structure the scatter of the refined values is what one test states."""
    start = poles_of(MODES)
    values, stated = [], []
    for seed in range(40):
        frf, _ = synthetic(MODES[:3], noise=0.0)
        noisy = np.random.default_rng(seed).standard_normal((2, *frf.values.shape)) * 0.02 * np.abs(frf.values).mean()
        rows = (frf.values + noisy[0] + 1j * noisy[1])[:, 0, 20:600]
        one = refine(start[:3], frf.frequency[20:600], rows, "accelerance")
        assert one.converged
        values.append(np.concatenate([np.abs(one.poles) / (2 * np.pi), -one.poles.real / np.abs(one.poles)]))
        stated.append(np.concatenate([one.frequency_error, one.damping_error]))
    ratio = np.std(values, axis=0, ddof=1) / np.mean(stated, axis=0)
    assert np.all((ratio > 0.6) & (ratio < 1.5))  # 99.9 % range of a standard deviation from 40 values: .65 to 1.4
    bias = (np.mean(values, axis=0) - np.ravel(np.array(MODES[:3]).T)) / (np.mean(stated, axis=0) / np.sqrt(40))
    assert np.abs(bias).max() < 4


@pytest.mark.slow
def test_many_frfs_are_compressed_without_loss(synthetic):
    """Two hundred pairs: the dozen directions that the modes and residuals fill hold all that the poles need."""
    frf, shapes = synthetic(MODES, outputs=200, noise=0.003, last=950.0)
    rows = frf.band(1, 950).rows()
    small = compressed(rows, 12)
    assert small.shape == (12, rows.shape[1])
    modes = identify_modes(frf).modes
    np.testing.assert_allclose(modes.frequencies, [f for f, _ in MODES], rtol=1e-4)
    np.testing.assert_allclose(modes.loss_factors, [2 * z for _, z in MODES], rtol=0.02)
    assert np.diag(mac(modes.shapes, shapes)).min() > 0.99
    clean, _ = synthetic(MODES, outputs=200)
    s = poles_of(MODES)
    band = clean.band(1, 950)
    a, _ = residues(s, band.frequency, band.rows(), "accelerance")
    b, _ = residues(s, band.frequency, compressed(band.rows(), 12), "accelerance")
    np.testing.assert_allclose(mac(a, a), mac(b, b), atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1), rtol=1e-9)


def test_a_roving_hammer_and_a_roving_sensor_give_the_same_shapes(synthetic):
    frf, _ = synthetic(MODES)
    turned = FRF(
        frequency=frf.frequency,
        values=frf.values.transpose(1, 0, 2),
        outputs=frf.inputs,
        inputs=frf.outputs,
        quantity=frf.quantity,
    )
    a, b = identify_modes(frf).modes, identify_modes(turned).modes
    assert a.dofs == b.dofs
    np.testing.assert_allclose(a.shapes, b.shapes, atol=1e-9)


def test_several_inputs(synthetic):
    frf, shapes = synthetic(MODES, outputs=6, inputs=2, noise=0.001)
    modes = identify_modes(frf).modes
    assert modes.shapes.shape == (5, 6)
    assert np.diag(mac(modes.shapes, shapes)).min() > 0.99


@pytest.mark.parametrize("missing", ["half of a reference", "all but a row and a column", "a chain of pairs"])
def test_pairs_that_were_not_measured_leave_the_shapes_as_they_are(synthetic, missing):
    """The matrix of residues is of rank one: taken for zeros, half of one column cost 28 % of MAC."""
    frf, shapes = synthetic(MODES[:4], outputs=8, inputs=8)
    known = np.zeros((8, 8), bool)
    if missing == "half of a reference":
        known[:, 0], known[:4, 3] = True, True
    elif missing == "a chain of pairs":
        for k in range(8):
            known[k, k], known[k, max(k - 1, 0)] = True, True
    else:
        known[:, 0], known[0] = True, True
    values = np.where(known[:, :, None], frf.values, np.nan)
    found = identify_modes(replace(frf, values=values))
    assert len(found.modes.dofs) == 8
    assert found.frf.warnings == ()
    np.testing.assert_allclose(np.diag(mac(found.modes.shapes, shapes)), 1, atol=1e-6)


def test_noise_is_averaged_over_the_pairs_that_were_measured(synthetic):
    frf, shapes = synthetic(MODES[:3], outputs=8, inputs=2, noise=0.01)
    values = frf.values.copy()
    values[6:, 1] = np.nan
    modes = identify_modes(replace(frf, values=values)).modes
    assert np.diag(mac(modes.shapes, shapes)).min() > 0.99


def test_outputs_that_nothing_joins_are_left_out_of_the_shapes_and_named(synthetic):
    frf, shapes = synthetic(MODES[:3], outputs=8, inputs=2)
    values = frf.values.copy()
    values[:3, 1], values[3:, 0] = np.nan, np.nan
    found = identify_modes(replace(frf, values=values))
    assert [dof.point for dof in found.modes.dofs] == [4, 5, 6, 7, 8]
    np.testing.assert_allclose(np.diag(mac(found.modes.shapes, shapes[:, 3:])), 1, atol=1e-6)
    assert found.frf.warnings == (
        "shapes are without 1+z, 2+z, 3+z: no FRFs join them to the others; measure all from one point",
    )


def test_the_rule_follows_a_pole_and_lets_go_of_one_that_jumps(synthetic):
    """Poles made by hand: one that drifts by half its tolerances, one that jumps by twice, one negatively damped."""
    frf, _ = synthetic(MODES[1:2])
    used, rule = frf.band(1, 1000), Rule(highest_order=12, orders=5)
    drift = [poles_of([(180 * 1.005**k, 0.005 * 1.02**k)])[0] for k in range(12)]
    jump = [poles_of([(300 * 1.02**k, 0.01)])[0] for k in range(12)]
    grows = [poles_of([(700, -0.01)])[0]] * 12
    diagram, found = tracks(used, [np.array(p) for p in zip(drift, jump, grows, strict=True)], rule)
    assert len(found) == 1
    np.testing.assert_array_equal(found[0], drift)
    assert not np.any(np.abs(diagram.frequency - 700) < 1)


def test_two_poles_of_one_order_never_belong_to_one_mode(synthetic):
    frf, _ = synthetic(CLOSE)
    used = frf.band(1, 1000)
    diagram, _ = tracks(used, poles_by_order(used, 40), Rule())
    for track in range(diagram.track.max() + 1):
        orders = diagram.order[diagram.track == track]
        assert len(set(orders)) == len(orders) >= 8


def test_a_gap_longer_than_the_rule_ends_a_track(synthetic):
    frf, _ = synthetic(MODES[1:2])
    s, none = poles_of(MODES[1:2]), np.zeros(0, complex)
    order = [s, s, s, none, none, s, s, s]
    used = frf.band(1, 1000)
    assert len(tracks(used, order, Rule(highest_order=8, orders=6, gap=3))[1]) == 1
    assert len(tracks(used, order, Rule(highest_order=8, orders=6, gap=2))[1]) == 0


def test_a_resonance_between_two_lines_is_said_to_be_so(synthetic):
    frf, _ = synthetic(((250.3, 0.0005), (600.0, 0.01)))
    modes = identify_modes(frf).modes
    assert "narrower than the 1 Hz" in modes.notes[0][0]
    assert modes.notes[1] == ()


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_the_sign_of_time_is_found_from_the_poles(synthetic, noise):
    """FRFs with exp(-i w t) are the complex conjugates; modes and fit are then those of FRFs with exp(i w t)."""
    frf, _ = synthetic(MODES[:2], noise=noise)
    right, turned = identify_modes(frf), identify_modes(replace(frf, values=frf.values.conj()))
    np.testing.assert_allclose(turned.modes.frequencies, right.modes.frequencies, rtol=1e-9)
    np.testing.assert_allclose(turned.modes.loss_factors, right.modes.loss_factors, rtol=1e-6)
    np.testing.assert_allclose(turned.fit, right.fit, rtol=1e-6, atol=1e-9 * np.abs(right.fit).max())
    assert right.frf.warnings == ()
    assert "their conjugates are taken" in turned.frf.warnings[0]


def test_coherence_that_is_not_used_is_said(synthetic):
    frf, _ = synthetic(MODES[:1], outputs=1)
    found = identify_modes(replace(frf, coherence=np.ones(frf.values.shape)))
    assert "coherence" in found.frf.warnings[0]


def test_real_frfs(measured_frfs):
    """The six modes of the measured beam, in each of the three forms of its file, within half a Hertz."""
    texts = [measured_frfs / f"meas_point_{k}.txt" for k in (1, 2, 3)]
    for frf in (
        read_uff(measured_frfs / "derived_3frf_accelerance.uff").frf(),
        read_frf_text(texts, quantity="accelerance", frequency_step=1.0),
    ):
        for refined in (True, False):
            found = identify_modes(frf, refined=refined)
            np.testing.assert_allclose(found.modes.frequencies, [51.5, 142.2, 278.7, 460.4, 687.2, 958.5], atol=0.1)
            assert found.misfit < 0.05
            assert np.all(found.modes.loss_interval[:, 0] < found.modes.loss_interval[:, 1])
            assert all("narrower than the 1 Hz" in notes[0] for notes in found.modes.notes)


def test_real_frfs_are_those_of_a_slender_beam(measured_frfs):
    """From the second mode on the frequencies stand near the squares of odd numbers, as a beam's do: (2k + 1)^2."""
    modes = identify_modes(read_uff(measured_frfs / "derived_3frf_accelerance.uff").frf()).modes
    k = np.arange(1, 7)
    np.testing.assert_allclose(modes.frequencies / modes.frequencies[0], ((2 * k + 1) / 3) ** 2, rtol=0.03)


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"orders": 90}, "lower orders or raise highest_order"),
        ({"frequency": 0.0}, "tolerances must be positive"),
    ],
)
def test_rules_that_cannot_be(given, match):
    with pytest.raises(InputError, match=match):
        Rule(**given)


def test_frfs_that_hold_no_mode():
    noise = np.random.default_rng(0).standard_normal((3, 1, 401))
    frf = FRF(
        frequency=np.arange(401.0),
        values=noise,
        outputs=[(k, "z") for k in range(3)],
        inputs=[(1, "z")],
        quantity="accelerance",
    )
    with pytest.raises(InputError, match="no pole stays over 20 of 30 orders.*loosen the rule"):
        identify_modes(frf, rule=Rule(highest_order=30, orders=20))


@pytest.mark.parametrize("count", [1, 3, 20])
@pytest.mark.parametrize("seed", range(3))
def test_noise_alone_holds_no_mode(count, seed):
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal((count, 1, 401)) + 1j * rng.standard_normal((count, 1, 401))
    frf = FRF(
        frequency=np.arange(401.0),
        values=noise,
        outputs=[(k, "z") for k in range(count)],
        inputs=[(1, "z")],
        quantity="accelerance",
    )
    with pytest.raises(InputError, match="no pole stays over 10 of 50 orders"):
        identify_modes(frf)


def test_lines_that_the_estimator_cannot_take(synthetic):
    frf, _ = synthetic(MODES)
    with pytest.raises(InputError, match="at most 25"):
        identify_modes(frf.band(100, 200), rule=Rule(highest_order=40))
    shifted = FRF(
        frequency=frf.frequency + 0.4, values=frf.values, outputs=frf.outputs, inputs=frf.inputs, quantity="mobility"
    )
    with pytest.raises(InputError, match="not a multiple of the spacing"):
        identify_modes(shifted)


def test_a_window_that_took_all_the_damping():
    rate, n = 1024.0, 1024
    t = np.arange(n) / rate
    force = np.zeros(n)
    force[0] = rate
    response = np.exp(-0.2 * t) * np.sin(2 * np.pi * 100 * t) / (2 * np.pi * 100)
    frf = frf_of_hit(force, response, rate, "receptance", decay=9.0)
    wrong = FRF(
        **{k: getattr(frf, k) for k in ("frequency", "values", "outputs", "inputs", "quantity")}, window_decay=15.0
    )
    modes = identify_modes(wrong, band=(20, 200)).modes
    assert any("no damping is left" in note for note in modes.notes[0])
