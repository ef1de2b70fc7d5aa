"""What a search for a manoeuvre is given: model, sensors, time, what may be moved and how far; tested first."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from seatrial.core.equations import Model
from seatrial.core.results import Actuator
from seatrial.core.values import Array, InputError, Ship, spelling_hint
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.trial import Trial
from seatrial.data.trial.design_request import DesignRequest
from seatrial.estimation.design.from_records import recorded_request
from seatrial.physics.simulate.states import approach_speed, held_inputs, settled_actuators

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
        if self.model.equations.layout and math.isfinite(self.request.limits.drift):
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
        if "u" in self.model.states:
            state[self.model.states.index("u")] = self._initial_speed
        return state

    @property
    def _initial_speed(self) -> float:
        """As required, else that at which surge balances; craft with thrusters start at rest."""
        if self.request.speed is not None:
            return self.request.speed
        return 0.0 if self.model.equations.layout else approach_speed(self.model, self.neutral_inputs)

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
