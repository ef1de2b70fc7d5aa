"""What a search for a manoeuvre is given: model, sensors, time, what may be moved and how far; ships of the prior."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Actuator
from seatrial.core.values import Array, InputError, Record, Ship, spelling_hint
from seatrial.data.check.motion import sample_noise
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.trial import Trial, load_records
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.data.trial.trial import Role
from seatrial.physics.simulate.states import approach_speed, held_inputs, settled_actuators

# A manoeuvre designed like the recorded ones: as long, with orders as large and as quick, by the same sensors.

# percentiles of an input that are its range and of its steps that are its rate; fewest orders of a run; chosen
_REACH, _FASTEST, _ORDERS = 99.0, 99.0, 20
_SLOWEST_RATE = 1.0  # Hz at which a design is sampled at most: standard errors go with the square root; chosen


def recorded_request(trial: Trial) -> tuple[DesignRequest, dict[str, float]]:
    """Return the request for a manoeuvre like the training runs, and the noise of their sensors [SI] by observable.

    As long as the longest run; an input that moves may be ordered as far and as fast as it was, a twentieth of the run
    apart; the others are held at their median.

    Raises:
        InputError: the trial has no training run, or no input moves in one.
    """
    records = [one.record for one in load_records(trial)[0] if one.role is Role.TRAIN] if trial.runs else []
    if not records:
        raise InputError("there is no table [design]; add it with duration, rate and [design.inputs]")
    longest = max(records, key=lambda record: record.duration)
    names = [name for name in trial.model.input_names if all(name in record for record in records)]
    hold = longest.duration / _ORDERS
    ranges = {name: _range(records, name, hold) for name in names}
    moved = {name: one for name, one in ranges.items() if one is not None}
    if not moved:
        raise InputError(f"no input moves in the training runs; {_without_inputs(trial.model)}")
    held = {name: float(np.median(longest[name])) for name in names if name not in moved}
    request = DesignRequest(
        duration=longest.duration, rate=min(_SLOWEST_RATE, 1.0 / longest.dt), inputs=moved, held=held
    )
    return request, _sensors(trial.model, records)


def _without_inputs(model: Model) -> str:
    """Return what can be done where no run shows how an input moves."""
    if "phi" in model.states and not model.has_course:
        return "orders cannot be designed for releases: record more of them, from larger angles, or with fins moving"
    return "add a table [design] with [design.inputs]"


def _range(records: Sequence[Record], name: str, hold: float) -> InputRange | None:
    """How far an input went to both sides, SI; None where it hardly moves."""
    values = np.concatenate([record[name] for record in records])
    low, high = (float(one) for one in np.percentile(values, [100.0 - _REACH, _REACH]))
    if high - low <= 0.1 * max(abs(low), abs(high)):  # of its size: it is steady; chosen
        return None
    steps = np.concatenate([np.abs(np.diff(record[name])) / record.dt for record in records])
    rate = float(np.percentile(steps, _FASTEST))
    unit = records[0].channel(name).unit
    return InputRange(lower=low, upper=high, unit=unit, rate=rate or None, hold=hold)


def _sensors(model: Model, records: Sequence[Record]) -> dict[str, float]:
    levels: Mapping[str, Array] = {
        name: np.array([sample_noise(record[name]) for record in records if name in record])
        for name in model.observables
    }
    return {name: float(np.median(one)) for name, one in levels.items() if one.size and np.median(one) > 0.0}


# What a search for a manoeuvre is given: model, sensors, time, what may be moved and how far; tested first.

# orders of an actuator that a trial must have room for, ours
FEWEST_ORDERS = 4


@dataclass(frozen=True, eq=False)
class DesignTask:
    """A manoeuvre to be designed; SI, angles in the record's signs.

    Attributes:
        sensors: observable -> standard deviation of its noise, SI.
        request: what may be moved, for how long and within which limits.
        covariance: of the free coefficients where the model comes from a fit; then the ships are drawn from it.
    """

    question: str
    ship: Ship
    model: Model
    sensors: Mapping[str, float]
    request: DesignRequest
    covariance: Array | None = None

    def __post_init__(self) -> None:
        if not self.sensors:
            raise InputError("a design needs its sensors' noise: give [noise] with the standard deviation of a channel")
        for name in self.sensors:
            if name not in self.model.observables:
                known = [*self.model.observables]
                raise InputError(
                    f"[noise] {name} is nothing that model '{self.model.name}' shows{spelling_hint(name, known)}"
                )
        if self.model.has_thrusters and math.isfinite(self.request.limits.drift):
            raise InputError(
                "[design] drift means nothing for a craft that turns on the spot and goes astern; remove it, and limit "
                "sea_room"
            )
        for actuator in self.request.actuators:
            _demand_movable(actuator, self.model, self.request.duration)
        if not self.model.parameters.free:
            raise InputError(f"model '{self.model.name}' has no free coefficient to design for")

    @property
    def neutral_positions(self) -> dict[str, float]:
        """Where every actuator stands before the first order: at zero, else in the middle of its range."""
        return {a.name: 0.0 if a.lower <= 0.0 <= a.upper else 0.5 * (a.lower + a.upper) for a in self.request.actuators}

    @property
    def neutral_inputs(self) -> Array:
        """All inputs before the first order, in the model's signs, shape (nu,)."""
        first = self.request.actuators[0].name
        others = {n: v for n, v in self.neutral_positions.items() if n != first}
        values = held_inputs(self.model, {**self.request.held, **others}, first)
        place = self.model.input_names.index(first)
        values[place] = self.neutral_positions[first] * (-1.0 if self.model.inputs[place].is_reversed else 1.0)
        return values

    @property
    def initial_state(self) -> Array:
        """The state before the first order, shape (nx,): a straight course; rest without surge, or with thrusters."""
        state = settled_actuators(self.model, self.neutral_inputs)
        if self.model.has_speed:
            state[self.model.states.index("u")] = self._initial_speed
        return state

    @property
    def _initial_speed(self) -> float:
        """As required, else that at which surge balances; craft with thrusters start at rest."""
        if self.request.speed is not None:
            return self.request.speed
        return 0.0 if self.model.has_thrusters else approach_speed(self.model, self.neutral_inputs)

    @property
    def shortest_hold(self) -> float:
        """The shortest time between two orders of any actuator [s]."""
        return min(a.hold for a in self.request.actuators)


def _demand_movable(actuator: Actuator, model: Model, duration: float) -> None:
    name = f"design input '{actuator.name}'"
    if actuator.name not in model.input_names:
        known = list(model.input_names)
        raise InputError(f"{name} is no input of model '{model.name}'{spelling_hint(actuator.name, known)}")
    if duration < FEWEST_ORDERS * actuator.hold:
        raise InputError(
            f"{name} is held for {actuator.hold:g} s at least, so that {duration:g} s leave no room for "
            f"{FEWEST_ORDERS} orders; shorten the hold or lengthen the trial"
        )
    if actuator.rate * duration < actuator.upper - actuator.lower:
        raise InputError(
            f"{name} does not cross its range within the trial of {duration:g} s; narrow the range or raise the rate"
        )


def design_task(trial: Trial, model_file: ModelFile | None = None) -> DesignTask:
    """Return the task that the trial describes.

    Args:
        trial: without a table [design] the manoeuvre is like the recorded ones.
        model_file: its values, freedom and covariance take the place of the trial's.
    """
    where = f"{trial.path}: " if trial.path else ""
    try:
        request, sensors = trial.design_request, trial.noise
        if request is None:
            request, recorded = recorded_request(trial)
            sensors = {**recorded, **sensors}
        model = trial.model if model_file is None else _demand_same_equations(model_file.model, trial.model)
        _demand_sizes(model)
        task = DesignTask(
            question=trial.question,
            ship=trial.ship,
            model=model,
            sensors=sensors,
            request=request,
            covariance=model_file.covariance if model_file is not None and model_file.covariance.size else None,
        )
        _ = task.initial_state
    except InputError as error:
        raise InputError(f"{where}{error}") from None
    return task


def _demand_same_equations(file_model: Model, model: Model) -> Model:
    if file_model.equation_hash != model.equation_hash:
        raise InputError(
            f"the model file holds the equations '{file_model.name}', the trial '{model.name}'; "
            "name the same model under [model]"
        )
    return file_model


def _demand_sizes(model: Model) -> None:
    for p in model.parameters.free:
        if p.value == 0.0 and p.scale == 0.0:
            raise InputError(
                f"coefficient '{p.name}' is zero, so that nothing can be relative to it; "
                "give it a likely value under [model.start], or leave it out of model.free"
            )


# Ships that the prior allows: the model itself first, then draws that cover what it may be wrong by.

# ships drawn lie within so many standard deviations, ours
_MAX_DEVIATES = 2.0
# share of the assumed value that stands for that of a drawn ship nearer to zero, ours
_NEAR_ZERO = 1e-3


@dataclass(frozen=True, eq=False)
class PriorShips:
    """Parameters (n, np) of every ship, the model's own first; precision (k,) of the free coefficients' priors."""

    parameters: Array
    precision: Array

    @property
    def count(self) -> int:
        """How many ships there are."""
        return len(self.parameters)


def draw_ships(task: DesignTask, seed: int, draws: int | None = None) -> PriorShips:
    """The model and `draws` ships about it (default: the task's), spread evenly (Latin hypercube; McKay et al. 1979).

    A coefficient without a prior differs by up to the task's spread of its characteristic scale, evenly; one with a
    Gaussian prior, or all where a fit gives their covariance, by normal deviates of up to two standard deviations.
    Bounds are kept.
    """
    parameters = task.model.parameters
    free = parameters.free
    count = task.request.draws if draws is None else draws
    unit = _latin_hypercube(count, len(free), np.random.default_rng(seed))
    drawn = np.tile(parameters.values, (count + 1, 1))
    if count:
        values = np.clip(_prior_values(task, unit), [p.lower for p in free], [p.upper for p in free])
        drawn[1:, [parameters.index(p.name) for p in free]] = values
    precision = np.array([0.0 if p.prior is None else p.prior.standard_deviation**-2 for p in free])
    return PriorShips(drawn, precision)


def coefficient_magnitudes(task: DesignTask, parameters: Array) -> Array:
    """Return what errors of each ship's free coefficients are relative to, (ships, k); parameters (ships, np).

    The magnitude of the coefficient; its standard deviation in the model file where that is larger; the size that its
    model gives where it is assumed zero.
    """
    free = task.model.parameters.free
    values = np.abs(parameters[:, [task.model.parameters.index(p.name) for p in free]])
    deviations = np.zeros(len(free)) if task.covariance is None else np.sqrt(np.diag(task.covariance))
    least = np.maximum(deviations, [_NEAR_ZERO * abs(p.value) for p in free])
    return np.maximum(values, np.where(least > 0.0, least, [p.characteristic_scale for p in free]))


def relative_spread(task: DesignTask) -> Array:
    """Return how far ships differ in each free coefficient, as a share of its magnitude, shape (k,)."""
    assumed = np.array(
        [
            task.request.relative_spread * p.characteristic_scale if p.prior is None else p.prior.standard_deviation
            for p in task.model.parameters.free
        ]
    )
    deviations = assumed if task.covariance is None else np.sqrt(np.diag(task.covariance))
    return deviations / coefficient_magnitudes(task, task.model.parameters.values[None])[0]


def _latin_hypercube(count: int, size: int, generator: np.random.Generator) -> Array:
    """Return one point in every `count`-th part of each side of the unit cube, (count, size)."""
    parts = np.array([generator.permutation(count) for _ in range(size)]).T
    return (parts + generator.random((count, size))) / max(count, 1)


def _prior_values(task: DesignTask, unit: Array) -> Array:
    free = task.model.parameters.free
    values = np.array([p.value for p in free])
    normal = np.clip(_normal_deviates(unit), -_MAX_DEVIATES, _MAX_DEVIATES)
    if task.covariance is not None:
        roots, vectors = np.linalg.eigh(task.covariance)
        return values + normal @ (vectors * np.sqrt(np.maximum(roots, 0.0))).T
    even = (2.0 * unit - 1.0) * task.request.relative_spread
    scale = np.array([p.characteristic_scale for p in free])
    own = [p.prior is not None for p in free]
    deviation = np.array([0.0 if p.prior is None else p.prior.standard_deviation for p in free])
    return values + np.where(own, normal * deviation, even * scale)


def _normal_deviates(unit: Array) -> Array:
    from scipy.special import ndtri

    return ndtri(np.clip(unit, 1e-9, 1.0 - 1e-9))  # within 6 standard deviations; chosen
