"""What a search for a manoeuvre is given: model, sensors, time, what may be moved and how far; tested first."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Actuator, TrialLimits
from seatrial.core.values import Array, InputError, Ship, spelling_hint
from seatrial.physics.simulate.approach import approach_speed, held_inputs

_FEWEST_ORDERS = 4


class DesignCriterion(StrEnum):
    """Which relative standard error is made small: of the least well told coefficient, or their root mean square."""

    WORST = "worst"
    MEAN = "mean"


@dataclass(frozen=True, eq=False)
class DesignTask:
    """A manoeuvre to be designed; SI, angles in the record's signs.

    Attributes:
        sensors: observable -> standard deviation of its noise; rate: Hz at which they are recorded.
        held: inputs that stay constant; absent wind, waves and fins are at rest.
        speed: approach speed u [m/s]; None: where surge balances.
        draws: ships drawn from the prior, besides the model; relative_spread: they differ by up to this share in
            every free coefficient that has no prior of its own.
        covariance: of the free coefficients where the model comes from a fit; then the ships are drawn from it.

    Raises:
        InputError: an input, observable or limit that cannot be.
    """

    question: str
    ship: Ship
    model: Model
    sensors: Mapping[str, float]
    rate: float
    duration: float
    actuators: tuple[Actuator, ...]
    limits: TrialLimits = field(default_factory=TrialLimits)
    held: Mapping[str, float] = field(default_factory=dict)
    speed: float | None = None
    criterion: DesignCriterion = DesignCriterion.WORST
    draws: int = 24
    relative_spread: float = 0.3
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
        if not self.actuators:
            raise InputError("a design needs an input that may be moved: give [design.inputs]")
        for actuator in self.actuators:
            _demand_movable(actuator, self.model, self.duration)
        if not self.model.parameters.free:
            raise InputError(f"model '{self.model.name}' has no free coefficient to design for")

    @property
    def neutral_positions(self) -> dict[str, float]:
        """Where every actuator stands before the first order: at zero, else in the middle of its range."""
        return {a.name: 0.0 if a.lower <= 0.0 <= a.upper else 0.5 * (a.lower + a.upper) for a in self.actuators}

    @property
    def neutral_inputs(self) -> Array:
        """All inputs before the first order, in the model's signs, shape (nu,)."""
        first = self.actuators[0].name
        others = {n: v for n, v in self.neutral_positions.items() if n != first}
        values = held_inputs(self.model, {**self.held, **others}, first)
        place = self.model.input_names.index(first)
        values[place] = self.neutral_positions[first] * (-1.0 if self.model.inputs[place].is_reversed else 1.0)
        return values

    @property
    def initial_state(self) -> Array:
        """The state before the first order, shape (nx,): a straight course, or rest for a model without surge.

        Raises:
            InputError: no speed was given and none balances surge.
        """
        state = np.zeros(len(self.model.states))
        if "u" in self.model.states:
            speed = approach_speed(self.model, self.neutral_inputs) if self.speed is None else self.speed
            state[self.model.states.index("u")] = speed
        return state

    @property
    def shortest_hold(self) -> float:
        """The shortest time between two orders of any actuator [s]."""
        return min(a.hold for a in self.actuators)


def _demand_movable(actuator: Actuator, model: Model, duration: float) -> None:
    name = f"design input '{actuator.name}'"
    if actuator.name not in model.input_names:
        known = list(model.input_names)
        raise InputError(f"{name} is no input of model '{model.name}'{spelling_hint(actuator.name, known)}")
    if not (math.isfinite(actuator.lower) and math.isfinite(actuator.upper) and actuator.lower < actuator.upper):
        raise InputError(f"{name} cannot move from {actuator.lower:g} to {actuator.upper:g}; give a range, lower first")
    if not actuator.rate > 0.0:
        raise InputError(f"{name} cannot move at a rate of {actuator.rate:g}; give a positive one, or leave it out")
    if not actuator.hold > 0.0 or duration < _FEWEST_ORDERS * actuator.hold:
        raise InputError(
            f"{name} is held for {actuator.hold:g} s at least, so that {duration:g} s leave no room for "
            f"{_FEWEST_ORDERS} orders; shorten the hold or lengthen the trial"
        )
    if actuator.rate * duration < actuator.upper - actuator.lower:
        raise InputError(
            f"{name} does not cross its range within the trial of {duration:g} s; narrow the range or raise the rate"
        )
