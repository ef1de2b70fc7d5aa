"""The sea in which an identified ship is shown: height and period are those of its record."""

import math

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.trial import Role, TrialRecord
from seatrial.estimation.identify.waves import recorded_sea, seakeeping
from seatrial.physics.hydro.excitation import BoxHull
from seatrial.physics.models import model_named
from seatrial.physics.sea.realise import realise, wave_record
from seatrial.physics.sea.spectrum import WaveEncounter, ittc, ittc_two_parameter

HULL = BoxHull(60.0, 7.14, 2.27, 3.15e6, 6.83e6, 6.83e6, 6.54e8)


@pytest.mark.parametrize(("speed", "heading"), [(1.2, 180.0), (1.2, 135.0), (0.0, 180.0)])
def test_height_and_period_of_a_simulated_sea_come_back_whatever_its_steepness(speed: float, heading: float) -> None:
    """Of a model's tank: 0.05 m is no ocean of that height, whose waves have a mean period of 0.6 s."""
    sea, beta = ittc_two_parameter(0.05, 1.2), math.radians(heading)
    lines = realise(sea, speed, beta, np.random.default_rng(3), count=400)
    record = wave_record(lines, np.arange(0.0, 600.0, 0.05), HULL)
    found = recorded_sea(record, WaveEncounter(HULL, speed, beta))
    assert found.significant_height == pytest.approx(0.05, rel=0.05)
    assert found.mean_period == pytest.approx(1.2, rel=0.05)


def test_of_a_following_sea_the_height_alone_is_known() -> None:
    lines = realise(ittc(2.0), 9.26, math.pi, np.random.default_rng(3), count=200)
    record = wave_record(lines, np.arange(0.0, 400.0, 0.2), HULL)
    assert recorded_sea(record, WaveEncounter(HULL, 9.26, 0.0)).name == "ITTC one-parameter"


def test_a_model_that_is_not_linear_has_no_operators() -> None:
    """Its fit is finished work all the same."""
    record = Record.from_arrays("run", np.arange(10.0), {"zeta": np.sin(np.arange(10.0))})
    met = TrialRecord(record, Role.TRAIN, "run", WaveEncounter(HULL, 0.0, math.pi))
    assert seakeeping(model_named("roll"), [met], 60.0) is None
