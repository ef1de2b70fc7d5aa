"""One set of gains in words a control engineer knows, and a demand carried out by it on the nonlinear model."""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import expm

from seatrial.control.gain_evaluation import (
    ACTUATOR_ACCELERATION,
    ACTUATOR_RATE,
    GainEvaluation,
    GainEvaluator,
    exceedance_share,
)
from seatrial.control.ship import DRAWS, draw_parameters, plant_as_model, stable_draws
from seatrial.control.task import OUTPUT, SLOWEST, Demand, TrimmedShip, TuningTask
from seatrial.core.results.tuning import (
    Component,
    Controller,
    DiscreteController,
    ManoeuvreResponse,
    ReferenceFilter,
)
from seatrial.core.values import (
    Array,
    DivergedError,
    InputError,
    frozen,
)
from seatrial.physics.loops import Block, TransferLoop, margins, reversals_per_hour
from seatrial.physics.loops.autopilot import START, FeedForward, acceleration_feed_forward, working_frequency
from seatrial.physics.loops.discrete import discrete_blocks
from seatrial.physics.loops.performance import frequency_band
from seatrial.physics.simulate.closed_loop import (
    REFERENCE,
    ActuatorLimits,
    ClosedLoop,
    fastest_motion,
    simulation_step,
    steps_a_sample,
)
from seatrial.physics.simulate.replay import series_record

# A demand carried out: a change and a zigzag by the nonlinear model within its limits, and by ships the fit allows.

DEMAND = "demand"
_SHOWN_DRAWS, _SAMPLES = 20, 1000  # sampled ships and samples in time that a figure shows; chosen
# steps of a simulation, and its step as a share of the fastest pole's time constant; chosen
_FEWEST_STEPS, _MOST_STEPS, _STEP_SHARE = 1000, 20_000, 0.2
_SETTLING_BAND = 0.05  # share of the change: the usual 5 % settling band
_LEGS = 4  # of the zigzag: two to either side; chosen
_CHANGE_NAMES = {"psi": "course change", "u": "speed change"}


@dataclass(frozen=True, eq=False)
class _Programme:
    """A demand (n,) and what the loop follows (n,), about the trim, every dt; its steps at `step_samples`.

    fed_forward: (n,), what the reference alone orders of the actuator.
    """

    name: str
    dt: float
    demand: Array
    reference: Array
    fed_forward: Array
    step_samples: tuple[int, ...]
    is_to_settle: bool


def simulate_manoeuvres(
    task: TuningTask, loop: TransferLoop, name: str, gains: Array, seed: int, draws: int = DRAWS
) -> tuple[ManoeuvreResponse, ...]:
    """The task's change of the output, and a zigzag about the trim of half of it to either side, with the gains (g,).

    Ships are drawn from the covariance of the fit; one that has no trim counts as not stable. Where one is not, or
    diverges, the worst overshoot is infinite. A task without a model behind its plant is simulated from its transfer
    functions.
    """
    ship = task.trimmed_ship or plant_as_model(loop)
    drawn = draw_parameters(ship, draws, seed)
    stable = sum(drawn.stable_ships(loop, gains)), drawn.draws
    limits = task.actuator_limits.without_stall
    return tuple(
        _simulate_manoeuvre(one, ship, loop, name, gains, limits, drawn.ships, stable)
        for one in _programmes(task, loop, gains, task.required_demand)
    )


def shortfall(task: TuningTask, loop: TransferLoop, gains: Array, *, draws: int = DRAWS) -> tuple[float, str]:
    """How far the gains (g,) are from following the task's change, to be compared, and why; 0 and nothing if they do.

    Every ship drawn is to be stable; the identified one settles within 5 % and overshoots no more than allowed. Both
    have the slowest and latest actuator of the task's spread.
    """
    asked = task.required_demand
    limits, loop = task.uncertainty.actuator.actuator_at(SLOWEST, task.actuator_limits, loop)
    task = replace(task, constraints=replace(task.constraints, rate=limits.rate))
    stable, drawn = stable_draws(task, gains, loop, draws=draws)
    lost = drawn - stable
    try:
        change = simulate_manoeuvres(task, loop, "", gains, 0, draws=0)[0]
    except DivergedError:
        return 100.0 + lost, "the simulation of the identified ship diverges"
    beyond = max(change.overshoot - asked.overshoot, 0.0)
    is_slow = not change.settling <= asked.settling
    why = [f"{lost} of {drawn} ships that the fit allows are not stable"] if lost else []
    why += [_slowness_text(change.settling)] if is_slow else []
    why += [f"it overshoots by {100.0 * change.overshoot:.1f} %"] if beyond else []
    return lost + float(is_slow) + beyond, " and ".join(why)


def _slowness_text(settling: float) -> str:
    if math.isnan(settling):
        return "the change does not settle within 5 %"
    return f"the change takes {settling:.3g} s to settle within 5 %"


def simulate_tracking(
    ship: TrimmedShip,
    loop: TransferLoop,
    gains: Array,
    limits: ActuatorLimits,
    dt: float,
    reference: Array,
    fed_forward: Array | None = None,
) -> tuple[Array, Array]:
    """Return output and actuator (n,), notation's signs, of a ship that follows a reference (n,) about its trim.

    fed_forward: (n,), added to the actuator's order.
    """
    model = ship.model
    place, rudder = model.states.index(ship.output), model.input_names.index(ship.actuator)
    sign = -1.0 if model.inputs[rudder].is_reversed else 1.0
    closed = ClosedLoop(model, loop, gains, dt, ship.actuator, "", ship.output, ship.state, ship.inputs)
    states, moved = closed.run(np.zeros(len(reference)), limits, ship.state[place] + reference, fed_forward)
    return states[:, place], sign * ship.inputs[rudder] + moved


@dataclass(frozen=True, eq=False)
class ReferenceMotion:
    """What a loop follows in place of steps: level, velocity and acceleration, each (n,)."""

    level: Array
    velocity: Array
    acceleration: Array

    def fed_forward(self, law: FeedForward) -> Array:
        """Return what the law orders of the actuator, (n,)."""
        return law.level * self.level + law.velocity * self.velocity + law.acceleration * self.acceleration


def reference_model(demand: Array, dt: float, time_constant: float, rate: float = math.inf) -> ReferenceMotion:
    """Follow steps (n,) by x'' + 2 w x' + w^2 x = w^2 r, w = 1 / time_constant, |x'| <= rate.

    Critically damped, with saturating rate (Fossen 2021, Handbook, section 12.1, reference models).
    """
    w, rows = 1.0 / time_constant, list[tuple[float, float, float]]()
    (stay, carry), (pull, damp) = expm(np.array([[0.0, 1.0], [-(w**2), -2.0 * w]]) * dt).tolist()
    x, v = 0.0, 0.0
    for r in demand.tolist():
        away, speed = stay * (x - r) + carry * v, pull * (x - r) + damp * v
        acceleration = -(w**2) * (x - r) - 2.0 * w * v
        if abs(speed) > rate:
            speed = math.copysign(rate, speed)
            away = x - r + 0.5 * (v + speed) * dt
            acceleration = (speed - v) / dt
        rows.append((x, v, acceleration))
        x, v = r + away, speed
    return ReferenceMotion(*np.array(rows).T.copy())


def relative_overshoot(output: Array, demand: Array, step_samples: tuple[int, ...]) -> float:
    """Largest share of a step of the demand by which the output exceeds it before the next, 0 or more; all (n,)."""
    worst = 0.0
    for first, last in zip(step_samples, (*step_samples[1:], len(demand)), strict=True):
        step = demand[first] - (demand[first - 1] if first else 0.0)
        worst = max(worst, float(np.max((output[first:last] - demand[first]) / step)))
    return worst


def settling_time(output: Array, demand: Array, step_samples: tuple[int, ...], dt: float) -> float:
    """s from a step of the demand until the output stays within 5 % of it, the slowest; NaN if one never does."""
    slowest = 0.0
    for first, last in zip(step_samples, (*step_samples[1:], len(demand)), strict=True):
        step = abs(demand[first] - (demand[first - 1] if first else 0.0))
        outside = np.flatnonzero(np.abs(output[first:last] - demand[first]) > _SETTLING_BAND * step)
        if outside.size and outside[-1] == last - first - 1:
            return math.nan
        slowest = max(slowest, (outside[-1] + 1) * dt if outside.size else 0.0)
    return slowest


def _programmes(task: TuningTask, loop: TransferLoop, gains: Array, demand: Demand) -> tuple[_Programme, ...]:
    dt, every = _clock(loop.with_gains(gains), demand)
    legs = max(1, math.ceil(demand.duration / (every * dt * _LEGS)))
    count, rate = legs * every * _LEGS, reference_rate(task, loop, demand)
    change, zigzag = np.full(count + 1, demand.change), np.empty(count + 1)
    change[:every] = 0.0
    begun = tuple(max(every, count * leg // _LEGS) for leg in range(_LEGS))
    zigzag[:every] = 0.0
    for leg, first in enumerate(begun):
        zigzag[first:] = 0.5 * demand.change * (-1.0) ** leg
    law = feed_forward(loop, demand)

    def programme(name: str, steps: Array, legs: tuple[int, ...], *, is_to_settle: bool) -> _Programme:
        motion = reference_model(steps[::every], every * dt, demand.time_constant, rate)
        level, fed = (np.repeat(one, every)[: count + 1] for one in (motion.level, motion.fed_forward(law)))
        return _Programme(name, dt, steps, level, fed, legs, is_to_settle)

    changed = _CHANGE_NAMES.get(loop.output, f"change of {loop.output}")
    return (
        programme(changed, change, (every,), is_to_settle=True),
        programme("zigzag", zigzag, begun, is_to_settle=False),
    )


def _clock(loop: TransferLoop, demand: Demand) -> tuple[float, int]:
    """Return the step [s] of a simulation, short for everything that moves, and how many of them make a sample."""
    count = int(np.clip(math.ceil(demand.duration * fastest_motion(loop) / _STEP_SHARE), _FEWEST_STEPS, _MOST_STEPS))
    dt = simulation_step(loop.required_sampling, demand.duration / count)
    return dt, steps_a_sample(loop.required_sampling, dt)


def feed_forward(loop: TransferLoop, demand: Demand) -> FeedForward:
    """Return what of the reference a demand adds to the actuator's order; nothing where it feeds nothing forward."""
    if not demand.feeds_forward:
        return FeedForward(0.0, 0.0, 0.0)
    return acceleration_feed_forward(loop.plant, 1.0 / demand.time_constant)


def reference_rate(task: TuningTask, loop: TransferLoop, demand: Demand) -> float:
    """Return the rate of the output that half the actuator's limit keeps up, at the reference's frequency.

    At most at the first bandwidth of the gains: faster references are not followed in any case.
    """
    omega = min(1.0 / demand.time_constant, START * working_frequency(loop.plant))
    return 0.5 * task.constraints.limit * omega * float(np.abs(loop.plant.frequency_response(np.array([omega])))[0])


def _simulate_manoeuvre(
    programme: _Programme, ship: TrimmedShip, loop: TransferLoop, controller: str, gains: Array, limits: ActuatorLimits,
    drawn_ships: tuple[TrimmedShip, ...], stable_and_drawn: tuple[int, int],
) -> ManoeuvreResponse:  # fmt: skip
    trim = _trim(ship)
    output, moved = simulate_tracking(
        ship, loop, gains, limits, programme.dt, programme.reference, programme.fed_forward
    )
    answers = [_output_about_trim(one, loop, gains, limits, programme) for one in drawn_ships]
    is_lost = stable_and_drawn[0] < stable_and_drawn[1] or any(a is None for a in answers)
    worst = max(
        (relative_overshoot(a, programme.demand, programme.step_samples) for a in answers if a is not None),
        default=math.nan,
    )
    every = math.ceil(len(output) / _SAMPLES)
    shown = [trim + a[::every] for a in answers if a is not None][:_SHOWN_DRAWS]
    drawn_answers = np.array(shown).reshape(len(shown), len(output[::every]))
    series = {
        loop.output: output,
        loop.actuator: moved,
        REFERENCE: trim + programme.reference,
        DEMAND: trim + programme.demand,
    }
    return ManoeuvreResponse(
        name=programme.name,
        controller=controller,
        record=series_record(
            f"{programme.name}, {controller}",
            programme.dt * every,
            {n: values[::every] for n, values in series.items()},
            f"loop '{loop.name}' following a demand",
            dict.fromkeys((REFERENCE, DEMAND), loop.output),
        ),
        output=loop.output,
        overshoot=relative_overshoot(output - trim, programme.demand, programme.step_samples),
        settling=settling_time(output - trim, programme.demand, programme.step_samples, programme.dt),
        stable_draws=stable_and_drawn[0],
        draws=stable_and_drawn[1],
        worst_overshoot=math.inf if is_lost else worst,
        sampled_outputs=frozen(drawn_answers),
        is_to_settle=programme.is_to_settle,
    )


def _trim(ship: TrimmedShip) -> float:
    return float(ship.state[ship.model.states.index(ship.output)])


def _output_about_trim(
    ship: TrimmedShip, loop: TransferLoop, gains: Array, limits: ActuatorLimits, programme: _Programme
) -> Array | None:
    """Return the output about the trim (n,); None where the simulation diverges."""
    try:
        answer = simulate_tracking(ship, loop, gains, limits, programme.dt, programme.reference, programme.fed_forward)
        return answer[0] - _trim(ship)
    except InputError:
        return None


# One set of gains in words a control engineer knows.

# relative excess over a limit that a search against it leaves; chosen: below the digits in which limits are stated
_LEAST_EXCESS = 1e-4

_RMS_NAMES = ("output", "actuator", "actuator_rate", "motion")  # in the order of an evaluation's variances
_POINTS = 400  # frequencies of the curves in the result, evenly in the logarithm; chosen


def describe_controller(evaluator: GainEvaluator, name: str, gains: Array) -> Controller:
    """Return all that linear theory says of gains (g,) in what the task meets; the frailest speed gives the margins."""
    evaluation = evaluator.evaluate(gains[None])
    speeds = dict.fromkeys(one.U for one in evaluator.task.disturbances)
    loops = [evaluator.task.loop_at(U, evaluator.loop).with_gains(gains) for U in speeds]
    frail, frailest = max(((margins(loop), loop) for loop in loops), key=lambda pair: pair[0].Ms)
    variances, limits = evaluation.variances[0], evaluator.task.constraints
    rms = np.sqrt(variances.mean(axis=0))
    names = _RMS_NAMES[:3] if evaluator.task.motion is OUTPUT else _RMS_NAMES
    left = float(rms[3]) / math.sqrt(evaluator.uncontrolled_variance) if evaluator.task.demand is None else math.nan
    omega = np.geomspace(*frequency_band(frailest), _POINTS)
    open_loop, drive = frailest.open_loop(omega), evaluator.task.drive
    return Controller(
        name=name,
        gains=dict(zip(evaluator.loop.gains.names, gains.tolist(), strict=True)),
        objectives=evaluation.objectives[0],
        rms=dict(zip(names, rms.tolist(), strict=False)),
        reduction=1.0 - left,
        Ms=frail.Ms,
        gain_margin=frail.gain,
        phase_margin=frail.phase,
        delay_margin=frail.delay,
        damping=frail.damping,
        saturation=exceedance_share(limits.limit, float(variances[:, 1].max())),
        rate_saturation=exceedance_share(limits.rate, float(variances[:, 2].max())),
        violated=(*violated_restrictions(evaluator, evaluation), *_broken_delay(frail.delay, limits.delay)),
        omega=omega,
        open_loop=open_loop,
        lower_gain_margin=frail.lower_gain,
        noise_gain=_noise_gain(frailest, omega) if frail.is_stable else math.nan,
        reversals=_reversals(evaluator, gains),
        energy=math.nan if drive is None else drive.energy(float(variances[:, 2].mean())),
    )


def _noise_gain(loop: TransferLoop, omega: Array) -> float:
    """Return the largest |K S|: what the actuator makes of a unit of noise in the output, at its worst frequency."""
    controller = loop.gain_values @ loop.controller_terms(omega)
    return float(np.max(np.abs(controller / (1.0 + loop.open_loop(omega)))))


def _reversals(evaluator: GainEvaluator, gains: Array) -> float:
    """Return how often the actuator turns back in an hour, mean over the seas; nan where it never moves."""
    rows = (ACTUATOR_RATE.variances[0], ACTUATOR_ACCELERATION.variances[0])
    rms = [np.sqrt(replace(one, variances=rows).evaluate(gains, with_Ms=False).variances[0])
           for one in evaluator.performances]  # fmt: skip
    counts = [reversals_per_hour(float(rate), float(acceleration)) for rate, acceleration in rms if rate > 0.0]
    return float(np.mean(counts)) if counts else math.nan


def _broken_delay(delay: float, least: float) -> tuple[str, ...]:
    """Return the delay margin in words where it is too short."""
    return (f"delay margin {delay:.3g} s where {least:.3g} s are required",) if delay < least else ()


def violated_restrictions(evaluator: GainEvaluator, evaluation: GainEvaluation) -> tuple[str, ...]:
    """Return restrictions that the first of some gains does not keep, in words."""
    if not math.isfinite(evaluation.Ms[0]):
        return ("stability: the closed loop is unstable",)
    limits, worst = evaluator.task.constraints, evaluation.variances[0].max(axis=0)
    broken = []
    if evaluation.excess[0, 0] > _LEAST_EXCESS:
        broken.append(f"Ms {evaluation.Ms[0]:.3g} where {limits.Ms:.3g} is allowed")
    amplitudes = (("angle", limits.limit, limits.saturation), ("rate", limits.rate, limits.rate_saturation))
    for i, (kind, limit, share) in enumerate(amplitudes, start=1):
        if evaluation.excess[0, i] > _LEAST_EXCESS:
            beyond = 100.0 * exceedance_share(limit, float(worst[i]))
            broken.append(f"{beyond:.0f} % of the actuator's {kind} amplitudes beyond its limit "
                          f"where {100.0 * share:.0f} % are allowed")  # fmt: skip
    return tuple(broken)


def discrete_controller(task: TuningTask, loop: TransferLoop) -> DiscreteController | None:
    """Return terms and filters of a loop with its gains as difference equations, and the reference that it follows.

    None where the loop is unstable.
    """
    if not margins(loop).is_stable:
        return None
    sampling = loop.required_sampling
    reference = None if task.demand is None else _reference_filter(task, loop, task.demand)
    return DiscreteController(
        sampling.sample_s, discrete_blocks(loop), sampling.dead_time, sampling.noise, sampling.resolution, reference,
        tuple(_component("sensor", block) for block in loop.sensor),
    )  # fmt: skip


def _reference_filter(task: TuningTask, loop: TransferLoop, demand: Demand) -> ReferenceFilter:
    law = feed_forward(loop, demand)
    rate = reference_rate(task, loop, demand)
    return ReferenceFilter(demand.time_constant, rate, law.level, law.velocity, law.acceleration)


def components(loop: TransferLoop) -> tuple[Component, ...]:
    """Return the blocks of a loop, in the order of the signal from its output back to it."""
    return (
        *(_component("sensor", block) for block in loop.sensor),
        *(_component("term", term.block, term.gain) for term in loop.terms),
        *(_component("filter", block) for block in loop.filters),
        *(_component("servo", block) for block in loop.servo),
        _component("plant", loop.plant),
        _component("disturbance", loop.disturbance),
    )


def _component(role: str, block: Block, gain: str = "") -> Component:
    return Component(role, block.name, block.num, block.den, gain, block.source)
