"""A heave or pitch that does not move about zero is named with its level; waves about zero are not."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.check.channels import resting_level_findings

TIME = np.arange(2000) * 0.05
SWING = np.sin(2.0 * np.pi * TIME / 2.0)


def record(**levels: float) -> Record:
    motions = {"zeta": 0.03 * SWING, "z": levels.get("z", 0.0) + 0.02 * SWING}
    return Record.from_arrays("run", TIME, motions | {"theta": levels.get("theta", 0.0) + 0.05 * SWING})


@pytest.mark.parametrize(("levels", "text"), [({"z": -0.0023}, "-0.0023 m"), ({"theta": 0.01}, "0.573 deg")])
def test_the_level_is_named_in_its_unit(levels: dict[str, float], text: str) -> None:
    (finding,) = resting_level_findings(record(**levels))
    (name,) = levels
    assert finding.code == "resting-level" and text in finding.message and f"channels.{name}" in finding.advice


def test_motions_about_zero_and_records_without_waves_are_left_in_peace() -> None:
    assert resting_level_findings(record()) == ()
    calm = Record.from_arrays("run", TIME, {"z": 1.0 + SWING})
    assert resting_level_findings(calm) == ()
    short = record(z=-0.0023).rows(slice(0, 200))
    assert resting_level_findings(short) == (), "five periods"
