"""Simulated trials err as predicted, also where a coefficient is far below the size that its model gives its kind."""

import math

import numpy as np
import pytest

from seatrial.core.values import Ship
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.estimation.design.design import confirm_design
from seatrial.estimation.design.manoeuvre_information import input_series, planned_record
from seatrial.estimation.design.task import DesignTask, coefficient_magnitudes, draw_ships, relative_spread
from seatrial.physics.models import model_named

COEFFICIENTS = {"Y_v": -0.022, "Y_r": 0.0039, "Y_d": 0.0048, "N_v": -0.0013, "N_r": -0.0031, "N_d": 0.0016}
SHIP = {"L": 88.0, "m": 4.2e6, "x_G": 0.0, "I_z": 2.0e9, "rho": 1025.0, "U_n": 6.2}
FIXED = {"X_u": -0.0033, "X_rr": -0.01, "N_rrr": -0.004, "X_udot": -0.0006, "Y_vdot": -0.01, "N_rdot": -0.0005}
NOISE = {"u": 0.01, "v": 0.003, "r": 5e-5, "psi": 5e-4}
ORDERS = np.array([1.0, -1.0, -1.0, 1.0, 0.5, -0.5])
TRIALS = 100


def coaster(*, is_fitted: bool) -> DesignTask:
    """Four minutes of a coaster of 88 m, whose yaw coefficients are a tenth of the size of their kind."""
    model = model_named("abkowitz").with_values({**SHIP, **FIXED, **COEFFICIENTS})
    model = model.with_parameters(model.parameters.only_free(tuple(COEFFICIENTS)))
    reach = math.radians(20.0)
    rudder = InputRange(lower=-reach, upper=reach, unit="rad", rate=math.radians(2.5), hold=40.0)
    covariance = np.diag([(0.01 * p.value) ** 2 for p in model.parameters.free]) if is_fitted else None
    request = DesignRequest(duration=240.0, rate=1.0, inputs={"delta": rudder}, prior_percent=2.0)
    return DesignTask("", Ship("coaster", {"L": SHIP["L"]}), model, NOISE, request, covariance)


@pytest.mark.parametrize("is_fitted", [False, True])
def test_the_error_of_each_coefficient_is_the_one_predicted(is_fitted: bool) -> None:
    """The rms of 100 errors has a standard error of 7 %: within a quarter of the predicted one for each of six."""
    task = coaster(is_fitted=is_fitted)
    inputs = input_series(task, [ORDERS * task.request.actuators[0].upper], 1.0)
    tried = confirm_design(
        task, inputs, planned_record(task, inputs, 1.0), draw_ships(task, 1, TRIALS - 1), 1, lambda _: None
    )
    assert tried.converged_runs == TRIALS
    assert np.all((tried.error / tried.bound > 0.8) & (tried.error / tried.bound < 1.25))


def test_what_a_fit_does_not_distinguish_from_zero_counts_by_its_standard_deviation() -> None:
    """One assumed zero counts by its kind's size; how far a ship may differ is a share of the same."""
    task = coaster(is_fitted=False)
    place = list(COEFFICIENTS).index("N_v")
    zero = task.model.with_values({"N_v": 0.0})
    deviations = np.full(len(COEFFICIENTS), 1e-5)
    deviations[place] = 0.004
    values = zero.parameters.values[None]
    unfitted = DesignTask("", task.ship, zero, NOISE, task.request)
    fitted = DesignTask("", task.ship, zero, NOISE, task.request, np.diag(deviations**2))
    assert coefficient_magnitudes(unfitted, values)[0, place] == zero.parameters["N_v"].scale
    assert coefficient_magnitudes(fitted, values)[0, place] == pytest.approx(0.004)
    assert relative_spread(fitted)[place] == pytest.approx(1.0)
    assert relative_spread(unfitted)[place] == pytest.approx(0.02)
