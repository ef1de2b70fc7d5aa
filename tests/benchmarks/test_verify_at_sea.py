"""Logs of a simulator of its own, verified: what changed is named."""

import pytest
from benchmarks.verify_at_sea import CHANGES, Change, Trial, is_named, log_of, tuned_trial

from seatrial.control.verification.verify import verify


@pytest.fixture(scope="module")
def trial() -> Trial:
    return tuned_trial()


@pytest.mark.long(every=len(CHANGES[::2]))
@pytest.mark.parametrize("change", CHANGES[::2], ids=lambda c: c.name)
def test_what_changed_is_named(trial: Trial, change: Change) -> None:
    made = verify(trial.task, trial.gains, [log_of(trial, change, 7)])
    assert is_named(change, made), made.findings


def test_a_stop_is_said_with_its_angles(trial: Trial) -> None:
    made = verify(trial.task, trial.gains, [log_of(trial, Change("stop", "actuator-stopped", stop=5.0), 8)])
    (text,) = [f.text for f in made.findings if f.code == "actuator-stopped"]
    assert "stops at -5 and 5 deg" in text and "declared 35 deg" in text
