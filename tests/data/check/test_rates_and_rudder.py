"""Yaw rates in deg/min are called so, and evidence that contradicts itself is no warning."""

import numpy as np
import pytest

from seatrial.core.values import Finding, Record
from seatrial.data.check import inputs as rudder
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
    assert finding.code == "angle-unit" and "looks like deg/min" in finding.message
    assert finding.advice == 'set channels.r.unit = "deg/min" in the trial file'


def test_degrees_per_second_are_not_taken_for_them() -> None:
    (finding,) = findings(180.0 / np.pi)
    assert finding.code == "angle-unit" and "deg/min" not in finding.message
    assert findings(1.0) == []


@pytest.mark.parametrize(
    ("first", "steady", "count"), [(-6.0, 8.0, 0), (-6.0, -1.0, 1), (-4.0, -4.0, 1), (3.0, 3.0, 0)]
)
def test_contradictory_evidence_is_silence(
    first: float, steady: float, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rudder, "yaw_acceleration_response", lambda _: (first, 1.0))
    monkeypatch.setattr(rudder, "steady_turning_response", lambda _: (steady, 1.0))
    record = Record.from_arrays("run", TIME, {"psi": PSI, "delta": 0.2 * np.sign(np.sin(0.05 * TIME))})
    assert len(rudder.rudder_findings(record)) == count
