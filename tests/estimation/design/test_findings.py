"""What a design warns of, and limits that no orders keep."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.results import Confirmation, ManoeuvrePrecision
from seatrial.core.values import InputError, Record, Ship
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.estimation.design.design import findings, refuse_violated_limits
from seatrial.estimation.design.task import DesignTask
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet

COUNT = len(COEFFICIENTS)
NOTHING = Record.from_arrays("run", np.arange(3.0), {"u": np.ones(3)})
TASK = DesignTask(
    "",
    Ship("craft", {"L": 9.8}),
    waterjet(),
    {"u": 0.02, "v": 0.02, "r": 0.002},
    DesignRequest(
        duration=600.0,
        rate=10.0,
        inputs={"delta": InputRange(lower=-0.6, upper=0.6, unit="rad", rate=0.07, hold=15.0)},
        held={"v_j": 1.866},
        drift=math.radians(30.0),
        sea_room=400.0,
        every_ship=False,
    ),
)
TEN = np.full(10, 1.0)
GOOD = ManoeuvrePrecision(
    "designed",
    np.full(COUNT, 0.1),
    np.full((10, COUNT), 0.2),
    0.4,
    300.0,
    np.full(10, 0.4),
    np.full(10, 300.0),
    NOTHING,
)


def codes(
    worth: ManoeuvrePrecision, confirmation: Confirmation | None = None, *, is_interrupted: bool = False
) -> list[str]:
    """Of all findings."""
    return [f.code for f in findings(TASK, worth, confirmation, is_interrupted=is_interrupted)]


def test_a_good_design_warns_of_nothing() -> None:
    """And is not refused."""
    assert codes(GOOD) == []
    refuse_violated_limits(TASK, GOOD)


def test_coefficients_that_cannot_be_stated_are_named() -> None:
    """By the ship assumed, and by others only."""
    relative, drawn = GOOD.relative_error.copy(), GOOD.sampled_relative_error.copy()
    relative[2], drawn[3, 6] = 1.2, 3.0
    worth = replace(GOOD, relative_error=relative, sampled_relative_error=drawn)
    assert codes(worth) == ["not-identifiable", "not-identifiable"]
    first, second = findings(TASK, worth, None, is_interrupted=False)
    assert "X_rr" in first.text and "Y_vr" in second.text


def test_ships_that_stray_are_a_note_when_few_and_a_warning_when_many() -> None:
    """With how far they go."""
    few, many = GOOD.sampled_drift.copy(), np.full(10, 2.0)
    few[0] = 1.0
    (note,) = findings(TASK, replace(GOOD, sampled_drift=few), None, is_interrupted=False)
    (warning,) = findings(TASK, replace(GOOD, sampled_drift=many), None, is_interrupted=False)
    assert (note.severity.value, warning.severity.value) == ("info", "warning")
    assert "1 of 10 ships" in note.text and "up to 57 deg" in note.text
    assert "10 of 10 ships" in warning.text and "300 m" in warning.text


def test_fits_that_fail_and_ships_that_are_lost_are_said() -> None:
    """A design nobody confirmed is none to sail."""
    drawn = GOOD.sampled_relative_error.copy()
    drawn[0] = np.nan
    known = Confirmation(20, 12, np.ones(COUNT), np.ones(COUNT))
    assert codes(replace(GOOD, sampled_relative_error=drawn), known) == ["lost", "unconfirmed"]
    assert codes(GOOD, replace(known, converged_runs=19)) == []


def test_limits_that_are_left_are_refused_with_what_is_reached() -> None:
    """By the ship assumed; by any, where every ship is bound; an interrupted search only warns."""
    far = replace(GOOD, drift=0.7)
    with pytest.raises(InputError, match=r"the ship reaches a drift angle of 40\.1 deg, 30 deg are allowed; widen"):
        refuse_violated_limits(TASK, far)
    with pytest.raises(InputError, match="the ship reaches 500 m from the start, 400 m are allowed"):
        refuse_violated_limits(TASK, replace(GOOD, distance=500.0))
    every = replace(TASK, request=replace(TASK.request, every_ship=True))
    stray = replace(GOOD, sampled_drift=TEN)
    refuse_violated_limits(TASK, stray)
    with pytest.raises(InputError, match=r"some ship of the prior reaches a drift angle of 57\.3 deg"):
        refuse_violated_limits(every, stray)
    assert codes(far, is_interrupted=True)[:2] == ["interrupted", "leaves-limits"]
