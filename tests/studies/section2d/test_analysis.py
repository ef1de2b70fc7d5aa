"""Instruments against one another: what was put in comes out."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial_studies.section2d.analysis import compare_instruments, dead_channel_findings

TIME, OMEGA = 0.02 * np.arange(1200), 5.4


@pytest.mark.parametrize(("delay", "drift", "gain"), [(0.065, 0.0, 1.13), (-0.2, 0.01, 0.9), (0.0, -0.004, 1.0)])
def test_delay_drift_and_gain_are_found(delay: float, drift: float, gain: float, rng: np.random.Generator) -> None:
    centre = 0.5 * (TIME[0] + TIME[-1])
    late = TIME - delay - drift * (TIME - centre)
    first = np.cos(OMEGA * late) + 0.02 * rng.standard_normal(len(TIME))
    found = compare_instruments(TIME, first, gain * np.cos(OMEGA * TIME), OMEGA)
    assert found.delay == pytest.approx(delay, abs=0.003) and found.clock_drift == pytest.approx(drift, abs=4e-4)
    assert found.gain == pytest.approx(gain, rel=0.01) and found.delay_scatter < 0.005


def test_a_delay_of_a_whole_period_cannot_be_stated() -> None:
    period = 2.0 * np.pi / OMEGA
    found = compare_instruments(TIME, np.cos(OMEGA * (TIME - period - 0.05)), np.cos(OMEGA * TIME), OMEGA)
    assert found.delay == pytest.approx(0.05, abs=0.003)


def test_a_channel_that_never_moves_is_dead_and_others_are_not() -> None:
    record = Record.from_arrays(
        "run", TIME, {"z": np.zeros(len(TIME)), "phi": np.sin(TIME), "y0": np.full(len(TIME), 1e-19)}
    )
    found = dead_channel_findings(record)
    assert [f.code for f in found] == ["dead-channel"] * 2 and {"'z'", "'y0'"} <= {
        w for f in found for w in f.message.split()
    }
