"""Model discrepancy from errors made up with a known one."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.estimation.information.discrepancy import (
    GROWTH_POWER,
    NO_DISCREPANCY,
    HoldoutError,
    discrepancy,
    discrepancy_growth,
    excess_sd,
    measure_kind,
)

ROWS = 300


def errors(sd: float, foreseen: np.ndarray, rng: np.random.Generator, grown: np.ndarray | None = None) -> np.ndarray:
    scale = np.ones_like(foreseen) if grown is None else grown
    return np.hypot(foreseen, scale * sd) * rng.standard_normal(foreseen.shape)


def test_excess_is_recovered_from_errors_of_unequal_foresight(rng: np.random.Generator) -> None:
    foreseen = rng.uniform(0.1, 5.0, (ROWS, 40))
    found = excess_sd(errors(2.0, foreseen, rng), foreseen, np.ones((ROWS, 1)))
    assert np.mean(found) == pytest.approx(2.0, rel=0.05)


def test_errors_that_were_foreseen_leave_next_to_nothing(rng: np.random.Generator) -> None:
    foreseen = np.full((ROWS, 40), 3.0)
    found = excess_sd(errors(0.0, foreseen, rng), foreseen, np.ones((ROWS, 1)))
    assert np.median(found) < 0.8
    assert np.all(excess_sd(0.5 * foreseen, foreseen, np.ones((ROWS, 1))) == 0.0)


def test_missing_errors_do_not_count(rng: np.random.Generator) -> None:
    foreseen = np.full((ROWS, 3), 0.5)
    made = errors(1.0, foreseen, rng)
    more = np.vstack([made, np.full((50, 3), np.nan)])
    widened = np.vstack([foreseen, np.full((50, 3), np.nan)])
    np.testing.assert_allclose(
        excess_sd(more, widened, np.ones((ROWS + 50, 1))), excess_sd(made, foreseen, np.ones((ROWS, 1))), rtol=1e-9
    )


def test_runs_that_extrapolate_are_allowed_more(rng: np.random.Generator) -> None:
    """Errors of runs with index 2 are 4 times the discrepancy: what is found is that within the covered ground."""
    grown = np.repeat([[1.0], [discrepancy_growth(2.0)]], ROWS // 2, axis=0)
    foreseen = np.full((ROWS, 40), 0.2)
    found = excess_sd(errors(1.0, foreseen, rng, grown), foreseen, grown)
    assert np.mean(found) == pytest.approx(1.0, rel=0.05)


@given(st.floats(1e-3, 1e3))
def test_excess_has_the_unit_of_the_errors(unit: float) -> None:
    rng = np.random.default_rng(1)
    foreseen = rng.uniform(0.1, 1.0, (30, 4))
    made = errors(1.0, foreseen, rng)
    one = np.ones((30, 1))
    np.testing.assert_allclose(
        excess_sd(unit * made, unit * foreseen, one), unit * excess_sd(made, foreseen, one), rtol=1e-6
    )


def missed(run: int, rng: np.random.Generator, index: float = 1.0) -> HoldoutError:
    """A run whose heading error grows with the root of time, and whose overshoots are off by 1 deg."""
    time = np.arange(200)
    error = 0.01 * np.sqrt(time) * rng.standard_normal() * discrepancy_growth(index)
    found = {f"overshoot_{k}_deg": (float(rng.standard_normal()), 0.1) for k in (1, 2, 3)}
    nothing = np.full(200, 1e-4)
    return HoldoutError(f"run {run}", 0.2, {"psi": error}, {"psi": nothing}, found, index)


def test_few_runs_tell_nothing(rng: np.random.Generator) -> None:
    assert discrepancy([missed(0, rng), missed(1, rng)]) is NO_DISCREPANCY
    assert NO_DISCREPANCY.measure_sd("advance_L", 0.3, 2.0) == 0.3


def test_the_curve_never_falls_and_follows_the_errors(rng: np.random.Generator) -> None:
    found = discrepancy([missed(k, rng) for k in range(400)])
    curve = found.sd_by_time["psi"]
    assert np.all(np.diff(curve) >= 0)
    np.testing.assert_allclose(curve[[25, 100, 199]], 0.01 * np.sqrt([25, 100, 199]), rtol=0.15)
    assert found.sd_by_kind["overshoot_deg"] == pytest.approx(1.0, rel=0.1)
    long = found.channel_sd("psi", np.zeros(400), 0.2, 1.0)
    np.testing.assert_allclose(long[200:], curve[-1])
    np.testing.assert_allclose(found.channel_sd("psi", np.zeros(200), 0.2, 2.0), 2.0**GROWTH_POWER * curve)


def test_chance_adds_next_to_nothing_to_what_was_foreseen() -> None:
    """Nine runs whose errors are as large as foreseen, many times over: what excess there is averages out."""
    rng, time = np.random.default_rng(6), np.arange(1.0, 101.0)
    excess = []
    for _ in range(60):
        walks = np.cumsum(rng.standard_normal((9, len(time))), axis=1)
        errors = [HoldoutError(f"run {k}", 0.2, {"psi": w}, {"psi": np.sqrt(time)}) for k, w in enumerate(walks)]
        excess.append(discrepancy(errors).sd_by_time["psi"] ** 2 / time)
    assert np.mean(excess) < 0.14  # of the variance foreseen; set to zero at every sample where negative: 0.154


def test_what_is_foreseen_too_widely_late_does_not_cancel_what_is_missed_early() -> None:
    """Errors of 1 throughout, foreseen as 0.1 and later as 10: whole runs together would have an excess of nothing."""
    rng, foreseen = np.random.default_rng(2), np.where(np.arange(400) < 40, 0.1, 10.0)
    held = [
        HoldoutError(f"run {k}", 0.2, {"psi": rng.standard_normal(400)}, {"psi": foreseen}) for k in range(20)
    ]  # fmt: skip
    curve = discrepancy(held).sd_by_time["psi"]
    assert np.mean(curve[:10]) == pytest.approx(1.0, rel=0.1)


def test_kinds_nobody_saw_get_the_factor(rng: np.random.Generator) -> None:
    """Overshoots miss ten times what was foreseen."""
    found = discrepancy([missed(k, rng) for k in range(400)])
    assert found.factor == pytest.approx(10.0, rel=0.1)
    assert found.measure_sd("tactical_diameter_L", 0.02, 2.0) == pytest.approx(0.02 * found.factor)
    assert found.measure_sd("overshoot_7_deg", 0.0, 2.0) == pytest.approx(
        2.0**GROWTH_POWER * found.sd_by_kind["overshoot_deg"]
    )


def test_both_axes_of_the_track_share_their_discrepancy(rng: np.random.Generator) -> None:
    """North and east depend on the course the run happened to take."""
    track = [
        replace(missed(k, rng), errors={"x0": np.full(50, 1.0), "y0": np.zeros(50)},
                predicted_sd={"x0": np.full(50, 1e-3), "y0": np.full(50, 1e-3)})
        for k in range(5)
    ]  # fmt: skip
    found = discrepancy(track)
    np.testing.assert_allclose(found.sd_by_time["x0"], found.sd_by_time["y0"])
    np.testing.assert_allclose(found.sd_by_time["x0"], np.sqrt(0.5), rtol=1e-2)


def test_overshoots_are_of_one_kind() -> None:
    assert measure_kind("overshoot_12_deg") == "overshoot_deg"
    assert measure_kind("tactical_diameter_L") == "tactical_diameter_L"
