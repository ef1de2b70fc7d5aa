"""Drawn runs against first-order covariance, and against integrated white noise written by hand."""

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Prior, Record
from seatrial.estimation.predict.draws import (
    PredictionUncertainty,
    StartStates,
    draw_runs,
    simulate_points,
    square_root,
)
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.batch import InputCorrection
from seatrial.physics.simulate.replay import inputs_of

K, T = 0.15, 8.0
DRAWS = 4000
REST = np.zeros(len(nomoto().states))


@pytest.fixture(scope="module")
def record() -> Record:
    time = 0.5 * np.arange(121)
    return Record.from_arrays(
        "run", time, {"delta": 0.3 * np.sign(np.sin(0.12 * time)), "r": 0 * time, "psi": 0 * time}
    )


@pytest.fixture(scope="module")
def model() -> Model:
    return nomoto().with_values({"K": K, "T": T})


def problem(model: Model, record: Record, *nuisances: Nuisance) -> OutputError:
    return OutputError(model, cut_segments(model, [record], ("r", "psi"), None), np.ones(2), nuisances, workers=1)


def scatter(
    model: Model, coefficients: np.ndarray, offsets: np.ndarray, process: tuple[float, float]
) -> PredictionUncertainty:
    intensity = dict(zip(("r", "psi"), process, strict=True))
    return PredictionUncertainty(coefficients, offsets, np.array([intensity.get(s, 0.0) for s in model.states]), np.inf)


def drawn(
    template: OutputError,
    record: Record,
    nuisances: np.ndarray,
    about: PredictionUncertainty,
    seed: int,
    count: int = DRAWS,
) -> np.ndarray:
    """Runs of the template's model along a record from rest, (count, rows, observables)."""
    model, rng = template.model, np.random.default_rng(seed)
    inputs = inputs_of(model, record)[None]
    return draw_runs(
        template,
        model,
        record.dt,
        inputs,
        StartStates.given(REST[None], len(nuisances)),
        nuisances[None],
        about,
        rng,
        count,
    )[0]


def test_scatter_of_the_outputs_is_that_of_the_coefficients(model: Model, record: Record) -> None:
    """Covariance J C J' with J from the exact sensitivities."""
    template = problem(model, record)
    spread = 0.005 * np.array([model.parameters[n].value for n in template.free])
    covariance = np.diag(spread**2)
    covariance[0, 1] = covariance[1, 0] = 0.5 * spread[0] * spread[1]
    about = scatter(model, covariance, np.zeros((0, 0)), (0.0, 0.0))
    runs = drawn(template, record, np.empty(0), about, seed=1)
    start, values, corrections = template.unpack(template.start(), np.zeros((1, len(template.starts))))
    _, slopes, _ = template._batch.differentiate(0, 1, start, values, corrections)
    place = [model.observables.index(o) for o in ("r", "psi")]
    for i, column in enumerate(place):
        jacobian = slopes[:, i, :2]
        expected = np.sqrt(np.einsum("ti,ij,tj->t", jacobian, covariance, jacobian))
        np.testing.assert_allclose(np.std(runs[:, :, column], axis=0)[10:], expected[10:], rtol=0.06)


def test_offsets_are_drawn_beside_the_coefficients(model: Model, record: Record) -> None:
    """A rudder zero of z moves the steady yaw rate by K z."""
    zero = Nuisance(InputCorrection("delta", "zero"), Prior(0.0, 0.05), "rad")
    template = problem(model, record, zero)
    still = record.with_channel("delta", record.channel("delta").with_values(np.zeros(len(record))))
    about = scatter(model, np.zeros((2, 2)), np.array([[0.01**2]]), (0.0, 0.0))
    runs = drawn(template, still, np.array([0.02]), about, seed=2)
    final = runs[:, -1, model.observables.index("r")]
    assert np.mean(final) == pytest.approx(K * 0.02, rel=0.03)
    assert np.std(final) == pytest.approx(K * 0.01, rel=0.05)


def test_process_noise_is_integrated_white_noise(model: Model, record: Record) -> None:
    """dr = -r/T dt + q dw has variance q^2 T/2 (1 - exp(-2 t/T)); beside it that of its integral."""
    template, q = problem(model, record), 1e-3
    still = record.with_channel("delta", record.channel("delta").with_values(np.zeros(len(record))))
    about = scatter(model, np.zeros((2, 2)), np.zeros((0, 0)), (q, 0.0))
    runs = drawn(template, still, np.empty(0), about, seed=3)
    t = still.time
    rate = np.sqrt(q**2 * T / 2 * (1 - np.exp(-2 * t / T)))
    angle = np.sqrt(q**2 * T**2 * (t - 2 * T * (1 - np.exp(-t / T)) + T / 2 * (1 - np.exp(-2 * t / T))))
    for name, expected in (("r", rate), ("psi", angle)):
        spread = np.std(runs[:, :, model.observables.index(name)], axis=0)
        np.testing.assert_allclose(spread[30:], expected[30:], rtol=0.06)


def test_the_middle_of_all_draws_is_the_prediction(model: Model, record: Record) -> None:
    template = problem(model, record)
    point = np.array([[model.parameters[n].value for n in template.free]])
    alone = simulate_points(
        template, model, record.dt, inputs_of(model, record)[None], REST[None], point, np.empty((1, 0))
    )[0]
    nothing = scatter(model, np.zeros((2, 2)), np.zeros((0, 0)), (0.0, 0.0))
    runs = drawn(template, record, np.empty(0), nothing, seed=4, count=3)
    np.testing.assert_array_equal(runs, np.tile(alone, (3, 1, 1)))


def test_the_root_of_a_singular_covariance() -> None:
    covariance = np.outer([1.0, 2.0], [1.0, 2.0])
    np.testing.assert_allclose(square_root(covariance) @ square_root(covariance).T, covariance, atol=1e-12)
    assert square_root(np.zeros((0, 0))).shape == (0, 0)


def test_windows_are_drawn_as_each_alone_would_be(model: Model, record: Record) -> None:
    """Without uncertainty; with it each window has draws of its own."""
    template, inputs = problem(model, record), inputs_of(model, record)
    both, start = np.stack([inputs, -inputs]), StartStates.given(np.tile(REST, (2, 1)), 0)
    none, rng = np.empty((2, 0)), np.random.default_rng(5)
    exact = scatter(model, np.zeros((2, 2)), np.zeros((0, 0)), (0.0, 0.0))
    runs = draw_runs(template, model, record.dt, both, start, none, exact, rng, 2)
    np.testing.assert_array_equal(runs[0, 0], drawn(template, record, np.empty(0), exact, 5, 1)[0])
    np.testing.assert_allclose(runs[1], -runs[0], atol=1e-12)
    pushed = scatter(model, np.zeros((2, 2)), np.zeros((0, 0)), (1e-3, 0.0))
    runs = draw_runs(template, model, record.dt, both, start, none, pushed, rng, 2)
    assert len(np.unique(runs[:, :, -1, 0])) == 4


def test_a_draw_begins_as_its_offset_says() -> None:
    by_offsets = np.array([[[0.5], [0.0]], [[0.0], [-1.0]]])
    starts = StartStates(np.array([[1.0, 2.0], [3.0, 4.0]]), lambda: (by_offsets, np.zeros((2, 2, 2))))
    offsets, rng = np.array([[[0.0], [2.0]], [[1.0], [3.0]]]), np.random.default_rng(1)
    np.testing.assert_array_equal(starts.draws(offsets, rng), [[[1.0, 2.0], [2.0, 2.0]], [[3.0, 3.0], [3.0, 1.0]]])
    again = StartStates.joined([starts[:1], starts[1:]])
    np.testing.assert_array_equal(again.draws(offsets, rng), starts.draws(offsets, rng))


def test_draws_begin_with_the_covariance_of_the_start() -> None:
    covariance = np.array([[[4.0, 1.0], [1.0, 0.5]], [[0.0, 0.0], [0.0, 1.0]]])
    starts = StartStates(np.ones((2, 2)), lambda: (np.zeros((2, 2, 1)), covariance))
    states = starts.draws(np.zeros((2, 40000, 1)), np.random.default_rng(2))
    for drawn_states, expected in zip(states, covariance, strict=True):
        np.testing.assert_allclose(np.cov(drawn_states.T), expected, atol=0.08)
