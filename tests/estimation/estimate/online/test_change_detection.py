"""Has the ship changed? False alarms, delay and the coefficient that is named, on streams of known truth."""

import numpy as np
import pytest
from tests.estimation.estimate.online.streams import DT, NAMES, NOISE, SeaStream

from seatrial.core.equations import Model
from seatrial.core.results.online import CoefficientChange
from seatrial.estimation.estimate.online.change_detector import (
    ChangeDetector,
    FilterWatch,
    GaussianEstimate,
    jump_search,
)
from seatrial.physics.simulate.linear import LinearBatch

Array = np.ndarray
FIRST, CHANGED = 601, 1350  # rows


def estimates(rng: np.random.Generator, shift: Array) -> list[tuple[Array, Array]]:
    """Least squares from more and more rows, the coefficients' moved by `shift` at row 200."""
    x, truth = rng.standard_normal((400, 3)), np.array([1.0, -2.0, 0.5])
    y = x @ truth + 0.3 * rng.standard_normal(400)
    y[200:] += x[200:] @ shift
    covariances = [0.09 * np.linalg.inv(x[:rows].T @ x[:rows]) for rows in range(20, 401, 5)]
    return [(c @ x[:rows].T @ y[:rows] / 0.09, c) for rows, c in zip(range(20, 401, 5), covariances, strict=True)]


def first_change(series: list[tuple[Array, Array]]) -> tuple[int, CoefficientChange] | None:
    """The look at which a change is reported."""
    detector = ChangeDetector(("a", "b", "c"))
    for look, (value, covariance) in enumerate(series):
        if detector.update_search(20.0 + 5.0 * look, GaussianEstimate(value, covariance)):
            assert detector.detected is not None
            return look, detector.detected
    return None


def test_regressions_without_change_raise_no_alarm() -> None:
    rng = np.random.default_rng(11)
    assert sum(first_change(estimates(rng, np.zeros(3))) is not None for _ in range(200)) <= 1


def test_the_coefficient_that_moved_its_instant_and_its_value_before_are_named(rng: np.random.Generator) -> None:
    found = first_change(estimates(rng, np.array([0.0, -0.6, 0.0])))
    assert found is not None
    look, change = found
    assert 36 < look < 46
    assert change.most_changed == "b"
    assert change.between[0] <= 200.0 <= change.between[1]
    assert change.before["b"] == pytest.approx(-2.0, abs=0.1)


def test_a_look_without_information_is_passed_over() -> None:
    detector = ChangeDetector(("a",))
    assert not detector.update_search(0.0, GaussianEstimate(np.ones(1), np.full((1, 1), np.inf)))
    same = np.full((1, 1), 1e-4)
    assert not any(detector.update_search(float(t), GaussianEstimate(np.ones(1), same)) for t in range(5))
    assert detector.detected is None


def test_searches_are_compared_where_much_is_new_only() -> None:
    """Two searches differ by parts of a standard error."""
    detector = ChangeDetector(("a",))
    detector.update_search(0.0, GaussianEstimate(np.ones(1), np.full((1, 1), 1e-4)))
    assert not detector.update_search(1.0, GaussianEstimate(np.full(1, 1.005), np.full((1, 1), 0.9999e-4)))
    assert detector.update_search(2.0, GaussianEstimate(np.full(1, 1.2), np.full((1, 1), 0.5e-4)))


def test_changes_in_a_row_are_the_models_misfit() -> None:
    """A ramp of a minute is found in three; beyond, none is believed and none is looked for."""
    detector, known = ChangeDetector(("a",)), np.full((1, 1), 1e-4)
    for k in range(4):
        assert not detector.update_search(10.0 * k, GaussianEstimate(np.full(1, 1.0 + 0.3 * (k % 2)), known))
        assert detector.update_search(10.0 * k + 5.0, GaussianEstimate(np.full(1, 1.3 - 0.3 * (k % 2)), 0.5 * known))
        assert detector.detected is not None
        assert detector.detected.is_believed == (k < 3)
    assert detector.is_ended
    assert detector.detected is not None  # one finding, from the first to the last
    assert (detector.detected.since, detector.detected.reported_at) == (0.0, 35.0)
    assert detector.detected.before == {"a": 1.0}
    detector.update_search(50.0, GaussianEstimate(np.ones(1), known))
    assert not detector.update_search(55.0, GaussianEstimate(np.full(1, 1.3), 0.5 * known))


def alarms(stream: SeaStream, measured: Array) -> list[tuple[float, CoefficientChange]]:
    """What a filter that watches from 60 s on tells up to the first change."""
    made = stream.filter(stream.batch_state(measured, FIRST), FIRST, jumps=jump_search(1.0 / DT))
    detector, watch = ChangeDetector(NAMES), FilterWatch(made)
    for row in range(FIRST, len(measured)):
        watch.update(np.array([row * DT]), measured[row : row + 1], stream.clean.inputs[row : row + 1])
        if detector.update(row * DT, watch):
            assert detector.detected is not None
            return [(row * DT, detector.detected)]
    return []


@pytest.fixture(scope="module")
def beam() -> SeaStream:
    return SeaStream.from_heading(90, 240.0, 7)


def test_thirty_streams_without_change_raise_no_alarm(beam: SeaStream) -> None:
    """An hour and a half; 5 alarms in 300 h are allowed for."""
    assert not any(alarms(beam, beam.measured(100 + k)) for k in range(30))


def test_spikes_of_a_sensor_are_no_change(beam: SeaStream) -> None:
    """One in a hundred samples is 20 standard deviations off."""
    for seed in range(10):
        rng, measured = np.random.default_rng([seed, 4]), beam.measured(200 + seed)
        measured[FIRST:] += 20.0 * NOISE * (rng.random(measured[FIRST:].shape) < 0.01) * rng.choice([-1.0, 1.0], 2)
        assert not alarms(beam, measured)


@pytest.mark.parametrize("seed", range(5))
def test_a_loaded_ship_is_told_within_seconds(beam: SeaStream, seed: int) -> None:
    """Mass and inertia grow by 10 % at 135 s."""
    inputs, model = beam.clean.inputs, beam.ship
    heavy = model.with_values({n: 1.1 * model.parameters[n].value for n in ("m", "I5")})

    def run(ship: Model, u: Array, x: Array) -> Array:
        batch = LinearBatch(ship, np.ascontiguousarray(u), np.array([0, len(u)]), DT, model.states)
        return batch.simulate(0, 1, x, ship.parameters.values[None], np.empty((1, 0)))[0]

    before = run(model, inputs[: CHANGED + 1], np.zeros((1, 4)))
    y = np.concatenate([before[:-1], run(heavy, inputs[CHANGED:], before[-1:])])
    measured = y[:, [0, 2]] + NOISE * np.random.default_rng([seed, 3]).standard_normal((len(y), 2))
    ((time, change),) = alarms(beam, measured)
    assert 0.0 < time - CHANGED * DT < 6.0
    assert change.between[0] - 1.0 <= CHANGED * DT <= change.between[1] + 1.0
