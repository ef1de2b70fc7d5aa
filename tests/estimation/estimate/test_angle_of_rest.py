"""The interval of the angle of rest of few roll decays, under forces slower than the roll."""

import numpy as np
import pytest
from scipy.stats import t as student

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record
from seatrial.estimation.estimate import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.intervals import with_slow_forces
from seatrial.physics.models.roll import roll
from seatrial.physics.simulate.replay import trajectory

TRUE = {"b_1": 0.06, "b_2": 0.35, "c_1": 0.698, "c_3": 0.0, "phi_0": 0.002}
DT, ROWS, NOISE = 0.2, 375, np.radians(0.05)


def model() -> Model:
    one = roll()
    return one.with_parameters(one.parameters.only_free(list(TRUE)))


def decay(name: str, start: float, heel: Array | float, seed: int) -> Record:
    inputs = np.zeros((ROWS, 2))
    inputs[:, 0] = heel  # a constant slope of the water heels the ship by as much
    phi = trajectory(model().with_values(TRUE), inputs, DT, np.array([start, 0.0]))[0][:, 0]
    noise = NOISE * np.random.default_rng(seed).standard_normal(ROWS)
    return Record.from_arrays(name, DT * np.arange(0.0, ROWS), {"phi": phi + noise})


def fitted(*heels: Array | float) -> Estimation:
    runs = [decay(f"run_{k}", 0.25 * (-1.0) ** k, heel, k) for k, heel in enumerate(heels)]
    return estimate_model(model(), Runs.one_session_each(runs, 5.0), options=EstimatorOptions(workers=1))


def half_width(estimation: Estimation) -> float:
    return float(estimation.interval.half_width[estimation.estimate.problem.free.index("phi_0")])


@pytest.mark.parametrize("heels", [(0.003, -0.001), (0.002, -0.001, -0.004)])
def test_heels_that_differ_from_run_to_run_widen_it_by_students_t(heels: tuple[float, ...]) -> None:
    """Each run's mean heel is its angle of rest, so that their mean has the interval of Student (1908)."""
    estimation, n = fitted(*heels), len(heels)
    spread = float(np.std(heels, ddof=1)) / np.sqrt(n)
    assert half_width(estimation) == pytest.approx(float(student.ppf(0.975, n - 1)) * spread, rel=0.05)
    assert estimation.model.parameters["phi_0"].value == pytest.approx(TRUE["phi_0"] + np.mean(heels), abs=2e-4)
    assert estimation.interval.meaning.endswith(f"phi_0 by one-step jackknife over {n} runs")


def test_other_coefficients_keep_their_intervals() -> None:
    estimation = fitted(0.003, -0.001)
    estimate, before = estimation.estimate, estimation.interval
    again = with_slow_forces(before, estimate, estimation.residuals)
    place = estimate.problem.free.index("phi_0")
    others = np.arange(len(estimate.problem.free)) != place
    np.testing.assert_array_equal(again.covariance[np.ix_(others, others)], before.covariance[np.ix_(others, others)])
    assert again.covariance[place, place] == pytest.approx(before.covariance[place, place])


def test_a_heel_that_drifts_through_the_only_run_widens_it() -> None:
    still, drifting = fitted(0.0), fitted(np.linspace(-0.004, 0.004, ROWS))
    assert still.whiteness.is_white and "phi_0" not in still.interval.meaning
    # a ramp of +-a: the mean's error by the first cosine 4 sqrt(2) a / pi^2, none by the second; t of two freedoms
    expected = float(student.ppf(0.975, 2)) * np.sqrt(0.5) * 4.0 * np.sqrt(2.0) * 0.004 / np.pi**2
    assert half_width(drifting) == pytest.approx(expected, rel=0.15)
    assert half_width(still) < 0.1 * half_width(drifting)
    assert abs(drifting.model.parameters["phi_0"].value - TRUE["phi_0"]) < half_width(drifting)


def test_without_a_free_angle_of_rest_nothing_changes() -> None:
    fixed = model().with_parameters(model().parameters.fixed("phi_0"))
    runs = [decay("a", 0.25, 0.003, 1), decay("b", -0.25, -0.003, 2)]
    estimation = estimate_model(fixed, Runs.one_session_each(runs, 5.0), options=EstimatorOptions(workers=1))
    assert with_slow_forces(estimation.interval, estimation.estimate, estimation.residuals) is estimation.interval
