"""A check to copy: a ship that leans to one side throughout a run."""

import math

import numpy as np

from seatrial.core.values import Finding, Record, Severity

LARGEST_HEEL = math.radians(2.0)  # [rad] in the median; chosen: beyond the zero error of a roll sensor


def heel_findings(record: Record) -> tuple[Finding, ...]:
    """Return a finding `heel` where the roll angle of a clean record with standard signs is large in the median."""
    if "phi" not in record:
        return ()
    heel = float(np.median(record["phi"]))
    if abs(heel) <= LARGEST_HEEL:
        return ()
    side = "starboard" if heel > 0.0 else "port"
    text = f"record '{record.name}': the ship heels {math.degrees(abs(heel)):.1f} deg to {side} in the median"
    evidence = f"roll from {math.degrees(record['phi'].min()):.1f} to {math.degrees(record['phi'].max()):.1f} deg"
    advice = "set the zero of the roll sensor, or leave roll out if the ship was loaded unevenly"
    return (Finding(Severity.WARNING, "heel", text, evidence, advice),)
