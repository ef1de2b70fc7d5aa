"""Tuning: fronts beside a brute-force grid, the fin example beside the published gains, autopilots of known ships."""

import math
import os
import tempfile
import time
from pathlib import Path

import numpy as np
from measure import Line, at_least, at_most

from seatrial import api
from seatrial.control.front import Effort, grid_front, pareto_front
from seatrial.control.gain_evaluation import gain_evaluator
from seatrial.control.task import Seaway, TuningTask
from seatrial.core.results.tuning import ControllerConstraints, ScheduleTrade, Tuning
from seatrial.numerics.optimise import hypervolume
from seatrial.physics.loops import HullFactor, LoopSignal, Objective
from seatrial.physics.loops.objective import squared_deviation, variance
from seatrial.physics.loops.structures import PUBLISHED_GAINS, Preamplifier, fin_loop
from seatrial.physics.sea.spectrum import ittc

EXAMPLES = Path(__file__).parents[1] / "examples"
KNOT, POINTS = 1852.0 / 3600.0, 160
PUBLISHED = np.array([list(PUBLISHED_GAINS.values())])
VARIANCES = (
    variance("roll", "rad^2", LoopSignal.OUTPUT),
    variance("fin", "rad^2", LoopSignal.ACTUATOR),
    variance("fin rate", "rad^2/s^2", LoopSignal.ACTUATOR, 1),
)
TARGET = squared_deviation("fin", LoopSignal.ACTUATOR, math.radians(math.sqrt(150.31)) ** 2, one_sided=False)
OBJECTIVES = {"variances": VARIANCES, "the paper's": (VARIANCES[0], TARGET, VARIANCES[2])}
SCHEDULE_LIMITS = {0.3: 0.55, math.inf: 0.47}
"""Largest mean cost over that of the published gains, by the largest step of a gain between neighbours."""


def run() -> list[Line]:
    """Fronts, the example, autopilots."""
    lines = []
    for reading in (Preamplifier.PRINTED, Preamplifier.WASHOUT):
        for name, objectives in OBJECTIVES.items():
            lines += _front(reading, name, objectives)
    return [*lines, *_fins(), *_autopilots()]


def _front(reading: Preamplifier, name: str, objectives: tuple[Objective, ...]) -> list[Line]:
    """Beam sea of 3.3 m at 18 kn, Ms <= 2."""
    U = 18.0 * KNOT
    met = Seaway(ittc(3.3), U, math.pi / 2.0, HullFactor(100.0, 10.5, 3.4))
    one = gain_evaluator(
        TuningTask("", "fins", "", fin_loop(reading), (met,), objectives, ControllerConstraints(Ms=2.0), U)
    )
    pareto_front(one, "", 0, _ignore_progress, Effort(1, 1, 100))
    began = time.perf_counter()
    made = pareto_front(one, "", 0, _ignore_progress, Effort())
    seconds = time.perf_counter() - began
    known = grid_front(one, (POINTS,) * 3)
    nadir = known.max(axis=0)
    share = hypervolume(made.objectives, nadir) / hypervolume(known, nadir)
    word = f"{reading.name.lower()}, {name}"
    lines = [
        at_least(f"{word}: hypervolume over that of a grid of {POINTS}^3", share, "x", 0.97),
        at_most(f"{word}: time of the front", seconds, "s", 10.0),
    ]
    if name == "variances":
        ratio = float((made.objectives / one.evaluate(PUBLISHED).objectives).max(axis=1).min())
        what = f"{word}: largest of three objectives over the published gains'"
        lines.append(at_most(what, ratio, "x", 0.62) if reading is Preamplifier.PRINTED else Line(what, ratio, "x"))
    return lines


def _fins() -> list[Line]:
    made = api.tune(api.load_loop(EXAMPLES / "fin_stabiliser.toml"))
    robust, rival = made.designs[0], made.baselines[0]
    published = float(np.mean([slot.baseline_costs["as published"] for slot in made.schedule]))
    headings = sorted({slot.beta for slot in made.schedule})
    worst = max(
        float(np.mean([s.cost for s in made.schedule if s.beta == b]))
        / float(np.mean([s.baseline_costs["as published"] for s in made.schedule if s.beta == b]))
        for b in headings
    )
    return [
        at_most(
            "fin example: points lost to angle and rate limits",
            100.0 * made.seaway_simulations[0].saturation_loss,
            "points",
            3.0,
        ),
        *(
            at_least(
                f"fin example: better than published, {p.stage}, lower end of 95 %", 100.0 * p.lower, "points", 0.0
            )
            for p in made.paired_differences
        ),
        *(
            Line(f"fin example: better than published, {p.stage}, mean", 100.0 * p.mean, "points")
            for p in made.paired_differences
        ),
        *(
            line
            for c in (made.chosen, robust, rival)
            for line in (
                Line(f"fin example: Ms, {c.name}", c.Ms, ""),
                Line(f"fin example: reduction by linear theory, {c.name}", 100.0 * c.reduction, "%"),
            )
        ),
        *(_schedule_line(trade, published) for trade in made.schedule_trades),
        at_most("fin example: worst heading of the schedule over the published gains'", worst, "x", 1.0),
        at_least("fin example: conditions feasible", sum(s.is_feasible for s in made.schedule), "of 27", 27),
        Line("fin example: whole tuning", made.elapsed_s, "s"),
    ]


def _schedule_line(trade: ScheduleTrade, published: float) -> Line:
    """Mean cost of a schedule over that of the published gains, by the largest step between neighbours."""
    step = f"steps of {100.0 * trade.largest_step:.0f} %" if math.isfinite(trade.largest_step) else "each its own"
    what = f"fin example: mean cost of the schedule over the published gains', {step}"
    limit = SCHEDULE_LIMITS.get(trade.largest_step)
    ratio = trade.cost / published
    return Line(what, ratio, "x") if limit is None else at_most(what, ratio, "x", limit)


def _autopilots() -> list[Line]:
    lines = []
    for trial, loop in (("waterjet", "waterjet_autopilot"), ("kvlcc2_hsva", "kvlcc2_autopilot")):
        if trial == "kvlcc2_hsva" and "SEATRIAL_DATA" not in os.environ:
            continue
        with tempfile.TemporaryDirectory() as folder:
            api.save(api.identify(api.load_trial(EXAMPLES / f"{trial}.toml")), folder)
            made = api.tune(api.load_loop(EXAMPLES / f"{loop}.toml", model_file=Path(folder) / "model.toml"))
        lines += _autopilot(trial, made)
    return lines


def _autopilot(name: str, tuning: Tuning) -> list[Line]:
    change = tuning.manoeuvres[0]
    return [
        at_most(f"{name}: overshoot of a 20 deg course change", 100.0 * change.overshoot, "%", 2.0),
        at_most(f"{name}: Ms", tuning.chosen.Ms, "", 1.7),
        at_least(f"{name}: ships of the fit that are stable", change.stable_draws, "of 100", 100),
        at_most(f"{name}: worst overshoot of these ships", 100.0 * change.worst_overshoot, "%", 2.0),
    ]


def _ignore_progress(_: str) -> None:
    pass
