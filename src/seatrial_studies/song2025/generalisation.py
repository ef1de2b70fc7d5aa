"""What coefficients are worth beyond their record: other manoeuvres, other speeds, sensitivities, an autopilot."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record, spelling_hint
from seatrial.data.example_series import JET_VELOCITY, SENSOR_NOISE, SLEW_RATE
from seatrial.estimation.information import directions
from seatrial.physics.manoeuvres import programme
from seatrial.physics.simulate import (
    ZERO_STARTS,
    HeadingStep,
    SegmentBatch,
    batch_class,
    forces,
    initial_state,
    inputs_of,
    manoeuvre,
    replay,
    trajectory,
)
from seatrial_studies.controller_cost import (
    ControlledMotion,
    ControllerCost,
    ControlTask,
    controller_costs,
)
from seatrial_studies.song2025.published import (
    APPROACH_SPEED,
    TRUTH,
    Accuracy,
    CoefficientSet,
    ManoeuvreRun,
    PublishedManoeuvre,
    replay_inputs,
    simulate_manoeuvre,
)
from seatrial_studies.study_file import study_setting

# Simulations with the columns of table 2: zigzags and a turn compared with the truth's: accuracy, forces, drift.

CHANNELS = ("u", "v", "r")
FORCES = {"X": "X_sum", "Y": "Y_sum", "N": "N_sum"}
STEADY_SECONDS, STEP = 1500.0, 0.1


@dataclass(frozen=True, eq=False)
class RunComparison:
    """One run of one craft, a column of table 2 or our own, and the truth's.

    Attributes:
        title: whose coefficients.
        reference: the truth, helmsman in the loop.
        steered: the column's, helmsman in the loop, so that nozzle angles differ as in figures 4c and 7c.
        replayed: the column's on the reference's nozzle history; shorter than the reference where it diverges.
        replayed_accuracy: over what reference and prediction have in common; None where it diverges.
    """

    title: str
    craft: Model
    run: PublishedManoeuvre
    reference: Record
    steered: ManoeuvreRun
    replayed: Record
    replayed_accuracy: Accuracy | None


def compare_run(coefficient_set: CoefficientSet, run: PublishedManoeuvre, truth: Record) -> RunComparison:
    """Compare one column in one run with the record `truth`."""
    return compare_craft(coefficient_set.title, coefficient_set.craft(), run, truth)


def compare_craft(title: str, craft: Model, run: PublishedManoeuvre, truth: Record) -> RunComparison:
    """Compare one craft in one run with the record `truth`."""
    steered, again = simulate_manoeuvre(craft, run), replay_inputs(craft, truth)
    return RunComparison(
        title,
        craft,
        run,
        truth,
        steered,
        again,
        prediction_accuracy(truth, again) if len(again) == len(truth) else None,
    )


def prediction_accuracy(truth: Record, other: Record) -> Accuracy:
    """Return root mean square errors and correlation coefficients (Pearson) of u, v, r over the samples both have."""
    n = min(len(truth), len(other))
    pairs = {c: (truth[c][:n], other[c][:n]) for c in CHANNELS}
    return Accuracy(
        {c: float(np.sqrt(np.mean((b - a) ** 2))) for c, (a, b) in pairs.items()},
        {c: float(np.corrcoef(a, b)[0, 1]) for c, (a, b) in pairs.items()},
    )


def hull_and_jet_forces(craft: Model, record: Record) -> dict[str, Array]:
    """Return X, Y [N] and N [N m] of hull and jet along a record by a model, by letter, each (n,)."""
    of_model = forces(craft, record)
    return {letter: of_model[binding] for letter, binding in FORCES.items()}


def steady_drift_angle(coefficient_set: CoefficientSet, degrees: float) -> float:
    """Return the steady drift angle [deg] of a turn with the nozzle held at `degrees`; NaN where it diverges."""
    craft = coefficient_set.craft()
    count = round(STEADY_SECONDS / STEP)
    held = {"delta": math.radians(degrees), "v_j": JET_VELOCITY}
    inputs = np.tile([-held[i.name] if i.is_reversed else held[i.name] for i in craft.inputs], (count, 1))
    start = np.array([APPROACH_SPEED if state == "u" else 0.0 for state in craft.states])
    states, _ = trajectory(craft, inputs, STEP, start)
    u, v = (states[-1, craft.states.index(s)] for s in "uv")
    return math.degrees(math.atan2(-v, u))


# RMSE and CC as measures of coefficients: a move of 100 % along the least identifiable direction of a record.

# relative change of a coefficient that a sentence names; our choice
NOTABLE_CHANGE = 0.2


@dataclass(frozen=True)
class Discrimination:
    """What accuracy sees of coefficients moved by 100 % along the weakest direction of the Fisher information.

    Attributes:
        changes: coefficient -> relative change of the moved craft.
        accuracy: of the moved craft on the same nozzle history, against the truth.
    """

    changes: dict[str, float]
    accuracy: Accuracy

    @property
    def changes_text(self) -> str:
        """Return the changes above a fifth, per cent of the signed value."""
        return ", ".join(f"{n} {100 * c:+.0f} %" for n, c in self.changes.items() if abs(c) > NOTABLE_CHANGE)

    @property
    def cc_loss(self) -> dict[str, float]:
        """Return 1 - CC by channel."""
        return {channel: 1.0 - cc for channel, cc in self.accuracy.cc.items()}


def discrimination(series: Record) -> Discrimination:
    """Return the discrimination of the consecutive zigzags, noise-free (0.8 s)."""
    craft = TRUTH.craft()
    names = craft.parameters.free_names
    sizes = np.array([p.characteristic_scale for p in craft.parameters.free])
    weakest = directions(fisher_information(craft, series), names, sizes)[0]
    moved = {p.name: p.value + weakest.combination[p.name] * p.characteristic_scale for p in craft.parameters.free}
    changes = {p.name: moved[p.name] / p.value - 1.0 for p in craft.parameters.free}
    accuracy = prediction_accuracy(series, replay_inputs(craft.with_values(moved), series))
    return Discrimination(changes, accuracy)


def fisher_information(craft: Model, record: Record) -> Array:
    """Return the Fisher information (k, k) of the free coefficients: output error, known initial state, white noise."""
    outputs = tuple(SENSOR_NOISE)
    offsets = np.array([0, len(record)])
    batch = SegmentBatch(craft, inputs_of(craft, record), offsets, record.dt, outputs, craft.parameters.free_names)
    start, none = initial_state(craft, record, {}), np.empty((1, 0))
    _, slopes, _ = batch.differentiate(0, 1, start[None], craft.parameters.values[None], none)
    weighted = slopes / np.array([SENSOR_NOISE[name] for name in outputs])[None, :, None]
    rows = weighted.reshape(-1, weighted.shape[2])
    return rows.T @ rows


# Conclusion 1, a wider range of speed: coefficients found at one speed predict the craft at half to twice of it.

SPEED_FACTORS = tuple(study_setting("song2025", "speed_factors", list).value)


@dataclass(frozen=True, eq=False)
class SpeedPrediction:
    """A 20/20 zigzag of the truth at one speed, predicted on its nozzle history.

    Attributes:
        factor: of the approach speed in the training series; speed: approach speed, m/s.
        errors: whose coefficients -> largest RMSE of u, v, r over the channel's rms; infinite where it diverges.
        cc: whose coefficients -> least correlation.
    """

    factor: float
    speed: float
    errors: dict[str, float]
    cc: dict[str, float]


def speed_predictions(crafts: Mapping[str, Model], factors: tuple[float, ...]) -> tuple[SpeedPrediction, ...]:
    """Return predictions at each speed; all coefficients come from a series at one."""
    return tuple(_at_speed(crafts, factor) for factor in factors)


def _at_speed(crafts: Mapping[str, Model], factor: float) -> SpeedPrediction:
    truth = manoeuvre(
        TRUTH.craft(), programme(PublishedManoeuvre.ZIGZAG_20), inputs={"v_j": factor * JET_VELOCITY},
        slew_rate=SLEW_RATE,
    )  # fmt: skip
    errors, cc = {}, {}
    for name, craft in crafts.items():
        again = replay_inputs(craft, truth)
        if len(again) < len(truth):
            errors[name], cc[name] = float("inf"), float("nan")
            continue
        accuracy = prediction_accuracy(truth, again)
        sizes = {c: float(np.sqrt(np.mean(truth[c] ** 2))) for c in CHANNELS}
        errors[name] = max(accuracy.rmse[c] / sizes[c] for c in CHANNELS)
        cc[name] = min(accuracy.cc.values())
    return SpeedPrediction(factor, float(truth["u"][0]), errors, cc)


# What a coefficient does to a manoeuvre: alone, as sensitivity analyses ask, and once the others may make up for it.

RELATIVE_CHANGE = 0.1


@dataclass(frozen=True, eq=False)
class IndirectSensitivity:
    """Relative changes of states for a relative change of one coefficient at a time, divided by it.

    Attributes:
        names: of the k coefficients; states: of the m states; change: the relative change that was made.
        matrix: shape (k, m), one where a state changes by as many per cent as the coefficient; not negative.
        total: over all states, the sum of a row, shape (k,).
    """

    names: tuple[str, ...]
    states: tuple[str, ...]
    change: float
    matrix: Array
    total: Array


@dataclass(frozen=True, eq=False)
class UniqueSensitivity:
    """Rms slopes of states, over their scales, by relative changes of coefficients: alone, and what is left of them.

    Attributes:
        names: of the k coefficients; states: of the m states.
        matrix: of each state by each coefficient alone, shape (k, m).
        total: over all states, the root of the sum of squares of a row, shape (k,).
        unique: of `total` what no change of the other coefficients can undo, shape (k,). total^2 / unique^2 is the
            variance inflation factor; with white noise as scales and n samples, 1 / (sqrt(n) unique) is the
            Cramér-Rao bound of the coefficient's relative standard error (initial state known).
    """

    names: tuple[str, ...]
    states: tuple[str, ...]
    matrix: Array
    total: Array
    unique: Array


def indirect_sensitivity(
    model: Model,
    record: Record,
    names: Sequence[str] | None = None,
    states: Sequence[str] | None = None,
    change: float = RELATIVE_CHANGE,
    initial: Mapping[str, float] | None = None,
) -> IndirectSensitivity:
    """Indirect sensitivities: each coefficient changed, the record's inputs replayed, the states compared over time.

    Song et al. 2025, section 1.3.2, take it from Xu et al. 2013, J. Harbin Eng. Univ. 34, 669, and print neither its
    formula nor the size of the change. Chosen here: 10 %, and for coefficient i and state j

        S_ij = (integral |x_j(a_i + change a_i) - x_j(a_i)| dt / integral |x_j(a_i)| dt) / |change|.

    The inputs stay as recorded: executes do not move as a helmsman's would.

    Args:
        model: all parameters must have values.
        names: coefficients, by default the free ones.
        states: by default all but the pose (x0, y0, psi), whose size depends on where the record begins.
        change: relative, of either sign.
        initial: state -> value where the record's first sample is not to be used.

    Raises:
        InputError: `change` is none, a coefficient is zero, a state does not move, or a simulation diverges; as
            `seatrial.physics.simulate.replay` for the record.
    """
    if not np.isfinite(change) or change == 0.0:
        raise InputError(f"a relative change of {change:g} is none: give one like 0.1 or -0.1")
    wanted, seen = _coefficients(model, names), _states(model, states)
    base = _simulated_states(model, record, initial, seen)
    sizes = _mean_magnitudes(base, seen, record)
    rows = []
    for name in wanted:
        moved = model.with_values({name: model.parameters[name].value * (1.0 + change)})
        try:
            other = _simulated_states(moved, record, initial, seen)
        except InputError as error:
            raise InputError(f"with '{name}' changed by {100.0 * change:+g} %: {error}") from error
        rows.append(_time_mean(np.abs(other - base)) / sizes / abs(change))
    matrix = np.array(rows).reshape(len(wanted), len(seen))
    return IndirectSensitivity(wanted, seen, change, matrix, matrix.sum(axis=1))


def unique_sensitivity(
    model: Model,
    record: Record,
    names: Sequence[str] | None = None,
    scales: Mapping[str, float] | None = None,
    initial: Mapping[str, float] | None = None,
) -> UniqueSensitivity:
    """Return sensitivities from exact slopes of the replayed record, and their parts orthogonal to all others'.

    With c_i the slopes of all states and samples by ln a_i, each state over its scale, unique_i is the rms of
    c_i - C b, b from least squares of c_i on the columns C of the other coefficients: their first-order adjustment. It
    is 1 / sqrt((C'C)^-1_ii) of all columns (partial regression: Belsley, Kuh & Welsch 1980, Regression Diagnostics,
    section 2.1).

    Args:
        names: coefficients, by default the free ones; those left out do not adjust.
        scales: state -> its scale, e.g. its noise, in SI units; by default all states but the pose, each over its mean
            magnitude, as in `indirect_sensitivity`.
        initial: as in `indirect_sensitivity`; it does not adjust.

    Raises:
        InputError: as `indirect_sensitivity`, or a scale is not positive.
    """
    wanted, seen = _coefficients(model, names), _states(model, None if scales is None else list(scales))
    base = _simulated_states(model, record, initial, seen)
    sizes = _mean_magnitudes(base, seen, record) if scales is None else np.array([scales[s] for s in seen])
    if not np.all(np.isfinite(sizes) & (sizes > 0.0)):
        raise InputError(f"the scale of '{seen[int(np.argmin(sizes > 0.0))]}' is not positive")
    slopes = _log_slopes(model, record, initial, wanted, seen) / sizes[:, None]
    matrix = np.sqrt(np.mean(slopes**2, axis=0)).T
    total = np.sqrt(np.sum(matrix**2, axis=1))
    columns = slopes.reshape(-1, len(wanted)) / np.sqrt(len(record))
    return UniqueSensitivity(wanted, seen, matrix, total, orthogonal_parts(columns))


def orthogonal_parts(columns: Array) -> Array:
    """Return the norm of what least squares on all other columns leaves of each, columns (n, k): shape (k,)."""
    lengths = np.linalg.norm(columns, axis=0)
    # the triangle keeps all lengths and angles
    triangle: Array = np.linalg.qr(columns / np.where(lengths > 0.0, lengths, 1.0))[1]
    left = np.empty(len(lengths))
    for i in range(len(lengths)):
        others, own = np.delete(triangle, i, axis=1), triangle[:, i]
        left[i] = np.linalg.norm(own - others @ np.linalg.lstsq(others, own, rcond=None)[0])
    return left * lengths


def _coefficients(model: Model, names: Sequence[str] | None) -> tuple[str, ...]:
    wanted = model.parameters.free_names if names is None else tuple(names)
    for name in wanted:
        if model.parameters[name].value == 0.0:
            raise InputError(f"coefficient '{name}' of model '{model.name}' is zero, which no relative change moves")
    return wanted


def _states(model: Model, states: Sequence[str] | None) -> tuple[str, ...]:
    if states is None:
        return tuple(s for s in model.states if s not in ZERO_STARTS)
    for state in states:
        if state not in model.states:
            raise InputError(f"'{state}' is no state of model '{model.name}'{spelling_hint(state, list(model.states))}")
    return tuple(states)


def _simulated_states(
    model: Model, record: Record, initial: Mapping[str, float] | None, states: tuple[str, ...]
) -> Array:
    return replay(model, record, initial).matrix(states)


def _time_mean(values: Array) -> Array:
    """Mean over the record by the trapezoidal rule, values (n, m): shape (m,)."""
    return 0.5 * np.mean(values[1:] + values[:-1], axis=0)


def _mean_magnitudes(base: Array, states: Sequence[str], record: Record) -> Array:
    """Mean magnitude of each state, shape (m,)."""
    sizes = _time_mean(np.abs(base))
    if not np.all(sizes > 0.0):
        still = states[int(np.argmin(sizes))]
        raise InputError(f"state '{still}' does not move in record '{record.name}': leave it out of `states`")
    return sizes


def _log_slopes(
    model: Model, record: Record, initial: Mapping[str, float] | None, names: tuple[str, ...], states: tuple[str, ...]
) -> Array:
    """Exact slopes of the states by ln of the coefficients, shape (n, m, k)."""
    inputs, start = inputs_of(model, record), initial_state(model, record, initial or {})
    batch = batch_class(model)(model, inputs, np.array([0, len(inputs)]), record.dt, states, names)
    values = model.parameters.values[None]
    _, slopes, _ = batch.differentiate(0, 1, start[None], values, np.empty((1, 0)))
    return slopes * np.array([model.parameters[name].value for name in names])


# The last row: an autopilot tuned on each method's coefficients and simulated on the true craft.

TURN = math.radians(30.0)  # change of heading to be followed, our choice
DURATION, TURN_STEP = 120.0, 0.25  # s; long enough for the turn, and a step well below the craft's time constants
NOZZLE_LIMIT = math.radians(35.0)  # the largest nozzle angle of the paper's manoeuvres
NOZZLE_WEIGHT = 0.3  # rad of heading error that count as much as a radian of nozzle; our choice
START_GAINS = np.array([1.0, 3.0])  # KP [rad/rad], KD [s]: where the tuning starts; our choice
NOZZLE = "delta"
_STEP = HeadingStep(TURN, NOZZLE_LIMIT, NOZZLE, DURATION, TURN_STEP)
_RUNAWAY = 100.0  # approach speeds beyond which a motion has run away; our choice


def heading_task() -> ControlTask[Model]:
    """Return the task: follow a step of heading without moving the nozzle more than needed."""

    def simulate(craft: Model, gains: Array) -> ControlledMotion:
        return _turn(craft, gains)

    return ControlTask(simulate, START_GAINS, NOZZLE_WEIGHT)


def _turn(craft: Model, gains: Array) -> ControlledMotion:
    """The craft under the controller."""
    start = np.zeros(len(craft.states))
    start[craft.states.index("u")] = APPROACH_SPEED
    motion = _STEP.simulate(craft, gains, start, np.array([0.0, JET_VELOCITY]))
    if motion is None or np.max(np.abs(motion[0][:, craft.states.index("u")])) > _RUNAWAY * APPROACH_SPEED:
        return ControlledMotion(np.inf, np.inf)
    states, inputs = motion
    output, actuator = (
        math.degrees(math.sqrt(float(np.mean(y**2))))
        for y in (TURN - states[:, craft.states.index("psi")], inputs[:, craft.input_names.index(NOZZLE)])
    )
    return ControlledMotion(output, actuator)


def heading_controller_costs(crafts: Mapping[str, Model]) -> tuple[ControllerCost, ...]:
    """Return what controllers tuned on these crafts cost on the true one."""
    return controller_costs(crafts, TRUTH.craft(), heading_task())
