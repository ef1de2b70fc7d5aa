"""Line of sight tuned around a heading loop, tried in what disturbs it and at a corner, by ships of the fit, too."""

import contextlib
import math
from collections.abc import Callable

import numpy as np

from seatrial.control.demand import reference_rate
from seatrial.control.front import refuse_infeasible
from seatrial.control.gain_evaluation import GainEvaluator, gain_evaluator
from seatrial.control.ship.parameter_draws import DRAWS
from seatrial.control.task import TrackDemand, TuningTask
from seatrial.control.track.corner import CornerTrial
from seatrial.control.track.simulate_track import TrackTrial
from seatrial.control.track.track_task import (
    heading_loop_of,
    largest_integral_gain,
    line_of_sight,
    refuse_impossible_track,
    track_task,
)
from seatrial.core.results.tuning import TrackKeeping
from seatrial.core.values import Array, DivergedError
from seatrial.physics.loops import TransferLoop, margins
from seatrial.physics.simulate.closed_loop import ActuatorLimits

_SLOWER = (1.0, 0.7, 0.5, 0.35, 0.25)  # of KP, tried until a corner is settled; chosen
_POINTS, _ROUNDS = 31, 4  # of a grid, and grids one after the other; chosen


def tune_track(
    task: TuningTask,
    demand: TrackDemand,
    loop: TransferLoop,
    gains: Array,
    seed: int,
    report_progress: Callable[[str], None],
    draws: int = DRAWS,
) -> TrackKeeping:
    """Return the guidance that leaves least of the distance within the limit of Ms, and how the track is kept.

    gains: (g,), of the heading loop; draws: craft of the fit that take the corner.

    Raises:
        InputError: the task has no model with heading and position, the current is as fast as the craft, or no
            guidance keeps the limit of Ms.
    """
    refuse_impossible_track(task, demand)
    heading = heading_loop_of(task, loop.with_gains(gains))
    outer = track_task(task, heading, demand)
    evaluator = gain_evaluator(outer)
    best = _least_distance(evaluator, largest_integral_gain(task, demand))
    if not evaluator.evaluate(best[None]).is_feasible[0]:
        refuse_infeasible(evaluator, seed)
    rate, limits = reference_rate(task, loop, task.required_demand), _limits(task)
    best = _settling(best, lambda gains: CornerTrial(heading, line_of_sight(gains, rate), limits, demand, task.U))
    KP, KI = best.tolist()
    guidance = line_of_sight((KP, KI), rate)
    closed = outer.loop.with_gains(best)
    found = margins(closed)
    report_progress("track: simulated with the actuator's limits")
    trial = TrackTrial(heading, closed, guidance, limits)
    corner = CornerTrial(heading, guidance, limits, demand, task.U)
    return TrackKeeping(
        lookahead=guidance.lookahead,
        integral_gain=guidance.integral_gain,
        order_rate=guidance.rate,
        speed=task.U,
        Ms=found.Ms,
        gain_margin=found.gain,
        phase_margin=found.phase,
        delay_margin=found.delay,
        disturbances=tuple(trial.simulate(met, seed) for met in outer.disturbances),
        corner=corner.respond(closed, draws, seed),
    )


def _limits(task: TuningTask) -> ActuatorLimits:
    return ActuatorLimits(task.constraints.limit, task.constraints.rate)


def _settling(gains: Array, trial: Callable[[tuple[float, float]], CornerTrial]) -> Array:
    """Return KP, KI (2,), slowed until the craft settles behind the corner within its order's rate and its limits.

    The lookahead grows, and the integral with its square; where that does not help, the gains as they were.
    """
    for share in _SLOWER:
        slower = gains * [share, share**2]
        with contextlib.suppress(DivergedError):
            if trial((float(slower[0]), float(slower[1]))).settles():
                return slower
    return gains


def _least_distance(evaluator: GainEvaluator, largest_sigma: float) -> Array:
    """Return KP, KI (2,) of the least distance within the limit of Ms, sigma = KI / KP^2 up to `largest_sigma` [m/s].

    By grids, each about the best of the one before, of sigma and at each sigma of Delta: Ms has kinks, which gradients
    do not pass.
    """
    low, high, KP, sigma, place = 0.0, largest_sigma, np.empty(0), np.empty(0), 0
    for _ in range(_ROUNDS):
        sigma = np.linspace(low, high, _POINTS)
        KP, values = _best_lookahead(evaluator, sigma)
        place, reach = int(np.argmin(values)), (high - low) / (_POINTS - 1)
        low, high = max(sigma[place] - reach, 0.0), min(sigma[place] + reach, largest_sigma)
    return np.array([KP[place], sigma[place] * KP[place] ** 2])


def _best_lookahead(evaluator: GainEvaluator, sigma: Array) -> tuple[Array, Array]:
    """Return KP = 1 / Delta of the least distance at each sigma (n,), and its variance; infinite where Ms is not kept.

    Where it is not at any Delta, that of the least Ms.
    """
    bounds = evaluator.loop.gains.items[0]
    ends = math.log(bounds.lower), math.log(bounds.upper)
    low, high = (np.full(len(sigma), end) for end in ends)
    rows, u, values = np.arange(len(sigma)), low, np.full(len(sigma), np.inf)
    for _ in range(_ROUNDS):
        tried = np.linspace(low, high, _POINTS, axis=1)
        KP = np.exp(tried)
        judged = evaluator.evaluate(np.column_stack([KP.ravel(), (sigma[:, None] * KP**2).ravel()]))
        found = np.where(judged.is_feasible, judged.objectives[:, 0], np.inf).reshape(tried.shape)
        is_kept = np.isfinite(found).any(axis=1)
        place = np.where(is_kept, np.argmin(found, axis=1), np.argmin(judged.Ms.reshape(tried.shape), axis=1))
        u, values, reach = tried[rows, place], found[rows, place], (high - low) / (_POINTS - 1)
        low, high = np.maximum(u - reach, ends[0]), np.minimum(u + reach, ends[1])
    return np.exp(u), values
