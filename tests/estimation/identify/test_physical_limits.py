"""Values that no craft has: signs of masses and damping, distance from priors, damping of roll over amplitudes."""

import numpy as np

from seatrial.core.values import Prior, Record, Severity, Ship
from seatrial.estimation.identify.roll_characteristics import objections, roll_characteristics, unphysical_finding
from seatrial.estimation.information.covariance import Interval
from seatrial.physics.models import model_named
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.models.roll import roll

DECAY = (Record.from_arrays("decay", 0.1 * np.arange(50.0), {"phi": 0.3 * np.cos(0.2 * np.arange(50.0))}),)


def test_published_coefficients_meet_no_objection() -> None:
    model = kvlcc2()
    freed = model.with_parameters(model.parameters.freed("m_x_prime", "m_y_prime", "J_z_prime"))
    assert objections(freed, ()) == ()


def test_masses_and_damping_of_the_wrong_sign_are_named() -> None:
    model = kvlcc2()
    wrong = {"m_x_prime": -0.01, "Y_v": 0.2}
    free = model.with_parameters(model.parameters.freed("m_x_prime")).with_values(wrong)
    assert objections(free, ()) == ("m_x_prime -0.01 is negative", "Y_v 0.2 is positive")
    assert objections(model.with_values({"m_x_prime": -0.01}), ()) == ()  # given, not estimated


def test_values_far_off_their_prior_are_named() -> None:
    model = kvlcc2()
    priors = {"X_vv": Prior(model.parameters["X_vv"].value, 0.01)}
    near = model.with_parameters(model.parameters.with_priors(priors))
    assert objections(near, ()) == ()
    far = near.with_values({"X_vv": priors["X_vv"].mean + 0.05})
    assert objections(far, ()) == ("X_vv is 5.0 standard deviations off its prior",)
    assert objections(far, (), {"X_vv": 0.01}) == ()  # 5 / sqrt(2), by an estimated size of the craft


def test_a_prior_whose_spread_is_assumed_makes_nothing_implausible() -> None:
    model = kvlcc2()
    mean = model.parameters["X_vv"].value
    guessed = {"X_vv": Prior(mean, 0.01, is_spread_assumed=True)}
    far = model.with_parameters(model.parameters.with_priors(guessed)).with_values({"X_vv": mean + 0.05})
    (finding,) = unphysical_finding(far, ())
    assert finding.severity is Severity.INFO and "X_vv is 5.0 standard deviations off" in finding.text


def test_damping_of_roll_is_judged_over_the_measured_amplitudes() -> None:
    base = {"c_1": 6.0, "b_1": 0.1}
    assert objections(roll().with_values({**base, "b_2": 0.2}), DECAY) == ()
    assert objections(roll().with_values({**base, "b_2": 0.0}), DECAY) == ()
    assert objections(roll().with_values({**base, "b_2": -0.05}), DECAY) == ("its damping decreases with amplitude",)
    negative = roll().with_values({**base, "b_2": -1.0})
    assert objections(negative, DECAY) == ("its damping is negative at amplitudes that were measured",)


def test_damping_that_chance_alone_makes_fall_is_not_implausible() -> None:
    """A roll whose intervals hold constant damping, and one whose do not."""
    model = roll().with_values({"c_1": 6.0, "b_1": 0.1, "b_2": -0.05})
    free = ("b_1", "b_2")
    for error, count in ((0.02, 0), (0.001, 1)):
        interval = Interval(error**2 * np.eye(2), np.inf, "")
        characteristics = roll_characteristics(model, interval, free, DECAY, Ship("ship", {"L": 1.0}))
        assert len(unphysical_finding(model, DECAY, roll=characteristics)) == count


def test_what_no_craft_has_is_a_warning_with_a_cure() -> None:
    assert unphysical_finding(roll().with_values({"c_1": 6.0, "b_1": 0.1, "b_2": 0.2}), DECAY) == ()
    (finding,) = unphysical_finding(roll().with_values({"c_1": 6.0, "b_1": 0.1, "b_2": -0.05}), DECAY)
    assert finding.code == "unphysical-values"
    assert "its damping decreases with amplitude" in finding.text
    assert "[model.fixed]" in finding.advice
    waves = model_named("heave_pitch")
    waves = waves.with_parameters(waves.parameters.with_priors({"b33": Prior(1.0, 0.1)})).with_values({"b33": 2.0})
    (finding,) = unphysical_finding(waves, ())
    assert "b33 is 10.0 standard deviations off its prior" in finding.text and "b_2" not in finding.advice
    (finding,) = unphysical_finding(kvlcc2().with_values({"Y_v": 0.2}), ())
    assert "Y_v 0.2 is positive" in finding.text
