"""Line of sight tuned around a heading loop, tried in what disturbs it and at a corner, by ships of the fit."""

import contextlib
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.controller import reference_rate
from seatrial.control.front import refuse_infeasible
from seatrial.control.gain_evaluation import GainEvaluator, gain_evaluator
from seatrial.control.ship import DRAWS, linearise
from seatrial.control.simulation import (
    LEAST_FREQUENCY,
    disturbance_clock,
    disturbance_realisation,
    rms_in_disturbance,
)
from seatrial.control.task import OUTPUT, Seaway, SlowDisturbance, TrackDemand, TrimmedShip, TuningTask
from seatrial.control.track.paths import CURRENT, EAST, CornerTrial, HeadingLoop, Reach
from seatrial.core.equations import Model
from seatrial.core.results.tuning import ControllerConstraints, DisturbanceSimulation, TrackKeeping
from seatrial.core.values import Array, DivergedError, InputError, Parameter, Parameters
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import Block, Term, TransferLoop, margins
from seatrial.physics.loops.autopilot import lag_frequency
from seatrial.physics.loops.loop_states import linear_model
from seatrial.physics.simulate.closed_loop import ActuatorLimits, ClosedLoop
from seatrial.physics.simulate.craft_control import LineOfSight, follow_track

# The linear ship behind heading and track as a model: the plant of linear theory, so that only limits are new.

DISTURBANCE = "disturbance"
_LEFT_OUT = ("x0",)  # along the track: nothing follows from it


def linear_ship(ship: TrimmedShip, disturbed: str) -> Model:
    """Return x' = A x + b u + e w about the trim, without the position along the track; u, w in the notation's signs.

    Inputs are the actuator and ``disturbance``, which acts on the rate of the state `disturbed`, or like the actuator
    where it has the actuator's name.
    """
    linear, names = linearise(ship), ship.model.states
    kept = [i for i, name in enumerate(names) if name not in _LEFT_OUT]
    A, column = linear.A[np.ix_(kept, kept)], ship.model.input_names.index(ship.actuator)
    sign = -1.0 if ship.model.inputs[column].is_reversed else 1.0
    b = sign * linear.B[kept, column]
    e = b if disturbed == ship.actuator else np.array([1.0 if names[i] == disturbed else 0.0 for i in kept])
    states = tuple(names[i] for i in kept)
    return linear_model(states, (ship.actuator, DISTURBANCE), A, np.stack([b, e], axis=1), np.ones_like(A, dtype=bool))


# A straight track kept in each disturbance: linear theory, simulated without limits and with those of the rudder.

_YAW_RATE = "r"  # state whose rate the waves' yaw acceleration is


@dataclass(frozen=True, eq=False)
class TrackTrial:
    """What a track is tried with: the heading loop, the outer loop at its gains, guidance and limits."""

    heading: HeadingLoop
    outer: TransferLoop
    guidance: LineOfSight
    limits: ActuatorLimits

    def simulate(self, met: Seaway | SlowDisturbance, seed: int) -> DisturbanceSimulation:
        """Return rms of distance, rudder and its rate in one disturbance of the outer loop."""
        loop = met.disturbed(self.outer)
        clock, disturbed = disturbance_clock(met, loop, self.heading.loop), self._disturbed_state(met)
        ship = self.heading.ship
        run = ClosedLoop(
            linear_ship(ship, disturbed), self.heading.loop, self.heading.loop.gain_values, clock.dt, ship.actuator,
            DISTURBANCE, ship.output,
        )  # fmt: skip

        expected = self.predicted(met)

        def counted(omega: Array) -> Array:
            return np.hypot(
                *(np.abs(response) / rms for response, rms in zip(self._responses(met, omega), expected, strict=False))
            )

        def of_one(number: int, each: ActuatorLimits) -> tuple[Array, Array]:
            series = disturbance_realisation(met, loop, clock, number, counted)
            path = follow_track(run, self.guidance, series, limits=each)
            return path.error, path.actuator

        return rms_in_disturbance(met, run, of_one, clock, self.limits, expected, seed)

    def predicted(self, met: Seaway | SlowDisturbance) -> Array:
        """Return the rms of distance, rudder and its rate by linear theory, (3,)."""
        spectrum = met.exposure(met.disturbed(self.outer))
        w = spectrum.omega_e
        distance, rudder = (np.abs(response) ** 2 * spectrum.energy for response in self._responses(met, w))
        return np.sqrt([distance.sum(), rudder.sum(), (w**2 * rudder).sum()])

    def _responses(self, met: Seaway | SlowDisturbance, omega: Array) -> tuple[Complex, Complex]:
        """Return distance and rudder for a unit of the disturbance, each (n,), at omega (n,) [rad/s]."""
        loop, w = met.disturbed(self.outer), np.maximum(omega, LEAST_FREQUENCY)
        guidance = loop.gain_values @ loop.controller_terms(w)
        distance = loop.disturbance.frequency_response(w) / (1.0 + loop.open_loop(w))
        return distance, self.heading.rudder_response(self._reach(met), guidance, w)

    def _reach(self, met: Seaway | SlowDisturbance) -> Reach:
        if isinstance(met, Seaway):
            return self.heading.waves
        return CURRENT if met.path == CURRENT.track else self.heading.rudder

    def _disturbed_state(self, met: Seaway | SlowDisturbance) -> str:
        if isinstance(met, Seaway):
            return _YAW_RATE
        return EAST if met.path == CURRENT.track else self.heading.ship.actuator


# The outer loop of track keeping as a tuning of its own: from the distance to the heading order.

# crossover U KP of the outer loop over the lag frequency of the heading loop: least, first, largest; chosen
_SLOWEST, _START, _FASTEST = 0.003, 0.1, 1.0
_INTEGRAL_SHARE = 0.2  # of the crossover, the largest KI / KP; chosen
_STRONGEST = 2.0  # the strongest current in its rms: 95 % of a Gaussian's are weaker
_SOURCE = "bandwidth of the heading loop"


def refuse_impossible_track(task: TuningTask, track: TrackDemand) -> None:
    """Refuse a track without an identified model of heading and position, or in a current as fast as the craft."""
    ship = task.trimmed_ship
    if ship is None or task.loop.output != "psi" or EAST not in ship.model.states:
        raise InputError(
            "track: a track is kept by a heading loop on an identified model with heading and position; give "
            "plant.model of such a model, or leave [track] out"
        )
    if not largest_integral_gain(task, track) > 0.0:
        raise InputError(
            f"track.current = {track.current:.3g} m/s is at times {_STRONGEST * track.current:.3g} m/s, no less than "
            f"the craft's {task.U:.3g} m/s: no track can be kept in it; give a slower one"
        )


def largest_integral_gain(task: TuningTask, track: TrackDemand) -> float:
    """Return the speed of the craft less that of the strongest current [m/s].

    Up to it sigma keeps the track stable from any distance (Caharija et al. 2016, IEEE Trans. Control Syst. Technol.
    24, 1623-1642).
    """
    return task.U - _STRONGEST * track.current


def heading_loop_of(task: TuningTask, loop: TransferLoop) -> HeadingLoop:
    """Return the heading loop that a track is kept with, of a task that `refuse_impossible_track` accepts."""
    assert task.trimmed_ship is not None
    return HeadingLoop(task.trimmed_ship, loop)


def track_disturbances(
    task: TuningTask, heading: HeadingLoop, track: TrackDemand
) -> tuple[Seaway | SlowDisturbance, ...]:
    """Return what disturbs the heading loop, carried to the track, and the current across it."""
    current = SlowDisturbance(
        track.current, track.bandwidth, task.U, "m/s", "of current across the track", CURRENT.track
    )
    carried = (
        replace(push, path=heading.disturbance_to_track(heading.waves if isinstance(push, Seaway) else heading.rudder))
        for push in task.disturbances
    )
    return (current, *carried)


def track_task(task: TuningTask, heading: HeadingLoop, track: TrackDemand) -> TuningTask:
    """Return the tuning of the distance from a track by the heading order, KP = 1 / Delta and KI = sigma / Delta^2.

    That is what line of sight with an integral is for small distances (Borhaug, Pavlov & Pettersen 2008, Proc. 47th
    IEEE CDC, 4984-4991, linearised).
    """
    plant = heading.order_to_track()
    scale = lag_frequency(plant) / task.U
    most = _FASTEST * scale
    gains = (
        Parameter("KP", _START * scale, "rad/m", _SLOWEST * scale, most, free=True, source=_SOURCE,
                  meaning="1 / lookahead distance"),
        Parameter("KI", 0.0, "rad/(m s)", 0.0, _INTEGRAL_SHARE * most**2 * task.U, free=True, source=_SOURCE,
                  meaning="integral gain over the square of the lookahead distance"),
    )  # fmt: skip
    terms = (Term("KP", Block("proportional")), Term("KI", Block("integral", (1.0,), (1.0, 0.0))))
    loop = TransferLoop("track", (), terms, (), (), plant, CURRENT.track, Parameters(gains), EAST, "psi", "disturbance")
    return TuningTask(
        question="",
        name="track",
        plant="",
        loop=loop,
        disturbances=track_disturbances(task, heading, track),
        objectives=(OUTPUT,),
        constraints=ControllerConstraints(Ms=task.constraints.Ms),
        U=task.U,
    )


def line_of_sight(gains: tuple[float, float], rate: float) -> LineOfSight:
    """Return the guidance whose linear part has gains KP [rad/m] and KI [rad/(m s)]."""
    KP, KI = gains
    return LineOfSight(1.0 / KP, KI / KP**2, rate)


# Line of sight tuned around a heading loop, tried in what disturbs it and at a corner, by ships of the fit, too.

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
    rate, limits = reference_rate(task, loop, task.required_demand), task.actuator_limits.without_stall
    best = _settling(best, lambda gains: CornerTrial(heading, line_of_sight(gains, rate), limits, demand, task.U))
    KP, KI = best.tolist()
    guidance = line_of_sight((KP, KI), rate)
    closed = outer.loop.with_gains(best)
    reserve = margins(closed)
    report_progress("track: simulated with the actuator's limits")
    trial = TrackTrial(heading, closed, guidance, limits)
    corner = CornerTrial(heading, guidance, limits, demand, task.U)
    return TrackKeeping(
        lookahead=guidance.lookahead,
        integral_gain=guidance.integral_gain,
        order_rate=guidance.rate,
        speed=task.U,
        Ms=reserve.Ms,
        gain_margin=reserve.gain,
        phase_margin=reserve.phase,
        delay_margin=reserve.delay,
        disturbances=tuple(trial.simulate(disturbance, seed) for disturbance in outer.disturbances),
        corner=corner.respond(closed, draws, seed),
    )


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
        cost = np.where(judged.is_feasible, judged.objectives[:, 0], np.inf).reshape(tried.shape)
        is_kept = np.isfinite(cost).any(axis=1)
        place = np.where(is_kept, np.argmin(cost, axis=1), np.argmin(judged.Ms.reshape(tried.shape), axis=1))
        u, values, reach = tried[rows, place], cost[rows, place], (high - low) / (_POINTS - 1)
        low, high = np.maximum(u - reach, ends[0]), np.minimum(u + reach, ends[1])
    return np.exp(u), values
