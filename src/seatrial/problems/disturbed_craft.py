"""Craft in gusts and waves, steered by a programme or a controller: records whose truth is known, and their bound."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.equations.augment import gust_name, with_gusts
from seatrial.core.values import Array, Record, Ship
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate.assemble import Runs, output_error_problem
from seatrial.estimation.estimate.newton_refinement import newton_step
from seatrial.estimation.estimate.plausibility import with_input_offsets
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise, initial_problem
from seatrial.numerics.optimise import Optimum, Solution, Status
from seatrial.physics.models import nomoto
from seatrial.physics.simulate.batch import SegmentBatch
from seatrial.problems.problem import BenchmarkProblem, Placement, ProblemDraw
from seatrial.problems.trial_problem import KnownCraft, craft_draw, off_centre_box, scaled_values

# Craft in gusts and waves, steered by a programme or by a controller: records whose truth is known.

# s: sample and length of a record, step of the independent simulation; chosen
SAMPLE_S, SECONDS = 0.1, 600.0
FINE_S = 0.02  # s, as above
# rad/s: rate of the rudder under the controller, and under a programme; chosen
SLEW, PROGRAMME_SLEW = math.radians(5.0), math.radians(20.0)
# rad: rudder of the programme, largest rudder, and courses ordered to both sides; chosen
AMPLITUDE, LIMIT, COURSE = math.radians(4.0), math.radians(20.0), math.radians(10.0)
# s: shortest time on one side of the programme, and time on one course; chosen
BIT_S, LEG_S = 4.0, 60.0
GAIN, RATE_GAIN = 1.0, 4.0
"""Of the controller: rudder over heading error [1], and over yaw rate [s]; chosen."""
WAVE_FREQUENCY, WAVE_DAMPING = 0.8, 0.1
"""Of wave forces: natural frequency [rad/s] and damping ratio [1]; chosen."""
WAVE_SLOPE = math.radians(1.0)


@dataclass(frozen=True)
class Disturbance:
    """What disturbs the craft.

    Attributes:
        size: standard deviation over that of the craft's `driven`; memory: s, 0: a new value each sample.
        waves: standard deviation of a second-order force at 0.8 rad/s, over the same; offset: of the rudder, rad.
    """

    size: float
    memory: float
    waves: float = 0.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class DisturbedCraft:
    """A craft and how it is measured and steered.

    Attributes:
        model: the truth, with its free parameters; driven: state -> acceleration of a disturbance of size 1, SI.
        steered: input -> share of the programme or of the controller's output that it gets.
        held: input -> its mean; start: state -> value at the start; wave_slope: whether irregular waves are recorded.
        sensors: channel -> standard deviation, SI; constant: channel -> value that is recorded without noise.
        length: m; guess: where the search starts.
        controlled, rate: states of the controller, gain, rate_gain: its input = gain * error - rate_gain * rate.
    """

    name: str
    model: Model
    driven: Mapping[str, float]
    sensors: Mapping[str, float]
    length: float
    guess: Mapping[str, float]
    steered: Mapping[str, float] = field(default_factory=lambda: {"delta": 1.0})
    controlled: str = "psi"
    rate: str = "r"
    held: Mapping[str, float] = field(default_factory=dict)
    start: Mapping[str, float] = field(default_factory=dict)
    constant: Mapping[str, float] = field(default_factory=dict)
    wave_slope: str = ""
    bit_s: float = BIT_S
    leg_s: float = LEG_S
    slew: float = SLEW
    amplitude: float = AMPLITUDE
    limit: float = LIMIT
    course: float = COURSE
    gain: float = GAIN
    rate_gain: float = RATE_GAIN


def programme(craft: DisturbedCraft, rows: int, step: float, rng: np.random.Generator) -> Array:
    """A random binary rudder: a new side every `bit_s` with probability a half, at 20 deg/s, (rows,)."""
    bits = rng.choice([-1.0, 1.0], math.ceil(rows * step / craft.bit_s) + 1)
    target, angle = craft.amplitude * np.repeat(bits, round(craft.bit_s / step))[:rows], np.zeros(rows)
    for k in range(1, rows):
        angle[k] = angle[k - 1] + np.clip(target[k] - angle[k - 1], -PROGRAMME_SLEW * step, PROGRAMME_SLEW * step)
    return angle


def course_at(time: float, craft: DisturbedCraft) -> float:
    """The heading that is ordered: a square wave."""
    return craft.course if int(time // craft.leg_s) % 2 == 0 else -craft.course


def _rudder_rate(craft: DisturbedCraft, error: Array, turning: Array, angle: Array) -> Array:
    """Rate by which the rudder reaches the ordered angle at the next sample, within its limits, (runs,)."""
    ordered = np.clip(craft.gain * error - craft.rate_gain * turning, -craft.limit, craft.limit)
    return np.clip((ordered - angle) / SAMPLE_S, -craft.slew, craft.slew)


def coloured(rows: int, count: int, disturbance: Disturbance, step: float, rng: np.random.Generator) -> Array:
    """Gusts and waves of unit `driven`, (rows, count)."""
    values = np.zeros((rows, count))
    if disturbance.size > 0.0 and disturbance.memory > 0.0:
        keep = math.exp(-step / disturbance.memory)
        x = rng.standard_normal(count)
        for k in range(rows):
            values[k] = disturbance.size * x
            x = keep * x + math.sqrt(1.0 - keep**2) * rng.standard_normal(count)
    elif disturbance.size > 0.0:
        hold = round(SAMPLE_S / step)
        values += disturbance.size * np.repeat(rng.standard_normal((rows // hold + 1, count)), hold, axis=0)[:rows]
    if disturbance.waves > 0.0:
        values += disturbance.waves * _waves(rows, count, step, rng)
    return values


def _waves(rows: int, count: int, step: float, rng: np.random.Generator) -> Array:
    """A lightly damped second-order process of unit variance, exact in steps, (rows, count)."""
    decay, fast = WAVE_DAMPING * WAVE_FREQUENCY, WAVE_FREQUENCY * math.sqrt(1.0 - WAVE_DAMPING**2)
    grown, cos, sin = math.exp(-decay * step), math.cos(fast * step), math.sin(fast * step)
    ratio = decay / fast
    transition = grown * np.array([[cos + ratio * sin, sin / fast],
                                   [-(WAVE_FREQUENCY**2) / fast * sin, cos - ratio * sin]])  # fmt: skip
    stationary = np.diag([1.0, WAVE_FREQUENCY**2])
    root = np.linalg.cholesky(stationary - transition @ stationary @ transition.T)
    x = np.sqrt(np.diag(stationary))[:, None] * rng.standard_normal((2, count))
    values = np.empty((rows, count))
    for k in range(rows):
        values[k] = x[0]
        x = transition @ x + root @ rng.standard_normal((2, count))
    return values


def records(
    craft: DisturbedCraft, disturbance: Disturbance, count: int, rng: np.random.Generator, *, is_closed: bool,
    step: float = SAMPLE_S, seconds: float = SECONDS,
) -> list[Record]:  # fmt: skip
    """Simulate runs of a craft by its compiled model, in steps of `step` [s]."""
    model, names = craft.model, craft.model.input_names
    rows, kept = round(seconds / step) + 1, round(SAMPLE_S / step)
    mean = np.array([craft.held.get(n, 0.0) for n in names])
    share = np.array([craft.steered.get(n, 0.0) for n in names])
    slope = np.zeros((rows, count))
    if craft.wave_slope:
        slope = WAVE_SLOPE * _waves(rows, count, step, rng)
    is_wave = np.array([n == craft.wave_slope for n in names], dtype=float)
    batch = SegmentBatch(model, np.zeros((2 * count, len(names))), 2 * np.arange(count + 1), step, model.states)
    values = np.tile(model.parameters.values, (count, 1))
    x = np.tile([craft.start.get(s, 0.0) for s in model.states], (count, 1)).astype(float)
    push = {model.states.index(s): size * coloured(rows, count, disturbance, step, rng)
            for s, size in craft.driven.items()}  # fmt: skip
    angle, turned = np.zeros(count), np.zeros(count)
    plan = None if is_closed else np.array([programme(craft, rows, step, rng) for _ in range(count)])
    states, inputs, sensed = (np.empty((rows, count, len(model.states))), np.empty((rows, count)), {})
    noise = {s: size * rng.standard_normal((rows // kept + 1, count)) for s, size in craft.sensors.items()}
    psi, rate = model.states.index(craft.controlled), model.states.index(craft.rate)
    for k in range(rows):
        states[k] = x
        if plan is None:
            if k % kept == 0:
                error = course_at(k * step, craft) - x[:, psi] - noise[craft.controlled][k // kept]
                turning = x[:, rate] + noise[craft.rate][k // kept]
                turned = _rudder_rate(craft, error, turning, angle)
            after = angle + turned * step
        else:
            angle, after = plan[:, k], plan[:, min(k + 1, rows - 1)]
        inputs[k] = angle
        ends = np.stack([angle, after], axis=1) + disturbance.offset
        sloping = np.stack([slope[k], slope[min(k + 1, rows - 1)]], axis=1)
        both = mean + share * ends[:, :, None] + is_wave * sloping[:, :, None]
        batch.inputs[:] = both.reshape(2 * count, -1)
        half = {i: 0.25 * step * (p[k] + p[min(k + 1, rows - 1)]) for i, p in push.items()}
        for i, kick in half.items():
            x[:, i] += kick
        y, _ = batch.simulate(0, count, x, values, np.empty((count, 0)))
        x, angle = np.ascontiguousarray(y.reshape(count, 2, -1)[:, 1]), after
        for i, kick in half.items():
            x[:, i] += kick
    sensed = {s: states[::kept, :, model.states.index(s)] + n[: len(states[::kept])] for s, n in noise.items()}
    time = SAMPLE_S * np.arange(len(inputs[::kept]), dtype=np.float64)
    kept_angle = inputs[::kept]
    worked = {n: craft.held.get(n, 0.0) + f * kept_angle for n, f in craft.steered.items()}
    worked |= {craft.wave_slope: slope[::kept]} if craft.wave_slope else {}
    moving = {**worked, **sensed}
    still = {n: v for n, v in {**craft.held, **craft.constant}.items() if n not in worked}
    return [
        Record.from_arrays(
            f"run {i}", time,
            {s: v[:, i] for s, v in moving.items()} | {s: np.full(len(time), v) for s, v in still.items()},
        )
        for i in range(count)
    ]  # fmt: skip


def independent_nomoto(
    craft: DisturbedCraft, disturbance: Disturbance, count: int, rng: np.random.Generator, *, is_closed: bool,
    seconds: float = SECONDS,
) -> list[Record]:  # fmt: skip
    """T r' + r = K (delta + w): exact in steps of 0.02 s for forces constant within each, with numpy alone."""
    gain, lag = (craft.model.parameters[n].value for n in ("K", "T"))
    rows, kept = round(seconds / FINE_S) + 1, round(SAMPLE_S / FINE_S)
    push = craft.driven["r"] * lag / gain * coloured(rows, count, disturbance, FINE_S, rng) + disturbance.offset
    decay = math.exp(-FINE_S / lag)
    plan = None if is_closed else np.array([programme(craft, rows, FINE_S, rng) for _ in range(count)])
    noise = {s: size * rng.standard_normal((rows // kept + 1, count)) for s, size in craft.sensors.items()}
    r, psi, angle, turned = (np.zeros(count) for _ in range(4))
    kept_rows = np.empty((3, rows // kept + 1, count))
    for k in range(rows):
        if k % kept == 0:
            sample = psi + noise["psi"][k // kept], r + noise["r"][k // kept]
            kept_rows[:, k // kept] = angle if plan is None else plan[:, k], *sample
            error = course_at(k * FINE_S, craft) - sample[0]
            turned = _rudder_rate(craft, error, sample[1], angle)
        after = angle + turned * FINE_S if plan is None else plan[:, min(k + 1, rows - 1)]
        now = angle if plan is None else plan[:, k]
        final = gain * (0.5 * (now + after) + push[k])
        psi, r = psi + final * FINE_S + (r - final) * lag * (1.0 - decay), final + (r - final) * decay
        angle = after
    time = SAMPLE_S * np.arange(kept_rows.shape[1], dtype=np.float64)
    return [
        Record.from_arrays(f"run {i}", time, {"delta": kept_rows[0, :, i], "psi": kept_rows[1, :, i],
                                               "r": kept_rows[2, :, i], "u": np.full(len(time), craft.constant["u"])})
        for i in range(count)
    ]  # fmt: skip


Generator = Callable[..., list[Record]]


# What the likelihood of the true disturbance admits on a record: Cramer-Rao bound, and an efficient estimate.

NONE = np.zeros((0, 0))


def limit_of(craft: DisturbedCraft, disturbance: Disturbance, record: Record) -> tuple[Array, Array]:
    """Return standard errors that the true disturbance admits on a record, and an efficient estimate's errors, (k,)."""
    model = craft.model
    settings = EstimateSettings().with_known_timing(model.input_names)  # the records were simulated sample by sample
    problem = output_error_problem(model, Runs.one_session_each([record], craft.length), np.inf, settings, 1)
    problem = replace(problem, noise=np.array([craft.sensors[o] for o in problem.data.outputs]))
    local = np.array([[craft.start.get(s, 0.0) for s in problem.starts]])
    optimum = Optimum(
        Solution(problem.start(), 0.0, Status.CONVERGED, 1), local, problem.normal(problem.start(), local)
    )
    estimate = PointEstimate(problem, optimum)
    if disturbance.size or disturbance.offset:
        estimate = with_input_offsets(estimate)
    driven = tuple(craft.driven) if disturbance.size else ()
    white = initial_problem(estimate, {}, tuple(craft.driven))
    white = replace(white, process=driven)
    squared = np.array([(disturbance.size * craft.driven[s]) ** 2 for s in driven])
    constants: list[float] = []
    if disturbance.memory > 0.0 and driven:
        augmented = with_gusts(model, dict.fromkeys(driven, disturbance.memory))
        spread = np.tile(squared, (1, 1))
        white = replace(white, runs=replace(white.runs, model=augmented), process=tuple(map(gust_name, driven)),
                        start=np.column_stack([white.start, np.zeros((1, len(driven)))]),
                        start_variance=np.hstack([white.start_variance, spread]))  # fmt: skip
        squared, constants = 2.0 * squared / disturbance.memory, [disturbance.memory] * len(driven)
    else:
        squared = squared * SAMPLE_S
    common, free = estimate.common_parameters, len(problem.free)
    session_values = common[free:].copy()
    session_values[-1:] = disturbance.offset
    variances = [craft.sensors[o] ** 2 for o in problem.data.outputs]
    point = np.concatenate([common[:free], constants, session_values, squared, variances])
    normal = white.normal(point, NONE)
    exact = replace(white, steps=white.difference_steps(point, normal.hessian))
    at = Optimum(Solution(point, 0.0, Status.CONVERGED, 1), NONE, exact.normal(point, NONE))
    noise = ProcessNoise(exact, at, 0.0, None, estimate.problem)  # type: ignore[arg-type]
    return noise.interval.standard_error[:free], (newton_step(exact, point) - point)[:free]


# Nomoto's steering model under gusts with a memory: a random rudder, and a controller on courses.

# 1/s and s of a ship of 50 m; chosen
_K, _T = 0.15, 8.0
NOMOTO = DisturbedCraft(
    "nomoto",
    nomoto().with_values({"K": _K, "T": _T}),
    {"r": AMPLITUDE * _K / _T},
    {"psi": math.radians(0.05), "r": math.radians(0.02)},  # rad and rad/s of a good compass and gyro, chosen
    50.0,  # m, length of the ship, chosen
    {"K": 0.1, "T": 10.0},  # 1/s and s where a search starts, chosen
    constant={"u": 5.0},  # m/s, recorded speed, chosen
)
"""The steering model of first order; a gust of size 1 is what the rudder of a programme does."""
# standard deviation over that of the rudder's effect, and memory [s], of the gusts; chosen
_GUSTS = Disturbance(0.3, 5.0)
# half range of the factor by which a draw scales the true coefficients, and half width of their box, 1; chosen
_SCALE, _HALF_WIDTH = 0.2, 0.5
# evaluations of two unknowns; chosen
_BUDGET = 1000
_SOURCE = "ours; the model is that of Nomoto et al. 1957, Int. Shipbuilding Progress 4(35), 354-370"


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return the problem with a random rudder, and with a controller that answers to the gusts."""
    words = {"open": "a random binary rudder", "closed": "a controller on courses of ±10°"}
    noise = "gusts of 0.3 times the rudder's effect with a memory of 5 s; psi 0.05 deg, r 0.02 deg/s, white"
    return tuple(
        BenchmarkProblem(
            f"nomoto-gusts-{name}", 2, f"K and T of a steering model under gusts, {text}, 600 s", _SOURCE, noise,
            _BUDGET, partial(_draw, is_closed=name == "closed"),
        )
        for name, text in words.items()
    )  # fmt: skip


def _draw(rng: np.random.Generator, placement: Placement, *, is_closed: bool) -> ProblemDraw:
    truth = np.array([_K, _T])
    if placement is Placement.SHIFTED:
        truth = scaled_values(truth, _SCALE, rng)
    model = nomoto().with_values({"K": float(truth[0]), "T": float(truth[1])})
    craft = replace(NOMOTO, model=model, driven={"r": float(AMPLITUDE * truth[0] / truth[1])})
    (record,) = independent_nomoto(craft, _GUSTS, 1, rng, is_closed=is_closed)
    bound, _ = limit_of(craft, _GUSTS, record)
    box = off_centre_box(truth, _HALF_WIDTH, rng)
    known = KnownCraft(
        Ship("steering model", {"L": NOMOTO.length}), model, [record], NOMOTO.sensors, [{}],
        disturbance_bound=bound,
    )  # fmt: skip
    return craft_draw(known, box, 0.5 * (box.lower + box.upper))
