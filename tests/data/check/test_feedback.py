"""Inputs that follow outputs are found where a controller steers, and not where a programme does."""

import numpy as np
import pytest
from scipy.special import chdtrc

from seatrial.core.values import Record
from seatrial.data.check.inputs import chi_square_tail, feedback_findings, feedback_tests, has_feedback

DT, ROWS, K, T = 0.1, 6001, 0.15, 8.0


def steered(seed: int, *, is_closed: bool, gust: float = np.radians(1.2), is_coarse: bool = False) -> Record:
    """T r' + r = K (delta + w), w first-order with a memory of 5 s, heading steps of +-10 deg each minute.

    is_coarse: one course, and orders in whole degrees.
    """
    rng = np.random.default_rng(seed)
    delta, r, psi = np.zeros(ROWS), np.zeros(ROWS), np.zeros(ROWS)
    bits = np.repeat(rng.choice([-1.0, 1.0], ROWS // 40 + 1), 40)[:ROWS] * np.radians(4.0)
    noise, force, keep = rng.standard_normal((ROWS, 2)) * np.radians([0.05, 0.02]), 0.0, np.exp(-DT / 5.0)
    for k in range(ROWS - 1):
        course = 0.0 if is_coarse else np.radians(10.0) * (1.0 if int(k * DT // 60.0) % 2 == 0 else -1.0)
        order = course - psi[k] - noise[k, 0] - 4.0 * (r[k] + noise[k, 1]) if is_closed else bits[k]
        order = np.radians(np.round(np.degrees(order))) if is_coarse else order
        delta[k + 1] = delta[k] + np.clip(order - delta[k], -0.01, 0.01)
        force = keep * force + np.sqrt(1.0 - keep**2) * gust * rng.standard_normal()
        r[k + 1] = r[k] + DT / T * (K * (delta[k] + force) - r[k])
        psi[k + 1] = psi[k] + DT * r[k]
    time = DT * np.arange(ROWS)
    return Record.from_arrays("run", time, {"delta": delta, "psi": psi + noise[:, 0], "r": r + noise[:, 1]})


@pytest.mark.parametrize("seed", range(3))
def test_a_controller_is_found(seed: int) -> None:
    record = steered(seed, is_closed=True)
    (test,) = feedback_tests(record)
    assert test.has_feedback
    assert test.command == "delta"
    assert test.motion in ("psi", "r")
    assert test.correlation < 0.0 < test.lag
    (finding,) = feedback_findings(record)
    assert finding.code == "feedback"
    assert "prediction error with a disturbance model" in finding.message


@pytest.mark.parametrize("seed", range(3))
def test_a_controller_is_found_whose_orders_are_coarse(seed: int) -> None:
    """Their steps hide most of what it answers."""
    record = steered(seed, is_closed=True, gust=np.radians(0.8), is_coarse=True)
    half = Record.from_arrays("run", record.time[::2], {n: record[n][::2] for n in ("delta", "psi")})
    (test,) = feedback_tests(half)
    assert test.has_feedback
    assert test.correlation < 0.0


@pytest.mark.parametrize("seed", range(3))
def test_a_programme_is_none(seed: int) -> None:
    record = steered(seed, is_closed=False)
    assert feedback_tests(record)[0].p > 1e-3
    assert not has_feedback(record)
    assert feedback_findings(record) == ()


def test_a_record_without_motion_or_too_short_says_nothing() -> None:
    record = steered(0, is_closed=True)
    short = Record.from_arrays("short", record.time[:20], {n: record[n][:20] for n in ("delta", "psi")})
    still = Record.from_arrays("still", record.time, {"delta": record["delta"]})
    assert feedback_tests(short) == feedback_tests(still) == ()


def test_the_tail_of_chi_square_is_that_of_another_code() -> None:
    values = np.array([0.0, 0.5, 3.0, 20.0, 90.0])
    np.testing.assert_allclose(chi_square_tail(10, values), chdtrc(10, values), rtol=1e-13)
