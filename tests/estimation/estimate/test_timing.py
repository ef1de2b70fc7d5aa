"""Inputs whose timing nobody recorded: held or straight, and a delay that the sample interval leaves open."""

import math

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate.assemble import (
    Runs,
    is_course_open,
    output_error_problem,
    set_inputs,
    timing_nuisances,
    with_held_inputs,
)
from seatrial.estimation.estimate.fit import estimate_model
from seatrial.estimation.problem.prediction_error import join_segments
from seatrial.physics.models import heave_pitch, mmg, model_named, nomoto, waterjet

K, T = 0.12, 9.0
DT = 1.0
WHOLE_RUNS = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
NOISE = {"psi": math.radians(0.02), "r": math.radians(0.01)}


def exact(rng: np.random.Generator, late: float = 0.0, count: int = 400) -> Record:
    """A craft of first order whose rudder is held from sample to sample, solved exactly; it acts `late` [s]."""
    time = DT * np.arange(count)
    order = 0.2 * np.sign(np.sin(2.0 * np.pi * (time + 0.3) / 26.0))
    share, psi, r = late / DT, np.zeros(count), np.zeros(count)
    for k in range(count - 1):
        parts = ((share, order[max(k - 1, 0)]), (1.0 - share, order[k]))
        psi[k + 1], r[k + 1] = psi[k], r[k]
        for part, delta in parts:
            decay, rest = math.exp(-part * DT / T), r[k + 1] - K * delta
            psi[k + 1] += K * delta * part * DT + rest * T * (1.0 - decay)
            r[k + 1] = K * delta + rest * decay
    values = {"delta": order, "psi": psi, "r": r}
    values |= {s: values[s] + size * rng.normal(size=count) for s, size in NOISE.items()}
    return Record.from_arrays("orders", time, values)


@pytest.mark.parametrize("late", [0.0, 0.4])
def test_held_orders_give_the_time_constant_whenever_they_act(late: float, rng: np.random.Generator) -> None:
    estimation = estimate_model(nomoto(), Runs.one_session_each((exact(rng, late),), 8.0), WHOLE_RUNS)
    gain, lag, delay = estimation.estimate.common_parameters
    errors = estimation.interval.standard_error
    assert abs(gain - K) < 3.0 * errors[0] and abs(lag - T) < 3.0 * errors[1] and errors[1] < 0.005 * T
    assert delay == pytest.approx(late, abs=3.0 * errors[2] + 0.01)


def test_timing_that_is_known_is_no_unknown(rng: np.random.Generator) -> None:
    runs = Runs.one_session_each((exact(rng),), 8.0)
    known = estimate_model(nomoto(), runs, WHOLE_RUNS.with_known_timing(["delta"]))
    free = estimate_model(nomoto(), runs, WHOLE_RUNS)
    assert len(known.estimate.common_parameters) == 2
    assert known.interval.standard_error[1] < 0.9 * free.interval.standard_error[1]


def test_the_prior_is_that_of_the_source_and_not_of_the_rate(rng: np.random.Generator) -> None:
    run = exact(rng).resampled(0.5)
    (nuisance,) = timing_nuisances(nomoto(), [run], EstimateSettings())
    assert nuisance.prior.standard_deviation == pytest.approx(DT / math.sqrt(12.0)) and nuisance.is_spread_fixed
    assert timing_nuisances(nomoto(), [run], EstimateSettings(delays={"delta": None})) == ()


def test_commands_that_are_one_in_all_runs_have_no_time_between_them(rng: np.random.Generator) -> None:
    commands = {f"command_{k}": rng.uniform(-1.0, 1.0, 50) for k in (1, 2)}
    alike = dict.fromkeys(commands, commands["command_1"])
    runs = [Record.from_arrays("run", DT * np.arange(50), channels) for channels in (commands, alike)]
    counts = [len(timing_nuisances(model_named("thrusters"), some, EstimateSettings())) for some in (runs, runs[1:])]
    assert counts == [2, 0]


def test_an_input_that_never_moves_has_no_delay(rng: np.random.Generator) -> None:
    run = exact(rng)
    still = run.with_channel("delta", run.channel("delta").with_values(np.full(len(run), 0.1)))
    assert timing_nuisances(nomoto(), [still], EstimateSettings()) == ()


def test_wind_forces_and_fins_of_a_linear_model_have_none() -> None:
    assert set_inputs(mmg()) == ("delta", "n")
    assert set_inputs(waterjet()) == ("delta", "v_j")
    assert set_inputs(heave_pitch()) == ()


def test_a_declaration_comes_before_the_steps(rng: np.random.Generator) -> None:
    run = exact(rng)
    assert with_held_inputs(nomoto(), [run]).held == {"delta"}
    straight = Record.from_dataframe(run.to_dataframe(), between={"delta": "straight"})
    assert with_held_inputs(nomoto(), [straight]).held == frozenset()
    assert with_held_inputs(nomoto(), [run.resampled(0.5)]).held == frozenset()  # a step lies anywhere in a sample
    assert [is_course_open("delta", [r]) for r in (run, straight, run.resampled(0.5))] == [True, False, False]


def test_segments_know_what_was_ordered_before_them(rng: np.random.Generator) -> None:
    """A step on the start of a segment, acting later: without the sample before, any delay would fit as well."""
    runs = Runs.one_session_each((exact(rng),), 8.0)
    cut = output_error_problem(nomoto(), runs, 26.0, EstimateSettings())
    whole = output_error_problem(nomoto(), runs, np.inf, EstimateSettings())
    point = np.array([K, T, 0.5])
    y = whole.simulated_outputs(point, whole.measured_initial_states())
    starts = y[[0, *cut.data.run_inputs.place[1:, 0]]]  # type: ignore[union-attr]
    local = starts[:, [cut.data.outputs.index(s) for s in cut.starts]]
    pieces = cut.simulated_outputs(point, local)
    rows = np.concatenate([np.arange(a, a + n) for a, n in zip(
        cut.data.run_inputs.place[:, 0], np.diff(cut.data.offsets), strict=True)])  # type: ignore[union-attr]  # fmt: skip
    np.testing.assert_allclose(pieces, y[rows], atol=1e-12)


def test_runs_whose_segments_are_joined_keep_their_inputs(rng: np.random.Generator) -> None:
    runs = Runs.one_session_each(tuple(exact(rng, count=count) for count in (120, 90, 150)), 8.0)
    cut = output_error_problem(nomoto(), runs, 26.0, EstimateSettings())
    whole = output_error_problem(nomoto(), runs, np.inf, EstimateSettings())
    joined, _ = join_segments(cut)
    point, local = np.array([K, T, 0.5]), whole.measured_initial_states()
    np.testing.assert_allclose(joined.simulated_outputs(point, local), whole.simulated_outputs(point, local))
