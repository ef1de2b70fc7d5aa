"""Stabilisers at sea: seas have the energy they should, linear runs the variance, pairs an interval."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from tests.control.fin_tasks import HULL, KNOT, PUBLISHED
from tests.control.fin_tasks import sampled_fin_task as fin_task

from seatrial.control.simulation import (
    compare_pairwise,
    disturbance_series,
    effect_amplitudes,
    energy_saving,
    frequency_band,
    seaway_reductions,
    simulate_in_seaway,
    sum_harmonics,
    wave_components,
)
from seatrial.control.task import (
    ActuatorSpread,
    Effectiveness,
    PlantUncertainty,
    Seaway,
    SimulationSettings,
    TrimmedShip,
    TuningTask,
)
from seatrial.core.results.tuning import SeawaySimulation
from seatrial.core.values import InputError
from seatrial.physics.loops import ActuatorDrive, LiftingSurface, LoopSignal, Performance, Sampling
from seatrial.physics.loops.loop_states import plant_model
from seatrial.physics.loops.objective import variance
from seatrial.physics.loops.performance import calm_actuator, distinct_variances
from seatrial.physics.loops.structures import Preamplifier, fin_loop
from seatrial.physics.models.roll import roll
from seatrial.physics.sea.spectrum import ittc, jonswap
from seatrial.physics.simulate.closed_loop import ActuatorLimits, ClosedLoop, sample_noise, simulation_step

BEAM = Seaway(ittc(3.3), 18.0 * KNOT, math.pi / 2, HULL)
QUARTERING = replace(BEAM, beta=math.radians(45.0), spreading=1.0)
FOLLOWING = Seaway(jonswap(3.0, 9.0), 22.0 * KNOT, math.radians(20.0), HULL)
HIGH = 2.657 * PUBLISHED


def at_sea(seeds: int = 20, duration: float = 1000.0) -> TuningTask:
    return replace(fin_task(), simulation=SimulationSettings(seeds, duration, 0.05))


@pytest.fixture(scope="module")
def paper() -> SeawaySimulation:
    """The published gains in twenty seas of 1000 s."""
    task = at_sea()
    return simulate_in_seaway(task, task.loop, "paper", PUBLISHED, 0)


@pytest.mark.parametrize("seaway", [BEAM, FOLLOWING])
def test_the_lines_have_the_slope_of_the_exposure(seaway: Seaway) -> None:
    """In every sea, not on average: the random place of a line in its interval is all that differs."""
    wanted = seaway.exposure(fin_loop()).variance
    for seed in range(5):
        lines = wave_components(seaway, np.random.default_rng(seed), frequency_band(seaway))
        assert 0.5 * np.sum(np.abs(effect_amplitudes(lines, seaway.effect)) ** 2) == pytest.approx(wanted, rel=5e-3)


def test_the_lines_of_short_crested_seas_have_it_on_average() -> None:
    wanted = QUARTERING.exposure(fin_loop()).variance
    drawn = [wave_components(QUARTERING, np.random.default_rng(seed), frequency_band(QUARTERING)) for seed in range(20)]
    ratio = (
        np.array([0.5 * np.sum(np.abs(effect_amplitudes(lines, QUARTERING.effect)) ** 2) for lines in drawn]) / wanted
    )
    assert abs(ratio.mean() - 1.0) < 3.5 * ratio.std(ddof=1) / math.sqrt(20.0)
    assert ratio.std() < 0.1


def test_the_lines_are_summed_as_cosines() -> None:
    lines = wave_components(BEAM, np.random.default_rng(3), frequency_band(BEAM))
    amplitude, time = effect_amplitudes(lines, BEAM.effect), 0.05 * np.arange(1003)
    wanted = np.real(amplitude[:, None] * np.exp(1j * lines.omega_e[:, None] * time)).sum(axis=0)
    assert sum_harmonics(lines.omega_e, amplitude, 0.05, 1003) == pytest.approx(wanted, abs=1e-10)


def test_seeds_decide_the_seas() -> None:
    short = SimulationSettings(3, 50.0, 0.1)
    first, shifted = disturbance_series(BEAM, short, 0), disturbance_series(BEAM, short, 1)
    assert np.array_equal(first[1], shifted[0])
    assert not np.allclose(first[0], first[1])


def test_linear_runs_have_the_variance_of_the_spectrum(paper: SeawaySimulation) -> None:
    """Within the scatter of the seas: 20 times 1000 s."""
    rows, _ = distinct_variances((variance("roll", "rad^2", LoopSignal.OUTPUT),))
    known = Performance(fin_loop(), BEAM.exposure(fin_loop()), rows)
    wanted = 1.0 - math.sqrt(known.evaluate(PUBLISHED).variances[0, 0] / known.uncontrolled_variances[0])
    error = paper.linear.std(ddof=1) / math.sqrt(len(paper.linear))
    assert error < 0.005
    assert abs(paper.linear.mean() - wanted) < 3.5 * error


def test_the_published_gains_lose_to_limits_and_more_to_stall(paper: SeawaySimulation) -> None:
    """About 76 % of the roll linear, 74 % within 22 deg and 25 deg/s, 67 % with stall at 18 deg; sampled."""
    means = [100.0 * float(np.mean(column)) for column in (paper.linear, paper.limited, paper.stalled)]
    assert means == pytest.approx([76.0, 74.3, 66.7], abs=0.5)
    assert paper.saturation_loss == pytest.approx(0.019, abs=0.005)
    assert np.all(paper.linear > paper.limited)
    assert np.all(paper.limited > paper.stalled)


def test_high_gains_win_on_paper_and_lose_at_sea(paper: SeawaySimulation) -> None:
    """Linear theory promises 89.5 %; with limits and stall they fall behind the published ones, beyond doubt."""
    task = at_sea()
    high = simulate_in_seaway(task, task.loop, "high gain", HIGH, 0)
    assert float(np.mean(high.linear)) == pytest.approx(0.895, abs=0.005)
    assert compare_pairwise(high, paper, "linear").lower > 0.1
    assert compare_pairwise(high, paper, "stalled").upper < 0.0
    assert high.saturation_loss > 0.08


def test_the_record_shows_the_first_sea_within_the_limits(paper: SeawaySimulation) -> None:
    record = paper.record
    assert record.time[0] == 0.0
    assert record.duration == pytest.approx(1000.0)
    assert np.degrees(np.abs(record["alpha_f"]).max()) <= 22.0 + 1e-9
    assert np.degrees(np.abs(np.diff(record["alpha_f"])).max() / record.dt) <= 25.0 + 1e-6
    assert {"phi", "alpha_f", "alpha_w"} <= set(record.channels)


def test_the_interval_is_students() -> None:
    rng = np.random.default_rng(1)
    task = at_sea(2, 20.0)
    known = simulate_in_seaway(task, task.loop, "one", PUBLISHED, 0)
    one, two = (replace(known, limited=rng.normal(0.7, 0.02, 20)) for _ in range(2))
    made = compare_pairwise(one, two, "limited")
    interval = stats.ttest_rel(one.limited, two.limited).confidence_interval(0.95)
    assert (made.lower, made.upper) == pytest.approx((interval.low, interval.high))
    assert made.seeds == 20
    same = compare_pairwise(one, one, "limited")
    assert (same.mean, same.lower, same.upper) == (0.0, 0.0, 0.0)
    with pytest.raises(InputError, match="not 'unlimited'"):
        compare_pairwise(one, two, "unlimited")
    with pytest.raises(InputError, match="same seas"):
        compare_pairwise(known, two, "limited")


def test_an_identified_roll_model_takes_the_plants_place() -> None:
    """The published roll as coefficients: the same reductions; with quadratic damping there is less left to reduce."""
    task = at_sea(2, 200.0)
    values = {"b_1": 0.3796 / 1.43242, "c_1": 1.0 / 1.43242, "K_alpha": 0.256}
    known = simulate_in_seaway(task, task.loop, "paper", PUBLISHED, 0)
    made = []
    for b_2 in (0.0, 2.0):
        ship = TrimmedShip(
            roll().with_values({**values, "b_2": b_2}), np.zeros(2), np.zeros(2), "alpha_f", "phi", "alpha_w"
        )
        made.append(simulate_in_seaway(replace(task, trimmed_ship=ship), task.loop, "paper", PUBLISHED, 0))
    assert made[0].stalled == pytest.approx(known.stalled, abs=1e-6)
    assert np.all(made[1].linear < known.linear)


def test_fins_lift_with_the_square_of_the_speed_before_a_model_too() -> None:
    fast = replace(BEAM, U=22.0 * KNOT)
    task = replace(at_sea(2, 200.0), disturbances=(fast,), effectiveness=Effectiveness.SPEED_SQUARED)
    values = {"b_1": 0.3796 / 1.43242, "c_1": 1.0 / 1.43242, "K_alpha": 0.256}
    ship = TrimmedShip(roll().with_values(values), np.zeros(2), np.zeros(2), "alpha_f", "phi", "alpha_w")
    plain = simulate_in_seaway(task, task.loop, "paper", PUBLISHED, 0)
    assert simulate_in_seaway(
        replace(task, trimmed_ship=ship), task.loop, "paper", PUBLISHED, 0
    ).stalled == pytest.approx(plain.stalled, abs=1e-6)
    assert np.all(
        plain.linear
        > simulate_in_seaway(
            replace(task, effectiveness=Effectiveness.CONSTANT), task.loop, "paper", PUBLISHED, 0
        ).linear
    )


def test_the_loop_as_printed_is_not_fit_for_sea() -> None:
    """Ms 5.4 and fins beyond their rate: within limits it swings more than without any control."""
    task = replace(fin_task(Preamplifier.PRINTED), simulation=SimulationSettings(4, 500.0, 0.05))
    made = simulate_in_seaway(task, task.loop, "paper", PUBLISHED, 0)
    assert float(np.mean(made.linear)) == pytest.approx(0.76, abs=0.02)
    assert np.all(made.limited < 0.2)


def test_without_a_sea_there_is_nothing_to_sail_in() -> None:
    task = fin_task()
    with pytest.raises(InputError, match="needs a sea and trials"):
        simulate_in_seaway(task, task.loop, "paper", PUBLISHED, 0)
    ship = TrimmedShip(roll().with_values({"K_alpha": 0.256}), np.zeros(2), np.zeros(2), "alpha_f", "phi")
    with pytest.raises(InputError, match="no input for the sea"):
        simulate_in_seaway(replace(at_sea(2, 20.0), trimmed_ship=ship), task.loop, "paper", PUBLISHED, 0)


@pytest.mark.parametrize("sample_s", [0.05, 0.1])
def test_noise_in_front_of_the_sensor_moves_the_fins_as_linear_theory_says(sample_s: float) -> None:
    """Of the roll angle, held over each sample, through gyro and preamplifier."""
    sampling = Sampling(sample_s, dead_time=0.1, noise=math.radians(0.05))
    loop = replace(fin_loop(), sampling=sampling)
    dt, model, count = simulation_step(sampling, 0.01), plant_model(loop), 200_000
    fins, waves = model.input_names
    run = ClosedLoop(model, loop, loop.gain_values, dt, fins, waves, loop.output)
    _, moved = run.run(np.zeros(count), noise=sample_noise(sampling, count, 3))
    assert calm_actuator(loop)[0] == pytest.approx(float(np.std(moved[count // 10 :])), rel=0.02)


def test_noise_costs_roll_and_every_sea_has_noise_of_its_own() -> None:
    task = at_sea(4, 300.0)
    quiet, noisy = (
        replace(task, loop=replace(task.loop, sampling=Sampling(0.1, 0.1, math.radians(degrees))))
        for degrees in (0.0, 0.5)
    )
    loud = replace(noisy, constraints=replace(noisy.constraints, limit=math.radians(5.0)))
    without, limited = (seaway_reductions(one, one.loop, PUBLISHED, 0) for one in (quiet, loud))
    assert np.all(limited[:, 1] < without[:, 1] - 0.1)
    same = replace(task, loop=noisy.loop)
    first, second = (seaway_reductions(same, same.loop, PUBLISHED, seed)[:, 0] for seed in (0, 1))
    np.testing.assert_array_equal(first[1:], second[:-1])


def with_spread(task: TuningTask, share: float) -> TuningTask:
    return replace(task, uncertainty=PlantUncertainty(actuator=ActuatorSpread(share, share, share)))


def test_in_the_ranking_the_actuator_differs_from_sea_to_sea_as_much_as_its_spread_says() -> None:
    """Without a spread it is the declared one of the results; with one all controllers meet the same actuators."""
    task = at_sea(4, 300.0)
    task = replace(task, loop=replace(task.loop, sampling=Sampling(0.05, 0.1)))
    shown = simulate_in_seaway(task, task.loop, "one", HIGH, 0)
    declared, drawn, again = (
        seaway_reductions(one, one.loop, HIGH, 0) for one in (with_spread(task, 0.0), with_spread(task, 0.5), task)
    )
    np.testing.assert_array_equal(declared.T, [shown.linear, shown.limited, shown.stalled])
    assert np.all(np.abs(drawn - declared).max(axis=0) > [1e-4, 0.003, 0.003])
    assert np.all(np.abs(again - declared).max(axis=0) < np.abs(drawn - declared).max(axis=0))
    np.testing.assert_array_equal(drawn[:, 1:], seaway_reductions(with_spread(task, 0.5), task.loop, HIGH, 0)[:, 1:])


def test_places_of_a_spread_are_shares_of_what_is_declared() -> None:
    loop = replace(fin_task().loop, sampling=Sampling(0.1, 0.5))
    spread = ActuatorSpread(0.1, 0.2, 0.3)
    limits, there = spread.actuator_at(np.array([-1.0, 1.0, -1.0]), ActuatorLimits(0.4, 0.5, 0.3), loop)
    assert (limits.limit, limits.rate, limits.stall) == pytest.approx((0.4, 0.45, 0.21))
    assert there.sampling is not None and there.sampling.dead_time == pytest.approx(0.6)
    assert spread.actuator_at(np.ones(3), ActuatorLimits(), loop)[0] == ActuatorLimits()
    with pytest.raises(InputError, match="rate = 1"):
        ActuatorSpread(rate=1.0)


def test_energy_in_the_same_seas_is_compared_pairwise(paper: SeawaySimulation) -> None:
    """Without limits' effect small gains move the fins less; the drag is that of the rms angle."""
    task = replace(at_sea(4, 300.0), drive=ActuatorDrive(800.0, 0.8), surface=LiftingSurface(5.0, 1.0))
    one, other = (simulate_in_seaway(task, task.loop, "one", share * PUBLISHED, 0) for share in (0.5, 1.0))
    saved = energy_saving(one, other)
    gap = other.drive_energy + other.drag_energy - one.drive_energy - one.drag_energy
    assert saved.mean == pytest.approx(np.mean(gap)) and saved.lower > 0.0 and saved.seeds == 4
    angle = other.record["alpha_f"]
    assert task.surface is not None
    assert other.drag_energy[0] == pytest.approx(task.surface.hourly_energy(float(np.mean(angle**2)), BEAM.U), rel=1e-9)
    assert len(paper.drive_energy) == len(paper.drag_energy) == 0
