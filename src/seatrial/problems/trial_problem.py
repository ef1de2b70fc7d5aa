"""Draws of trials whose truth is known: output error over whole runs as fitness, its initial states held."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record, Ship
from seatrial.data.trial import EstimateSettings, Trial, TrialRun
from seatrial.estimation.problem import OutputError, cut_segments
from seatrial.numerics.optimise import Box, NormalEquations
from seatrial.problems.boxes import standard_errors_within, start_within
from seatrial.problems.problem import ProblemDraw
from seatrial.problems.yardstick import KnownTruth

_NO_LOCAL = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class HeldInitialStates:
    """Output error with its initial states held.

    Attributes:
        states: of each run, those that the problem would estimate, (runs, m).
    """

    problem: OutputError
    states: Array
    lower: Array
    upper: Array

    def cost(self, shared: Array, local: Array = _NO_LOCAL) -> float:  # noqa: ARG002  # nothing is local
        """Return half the sum of squared residuals in standard deviations; infinite after a divergence."""
        return self.problem.cost(shared, self.states)

    def normal(self, shared: Array, local: Array = _NO_LOCAL) -> NormalEquations:  # noqa: ARG002  # nothing is local
        """Return cost, gradient and Gauss-Newton Hessian of the coefficients."""
        normal = self.problem.normal(shared, self.states)
        return NormalEquations(normal.cost, normal.gradient, normal.hessian, _NO_LOCAL, _NO_LOCAL, _NO_LOCAL)


@dataclass(frozen=True, eq=False)
class KnownCraft:
    """A craft whose coefficients are known, and its records.

    Attributes:
        model: the true one, its free coefficients the unknowns.
        records: with noise; noise: channel -> standard deviation, SI.
        initial_state: state -> value at the start of every run, known to the methods.
        disturbance_bound: bound of the standard errors (d,) where more than sensor noise limits them.
    """

    ship: Ship
    model: Model
    records: Sequence[Record]
    noise: Mapping[str, float]
    initial_state: Mapping[str, float]
    settings: EstimateSettings = field(default_factory=EstimateSettings)
    disturbance_bound: Array | None = None


def craft_draw(craft: KnownCraft, box: Box, start: Array) -> ProblemDraw:
    """Return the draw of a craft: bounds, start values (d,), truth and Cramer-Rao bound."""
    names = craft.model.parameters.free_names
    truth = np.array([craft.model.parameters[name].value for name in names])
    problem = _output_error(craft)
    states = np.tile([craft.initial_state.get(s, 0.0) for s in problem.starts], (len(craft.records), 1))
    held = HeldInitialStates(problem, states.astype(np.float64), box.lower, box.upper)
    bound = craft.disturbance_bound
    if bound is None:
        bound = standard_errors_within(held.normal(truth).hessian, box)

    def fitness(points: Array, _: int) -> Array:
        return np.array([held.cost(point) for point in points])

    trial = Trial(
        craft.ship, tuple(map(TrialRun, craft.records)), start_within(craft.model, names, start, box),
        craft.settings.with_known_timing(craft.model.input_names), dict(craft.noise),
    )  # fmt: skip
    units = tuple(craft.model.parameters[name].unit for name in names)
    return ProblemDraw(names, units, box, fitness, KnownTruth(truth, bound), start, held, trial)


def _output_error(craft: KnownCraft) -> OutputError:
    """Whole runs, channels weighted by their noise."""
    outputs = tuple(name for name in craft.noise if name in craft.model.observables)
    data = cut_segments(craft.model, list(craft.records), outputs, None)
    return OutputError(craft.model, data, np.array([craft.noise[name] for name in outputs]), workers=1)
