"""What several starts say of an estimate: an end that is as good and far away is named."""

from dataclasses import replace

import pytest
from tests.estimation.identify.conftest import WriteTrial

from seatrial.core.results import SearchAttempt
from seatrial.data.trial import checked_records, load_trial
from seatrial.estimation.estimate import Estimation, Runs, estimate_model
from seatrial.estimation.identify.warnings import other_optima


@pytest.fixture
def estimation(trial_of: WriteTrial) -> Estimation:
    trial = load_trial(trial_of({"a": 0.0}))
    (record,) = [r.record for r in checked_records(trial).records]
    return estimate_model(trial.model, Runs.one_session_each([record], trial.ship.length), trial.estimate)


def with_attempt(estimation: Estimation, loss: float, T: float) -> Estimation:
    names = estimation.estimate.problem.free
    point = dict(zip(names, map(float, estimation.estimate.common_parameters), strict=False))
    used = SearchAttempt("weak form", 10.0, 0.0, 30, point, is_used=True)
    other = SearchAttempt("drawn point 1", 50.0, loss, 30, point | {"T": T}, is_used=False)
    return replace(estimation, search_attempts=(used, other))


def test_an_end_that_is_as_good_and_far_away_is_a_warning(estimation: Estimation) -> None:
    (finding,) = other_optima(with_attempt(estimation, 0.5, T=99.0))
    assert finding.code == "equal-optimum"
    assert "T = 99 instead of" in finding.message
    assert "drawn point 1" in finding.evidence


def test_a_worse_end_and_one_at_the_same_place_are_none(estimation: Estimation) -> None:
    T = float(estimation.model.parameters["T"].value)
    assert other_optima(with_attempt(estimation, 5.0, T=99.0)) == []
    assert other_optima(with_attempt(estimation, 0.5, T=T)) == []
    assert other_optima(estimation) == []
