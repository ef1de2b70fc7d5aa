"""A step of heading followed: as the sampled linear loop says, within the actuator's limit, to the right side."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from seatrial.core.equations import Model
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate import HeadingStep

K, T, DT = 0.2, 5.0, 0.25
GAINS = np.array([0.8, 3.0])


def ship() -> Model:
    return nomoto().with_values({"K": K, "T": T})


def test_a_linear_ship_follows_the_exactly_sampled_loop() -> None:
    step = HeadingStep(0.1, math.inf, "delta", 60.0, DT)
    model = ship()
    motion = step.simulate(model, GAINS, np.zeros(len(model.states)), np.zeros(len(model.inputs)))
    assert motion is not None
    # psi' = r, T r' + r = K delta (Nomoto 1957), delta held: exact by the exponential of the augmented matrix
    over = expm(DT * np.array([[0.0, 1.0, 0.0], [0.0, -1.0 / T, K / T], [0.0, 0.0, 0.0]]))
    x, expected = np.zeros(2), []
    for _ in range(len(motion[0])):
        expected.append(x)
        x = (over @ [*x, GAINS[0] * (0.1 - x[0]) - GAINS[1] * x[1]])[:2]
    places = [model.states.index("psi"), model.states.index("r")]
    assert motion[0][:, places] == pytest.approx(np.array(expected), abs=1e-8)


def test_the_actuator_keeps_its_limit_and_turns_the_craft_to_the_ordered_side() -> None:
    craft, limit = waterjet(), math.radians(35.0)
    start = np.zeros(len(craft.states))
    start[craft.states.index("u")] = 0.8
    for change in (0.5, -0.5):
        step = HeadingStep(change, limit, "delta", 120.0, DT)
        motion = step.simulate(craft, np.array([3.0, 20.0]), start, np.array([0.0, 1.866]))
        assert motion is not None
        assert motion[0][-1, craft.states.index("psi")] == pytest.approx(change, rel=0.02)  # band of settling
        assert np.max(np.abs(motion[1][:, 0])) == pytest.approx(limit)
        # positive nozzle angles of this model turn to port
        assert motion[1][0, 0] * change < 0.0


def test_a_craft_that_runs_away_has_no_motion() -> None:
    step = HeadingStep(0.1, math.inf, "delta", 4000.0, DT)
    model = ship()
    assert step.simulate(model, -10.0 * GAINS, np.zeros(len(model.states)), np.zeros(len(model.inputs))) is None
