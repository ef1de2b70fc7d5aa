"""What a roll model's coefficients mean, and what is said of the inertia that nobody measured."""

import numpy as np
import pytest

from seatrial.core.values import Record, Ship
from seatrial.estimation.identify.roll_characteristics import one_speed_finding, roll_characteristics
from seatrial.estimation.information.covariance import Interval
from seatrial.physics.hydro.free_roll import equivalent_damping, swing_period
from seatrial.physics.models.nomoto import nomoto
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
