"""A task in, a tuning out: the recommendation beats the published gains where it counts, or says that it does not."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from tests.control.fin_tasks import KNOT, LIMITS, PUBLISHED, QUICK
from tests.control.fin_tasks import sampled_fin_task as fin_task
from tests.control.loop_files import AUTOPILOT, PATROL_BOAT, model_file, write_loop_file

from seatrial.control import tune as module
from seatrial.control.controller import describe_controller
from seatrial.control.findings import Checks, findings
from seatrial.control.front import Effort, pareto_front
from seatrial.control.gain_evaluation import gain_evaluator
from seatrial.control.loopfile.load import tuning_task
from seatrial.control.task import ScheduleGrid, SimulationSettings, TrimmedShip
from seatrial.control.tune import tune
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import InputError
from seatrial.data.folder.gains_file import gains_toml
from seatrial.physics.loops.performance import calm_actuator
from seatrial.physics.loops.structures import five_gain_loop
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.models.roll import roll
from seatrial.reporting.tuning import html
from seatrial.reporting.tuning_text import demand_sentence

TINY = Effort(refined=4, fill_rounds=2, neighbours=2000)
SHORT = SimulationSettings(seeds=2, duration=200.0)
PUBLISHED_BY_NAME = {"as published": dict(zip(("KP", "KI", "KD"), PUBLISHED.tolist(), strict=True))}


@pytest.fixture(scope="module")
def made():
    task = fin_task()
    asked = replace(
        task,
        baselines=PUBLISHED_BY_NAME,
        extended_structures=(five_gain_loop(task.loop),),
        simulation=SimulationSettings(seeds=20),
    )
    return tune(asked, effort=QUICK)


def test_recommended_gains_keep_every_restriction(made):
    assert made.chosen.violated == ()
    assert made.chosen.Ms <= LIMITS.Ms
    assert made.chosen.saturation <= LIMITS.saturation


def test_recommended_gains_lose_less_than_three_points_to_the_limits(made):
    assert made.seaway_simulations[0].name == "chosen"
    assert made.seaway_simulations[0].saturation_loss < 0.03


def test_recommended_gains_beat_the_published_ones_on_the_same_seas(made):
    for pair in made.paired_differences:
        assert pair.seeds == 20
        assert pair.lower > 0.0, pair


def test_front_covers_the_grid_and_the_rival_is_shown(made):
    assert made.front.hypervolume >= 0.97
    assert [front.name for front in made.extended_fronts] == [five_gain_loop(fin_task().loop).name]
    assert made.baselines[0].name == "as published"
    assert made.baselines[0].Ms == pytest.approx(1.36, abs=0.01)  # 1.32 in continuous time


def test_five_gains_roll_a_third_less_at_equal_fin_rate(made):
    published, front = made.baselines[0], made.extended_fronts[0]
    keeping = front.objectives[:, 2] <= published.objectives[2]
    assert front.objectives[keeping, 0].min() <= 0.7 * published.objectives[0]


def test_same_seed_same_gains():
    task = replace(fin_task(), simulation=SHORT)
    first, again = (tune(task, seed=5, effort=TINY).chosen.gains for _ in range(2))
    assert first == again


def test_without_simulation_the_compromise_is_taken_and_said():
    """Gains near zero, which are on the front as well, are no compromise."""
    bare = tune(fin_task(), effort=TINY)
    assert bare.seaway_simulations == () and bare.schedule == ()
    assert bare.chosen.reduction > 0.3
    assert any("compromise" in reason for reason in bare.reasons)


def test_restrictions_that_nothing_keeps_are_refused():
    task = fin_task(restriction=ControllerConstraints(Ms=1.05))
    gains = task.loop.gains.bounded("KP", 5.0, 100.0)
    with pytest.raises(InputError, match="keep all limits"):
        tune(replace(task, loop=replace(task.loop, gains=gains)), effort=TINY)


def test_gains_on_their_bounds_are_found():
    """Of the gains themselves: whether a small search ends exactly on a bound is chance."""
    task = fin_task()
    narrow = task.loop.gains.bounded("KP", 0.0, 2.0).bounded("KD", 0.0, 1.0)
    evaluator = gain_evaluator(replace(task, loop=replace(task.loop, gains=narrow)))
    front = pareto_front(evaluator, "narrow", 0, lambda _: None, TINY)
    on_bound, inside = (describe_controller(evaluator, "chosen", np.array([KP, 1.0, 0.5])) for KP in (2.0, 1.9))
    assert "gain-on-bound" in {one.code for one in findings(evaluator, on_bound, (), front, Checks())}
    assert "gain-on-bound" not in {one.code for one in findings(evaluator, inside, (), front, Checks())}


def test_a_term_left_out_says_whether_the_front_uses_it_and_what_it_leaves():
    evaluator = gain_evaluator(fin_task())
    front = pareto_front(evaluator, "fins", 0, lambda _: None, TINY)
    without = replace(front, gains=front.gains * [1.0, 0.0, 1.0])
    chosen = describe_controller(evaluator, "chosen", PUBLISHED * [1.0, 0.0, 1.0])
    used, unused = (
        next(one.text for one in findings(evaluator, chosen, (), made, Checks()) if one.code == "gain-at-zero")
        for made in (front, without)
    )
    assert re.fullmatch(r"gain KI ends at zero; on the front it reaches [\d.]+", used)  # a slow lag is no integral
    assert unused == "gain KI ends at zero as on the whole front"


def test_an_integral_left_out_leaves_an_offset(tmp_path):
    evaluator = gain_evaluator(tuning_task(write_loop_file(tmp_path, PATROL_BOAT)))
    front = pareto_front(evaluator, "heading", 0, lambda _: None, TINY)
    gains = np.array([1.0, 0.0, 2.0])
    assert evaluator.loop.gains.names == ("KP", "KI", "KD")
    chosen = describe_controller(evaluator, "chosen", gains)
    (found,) = (one for one in findings(evaluator, chosen, (), front, Checks()) if one.code == "gain-at-zero")
    assert "where the demand does not count," in found.text
    assert found.text.endswith("have no steady part, and such a part would leave an offset")
    assert "[controller.gains.KI] lower" in found.advice


def test_gains_of_a_fit_that_warned_say_so():
    ship = TrimmedShip(roll(), np.zeros(2), np.zeros(1), "alpha", "phi", warnings=("the search did not converge",))
    warned = replace(gain_evaluator(fin_task()), task=replace(fin_task(), trimmed_ship=ship))
    front = pareto_front(warned, "fins", 0, lambda _: None, TINY)
    chosen = describe_controller(warned, "chosen", PUBLISHED)
    found = {one.code: one.text for one in findings(warned, chosen, (), front, Checks())}
    assert found["warned-fit"].endswith("the search did not converge")


def test_an_interruption_keeps_what_is_finished(monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(module, "schedule", interrupted)
    plan = ScheduleGrid((18.0 * KNOT,), (math.pi / 2,), (3.3,))
    found = tune(replace(fin_task(), schedule_grid=plan, simulation=SHORT), effort=TINY)
    assert found.seaway_simulations and not found.schedule
    assert found.findings[0].code == "interrupted"
    assert np.isfinite(found.chosen.Ms)


def test_no_control_at_all_is_no_answer():
    task = replace(fin_task(), constraints=ControllerConstraints(limit=1e-5))
    with pytest.raises(InputError, match="no control at all, with every gain at zero"):
        tune(replace(task, simulation=None), effort=TINY)


POLE_PLACEMENT = """
[baselines.pole_placement]
KP = 1.0
KD = 1.5
KI = 0.05
"""
NOISY = """
[sensors]
noise = { value = 0.5, unit = "deg" }
"""


def test_no_sentence_has_a_number_that_is_none(tmp_path):
    """A heading has no variance without control, so that it is left as an rms; a zigzag is not asked to settle."""
    task = tuning_task(write_loop_file(tmp_path, PATROL_BOAT + POLE_PLACEMENT))
    made = tune(task, effort=QUICK)
    texts = [*made.reasons, *(f.text for f in made.findings), html(made), gains_toml(made), repr(made)]
    assert not [text for text in texts if re.search(r"\bnan\b", text)]
    assert any(re.search(r"leaves [\d.]+ deg rms instead of [\d.]+ deg rms", reason) for reason in made.reasons)
    zigzag = made.manoeuvres[1]
    assert not zigzag.is_to_settle
    assert "settle" not in demand_sentence(replace(zigzag, settling=math.nan))
    endless = replace(made.manoeuvres[0], settling=math.nan)
    assert "does not settle" in demand_sentence(endless)


def test_noise_is_in_the_choice_and_in_what_it_warns_of(tmp_path):
    noisy = tuning_task(write_loop_file(tmp_path, PATROL_BOAT + NOISY))
    quiet = tuning_task(write_loop_file(tmp_path, PATROL_BOAT))
    rough, calm = (tune(task, effort=QUICK) for task in (noisy, quiet))
    assert rough.chosen.gains["KD"] < 0.5 * calm.chosen.gains["KD"]
    assert rough.discrete.noise == pytest.approx(math.radians(0.5))
    wild = noisy.loop.with_gains(np.array([5.0, 0.1, 20.0]))
    loud, quiet = (calm_actuator(one)[1] for one in (wild, wild.with_gains(np.array([1.0, 1e-3, 0.0]))))
    assert loud > 10.0 * quiet


def test_an_input_without_effect_is_refused(tmp_path):
    model_file(tmp_path, kvlcc2())
    with pytest.raises(InputError, match=r"plant\.inputs\.wind_speed = 10 has no effect in model 'mmg'"):
        tuning_task(
            write_loop_file(
                tmp_path,
                AUTOPILOT,
                ("[plant]\n", "[plant]\ninputs = { n = 10.23, wind_speed = 10 }\n"),
            )
        )
