"""The likelihood of innovations: gradients against differences of the cost, and output error as its limit."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from seatrial.core.values import Prior, Record
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.prediction_error import PredictionError, join_segments, over_runs
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate import replay
from seatrial.physics.simulate.batch import InputCorrection

Array = NDArray[np.float64]
OUTPUTS = ("u", "v", "r", "psi", "x0", "y0")
NOISE = np.array([0.02, 0.02, 2e-3, 4e-3, 0.5, 0.5])
START = {"u": 0.9, "v": 0.0, "r": 0.0, "psi": 0.0, "x0": 0.0, "y0": 0.0}
NONE = np.zeros((0, 0))


def record_of(name: str, seed: int, rows: int = 120) -> Record:
    rng, time = np.random.default_rng(seed), np.linspace(0.0, 0.25 * (rows - 1), rows)
    delta = np.interp(time, np.arange(0.0, 36.0, 4.0), rng.uniform(-0.5, 0.5, 9))
    plan = Record.from_arrays(name, time, {"delta": delta, "v_j": 1.866 + 0.2 * np.sin(0.2 * time)})
    record = replay(waterjet(), plan, START)
    for symbol, size in zip(OUTPUTS, NOISE, strict=True):
        channel = record.channel(symbol)
        record = record.with_channel(
            symbol, channel.with_values(channel.values + size * rng.standard_normal(len(record)))
        )
    return record


@pytest.fixture(scope="module")
def runs() -> OutputError:
    """Three runs of two days with a nuisance, a prior and a gap."""
    model = waterjet()
    model = model.with_parameters(model.parameters.only_free(("X_uu", "Y_v", "N_r")))
    records = [record_of(name, seed) for seed, name in enumerate("abc")]
    data = cut_segments(model, records, OUTPUTS, None, ("day 1", "day 1", "day 2"))
    measured = data.measured.copy()
    measured[130:150, 3] = np.nan
    zero = Nuisance(InputCorrection("delta", "zero"), Prior(0.01, 0.03), "rad")
    return OutputError(model, replace(data, measured=measured), NOISE, (zero,), workers=1)


@pytest.fixture(scope="module")
def problem(runs: OutputError) -> PredictionError:
    start = np.tile([START[s] for s in runs.model.states], (3, 1))
    variance = np.tile((3 * NOISE) ** 2, (3, 1))
    return PredictionError(runs, ("u", "v", "r"), start, variance, np.full(6, np.nan))


@pytest.fixture(scope="module")
def point(problem: PredictionError) -> Array:
    return np.concatenate([problem.runs.start(), np.array([1e-2, 1e-2, 2e-3]) ** 2, (1.1 * NOISE) ** 2])


def differences(problem: PredictionError, point: Array, steps: Array) -> Array:
    """Gradient of the cost by central differences of fourth order."""
    made = []
    for step in np.diag(steps):
        near, far = (problem.cost(point + k * step, NONE) - problem.cost(point - k * step, NONE) for k in (1, 2))
        made.append((8.0 * near - far) / (12.0 * np.sum(step)))
    return np.array(made)


def test_exact_gradient_is_the_slope_of_the_cost(problem: PredictionError, point: Array) -> None:
    normal = problem.normal(point, NONE)
    exact = replace(problem, steps=problem.difference_steps(point, normal.hessian, 1e-3))
    error = 1.0 / np.sqrt(np.diag(normal.hessian))
    slope = differences(problem, point, 0.03 * error)
    np.testing.assert_allclose(exact.normal(point, NONE).gradient * error, slope * error, atol=2e-4)


def test_noise_columns_of_both_gradients_agree(problem: PredictionError, point: Array) -> None:
    normal = problem.normal(point, NONE)
    exact = replace(problem, steps=problem.difference_steps(point, normal.hessian, 1e-3)).normal(point, NONE)
    error = 1.0 / np.sqrt(np.diag(exact.hessian))
    noise = slice(problem.runs.size, None)
    np.testing.assert_allclose((normal.gradient * error)[noise], (exact.gradient * error)[noise], atol=0.05)


def test_without_process_noise_it_is_output_error(problem: PredictionError) -> None:
    quiet = replace(problem, process=(), start_variance=np.zeros((3, 6)), measurement=problem.runs.noise)
    shared = problem.runs.start() * 1.02
    local = problem.start[:, [problem.runs.model.states.index(s) for s in problem.runs.starts]]
    made, expected = quiet.normal(np.concatenate([shared, NOISE**2]), NONE), problem.runs.normal(shared, local)
    samples = np.isfinite(problem.runs.data.measured).sum(axis=0)
    assert made.cost - np.sum(samples * np.log(NOISE)) == pytest.approx(expected.cost, rel=1e-10)
    k = problem.runs.size
    scale = np.sqrt(np.diag(expected.hessian))
    np.testing.assert_allclose(made.gradient[:k] / scale, expected.gradient / scale, atol=1e-8)
    np.testing.assert_allclose(made.hessian[:k, :k], expected.hessian, rtol=1e-9, atol=1e-9 * scale.max() ** 2)


def test_runs_add_up(problem: PredictionError, point: Array) -> None:
    blocks, whole = problem.segment_normals(point), problem.normal(point, NONE)
    parts = [problem.assemble(blocks, point, np.array([r]), with_prior=False) for r in range(3)]
    prior = problem.runs.priors
    np.testing.assert_allclose(
        np.sum([p.gradient for p in parts], axis=0)[: problem.runs.size]
        + prior[1] * (point[: problem.runs.size] - prior[0]),
        whole.gradient[: problem.runs.size],
        rtol=1e-9,
    )


def test_a_known_deviation_stays(problem: PredictionError) -> None:
    known = replace(problem, measurement=np.where(np.arange(6) == 2, 2e-3, np.nan))
    assert known.lower[-4] == known.upper[-4] == pytest.approx(4e-6)
    assert np.all(known.lower[-3:] < known.upper[-3:])


def test_segments_are_joined_again(runs: OutputError) -> None:
    records = [record_of(name, seed) for seed, name in enumerate("abc")]
    pieces = replace(runs, data=cut_segments(runs.model, records, OUTPUTS, 5.0, ("day 1", "day 1", "day 2")))
    whole = cut_segments(runs.model, records, OUTPUTS, None, ("day 1", "day 1", "day 2"))
    joined, first = join_segments(pieces)
    np.testing.assert_array_equal(joined.data.measured, whole.measured)
    np.testing.assert_array_equal(joined.data.offsets, whole.offsets)
    np.testing.assert_array_equal(joined.data.session, whole.session)
    np.testing.assert_array_equal(pieces.data.offsets[first], whole.offsets[:-1] + first - np.arange(3))


def test_likelihood_does_not_depend_on_workers(problem: PredictionError, point: Array) -> None:
    two = replace(problem, runs=replace(problem.runs, workers=2))
    assert two.cost(point, NONE) == problem.cost(point, NONE)


def test_other_runs_keep_the_filter_and_begin_as_measured(problem: PredictionError, point: Array) -> None:
    cut = cut_segments(problem.runs.model, [record_of("d", 9)], OUTPUTS, None, ("day 1",))
    other = replace(problem.runs, data=replace(cut, sessions=problem.runs.data.sessions))
    moved = over_runs(problem, other)
    np.testing.assert_allclose(moved.start[0], [cut.measured[0, OUTPUTS.index(s)] for s in moved.runs.model.states])
    innovations = moved.innovations(point).normalised[20:]
    assert 0.7 < np.std(innovations) < 1.1
