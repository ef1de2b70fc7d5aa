"""Yaw rates in deg/min are called so."""

import numpy as np
import pytest

from seatrial.core.values import Finding, Record
from seatrial.data.check.examine import examined_record

TIME = 0.1 * np.arange(3000)
PSI = 0.8 * np.sin(0.05 * TIME) + 0.002 * TIME
RATE = 0.04 * np.cos(0.05 * TIME) + 0.002


def findings(factor: float) -> list[Finding]:
    record = Record.from_arrays("run", TIME, {"psi": PSI, "r": factor * RATE})
    return [one for one in examined_record(record).findings if one.severity.value == "error"]


@pytest.mark.parametrize("factor", [60.0, 60.0 * 180.0 / np.pi])
def test_deg_per_minute_is_named(factor: float) -> None:
    (finding,) = findings(factor)
    assert finding.code == "wrong-unit" and "in deg/min" in finding.message
    assert (finding.advice == 'set channels.r.unit = "deg/min" in the trial file') == (factor > 60.0)


def test_a_factor_that_is_near_that_of_degrees_names_both() -> None:
    (finding,) = findings(60.0)
    assert "or 'psi' is in rad although declared in deg" in finding.message and not finding.edits


def test_degrees_per_second_are_not_taken_for_them() -> None:
    (finding,) = findings(180.0 / np.pi)
    assert finding.code == "wrong-unit" and "deg/min" not in finding.message
    assert findings(1.0) == []
