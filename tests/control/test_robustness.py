"""A controller on ships that differ from the model: closed forms of corners, and draws that are counted."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.control.fin_tasks import PUBLISHED, fin_task

from seatrial.control.robustness import robustness, slowed_plant
from seatrial.control.ship import draw_parameters, plant_and_disturbance, stable_draws, trim_ship
from seatrial.control.task import PlantUncertainty, SlowDisturbance, TuningTask
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import Parameter, Parameters
from seatrial.data.folder.model_file import ModelFile
from seatrial.physics.loops import Block, LoopSignal, Term, TransferLoop, margins
from seatrial.physics.loops.autopilot import heading_loop
from seatrial.physics.loops.objective import variance
from seatrial.physics.models import model_named

OBJECTIVES = (variance("output", "rad^2", LoopSignal.OUTPUT),)


def integrator_task(k: float, box: PlantUncertainty) -> TuningTask:
    """L = k / s: with a dead time tau it is stable below k tau = pi / 2."""
    plant = Block("integrator", (1.0,), (1.0, 0.0))
    gains = Parameters((Parameter("KP", k, "1", 0.0, 10.0, free=True),))
    loop = TransferLoop("one", (), (Term("KP", Block("gain")),), (), (), plant, plant, gains, "psi", "delta")
    met = (SlowDisturbance(0.01, 0.1, 1.0),)
    return TuningTask("", "one", "", loop, met, OBJECTIVES, ControllerConstraints(), 1.0, uncertainty=box)


@pytest.mark.parametrize(("share", "stable"), [(0.99, 4), (1.01, 3)])
def test_a_corner_holds_up_to_the_dead_time_of_the_closed_form(share: float, stable: int) -> None:
    """Only the corner of most gain and dead time fails: k = 1.2 x 0.5, tau = share x pi / 2 / k."""
    task = integrator_task(0.5, PlantUncertainty(0.2, 0.0, share * 0.5 * math.pi / 0.6))
    judged = robustness(task, task.loop, "one", np.array([0.5]))
    assert (judged.corners, judged.stable_corners) == (4, stable)
    assert math.isfinite(judged.corners_Ms) == (stable == 4)
    assert judged.worst_corner.startswith("gain 1.2, time constants 1, dead time")
    assert judged.draws == 0 and math.isnan(judged.draws_Ms)


def test_a_slower_plant_answers_later_and_as_much() -> None:
    w = np.geomspace(0.01, 1.0, 20)
    steered = slowed_plant(Block("psi", (0.08,), (10.0, 1.0, 0.0)), 1.3)
    np.testing.assert_allclose(steered.frequency_response(w), 0.08 / (1j * w * (13.0j * w + 1.0)), rtol=1e-12)
    rolled = slowed_plant(Block("phi", (2.0,), (4.0, 0.4, 1.0)), 0.5)
    np.testing.assert_allclose(rolled.frequency_response(w), 2.0 / (1.0 - w**2 + 0.2j * w), rtol=1e-12)


def test_corners_of_fins_are_loops_of_their_own() -> None:
    task = replace(fin_task(), uncertainty=PlantUncertainty(0.25, 0.15, 0.0))
    loop = task.loop
    judged = robustness(task, loop, "published", PUBLISHED)
    corners = [
        margins(replace(loop.with_gains(PUBLISHED), plant=slowed_plant(loop.plant, time).scaled(gain)))
        for gain in (0.75, 1.25)
        for time in (0.85, 1.15)
    ]
    assert judged.stable_corners == judged.corners == 4
    # on samples of frequency, which may miss the peak by little
    assert judged.corners_Ms == pytest.approx(max(one.Ms for one in corners), rel=1e-4)


@pytest.mark.parametrize(("sd", "share_lost"), [(0.02, False), (0.15, True)])
def test_ships_of_the_fit_are_counted(sd: float, *, share_lost: bool) -> None:
    """A gain K drawn near zero or below steers the wrong way, and no controller holds it."""
    model = model_named("nomoto").with_values({"K": 0.2, "T": 8.0})
    ship = trim_ship(ModelFile(model, np.diag([sd**2, 1e-4])), output="psi", actuator="delta")
    plant, disturbance = plant_and_disturbance(ship)
    loop = heading_loop(plant, disturbance, (), parts=("KP", "KD"))
    met = (SlowDisturbance(0.03, 0.05, 1.0),)
    task = TuningTask("", "autopilot", "", loop, met, OBJECTIVES, ControllerConstraints(), 1.0, trimmed_ship=ship)
    judged = robustness(task, loop, "start", loop.gain_values, draws=100)
    assert (judged.stable_draws, judged.draws) == stable_draws(task, loop.gain_values, draws=100)
    assert (judged.stable_draws < judged.draws) == share_lost == math.isinf(judged.draws_Ms)
    if not share_lost:
        plants = [sides[0] for sides in draw_parameters(ship, 100, 0).plants]
        peaks = [margins(replace(loop, plant=plant)).Ms for plant in plants[:20]]
        assert max(peaks) <= judged.draws_Ms * (1.0 + 1e-4)
