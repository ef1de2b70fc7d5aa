"""Sampled loops in w: exact responses, stability as of the matrix of a sample, noise as by Lyapunov's equation."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov
from tests.physics.loops.sampled_loops import RIB, TANKER, SampledMatrices, sampled_loop

from seatrial.core.values import InputError
from seatrial.physics.loops import Block, LoopSignal, Performance, Sampling, margins, variance
from seatrial.physics.loops.discrete import ringing_blocks
from seatrial.physics.loops.encounter_spectrum import disturbance_spectrum
from seatrial.physics.loops.loop import held
from seatrial.physics.loops.performance import calm_actuator
from seatrial.physics.loops.structures import SERVO, fin_loop

SAMPLINGS = [Sampling(1.0, 0.2), Sampling(0.1, 0.2), Sampling(0.02, 0.5), Sampling(0.5), Sampling(0.5, 1.3)]


@pytest.mark.parametrize("sampling", SAMPLINGS, ids=str)
@pytest.mark.parametrize("plant", [RIB, TANKER], ids=lambda p: p.name)
def test_the_response_is_that_of_the_samples(plant: Block, sampling: Sampling) -> None:
    loop = sampled_loop(plant, sampling)
    made = SampledMatrices(loop.with_gains(0.0 * loop.gain_values + np.array([1.0, 0.0, 0.0])))
    omega = np.geomspace(1e-3, sampling.highest, 60)
    z = np.exp(1j * omega * sampling.sample_s)
    # with KP alone order = -(psi + n): L = T / (1 - T), T = -psi / n
    psi = np.array([made.c @ np.linalg.solve(one * np.eye(made.size) - made.M, made.N) for one in z])
    seen = held((*loop.servo, loop.plant), sampling).frequency_response(sampling.in_w(omega))
    np.testing.assert_allclose(-psi / (1.0 + psi), seen, rtol=1e-6)


def test_fins_behind_a_gyro_are_the_continuous_loop_at_short_samples() -> None:
    loop = fin_loop()
    fast = replace(loop, sampling=Sampling(1e-3))
    omega = np.geomspace(0.1, 5.0, 30)
    late = np.exp(-0.5e-3j * omega)  # of the hold: half a sample
    np.testing.assert_allclose(fast.open_loop(omega), loop.open_loop(omega) * late, rtol=2e-4)
    np.testing.assert_allclose(fast.plant_response(omega), loop.plant.frequency_response(omega), rtol=1e-3)
    assert SERVO in fast.servo


@pytest.mark.parametrize("sampling", SAMPLINGS, ids=str)
@pytest.mark.parametrize("plant", [RIB, TANKER], ids=lambda p: p.name)
def test_stability_is_that_of_the_matrix_of_a_sample(plant: Block, sampling: Sampling) -> None:
    base, rng, seen = sampled_loop(plant, sampling), np.random.default_rng(1), set()
    for _ in range(40):
        loop = base.with_gains(base.gain_values * np.exp(rng.uniform(-3.0, 3.0, 3)))
        largest = np.abs(np.linalg.eigvals(SampledMatrices(loop).M)).max()
        if abs(largest - 1.0) > 1e-6:
            assert margins(loop).is_stable == (largest < 1.0)
            seen.add(bool(largest < 1.0))
    assert seen == {True, False}


def test_margins_in_gain_and_delay_are_where_the_sampled_loop_is_lost() -> None:
    base = sampled_loop(RIB, Sampling(0.1, 0.2))
    loop = base.with_gains(0.5 * base.gain_values)
    found = margins(loop)
    for share, stands in ((0.99, True), (1.01, False)):
        assert margins(loop.with_gains(share * found.gain * loop.gain_values)).is_stable == stands
        late = replace(loop, sampling=Sampling(0.1, 0.2 + share * found.delay))
        assert margins(late).is_stable == stands


def test_noise_and_steps_of_reading_are_in_every_variance() -> None:
    base = sampled_loop(RIB, Sampling(0.1, 0.2, noise=0.01, resolution=0.02))
    loop = base.with_gains(0.4 * base.gain_values)
    rows = tuple(
        row
        for signal, power in ((LoopSignal.OUTPUT, 0), (LoopSignal.ACTUATOR, 0))
        for row in variance("", "", signal, power).variances
    )
    still = disturbance_spectrum(lambda w: 0.0 * w, 1e-3, 1.0, RIB, "nothing")
    output, _ = Performance(loop, still, rows).evaluate(loop.gain_values).variances[0]
    made = SampledMatrices(loop)
    X = solve_discrete_lyapunov(made.M, np.outer(made.N, made.N) * (0.01**2 + 0.02**2 / 12.0))
    # looked at up to 0.999 of the Nyquist frequency
    assert output == pytest.approx(made.c @ X @ made.c, rel=1e-3)
    quiet = replace(loop, sampling=Sampling(0.1, 0.2))
    assert not Performance(quiet, still, rows).evaluate(loop.gain_values).variances.any()


def test_the_actuator_in_calm_water_is_moved_by_the_samples_errors_alone() -> None:
    """Without a lag the order is what acts: its variance over all frequencies by Lyapunov, sharpened by the hold."""
    base = sampled_loop(RIB, Sampling(0.1, 0.2, noise=0.01), gear=0.0)
    loop = base.with_gains(0.2 * base.gain_values * [1.0, 1.0, 0.0])
    made = SampledMatrices(loop)
    X = solve_discrete_lyapunov(made.M, 1e-4 * np.outer(made.N, made.N))
    ordered = made.k @ X @ made.k + 1e-4 * made.d**2
    rms_angle, _ = calm_actuator(loop)
    # white orders of one sample: the hold passes the mean of sinc^2 up to the Nyquist frequency, 0.7737
    assert 0.7 * ordered < rms_angle**2 < ordered
    assert calm_actuator(replace(loop, sampling=Sampling(0.1, 0.2)))[1] == 0.0


def test_slopes_of_variances_with_noise_are_their_differences() -> None:
    loop = sampled_loop(RIB, Sampling(0.1, 0.2, noise=0.01))
    loop = loop.with_gains(0.4 * loop.gain_values)
    rows = (*variance("", "", LoopSignal.OUTPUT).variances, *variance("", "", LoopSignal.ACTUATOR, 1).variances)
    met = disturbance_spectrum(lambda w: 1e-3 / (w**2 + 0.04), 1e-3, 10.0, RIB, "slow")
    made, k, h = Performance(loop, met, rows), loop.gain_values, 1e-5
    steps = h * np.eye(3)
    apart = made.evaluate(np.concatenate([k + steps, k - steps])).variances
    np.testing.assert_allclose(made.variance_gradients(k), ((apart[:3] - apart[3:]) / (2.0 * h)).T, rtol=1e-5)


def test_blocks_that_ring_are_named_and_impossible_samplings_refused() -> None:
    loop = sampled_loop(RIB, Sampling(0.1))
    assert ringing_blocks(loop, 0.1) == ()
    assert ringing_blocks(loop, 0.3) == ("derivative",)
    with pytest.raises(InputError, match=r"sample time of 0\.0075 s or more"):
        Sampling(0.001, 0.3)
    with pytest.raises(InputError, match="is none"):
        Sampling(-1.0)
