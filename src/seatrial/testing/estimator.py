"""An estimator by regression, checked on a simulated run whose coefficients are known."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model, Sheet
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.regress.estimators import RegressionEstimate, RegressionEstimator
from seatrial.physics.simulate.replay import replay
from seatrial.testing.conformance import require, require_refusal

_STEP, _DURATION = 0.1, 400.0  # s; ours: ten samples a second over ten rudder periods
_RUDDER, _PERIOD = 0.3, 40.0  # rad and s; ours: rudder to both sides, slow against the response
_START_FACTOR = 1.7  # dimensionless; ours: another start value for every coefficient
_SAME = 1e-6  # relative; ours: what another start value may change by rounding


def check_estimator(estimator: RegressionEstimator, tolerance: float = 0.2) -> None:
    """Check an estimator: coefficients of a noise-free run, independent of start values, reproducible, refusals.

    Args:
        estimator: as the entry points of ``seatrial.estimators`` offer it.
        tolerance: largest relative error of a coefficient on the noise-free run.

    Raises:
        ConformanceError: the first violation.
    """
    require(bool(estimator.name) and isinstance(estimator.name, str), "name is empty; tables need it")
    model = steering_model()
    records = [simulated_steering(model)]
    truth = np.array([p.value for p in model.parameters.free])
    values = _coefficients(estimator, model, records)
    again = _coefficients(estimator, model, records)
    require(values.tobytes() == again.tobytes(), "the same records give other coefficients; fix the seed")
    worst = float(np.max(np.abs(values / truth - 1.0)))
    require(worst <= tolerance, f"a coefficient is {worst:.0%} off on a run without noise (tolerance {tolerance:.0%})")
    moved = model.with_values({p.name: _START_FACTOR * p.value for p in model.parameters.free})
    other = _coefficients(estimator, moved, records)
    independent = np.allclose(other, values, rtol=_SAME, atol=0.0)
    require(independent, "the coefficients depend on the values that the model comes with; estimate from records alone")
    blind = [record.without("r", "psi") for record in records]
    require_refusal(lambda: estimator.estimate(model, blind), InputError, "a record without any state of the model")


def steering_model() -> Model:
    """Return a model of yaw rate and heading that is linear in its three coefficients."""
    sheet = Sheet("steering", source="Norrbin 1963, nonlinear steering equation, solved for the yaw acceleration")
    r, psi = sheet.states("r psi")
    delta = sheet.input("delta")
    # coefficients of a ship that is straight-line stable; chosen
    damping = sheet.parameter("a_r", -0.3, "1/s", "damping", free=True)
    cubic = sheet.parameter("a_rrr", -8.0, "s/rad^2", "cubic damping", free=True)
    rudder = sheet.parameter("a_delta", 0.12, "1/s^2", "rudder", free=True)  # of a model of some metres; chosen
    sheet.rate(r, damping * r + cubic * r**3 + rudder * delta)
    sheet.rate(psi, r)
    return sheet.model()


def simulated_steering(model: Model) -> Record:
    """Return a simulated run of the model under a rudder of two frequencies, without noise."""
    time = np.arange(0.0, _DURATION, _STEP)
    phase = 2.0 * np.pi * time / _PERIOD
    rudder = _RUDDER * np.sin(phase) + _RUDDER / 2.0 * np.sin(3.0 * phase)
    return replay(model, Record.from_arrays("steering", time, {"delta": rudder}), {"r": 0.0, "psi": 0.0})


def _coefficients(estimator: RegressionEstimator, model: Model, records: Sequence[Record]) -> Array:
    """Return the coefficients of one estimate after checking their form, shape (k,)."""
    estimate = estimator.estimate(model, records)
    kind = type(estimate).__name__
    require(isinstance(estimate, RegressionEstimate), f"estimate() returns a {kind}, not a RegressionEstimate")
    names = model.parameters.free_names
    shape = np.shape(estimate.values)
    require(shape == (len(names),), f"values have shape {shape} for the {len(names)} free coefficients of the model")
    finite = [name for name, value in zip(names, estimate.values, strict=True) if not np.isfinite(value)]
    require(not finite, f"the coefficient {', '.join(finite)} is not a finite number")
    return estimate.values
