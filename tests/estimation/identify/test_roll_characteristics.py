"""What a roll model's coefficients mean, which values no craft has, and where its inertia comes from."""

import math

import numpy as np
import pytest

from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.values import Prior, Record, Severity, Ship
from seatrial.estimation.identify.characteristics import (
    gyradius_findings,
    objections,
    one_speed_finding,
    roll_characteristics,
    roll_inertia,
    unphysical_finding,
)
from seatrial.estimation.information.covariance import Interval
from seatrial.physics.hydro.free_roll import equivalent_damping, metacentric_height, swing_period
from seatrial.physics.models import model_named
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.models.roll import roll
from seatrial.physics.simulate.replay import trajectory

TRUE = {"b_1": 0.03, "b_2": 0.2, "b_3": 0.1, "c_1": 4.0, "c_3": 6.0, "c_5": -20.0, "phi_0": 0.01}
FREE = tuple(TRUE)
SHIP = Ship("barge", {"L": 20.0, "B": 5.0})


@pytest.fixture(scope="module")
def decay() -> Record:
    """Released at 14 deg."""
    states, _ = trajectory(roll().with_values(TRUE), np.zeros((1200, 2)), 0.05, np.array([0.25, 0.0]))
    return Record.from_arrays("decay", np.arange(0.0, 1200.0) * 0.05, {"phi": states[:, 0]})


def correlated() -> Interval:
    """Standard errors of 10 % with correlations."""
    shape = np.random.default_rng(3).standard_normal((7, 9))
    size = 0.1 * np.abs(np.array(list(TRUE.values())))
    return Interval(np.corrcoef(shape) * np.outer(size, size), np.inf, "")


def test_values_and_bands_are_those_of_draws(decay: Record) -> None:
    """Bands of ships drawn from the covariance, to 5 % of their width."""
    interval = correlated()
    ship = roll().with_values(TRUE)
    known = roll_characteristics(ship, interval, FREE, [decay], SHIP)
    assert known is not None
    small = Interval(1e-4 * interval.covariance, np.inf, "")
    narrow = roll_characteristics(ship, small, FREE, [decay], SHIP)
    assert narrow is not None
    drawn = np.random.default_rng(1).multivariate_normal(list(TRUE.values()), small.covariance, 4000)
    at = np.array(known.amplitude)[[9, 39]]
    damping = np.array([equivalent_damping(d[:3], d[3:6], at)[0] for d in drawn])
    period = np.array([swing_period(d[3:6], at)[0] for d in drawn])
    for k, place in enumerate((9, 39)):
        width = narrow.damping_upper[place] - narrow.damping_lower[place]
        assert 2 * 1.96 * np.std(damping[:, k]) == pytest.approx(width, rel=0.06)
        width = narrow.period_upper[place] - narrow.period_lower[place]
        assert 2 * 1.96 * np.std(period[:, k]) == pytest.approx(width, rel=0.06)
    assert known.natural_period.value == pytest.approx(np.pi)
    assert known.damping_ratio.value == pytest.approx(0.0075)
    assert known.natural_period.upper - known.natural_period.value == pytest.approx(1.96 * 0.05 * np.pi, rel=1e-3)


def test_recorded_swings_lie_on_the_curve_and_only_decays_have_them(decay: Record) -> None:
    """Damping of each swing within 4 % of the model's."""
    known = roll_characteristics(roll().with_values(TRUE), correlated(), FREE, [decay], SHIP)
    assert known is not None
    seen = np.array(known.swings)
    expected = np.interp(seen[:, 0], known.amplitude, known.damping)
    np.testing.assert_allclose(seen[:, 1], expected, rtol=0.04)
    waves = decay.with_channel("alpha_w", decay.channel("phi"))
    driven = roll_characteristics(roll().with_values(TRUE), correlated(), FREE, [waves], SHIP)
    assert driven is not None
    assert driven.swings == ()


def test_without_any_size_there_is_no_metacentric_height(decay: Record) -> None:
    """And the way out is named; models that do not roll have no such chapter."""
    known = roll_characteristics(roll().with_values(TRUE), correlated(), FREE, [decay], Ship("s", {"L": 3.0}))
    assert known is not None
    assert known.metacentric_height is None
    assert "give GM, k_xx_prime, k_xx or B" in known.gyradius_source
    assert roll_characteristics(nomoto(), correlated(), FREE, [decay], SHIP) is None


@pytest.mark.parametrize(
    ("speeds", "text"),
    [((1.0, 1.01), "at 1 m/s alone"), ((None, None), "without a channel of speed (u)"), ((0.0, 1.0), "")],
)
def test_decays_at_one_speed_are_said_not_to_identify_its_effect(
    decay: Record, speeds: tuple[float | None, ...], text: str
) -> None:
    runs = [
        decay if u is None else Record.from_arrays(str(u), decay.time, {"phi": decay["phi"], "u": u + 0.0 * decay.time})
        for u in speeds
    ]
    known = roll_characteristics(roll().with_values(TRUE), correlated(), FREE, runs, SHIP)
    findings = one_speed_finding(known, runs)
    assert [text in f.message for f in findings] == ([True] if text else [])
    assert one_speed_finding(None, runs) == ()


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


C_1 = IntervalEstimate(1.0, 0.9, 1.1)


@pytest.mark.parametrize(
    ("particulars", "value", "width", "said"),
    [
        ({"k_xx_prime": 2.1, "k_xx": 1.0}, 2.1, 0.0, "taken as exact"),
        ({"k_xx": 1.9, "B": 5.0, "GM": 9.0}, 1.9 * math.sqrt(1.18), 0.219, "added inertia of 18 (5 to 30) %"),
        ({"B": 5.0}, 2.0, 0.5, "0.4 (0.35 to 0.45) of the breadth"),
    ],
)
def test_the_radius_of_gyration_is_given_or_assumed(
    particulars: dict[str, float], value: float, width: float, said: str
) -> None:
    inertia = roll_inertia(Ship("s", particulars), C_1)
    radius, height = inertia.gyradius, inertia.metacentric_height
    assert radius is not None and height is not None
    assert radius.value == pytest.approx(value)
    assert radius.upper - radius.lower == pytest.approx(width, abs=1e-3)
    assert said in inertia.source
    assert height.lower == pytest.approx(metacentric_height(0.9, radius.lower))
    assert height.upper == pytest.approx(metacentric_height(1.1, radius.upper))


def test_a_metacentric_height_that_is_known_gives_the_radius() -> None:
    """And the way back gives the height again; the breadth is no longer needed."""
    inertia = roll_inertia(Ship("s", {"GM": 1.1, "B": 5.0}), C_1)
    radius, height = inertia.gyradius, inertia.metacentric_height
    assert radius is not None and height is not None
    assert (height.lower, height.value, height.upper) == (1.1, 1.1, 1.1)
    assert metacentric_height(1.0, radius.value) == pytest.approx(1.1)
    assert metacentric_height(0.9, radius.upper) == metacentric_height(1.1, radius.lower) == pytest.approx(1.1)
    assert "GM of the ship, 1.1 m" in inertia.source


def test_a_period_that_is_not_determined_leaves_the_radius_open() -> None:
    radius = roll_inertia(Ship("s", {"GM": 1.1}), IntervalEstimate(1.0, -0.1, 2.1)).gyradius
    assert radius is not None and radius.upper == math.inf


@pytest.mark.parametrize(("radius", "text"), [(3.87, "0.47 of the breadth"), (2.0, "0.24 of the breadth"), (3.2, "")])
def test_a_radius_unusual_for_the_breadth_is_named_with_the_usual_height(radius: float, text: str) -> None:
    ship = Ship("yacht", {"L": 36.0, "B": 8.2, "GM": 1.1})
    findings = gyradius_findings(ship, IntervalEstimate(radius, radius, radius))
    assert [text in f.message for f in findings] == ([True] if text else [])
    if radius == 3.87:
        assert "GM would be 0.79 m" in findings[0].advice


def test_without_height_breadth_or_radius_nothing_is_judged() -> None:
    radius = IntervalEstimate(9.0, 9.0, 9.0)
    assert gyradius_findings(Ship("s", {"B": 8.2}), radius) == gyradius_findings(Ship("s", {"GM": 1.0}), radius) == ()
    assert gyradius_findings(Ship("s", {"B": 8.2, "GM": 1.0}), None) == ()
