"""Process noise found where there is some and not where there is none; its floor against simulated runs."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Record
from seatrial.estimation.estimate.disturbance_tests import boundary_quantile
from seatrial.estimation.estimate.plausibility import own_starts
from seatrial.estimation.estimate.point_estimate import PointEstimate, fit_output_error
from seatrial.estimation.estimate.process_noise import ProcessNoise, fit_prediction_error, has_noise
from seatrial.estimation.predict.draws import PredictionUncertainty, StartStates, draw_runs
from seatrial.estimation.predict.predict_runs import process_noise_floor
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.replay import inputs_of

Array = NDArray[np.float64]
K, T, INTENSITY = 0.15, 8.0, 2e-3
NOISE = {"r": 1e-3, "psi": 3e-3}
DT, FINE, ROWS = 0.5, 10, 800
NONE = np.zeros((0, 0))


@pytest.fixture(scope="module")
def model() -> Model:
    return nomoto().with_values({"K": K, "T": T})


def seconds(rows: int) -> Array:
    return np.linspace(0.0, DT * (rows - 1), rows)


def rudder(rows: int, phase: float = 0.0) -> Array:
    return 0.3 * np.clip(8.0 * np.sin(2 * np.pi * (DT * np.arange(rows) + phase) / 52.0), -1.0, 1.0)


def yawing(rng: np.random.Generator, intensity: float, phase: float = 0.0, rows: int = ROWS) -> Record:
    """T r' + r = K delta with white noise on r', Euler steps ten times finer than the samples."""
    delta, h = np.repeat(rudder(rows, phase), FINE), DT / FINE
    state, kept = np.zeros(2), np.empty((rows, 2))
    for step in range(rows * FINE):
        if step % FINE == 0:
            kept[step // FINE] = state
        slope = np.diff(rudder(rows + 1, phase))[step // FINE] * (step % FINE) / FINE
        kick = intensity * np.sqrt(h) * rng.standard_normal()
        state = state + np.array([h * (K * (delta[step] + slope) - state[0]) / T + kick, h * state[0]])
    noisy = kept + rng.standard_normal(kept.shape) * list(NOISE.values())
    return Record.from_arrays(
        "run", seconds(rows), {"delta": rudder(rows, phase), "r": noisy[:, 0], "psi": noisy[:, 1]}
    )


def made_of(model: Model, intensity: float, seed: int, runs: int = 1) -> PointEstimate:
    rng = np.random.default_rng(seed)
    records = [replace(yawing(rng, intensity, 7.0 * i), name=f"run {i}") for i in range(runs)]
    problem = OutputError(model, cut_segments(model, records, ("r", "psi"), 20.0), np.array([1e-2, 1e-1]), workers=1)
    return fit_output_error(problem, problem.start(), problem.measured_initial_states(), {})


@pytest.fixture(scope="module")
def found(model: Model) -> ProcessNoise:
    return fit_prediction_error(made_of(model, INTENSITY, 3, runs=4))


def test_process_noise_is_needed_and_suffices(found: ProcessNoise) -> None:
    assert found.test.is_needed
    assert found.test.is_white
    assert "innovations are white" in found.test.summary


def test_intensities_and_coefficients_are_found(found: ProcessNoise) -> None:
    assert found.process_intensities == {"r": pytest.approx(INTENSITY, rel=0.1)}
    assert found.measurement_noise == {s: pytest.approx(v, rel=0.1) for s, v in NOISE.items()}
    error = (found.common_parameters - np.array([K, T])) / found.interval.standard_error
    assert np.all(np.abs(error) < 3.0)
    assert np.all(found.interval.standard_error / np.array([K, T]) < 0.05)


def test_slope_of_the_likelihood_vanishes(found: ProcessNoise) -> None:
    """Central differences of the cost itself, in units of each unknown's standard error."""
    point, hessian = found.optimum.solution.point, found.optimum.normal.hessian
    for i, size in enumerate(0.05 / np.sqrt(np.diag(hessian))):
        step = size * (np.arange(len(point)) == i)
        rise = found.problem.cost(point + step, NONE) - found.problem.cost(point - step, NONE)
        assert abs(rise / (2.0 * 0.05)) < 0.02
    assert found.newton_decrement < 1e-3


@pytest.mark.parametrize("seed", range(3))
def test_sensor_noise_is_no_process_noise(model: Model, seed: int) -> None:
    none = fit_prediction_error(made_of(model, 0.0, seed))
    assert not none.test.is_needed
    assert none.test.summary.startswith("no process noise")


def test_a_search_that_begins_in_the_basin_of_an_unstable_ship(model: Model, found: ProcessNoise) -> None:
    """As where an autopilot answers gusts: output error ends there, and the model's own values lead out of it."""
    made = made_of(model, INTENSITY, 3, runs=4)
    point = made.common_parameters.copy()
    point[made.problem.free.index("T")] *= -1.0
    solution = replace(made.optimum.solution, point=point)
    astray = replace(made, optimum=replace(made.optimum, solution=solution))
    again = fit_prediction_error(astray, further_starts=own_starts(astray))
    assert again.common_parameters == pytest.approx(found.common_parameters, rel=1e-3)


def test_a_known_deviation_is_kept(model: Model) -> None:
    held = fit_prediction_error(made_of(model, INTENSITY, 5), {"psi": 3.1e-3})
    assert held.measurement_noise["psi"] == pytest.approx(3.1e-3, rel=1e-12)


def test_a_channel_that_only_one_run_has(model: Model) -> None:
    made = made_of(model, INTENSITY, 6, runs=2)
    measured = made.problem.data.measured.copy()
    measured[np.isin(np.repeat(made.problem.data.run, np.diff(made.problem.data.offsets)), [1]), 0] = np.nan
    gappy = replace(made, problem=replace(made.problem, data=replace(made.problem.data, measured=measured)))
    assert fit_prediction_error(gappy).process_intensities["r"] == pytest.approx(INTENSITY, rel=0.15)


def test_a_state_that_is_not_seen_is_refused(model: Model) -> None:
    with pytest.raises(InputError, match="'x0' would move nothing"):
        fit_prediction_error(made_of(model, 0.0, 0), driven_states=("x0",))


def test_runs_left_out_by_one_step(found: ProcessNoise) -> None:
    """Against a full refit of the likelihood to the other runs."""
    problem = found.problem
    assert found.leave_one_out.shape == (4, 2)
    rest = np.array([0, 2, 3])
    again = replace(
        problem, runs=replace(problem.runs, data=problem.runs.data.selected(rest)), start=problem.start[rest],
        start_variance=problem.start_variance[rest],
    )  # fmt: skip
    point = found.optimum.solution.point
    for _ in range(6):
        normal = again.normal(point, NONE)
        point = point - np.linalg.solve(normal.hessian, normal.gradient)
    moved = (found.leave_one_out[1] - found.common_parameters) / found.interval.standard_error
    np.testing.assert_allclose(moved, (point[:2] - found.common_parameters) / found.interval.standard_error, atol=0.15)


def test_the_estimate_it_leaves_is_one_over_whole_runs(found: ProcessNoise) -> None:
    made = found.as_point_estimate()
    assert made.problem.data.count == 4
    np.testing.assert_array_equal(made.common_parameters, found.common_parameters)
    np.testing.assert_array_equal(made.optimum.normal.without_local()[1], found.information)
    assert made.residuals().shape == made.problem.data.measured.shape


def test_records_without_noise_have_no_likelihood(model: Model) -> None:
    made = made_of(model, 0.0, 0)
    assert has_noise(made)
    exact = replace(made, problem=replace(made.problem, noise=np.full(2, 1e-12)))
    assert not has_noise(exact)


def test_floor_is_the_scatter_of_simulated_runs(model: Model) -> None:
    """400 nonlinear simulations with kicks every half second."""
    moving = model.with_values({"U": 1.0})
    record = Record.from_arrays("run", seconds(120), {"delta": rudder(120)})
    template = OutputError(
        moving,
        cut_segments(moving, [yawing(np.random.default_rng(0), 0.0, rows=120)], ("r", "psi"), None),
        np.ones(2),
    )
    start, own = np.array([0.0, 0.4, 0.0, 0.0]), np.zeros(0)
    made = process_noise_floor(template, moving, record, start, own, {"r": INTENSITY})
    nothing = PredictionUncertainty(np.zeros((2, 2)), np.zeros((0, 0)), np.array([INTENSITY, 0.0, 0.0, 0.0]), np.inf)
    inputs, rng = inputs_of(moving, record)[None], np.random.default_rng(1)
    runs = draw_runs(
        template, moving, record.dt, inputs, StartStates.given(start[None], 0), own[None], nothing, rng, 400
    )[0]
    spread = np.sqrt(np.mean(np.var(runs, axis=0), axis=0))
    assert made["r"] == pytest.approx(spread[0], rel=0.05)
    assert made["psi_deg"] == pytest.approx(np.degrees(spread[1]), rel=0.1)
    assert made["position_m"] == pytest.approx(np.hypot(spread[2], spread[3]), rel=0.12)


def test_quantiles_on_the_boundary() -> None:
    """Half of chi squared with one degree of freedom, and by drawing for three."""
    assert boundary_quantile(1, 0.95) == pytest.approx(2.7055, abs=1e-3)
    assert boundary_quantile(0, 0.95) == 0.0
    draws = np.random.default_rng(2).standard_normal((200_000, 3))
    ratio = np.sum(np.maximum(draws, 0.0) ** 2, axis=1)
    assert boundary_quantile(3, 0.99) == pytest.approx(np.quantile(ratio, 0.99), rel=0.02)
