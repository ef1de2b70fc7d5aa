"""The approach of a run: straight at a steady speed, or what is wrong with it."""

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Record, Severity
from seatrial.data.check import examine
from seatrial.data.check.phases import approach_fault, approach_findings, first_execution
from seatrial.data.trial.records import approach_condition
from seatrial.physics.models import model_named

STEP, EXECUTE_S = 0.2, 30.0  # s
TIME = STEP * np.arange(1000)


def zigzag(name: str = "run", slope: float = 0.0, rate: float = 0.0, noise: float = 0.0) -> Record:
    """A zigzag from 30 s on; speed [m/s] with a slope [m/s^2], yaw rate [rad/s] before the execute."""
    after = TIME >= EXECUTE_S
    delta = np.where(after, 0.2 * np.sign(np.sin(2.0 * np.pi * (TIME - EXECUTE_S) / 40.0) + 1e-9), 0.0)
    r = np.where(after, 0.05 * np.sin(2.0 * np.pi * (TIME - EXECUTE_S) / 40.0), rate)
    u = 2.0 + slope * np.minimum(TIME - EXECUTE_S, 0.0)
    generator = np.random.default_rng(5)
    u, r = u + 10.0 * noise * generator.standard_normal(u.size), r + noise * generator.standard_normal(r.size)
    channels = {"delta": delta, "u": u, "v": 0.0 * u, "r": r, "psi": STEP * np.cumsum(r)}
    return Record.from_arrays(name, TIME, channels)


def test_a_straight_run_at_a_steady_speed_has_no_fault() -> None:
    assert approach_fault(zigzag()) == approach_fault(zigzag(noise=0.005)) == ""
    assert TIME[first_execution(zigzag())] == pytest.approx(EXECUTE_S)
    assert approach_findings(zigzag()) == ()


def test_a_craft_that_still_turns_or_gathers_speed_is_named() -> None:
    assert "it turns at 1.1 deg/s there, and by 2.5 deg/s" in approach_fault(zigzag(rate=0.02))
    assert "speed 1.6 to 2 m/s in the 20 s before it" in approach_fault(zigzag(slope=0.02))
    assert approach_fault(zigzag(slope=0.02, noise=0.1)) == "", "a change within the noise of the speed is none"
    (finding,) = (one for one in examine(zigzag(slope=0.02)) if one.code == "approach")
    assert finding.severity is Severity.WARNING and finding.consequence


def test_records_without_a_rudder_or_a_manoeuvre_are_not_judged() -> None:
    record = zigzag(slope=0.02)
    straight = Record.from_arrays("straight", TIME, {"u": record["u"], "psi": 0.0 * TIME})
    assert approach_fault(straight) == "" and approach_findings(straight) == ()


def test_the_approach_speed_is_that_of_the_runs_whose_approach_is_steady() -> None:
    model: Model = model_named("waterjet")
    settling = [zigzag(name, slope=0.05) for name in "ab"]
    assert approach_condition([zigzag(), *settling], model)["u"] == pytest.approx(2.0)
    assert approach_condition(settling, model)["u"] < 1.99, "where none is steady, all count"
