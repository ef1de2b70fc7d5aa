"""Draws of trials whose truth is known, and folds of measured trials that are left out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Parameter, Record, Ship
from seatrial.data.trial import EstimateSettings, Role, Run, Trial, TrialRecord
from seatrial.estimation.estimate.assemble import Runs, output_error_problem
from seatrial.estimation.estimate.fit import with_segment_seconds
from seatrial.estimation.information.covariance import from_information
from seatrial.estimation.predict import HoldoutProtocol, split_windows, window_errors
from seatrial.estimation.predict.open_loop import rms_errors
from seatrial.estimation.predict.window_scores import constant_course
from seatrial.estimation.problem import OutputError, cut_segments
from seatrial.numerics.optimise import Box, NormalEquations
from seatrial.problems.problem import KnownTruth, Placement, ProblemDraw

# Boxes about a truth, and truths near published values.

# least and largest share of a box's width between its lower bound and the truth; chosen
_LOWEST_PLACE, _HIGHEST_PLACE = 0.2, 0.8
# variance of a uniform distribution over the square of its width
_UNIFORM_VARIANCE = 1.0 / 12.0


def centred_box(truth: Array, half_width: float) -> Box:
    """Return the box of the truth +- a share of it: the truth in the middle."""
    ends = np.stack([truth * (1.0 - half_width), truth * (1.0 + half_width)])
    return Box(ends.min(axis=0), ends.max(axis=0))


def off_centre_box(truth: Array, half_width: float, rng: np.random.Generator) -> Box:
    """As wide, the truth anywhere between a fifth and four fifths of it."""
    below = 2.0 * half_width * rng.uniform(_LOWEST_PLACE, _HIGHEST_PLACE, len(truth))
    ends = np.stack([truth * (1.0 - below), truth * (1.0 + 2.0 * half_width - below)])
    return Box(ends.min(axis=0), ends.max(axis=0))


def scaled_values(published: Array, half_range: float, rng: np.random.Generator) -> Array:
    """Return values each scaled by a factor of its own within 1 +- half_range, (d,)."""
    return published * rng.uniform(1.0 - half_range, 1.0 + half_range, len(published))


def placed_model(model: Model, placement: Placement, half_range: float, rng: np.random.Generator) -> Model:
    """Return the model with its free coefficients as published, or each scaled within 1 +- half_range."""
    if placement is not Placement.SHIFTED:
        return model
    values = scaled_values(free_values(model), half_range, rng)
    return model.with_values(dict(zip(model.parameters.free_names, values.tolist(), strict=True)))


def free_values(model: Model) -> Array:
    """Return the values of the free coefficients, (d,)."""
    return np.array([model.parameters[name].value for name in model.parameters.free_names])


def standard_errors_within(information: Array, box: Box) -> Array:
    """Return the Cramer-Rao bound of the standard errors (d,) where the box counts as what was known before.

    Van Trees 1968, Detection, Estimation, and Modulation Theory I, section 2.4 (random parameters), the uniform
    distribution over the box taken as the normal one of its variance. Records that say less than the box would
    otherwise have a bound beyond it, which any answer inside the box meets.
    """
    return from_information(information + np.diag(1.0 / (_UNIFORM_VARIANCE * box.width**2))).standard_error


def start_within(model: Model, names: Sequence[str], start: Array, box: Box) -> Model:
    """Return a model whose unknowns have the bounds of a box, and the values nearest to a start (d,) in it."""
    values = np.clip(start, box.lower, box.upper)
    parameters = model.with_values(dict(zip(names, values.tolist(), strict=True))).parameters
    for name, lower, upper in zip(names, box.lower.tolist(), box.upper.tolist(), strict=True):
        parameters = parameters.bounded(name, lower, upper)
    return model.with_parameters(parameters)


# Draws of trials whose truth is known: output error over whole runs as fitness, its initial states held.

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
        initial_states: state -> value at the start of each run, known to the methods.
        disturbance_bound: bound of the standard errors (d,) where more than sensor noise limits them.
    """

    ship: Ship
    model: Model
    records: Sequence[Record]
    noise: Mapping[str, float]
    initial_states: Sequence[Mapping[str, float]]
    settings: EstimateSettings = field(default_factory=EstimateSettings)
    disturbance_bound: Array | None = None


def craft_draw(craft: KnownCraft, box: Box, start: Array) -> ProblemDraw:
    """Return the draw of a craft: bounds, start values (d,), truth and Cramer-Rao bound."""
    names = craft.model.parameters.free_names
    truth = np.array([craft.model.parameters[name].value for name in names])
    problem = _output_error(craft)
    states = np.array([[start.get(s, 0.0) for s in problem.starts] for start in craft.initial_states], dtype=np.float64)
    held = HeldInitialStates(problem, states, box.lower, box.upper)
    bound = craft.disturbance_bound
    if bound is None:
        bound = standard_errors_within(held.normal(truth).hessian, box)

    def fitness(points: Array, _: int) -> Array:
        return np.array([held.cost(point) for point in points])

    trial = Trial(
        craft.ship, tuple(map(Run, craft.records)), start_within(craft.model, names, start, box),
        craft.settings.with_known_timing(craft.model.input_names), dict(craft.noise),
    )  # fmt: skip
    units = tuple(craft.model.parameters[name].unit for name in names)
    return ProblemDraw(names, units, box, fitness, KnownTruth(truth, bound), start, held, trial)


def _output_error(craft: KnownCraft) -> OutputError:
    """Whole runs, channels weighted by their noise."""
    outputs = tuple(name for name in craft.noise if name in craft.model.observables)
    data = cut_segments(craft.model, list(craft.records), outputs, None)
    return OutputError(craft.model, data, np.array([craft.noise[name] for name in outputs]), workers=1)


# Folds of measured trials: a session is left out, and answers are judged by windows of it, predicted open loop.

PRIOR_WIDTHS = 4.0
"""Half width of the box of a coefficient with a prior, in the prior's standard deviations; chosen."""
SCALES = 2.0
"""The same without prior and bounds, in sizes of the coefficient; chosen: signs are not known."""
SUCCESS = 0.5
"""Error of a success, in those of constant course and speed; chosen."""


@dataclass(frozen=True, eq=False)
class HoldoutWindows:
    """Windows of runs that no method has seen.

    Attributes:
        template: the problem whose free coefficients are judged, without offsets; its noise weighs initial states.
        baseline: mean rms error of constant course and speed over the same windows, [position m, heading deg].
    """

    template: OutputError
    records: Sequence[Record]
    protocol: HoldoutProtocol
    baseline: Array
    truth: None = None
    bound: None = None

    @property
    def unit(self) -> str:
        """What an error of 1 is."""
        seconds = f"{self.protocol.window_s:g} s"
        return f"that of constant course and speed over windows of {seconds} left out, rms of position and heading"

    @property
    def success_limit(self) -> float:
        """Half the error of constant course and speed."""
        return SUCCESS

    def error(self, values: Array) -> float:
        """Return the rms over position and heading of mean errors over the baseline's, infinite after a divergence."""
        model = self.template.model.with_values(dict(zip(self.template.free, values.tolist(), strict=True)))
        nothing = [np.empty(0)] * len(self.records)
        labels = [record.name for record in self.records]
        try:
            windows = window_errors(self.template, model, self.records, nothing, labels, self.protocol)
        except InputError:
            return np.inf
        mean = np.mean([(w.position_m, w.heading_deg) for w in windows], axis=0)
        return float(np.sqrt(np.mean((mean / self.baseline) ** 2)))


def fold_draw(
    trial: Trial, items: Sequence[TrialRecord], protocol: HoldoutProtocol, rng: np.random.Generator
) -> ProblemDraw:  # fmt: skip
    """Return the draw that leaves out one session, which `rng` chooses.

    Args:
        items: the records of the trial at the rate of its estimate; whatever their roles, all train but the session.
    """
    long_enough = [item.session for item in items if split_windows(item.record, protocol)]
    sessions = list(dict.fromkeys(long_enough))
    left_out = sessions[int(rng.integers(len(sessions)))]
    train = [item for item in items if item.session != left_out]
    held = [item.record for item in items if item.session == left_out and split_windows(item.record, protocol)]
    names = trial.model.parameters.free_names
    box = _box([trial.model.parameters[name] for name in names])
    start = np.array([trial.model.parameters[name].value for name in names])
    model = start_within(trial.model, names, start, box)
    problem = _coefficients_alone(trial, model, train)
    fitted = HeldInitialStates(problem, problem.measured_initial_states(), box.lower, box.upper)

    def fitness(points: Array, _: int) -> Array:
        return np.array([fitted.cost(point) for point in points])

    runs = tuple(Run(item.record, Role.TRAIN, item.session) for item in train)
    units = tuple(model.parameters[name].unit for name in names)
    yardstick = HoldoutWindows(problem, held, protocol, _baseline(held, protocol))
    return ProblemDraw(
        names, units, box, fitness, yardstick, np.clip(start, box.lower, box.upper), fitted,
        replace(trial, runs=runs, model=model, path=None),
    )  # fmt: skip


def _coefficients_alone(trial: Trial, model: Model, train: Sequence[TrialRecord]) -> OutputError:
    """Return output error over segments from measured states, channels weighted by their spread, without offsets."""
    sessions = tuple(item.session for item in train)
    runs = Runs(tuple(item.record for item in train), sessions, trial.ship.length, forces=trial.forces)
    plain = EstimateSettings(
        segment_s=trial.estimate.segment_s, segment_lengths=trial.estimate.segment_lengths,
        channels=trial.estimate.channels,
    ).with_known_timing(model.input_names)  # fmt: skip  # coefficients alone: nothing that sessions have of their own
    seconds = with_segment_seconds(plain, model, runs).segment_s or np.inf
    return output_error_problem(model, runs, seconds, plain, workers=1)


def _box(parameters: Sequence[Parameter]) -> Box:
    """Bounds where a coefficient has them, else by its prior, else by its size."""
    middle = np.array([p.value if p.prior is None else p.prior.mean for p in parameters])
    half = np.array([
        SCALES * p.characteristic_scale if p.prior is None else PRIOR_WIDTHS * p.prior.standard_deviation
        for p in parameters
    ])  # fmt: skip
    lower, upper = np.array([(p.lower, p.upper) for p in parameters]).T
    return Box(np.maximum(lower, middle - half), np.minimum(upper, middle + half))


def _baseline(held: Sequence[Record], protocol: HoldoutProtocol) -> Array:
    """Return mean rms errors of constant course and speed, [position m, heading deg]."""
    pieces = [piece for record in held for piece in split_windows(record, protocol)]
    errors = [rms_errors(piece, constant_course(piece, protocol.initial_s)) for piece in pieces]
    means = [np.mean([e[name] for e in errors if name in e]) for name in ("position_m", "psi_deg")]
    return np.array(means, dtype=np.float64)
