"""A published search on a stream: what it takes from the trial, and what it refuses. Streams: tests/onboard."""

from dataclasses import replace
from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.data.trial import EstimateMethod, EstimateSettings, SearchSettings, load_trial
from seatrial.estimation.identify.online import SearchFollower, own_trial


def test_the_packages_own_follower_keeps_every_setting_but_the_method(repository: Path) -> None:
    trial = load_trial(repository / "examples" / "heave_pitch_follow.toml")
    settings = EstimateSettings(method=EstimateMethod.IWHO, search=SearchSettings(), rate=2.0, channels=("z",))
    assert own_trial(replace(trial, estimate=settings)).estimate == EstimateSettings(rate=2.0, channels=("z",))


def test_a_box_is_needed_before_any_sample_comes(repository: Path) -> None:
    trial = load_trial(repository / "examples" / "heave_pitch_follow.toml")
    model = trial.model.with_parameters(trial.model.parameters.bounded("a33", 0.0, float("inf")))
    with pytest.raises(InputError, match="method 'iwho' searches within bounds, which a33 lacks"):
        SearchFollower(replace(trial, model=model, estimate=EstimateSettings(method=EstimateMethod.IWHO)), 0)
