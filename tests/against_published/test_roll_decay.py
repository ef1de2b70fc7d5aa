"""KVLCC2's roll decays: fitted without a guess, one predicts the other, and no coefficient is needed beforehand.

Yardstick: the best public class of roll decay estimators reaches R2 = .99991 and .99906 on these runs.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.results import Fit
from seatrial.data.trial import load_trial
from seatrial.estimation.identify import identify

TRIAL = Path(__file__).parents[2] / "examples" / "kvlcc2_rolldecay.toml"
RUNS = ("model_test_21337", "model_test_21338")


@pytest.fixture(scope="module")
def fits(data_folder: Path) -> dict[str, Fit]:
    """By the run that trains."""
    trial = load_trial(TRIAL)
    role = {run.name: run.role for run in trial.runs}
    other = {RUNS[0]: role[RUNS[1]], RUNS[1]: role[RUNS[0]]}
    turned = replace(trial, runs=tuple(replace(run, role=other[run.name]) for run in trial.runs))
    assert data_folder
    return {RUNS[0]: identify(trial), RUNS[1]: identify(turned)}


def r_squared(fit: Fit, run: str) -> float:
    """Share of the roll angle's variance that the model, simulated open loop, explains."""
    (p,) = [p for p in fit.predictions if p.record == run]
    measured, simulated = p.measured["phi"], p.simulated["phi"]
    return 1.0 - float(np.sum((measured - simulated) ** 2) / np.sum((measured - measured.mean()) ** 2))


def test_each_run_is_fitted_better_than_by_the_best_public_class(fits: dict[str, Fit]) -> None:
    """From automatic starts."""
    assert r_squared(fits[RUNS[0]], RUNS[0]) >= 0.99998
    assert r_squared(fits[RUNS[1]], RUNS[1]) >= 0.9999


def test_one_run_predicts_the_other_without_being_refitted(fits: dict[str, Fit]) -> None:
    """Only its first ten seconds give the state it starts from."""
    assert r_squared(fits[RUNS[0]], RUNS[1]) >= 0.998
    assert r_squared(fits[RUNS[1]], RUNS[0]) >= 0.998


def test_intervals_of_the_two_runs_overlap(fits: dict[str, Fit]) -> None:
    """Of all coefficients; the angle of rest is each run's own. White-noise intervals would not overlap."""
    one, other = ({c.name: (c.lower, c.upper) for c in fits[run].coefficients} for run in RUNS)
    for name in ("b_1", "b_2", "b_3", "c_1", "c_3", "c_5"):
        (a, b), (c, d) = one[name], other[name]
        assert None not in (a, b, c, d)
        assert max(a or 0.0, c or 0.0) <= min(b or 0.0, d or 0.0), name
    assert all("process noise" in fit.method.intervals for fit in fits.values())


def test_both_find_the_same_natural_period(fits: dict[str, Fit]) -> None:
    """Within a tenth of a per cent: 2.551 and 2.550 s at model scale."""
    periods = []
    for fit in fits.values():
        (c_1,) = [c.estimate for c in fit.coefficients if c.name == "c_1"]
        periods.append(2.0 * np.pi / np.sqrt(c_1))
    assert periods[0] == pytest.approx(periods[1], rel=1e-3)
    assert periods[0] == pytest.approx(2.551, abs=0.005)
