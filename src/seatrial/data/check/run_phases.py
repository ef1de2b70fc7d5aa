"""Phases of a run that are not the manoeuvre: getting under way and coasting."""

import numpy as np

from seatrial.core.values import Finding, Record, Severity
from seatrial.data.check.motion import MIN_SAMPLES
from seatrial.data.check.run_clock import moment
from seatrial.data.check.signal import smoothed, window_length
from seatrial.physics.manoeuvres.track import speed

# shares of largest revolutions (stopped) and of the speed reached (slow, under way); chosen
STOPPED_FRACTION, SLOW_FRACTION, RUNNING_FRACTION = 0.05, 0.5, 0.8
# quantile of the speed that counts as reached; chosen: a few wild samples do not count
REACHED_QUANTILE = 0.95
# s without propeller that count as coasting; chosen
MIN_COASTING_S = 2.0


def phase_findings(record: Record) -> tuple[Finding, ...]:
    """Return findings on acceleration and a stopped propeller at the ends of a clean, signed record."""
    return (*_acceleration_findings(record), *_propeller_findings(record))


def acceleration_end_time(record: Record) -> float | None:
    """Return when a run that starts below half its speed first reaches four fifths of it [s]; None if it starts faster.

    Its speed is the 95 % quantile of the smoothed speed.
    """
    U = speed(record)
    if U is None or len(record) < MIN_SAMPLES:
        return None
    length = window_length(len(record))
    U = smoothed(U, length)
    reached = float(np.quantile(U, REACHED_QUANTILE))
    if reached <= 0 or U[0] > SLOW_FRACTION * reached:
        return None
    return float(record.time[int(np.argmax(RUNNING_FRACTION * reached <= U)) + length // 2])


def _acceleration_findings(record: Record) -> list[Finding]:
    end = acceleration_end_time(record)
    if end is None:
        return []
    U = speed(record)
    assert U is not None
    text = f"record '{record.name}': the ship is still gathering speed until {moment(end)}"
    evidence = f"speed {U[0]:.3g} m/s at first, {np.quantile(U, REACHED_QUANTILE):.3g} m/s later"
    advice = "leave the phase out of manoeuvring measures, or fit it with a model that covers it"
    return [Finding(Severity.INFO, "acceleration-phase", text, evidence, advice)]


def _propeller_findings(record: Record) -> list[Finding]:
    if "n" not in record:
        return []
    n = np.abs(record["n"])
    turning = np.flatnonzero(n > STOPPED_FRACTION * n.max())
    if n.max() == 0 or turning.size == 0:
        return []
    first, last = int(turning[0]), int(turning[-1])
    findings = []
    if first > 0:
        text = f"record '{record.name}': the propeller is stopped until {moment(record.time[first])}"
        advice = "cut the beginning, or use a model that covers rest"
        findings.append(Finding(Severity.INFO, "propeller-stopped", text, f"{first} samples", advice))
    rest = record.time[-1] - record.time[last]
    if rest >= MIN_COASTING_S:
        text = f"record '{record.name}': the ship coasts from {moment(record.time[last])} on, the propeller stopped"
        advice = "leave coasting out of turning measures; it carries information on resistance"
        findings.append(Finding(Severity.INFO, "coasting", text, f"{rest:.3g} s at the end", advice))
    return findings
