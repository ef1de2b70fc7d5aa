"""The weak form: windows that vanish at their ends, equations that hold on smooth trajectories, noise averaged."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from seatrial.core.equations import Model, Sheet
from seatrial.core.values import Prior
from seatrial.estimation.regress.operators import WeakForm, window_bounds, window_function
from seatrial.numerics.optimise import Status, levenberg_marquardt

Array = NDArray[np.float64]
DT = 0.1


@cache
def oscillator() -> Model:
    """x' = -a x + b w, w' = -b x - c w: two rates, linear in a, b, c."""
    sheet = Sheet("decay")
    x, w = sheet.states("x w")
    force = sheet.input("force")
    a, b, c = (sheet.parameter(n, v, free=True) for n, v in (("a", 0.05), ("b", 0.9), ("c", 0.02)))
    sheet.rate(x, -a * x + b * w + force)
    sheet.rate(w, -b * x - c * w)
    return sheet.model()


def exact_states(time: Array) -> Array:
    """The solution from (1, 0) without force."""
    a, b, c = 0.05, 0.9, 0.02
    matrix = np.array([[-a, b], [-b, -c]])
    values, vectors = np.linalg.eig(matrix)
    weights = np.linalg.solve(vectors, np.array([1.0, 0.0]))
    return np.real(np.exp(np.outer(time, values)) * weights @ vectors.T)


@pytest.fixture
def weak() -> WeakForm:
    time = DT * np.arange(600)
    x = np.ascontiguousarray(exact_states(time))
    return WeakForm(oscillator(), (x,), (np.zeros((600, 1)),), DT, 5.0, np.ones(2))


def test_windows_cover_the_record_half_overlapping() -> None:
    found = window_bounds(101, 20)
    assert found[0] == (0, 40)
    assert {b - a for a, b in found} == {40}
    assert found[-1][1] == 100
    assert {b - a for a, b in zip([f[0] for f in found], [f[0] for f in found][1:], strict=False)} == {10}
    assert window_bounds(30, 100) == [(0, 28), (14, 42)][:1]


def test_window_vanishes_with_its_slope_at_the_ends() -> None:
    w, slope = window_function(50, DT)
    assert w[0] == w[-1] == slope[0] == slope[-1] == 0.0
    assert w[50] == 1.0
    np.testing.assert_allclose(slope[1:-1], np.gradient(w, DT)[1:-1], atol=2e-3)
    assert abs(np.sum(slope)) < 1e-12


def test_true_parameters_leave_no_residual(weak: WeakForm) -> None:
    """Up to the trapezoidal rule's error, sixth order in the sample interval for this window."""
    errors = []
    for rate in (1, 2):
        time = DT / rate * np.arange(600 * rate)
        x = np.ascontiguousarray(exact_states(time))
        finer = replace(weak, states=(x,), inputs=(np.zeros((len(x), 1)),), dt=DT / rate)
        errors.append(np.max(np.abs(finer.linearised(np.array([0.05, 0.9, 0.02]))[0])))
        wrong = np.max(np.abs(finer.linearised(np.array([0.05, 0.8, 0.02]))[0]))
        assert errors[-1] < 2e-6 * wrong
    assert errors[0] / errors[1] > 10.0


def test_one_step_from_zero_recovers_what_enters_linearly(weak: WeakForm) -> None:
    found = levenberg_marquardt(weak, np.zeros(3), np.zeros((0, 0))).solution
    np.testing.assert_allclose(found.point, [0.05, 0.9, 0.02], rtol=1e-5)
    assert found.status is Status.CONVERGED


def test_jacobian_and_gradient_against_differences(weak: WeakForm) -> None:
    weak = replace(weak, residual_sd=np.array([0.5, 2.0]))
    point, none = np.array([0.1, 0.5, 0.3]), np.zeros((0, 0))
    jacobian, normal = weak.linearised(point)[1], weak.normal(point, none)
    assert normal.cost == pytest.approx(weak.cost(point, none))
    for i, h in enumerate(1e-5 * np.eye(3)):
        column = (weak.linearised(point + h)[0] - weak.linearised(point - h)[0]) / 2e-5
        np.testing.assert_allclose(jacobian[:, :, i], column, atol=1e-9)
        slope = (weak.cost(point + h, none) - weak.cost(point - h, none)) / 2e-5
        assert normal.gradient[i] == pytest.approx(slope, rel=1e-6)


def test_offsets_of_states_do_not_matter_to_the_window() -> None:
    """A record far from the origin: position-like states lose no digits."""
    sheet = Sheet("drift")
    (x,) = sheet.states("x")
    sheet.rate(x, sheet.parameter("k", 1.0, free=True))
    model, time, found = sheet.model(), DT * np.arange(200), []
    for origin in (0.0, 1e6):
        states = np.ascontiguousarray(origin + 0.3 * time[:, None])
        weak = WeakForm(model, (states,), (np.zeros((200, 0)),), DT, 4.0, np.ones(1))
        found.append(levenberg_marquardt(weak, np.zeros(1), np.zeros((0, 0))).solution.point[0])
    assert found[0] == pytest.approx(0.3, rel=1e-5)
    assert found[1] == pytest.approx(found[0], rel=1e-8)


def test_noise_is_averaged_not_differentiated(weak: WeakForm, rng: np.random.Generator) -> None:
    """Against regression on central differences of the same noisy states."""
    noisy = weak.states[0] + 0.01 * rng.standard_normal(weak.states[0].shape)
    found = levenberg_marquardt(replace(weak, states=(noisy,)), np.zeros(3), np.zeros((0, 0))).solution.point
    rates = np.gradient(noisy, DT, axis=0)
    x, w, zero = noisy[:, 0], noisy[:, 1], np.zeros(len(noisy))
    features = np.concatenate([np.stack([-x, w, zero], axis=1), np.stack([zero, -x, -w], axis=1)])
    naive = np.linalg.lstsq(features, rates.T.ravel())[0]
    truth = np.array([0.05, 0.9, 0.02])
    assert np.max(np.abs(found - truth)) < 2e-3
    assert np.max(np.abs(found - truth)) < 0.5 * np.max(np.abs(naive - truth))


def test_priors_and_bounds_come_from_the_parameters(weak: WeakForm) -> None:
    parameters = weak.model.parameters.with_priors({"a": Prior(0.2, 1e-6)}).bounded("c", 0.1, 1.0)
    weak = replace(weak, model=weak.model.with_parameters(parameters), residual_sd=np.full(2, 1e-3))
    found = levenberg_marquardt(weak, np.array([0.0, 0.0, 0.5]), np.zeros((0, 0))).solution.point
    assert found[0] == pytest.approx(0.2, abs=1e-3)
    assert found[2] == pytest.approx(0.1)


def test_several_runs_count_together(weak: WeakForm) -> None:
    double = replace(weak, states=weak.states * 2, inputs=weak.inputs * 2)
    point, none = np.zeros(3), np.zeros((0, 0))
    assert double.cost(point, none) == pytest.approx(2 * weak.cost(point, none))


def test_a_held_input_is_integrated_as_it_acts(rng: np.random.Generator) -> None:
    """The state of x' = -a x + u, u constant between samples, in closed form; straight lines would put u half a
    sample early."""
    sheet = Sheet("held")
    x = sheet.states("x")[0]
    force = sheet.input("force", is_held=True)
    a, b = (sheet.parameter(n, 1.0, free=True) for n in ("a", "b"))
    sheet.rate(x, -a * x + b * force)
    force_values, decay = rng.standard_normal(2000), np.exp(-0.3 * DT)
    states = np.zeros(2000)
    for k in range(1999):
        states[k + 1] = decay * states[k] + 2.0 * (1.0 - decay) / 0.3 * force_values[k]
    weak = WeakForm(sheet.model(), (states[:, None],), (force_values[:, None],), DT, 5.0, np.ones(1))
    solution = levenberg_marquardt(weak, np.ones(2), np.zeros((0, 0))).solution
    np.testing.assert_allclose(solution.point, [0.3, 2.0], rtol=2e-3)
