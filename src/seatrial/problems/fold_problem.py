"""Folds of measured trials: a session is left out, and answers are judged by windows of it, predicted open loop.

Nobody knows the true coefficients of a real craft, so the measure is an error that no method has seen. It is that of
the coefficients alone: offsets that a session has of its own count as zero for all methods alike.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Parameter, Record
from seatrial.data.trial import EstimateSettings, Role, Trial, TrialRecord, TrialRun
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.estimation.estimate.fit import with_segment_seconds
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.predict import HoldoutProtocol, split_windows, window_errors
from seatrial.estimation.predict.open_loop import rms_errors
from seatrial.estimation.predict.window_baselines import constant_course
from seatrial.estimation.problem import OutputError
from seatrial.numerics.optimise import Box
from seatrial.problems.boxes import start_within
from seatrial.problems.problem import ProblemDraw
from seatrial.problems.trial_problem import HeldInitialStates

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

    runs = tuple(TrialRun(item.record, Role.TRAIN, item.session) for item in train)
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
