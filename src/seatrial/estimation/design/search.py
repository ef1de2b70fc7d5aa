"""The search for a manoeuvre: orders whose worst ship, measured against standard manoeuvres, is identified best."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from operator import itemgetter

import numpy as np

from seatrial.core.equations.model import RUDDER
from seatrial.core.results import Actuator
from seatrial.core.values import Array, InputError
from seatrial.data.trial.design_request import DesignCriterion
from seatrial.estimation.design.manoeuvre_information import (
    ManoeuvreEvaluator,
    ManoeuvreInformation,
    actuator_response,
    input_series,
    leaves_limits,
    limit_excess,
    order_counts,
    orders_at,
    sample_count,
)
from seatrial.estimation.design.task import FEWEST_ORDERS, DesignTask, PriorShips
from seatrial.numerics.optimise import AdaptationSettings, Box, CovarianceAdaptation, Solution, Status
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.manoeuvres.programme import binary_sequence, programme
from seatrial.physics.simulate.replay import inputs_of
from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE, manoeuvre

# Exchange of single orders: one after another takes the value that lowers the cost most (Meyer & Nachtsheim 1995).

# as shares of the range; what lies beyond an end means that end
MOVES = np.array([-1.0, -0.5, -0.2, 0.2, 0.5, 1.0])
# decrease of the cost in a whole round below which the exchange ends, ours
NO_GAIN = 1e-3


@dataclass(frozen=True, eq=False)
class ExchangedOrders:
    """A point of the unit box, its cost, and the evaluations that the exchange spent on it so far."""

    point: Array
    cost: float
    evaluations: int = 0


def coordinate_exchange(
    cost: Callable[[Array], float], start: ExchangedOrders, generator: np.random.Generator, evaluations: int
) -> Iterator[ExchangedOrders]:
    """Return the best point after each coordinate.

    Coordinates come in random order, all of them before any comes again; it ends when a whole round lowers the cost by
    less than `NO_GAIN`, or when the evaluations are spent.
    """
    point, value, spent, before = start.point, start.cost, 0, np.inf
    while before - value > NO_GAIN:
        before = value
        for place in generator.permutation(len(point)):
            candidates = _exchange_candidates(point, int(place))
            costs = map_in_threads(cost, candidates)
            spent += len(costs)
            least = int(np.argmin(costs))
            if costs[least] < value:
                point, value = candidates[least], costs[least]
            yield ExchangedOrders(point, value, spent)
            if spent >= evaluations:
                return


def _exchange_candidates(point: Array, coordinate: int) -> list[Array]:
    candidates = []
    for to in np.unique(np.clip(point[coordinate] + MOVES, 0.0, 1.0)):
        if to != point[coordinate]:
            candidates.append(point.copy())
            candidates[-1][coordinate] = to
    return candidates


# The standard manoeuvres a design is measured by: equal duration, the same inputs, ranges, rates and ships.

# switching times as shares of the designed one's hold; amplitudes as shares of the range, the first that keeps within
SWITCHING_SHARES = (1.0 / 3.0, 2.0 / 3.0, 1.0, 4.0 / 3.0)
# shares of the actuators' range that binary sequences are tried with, largest first, ours
AMPLITUDES = (1.0, 0.85, 0.7, 0.55, 0.4, 0.25, 0.1)
# of the binary sequences
SEQUENCE_SEEDS = (0, 1)
# deg; 10/10 and 20/20 by IMO MSC.137(76), 30/30 ours
_ZIGZAG_ANGLES = (10.0, 20.0, 30.0)
# of angles and of counts of holds
_ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class StandardManoeuvre:
    """A standard manoeuvre; `inputs_for` gives its inputs for ships and step of an evaluator, in the model's signs.

    One course (rows, nu) for all ships, or one each (ships, rows, nu) where a helmsman steers them.
    """

    name: str
    inputs_for: Callable[[ManoeuvreEvaluator], Array]
    is_random: bool = False


def standard_manoeuvres(evaluator: ManoeuvreEvaluator) -> list[StandardManoeuvre]:
    """Return random binary sequences and, by the model, zigzags and turning circles, steps, or steps and a sweep."""
    task = evaluator.task
    drawn = (_largest_within_limits(evaluator, share, seed) for share in SWITCHING_SHARES for seed in SEQUENCE_SEEDS)
    sequences = list({one.name: one for one in drawn}.values())  # a short trial shortens all holds to one
    if task.model.has_thrusters:
        return [*sequences, StandardManoeuvre("steps one by one", _single_step_inputs)]
    if not _is_steered(task):
        return [*sequences, StandardManoeuvre("sine sweep", _sweep_inputs), StandardManoeuvre("steps", _step_inputs)]
    steered = [StandardManoeuvre(text, partial(_steered_inputs, text, {})) for text in _programmes(task)]
    return [*sequences, *(r for r in steered if _can_be_steered(evaluator, r))]


def binary_sequence_inputs(hold: float, amplitude: float, seed: int, evaluator: ManoeuvreEvaluator) -> Array:
    """Every actuator between its ends, or `amplitude` of the way to them, by maximum length sequences of their own."""
    task, orders = evaluator.task, list[Array]()
    switched = replace(task, request=task.request.with_hold(hold))
    for j, actuator in enumerate(task.request.actuators):
        count = int(np.ceil(task.request.duration / hold - _ROUNDING))
        signs = np.sign(np.resize(binary_sequence(1.0, seed + 10 * j), count))
        orders.append(_mid_range(actuator) + signs * amplitude * 0.5 * (actuator.upper - actuator.lower))
    return input_series(switched, orders, evaluator.dt)


def _largest_within_limits(evaluator: ManoeuvreEvaluator, switching: float, seed: int) -> StandardManoeuvre:
    """Return the largest amplitude whose drift and distance keep within the limits; else the smallest tried."""
    task = evaluator.task
    hold = max(switching * task.shortest_hold, 2.0 / task.request.rate)
    hold = min(hold, task.request.duration / FEWEST_ORDERS)
    standard = StandardManoeuvre("", _step_inputs)
    for share in AMPLITUDES:
        standard = StandardManoeuvre(
            f"prbs:{100 * share:.0f}%:{hold:.3g} s:{seed}",
            partial(binary_sequence_inputs, hold, share, seed),
            is_random=True,
        )
        precision = evaluator.evaluate(standard.inputs_for(evaluator))
        if not leaves_limits(task, precision) and np.isfinite(precision.relative_errors).all():
            break
    return standard


def _mid_range(actuator: Actuator) -> float:
    return 0.5 * (actuator.lower + actuator.upper)


def _is_steered(task: DesignTask) -> bool:
    return task.model.has_heading and any(a.name == RUDDER for a in task.request.actuators)


def _programmes(task: DesignTask) -> list[str]:
    """Return zigzags that the rudder's range allows, compressed ones as long as fits, the hardest turning circle."""
    (rudder,) = [a for a in task.request.actuators if a.name == RUDDER]
    most = float(np.degrees(min(rudder.upper, -rudder.lower)))
    angles = [a for a in _ZIGZAG_ANGLES if a <= most + _ROUNDING]
    texts = [f"zigzag:{a:g}/{a:g}" for a in angles]
    if most >= _ZIGZAG_ANGLES[-1] - _ROUNDING:
        texts += ["consecutive-zigzags:1", "consecutive-zigzags:2"]
    return [*texts, f"turning-circle:{most:.4g}"] if most > 0.0 else texts


def _can_be_steered(evaluator: ManoeuvreEvaluator, standard: StandardManoeuvre) -> bool:
    """Return whether no ship is lost under the helmsman."""
    try:
        standard.inputs_for(evaluator)
    except InputError:
        return False
    return True


def _steered_inputs(text: str, courses: dict[bytes, Array], evaluator: ManoeuvreEvaluator) -> Array:
    """Return each ship under the helmsman; after the last execute the rudder stays.

    courses: inputs at the sensors' rate by the ship's parameters; those that are missing are simulated and added.
    """
    task, count = evaluator.task, sample_count(evaluator.task, evaluator.dt)
    stride = round(evaluator.dt * task.request.rate)
    rows = []
    for parameters in evaluator.ships.parameters:
        if (ship := parameters.tobytes()) not in courses:
            courses[ship] = _simulate_steered(task, parameters, text)
        held = courses[ship][::stride]
        rows.append(np.concatenate([held, np.repeat(held[-1:], max(0, count - len(held)), axis=0)])[:count])
    return np.stack(rows)


def _simulate_steered(task: DesignTask, parameters: Array, text: str) -> Array:
    """Return the inputs of a ship under the helmsman at the sensors' rate, (rows, nu), until he has finished."""
    model = task.model
    ship = model.with_parameters(
        model.parameters.with_values(dict(zip(model.parameters.names, parameters, strict=True)))
    )
    (rudder,) = [a for a in task.request.actuators if a.name == RUDDER]
    other_inputs = {a.name: task.neutral_positions[a.name] for a in task.request.actuators if a.name != RUDDER}
    record = manoeuvre(
        ship,
        programme(text),
        dt=1.0 / task.request.rate,
        duration=task.request.duration,
        speed=float(task.initial_state[model.states.index("u")]) if model.has_speed else task.request.speed,
        inputs={**task.request.held, **other_inputs},
        slew_rate=rudder.rate if np.isfinite(rudder.rate) else SOLAS_SLEW_RATE,
    )
    return inputs_of(model, record)


def _sweep_inputs(evaluator: ManoeuvreEvaluator) -> Array:
    """All actuators swing between their ends, from one swing in the trial to one in four holds, evenly faster."""
    task, time = evaluator.task, evaluator.dt * np.arange(sample_count(evaluator.task, evaluator.dt))
    first, last = 1.0 / task.request.duration, 0.25 / task.shortest_hold
    return _drive_all(
        evaluator, np.sin(2.0 * np.pi * (first * time + 0.5 * (last - first) * time**2 / task.request.duration))
    )


def _step_inputs(evaluator: ManoeuvreEvaluator) -> Array:
    """Return steps from end to end, eight times."""
    time = evaluator.dt * np.arange(sample_count(evaluator.task, evaluator.dt))
    # eight steps, as said above
    return _drive_all(evaluator, np.where((8.0 * time / evaluator.task.request.duration).astype(int) % 2, 1.0, -1.0))


def _single_step_inputs(evaluator: ManoeuvreEvaluator) -> Array:
    """Return each actuator to its upper, then each to its lower end for a part of the trial, the rest in the middle."""
    count = len(evaluator.task.request.actuators)
    rows = sample_count(evaluator.task, evaluator.dt)
    step = (2 * count * np.arange(rows)) // rows
    return _drive(
        evaluator, np.where(step[:, None] % count == np.arange(count), np.where(step < count, 1.0, -1.0)[:, None], 0.0)
    )


def _drive_all(evaluator: ManoeuvreEvaluator, course: Array) -> Array:
    """Return every actuator along a course (rows,) between -1 and 1, at its own rate."""
    return _drive(evaluator, np.tile(course[:, None], (1, len(evaluator.task.request.actuators))))


def _drive(evaluator: ManoeuvreEvaluator, courses: Array) -> Array:
    """Return each actuator along its course between -1 and 1, (rows, actuators), at its own rate."""
    task, dt = evaluator.task, evaluator.dt
    inputs = np.tile(task.neutral_inputs, (len(courses), 1))
    for a, course in zip(task.request.actuators, courses.T, strict=True):
        j = task.model.input_names.index(a.name)
        free = replace(a, hold=dt)
        wanted = actuator_response(
            free, _mid_range(a) + 0.5 * (a.upper - a.lower) * course, task.neutral_positions[a.name], dt, len(course)
        )
        inputs[:, j] = -wanted if task.model.inputs[j].is_reversed else wanted
    return inputs


# The search: orders whose worst ship, measured against standard sequences, is identified best.

# the mean over ships of (error / error of the best standard sequence)^4: near the worst ship's, and smooth
MEAN_POWER = 4.0
# error over that of standard sequences that stands for a simulation that diverges, ours
DIVERGED_RATIO = 50.0
# cost of exceeding a limit by its own size, ours
LIMIT_PENALTY = 20.0
# kept from the limits during the search, so that finer steps and other ships do not cross them
LIMIT_MARGIN = 0.02
# random orders tried before the evolution strategy, ours
RANDOM_STARTS = 96
# of the evolution strategy, ours
GENERATIONS = 180
# generations without a better point after which the strategy ends: on four craft gains came after 34 at most; chosen
IDLE_GENERATIONS = 60
# best random orders whose orders are exchanged; chosen: one alone often ends in a poor optimum
EXCHANGED_STARTS = 3
# evaluations of the exchanges for each generation that follows
EXCHANGES_PER_GENERATION = 8
# the search's box: a point beyond an end means that end, so that full deflection is no corner to be hit
BOX_LOWER, BOX_UPPER, INITIAL_STEP = -1.0, 2.0, 0.1


@dataclass(frozen=True, eq=False)
class DesignObjective:
    """The smallest error (ships,) that any standard sequence gives each ship."""

    evaluator: ManoeuvreEvaluator
    baseline_errors: Array

    @classmethod
    def from_standards(cls, evaluator: ManoeuvreEvaluator, standards: list[StandardManoeuvre]) -> "DesignObjective":
        """Return the objective of the standard manoeuvres that keep within the limits, or all where none does."""
        precision = [evaluator.evaluate(r.inputs_for(evaluator)) for r in standards]
        errors = np.array([criterion_errors(evaluator.task, t) for t in precision])
        within = np.array([not leaves_limits(evaluator.task, t) for t in precision])
        chosen = errors[within] if within.any() else errors
        return cls(evaluator, np.nanmin(np.where(np.isfinite(chosen), chosen, DIVERGED_RATIO), axis=0))

    def cost(self, point: Array) -> float:
        """Return the logarithm of the power mean of the ratios, and what leaving the limits costs."""
        task = self.evaluator.task
        precision = self.evaluator.evaluate(input_series(task, orders_at(task, point), self.evaluator.dt))
        ratio = np.minimum(
            np.nan_to_num(criterion_errors(task, precision) / self.baseline_errors, nan=DIVERGED_RATIO), DIVERGED_RATIO
        )
        return float(np.log(np.mean(ratio**MEAN_POWER)) / MEAN_POWER + _limit_cost(task, precision))


def criterion_errors(task: DesignTask, information: ManoeuvreInformation) -> Array:
    """Return what the criterion looks at, for each ship; NaN for a lost one."""
    if task.request.criterion is DesignCriterion.WORST:
        return information.relative_errors.max(axis=1)
    return np.sqrt(np.mean(information.relative_errors**2, axis=1))


def search_orders(
    objective: DesignObjective, seed: int, report_progress: Callable[[str], None], generations: int = GENERATIONS
) -> tuple[Solution, bool]:
    """Random sequences, orders of the best few exchanged one by one, then an evolution strategy about the best result.

    The strategy is that of Hansen 2016, by `cmaes`; exchange finds the ends that orders go to, and leaves the rest.
    Ctrl-C gives the best so far, and True with it. The same seed gives the same bits, whatever the number of workers.
    """
    generator = np.random.default_rng(seed)
    best, value, evaluations, history = np.zeros(0), np.inf, 0, []
    interrupted = False
    try:
        points = _random_sequences(objective.evaluator.task, generator)
        costs = np.array(map_in_threads(objective.cost, points))
        starts = [ExchangedOrders(points[k], float(costs[k])) for k in np.argsort(costs)[:EXCHANGED_STARTS]]
        best, value, evaluations = starts[0].point, starts[0].cost, len(points)
        history.append(value)
        for start in starts:
            report_progress(f"search: orders exchanged one by one, {_cost_text(value)}")
            before = evaluations
            for now in coordinate_exchange(
                objective.cost, start, generator, EXCHANGES_PER_GENERATION * generations // EXCHANGED_STARTS
            ):
                best, value = min((best, value), (now.point, now.cost), key=itemgetter(1))
                evaluations = before + now.evaluations
            history.append(value)
        box = Box(np.full(len(best), BOX_LOWER), np.full(len(best), BOX_UPPER))
        # draws of a point outside the box; chosen
        settings = AdaptationSettings(iterations=generations, step=INITIAL_STEP / (BOX_UPPER - BOX_LOWER), resampling=5)
        strategy = CovarianceAdaptation(box, generator, settings, best)
        idle = 0
        while not strategy.done and idle < IDLE_GENERATIONS:
            asked = strategy.ask()
            strategy.tell(np.array(map_in_threads(objective.cost, list(asked))))
            evaluations += len(asked)
            point, cost = strategy.best
            idle = 0 if cost < value else idle + 1
            if cost < value:
                best, value = point, cost
            history.append(value)
            if len(history) % 10 == 0:
                report_progress(f"search: {len(history)} of {generations} generations, {_cost_text(value)}")
    except KeyboardInterrupt:
        if not len(best):
            raise
        interrupted = True
    status = Status.EXHAUSTED
    return Solution(best, value, status, evaluations, tuple(history), seed), interrupted


def _cost_text(value: float) -> str:
    """Return a cost in words."""
    return (
        f"error {np.exp(value):.3f} of the standard"
        if value < np.log(DIVERGED_RATIO)
        else "the limits are not kept yet"
    )


def _limit_cost(task: DesignTask, information: ManoeuvreInformation) -> float:
    """Return what it costs that ships which the limits bind leave them."""
    over = limit_excess(task, information, LIMIT_MARGIN)
    return LIMIT_PENALTY * float(over.max() if task.request.limits.for_every_ship else over[0])


def _random_sequences(task: DesignTask, generator: np.random.Generator) -> list[Array]:
    """Return sequences that jump between two ends, of several switching times and amplitudes."""
    points = []
    for _ in range(RANDOM_STARTS):
        pieces = []
        for count in order_counts(task):
            times = int(generator.integers(1, 4))
            signs = np.repeat(generator.choice([-1.0, 1.0], size=count // times + 1), times)[:count]
            # amplitudes up to 0.45 about the middle of the range; chosen
            pieces.append(0.5 + 0.45 * generator.choice([0.25, 0.5, 0.75, 1.0]) * signs)
        points.append(np.concatenate(pieces))
    return points


def at_sensor_rate(evaluator: ManoeuvreEvaluator) -> ManoeuvreEvaluator:
    """Return the same ships at the sensors' rate."""
    return replace(evaluator, dt=1.0 / evaluator.task.request.rate)


# The step of the search: as coarse as leaves the errors of a random binary sequence what they are.

# steps in the shortest hold at least; chosen
_STEPS_PER_HOLD = 4
# largest relative change of a ship's worst error that a coarser step may make; chosen
_TOLERANCE = 0.05
# ships that this is tried on, the model itself first; chosen
_SHIPS_TRIED = 7
# share of its range that the sequence moves each actuator by: all, where motions are quickest
_AMPLITUDE = 1.0


def search_step(task: DesignTask, ships: PriorShips) -> float:
    """Return the step [s], a whole number of samples that divides every hold; the sensors' own where none is good.

    Steps that divide no hold are none: orders that change between steps put the errors off.
    """
    few = PriorShips(ships.parameters[:_SHIPS_TRIED], ships.precision)
    fine = ManoeuvreEvaluator(task, few, 1.0 / task.request.rate)
    right = _worst_errors(fine)
    kept = np.isfinite(right)
    for samples in _dividing_counts(task):
        coarse = replace(fine, dt=samples / task.request.rate)
        if np.all(np.abs(_worst_errors(coarse) - right)[kept] <= _TOLERANCE * right[kept]):
            return coarse.dt
    return fine.dt


def _dividing_counts(task: DesignTask) -> Iterator[int]:
    """Yield the counts of samples that divide the trial and every hold, largest first."""
    request = task.request
    spans = [request.rate * s for s in (request.duration, *(a.hold for a in request.actuators))]
    for count in range(int(request.rate * task.shortest_hold / _STEPS_PER_HOLD + _ROUNDING), 1, -1):
        if all(abs(span - count * round(span / count)) < _ROUNDING for span in spans):
            yield count


def _worst_errors(evaluator: ManoeuvreEvaluator) -> Array:
    """Return the worst coefficient's relative standard error of each ship; NaN for a lost one."""
    inputs = binary_sequence_inputs(evaluator.task.shortest_hold, _AMPLITUDE, 0, evaluator)
    return evaluator.evaluate(inputs).relative_errors.max(axis=1)
