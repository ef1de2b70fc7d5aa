"""Which criterion the records call for, from an estimate over segments onwards, judged on parts left out."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, Index, ProgressReporter
from seatrial.data.trial import EstimateSettings, FitCriterion
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.disturbance_choice import ALIKE, DisturbanceChoice, choose_disturbance, likeliest
from seatrial.estimation.estimate.disturbance_tests import HINT, spectral_hint
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE, with_whole_run_intensity
from seatrial.estimation.estimate.newton_refinement import refine_by_newton, step_within
from seatrial.estimation.estimate.plausibility import is_lost, own_starts, with_input_offsets, with_plausible_start
from seatrial.estimation.estimate.point_estimate import (
    PointEstimate,
    filter_with_steps,
    fit_output_error,
    residual_correlation,
    residual_spread,
    rounding_level,
    sufficient_steps_of_filter,
)
from seatrial.estimation.estimate.process_noise import (
    ProcessNoise,
    fit_prediction_error,
    has_noise,
    implied_intensities,
    implied_process_noise,
)
from seatrial.estimation.estimate.settings import WHITE_INFLATION
from seatrial.estimation.information.whiteness import WhitenessTest, is_no_worse, whiteness_test
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import Segments, segments_between
from seatrial.numerics.optimise import levenberg_marquardt

# How far off a criterion's estimate is on what it did not see: training runs, or quarters of few, left out in turn.

_QUARTERS = 4  # parts of each run that are left out in turn where runs are few; chosen
_MOST_GROUPS = 8  # groups of whole runs that are left out in turn, at most; chosen
_FEWEST_ROWS = 8  # rows of the shortest part that is judged; chosen
_FEWEST_WINDOWS = 4  # of the shortest part; chosen
_LEAST_START = 4  # rows that show where a window begins, at least; chosen
_EVALUATIONS = 40  # of the search for states at which windows begin; chosen: a few are enough
_HEADING, _POSITION = ("psi",), ("x0", "y0")


@dataclass(frozen=True)
class WindowSeconds:
    """Length of the windows in which a quarter is simulated, and of their beginnings, which show their first state."""

    length: float
    beginning: float


@dataclass(frozen=True)
class Parts:
    """What is left out in turn: `count` groups of whole runs, every so many-th one, or so many pieces of every run."""

    count: int
    are_runs: bool

    @classmethod
    def for_runs(cls, runs: Runs) -> "Parts | None":
        """Return whole runs where they are enough for a jackknife, else quarters; None where these say nothing."""
        if len(runs) >= RUNS_FOR_JACKKNIFE:
            return cls(min(len(runs), _MOST_GROUPS), True)
        return cls(_QUARTERS, False) if min(map(len, runs.records)) >= _QUARTERS * _FEWEST_ROWS else None

    def __str__(self) -> str:
        return "runs left out" if self.are_runs else "quarters of the runs left out"

    def rows(self, runs: Runs, part: int) -> list[tuple[int, int]]:
        """Return of each run the first row of a part and the row behind its last; the same where it has none of it."""
        if self.are_runs:
            return [(0, len(r) if i % self.count == part else 0) for i, r in enumerate(runs.records)]
        edges = (part / self.count, (part + 1) / self.count)
        return [(round(edges[0] * len(r)), round(edges[1] * len(r))) for r in runs.records]

    def of_rows(self, data: Segments) -> Index:
        """Return the part to which each row of the segments belongs, (rows,)."""
        if self.are_runs:
            return np.repeat(data.run % self.count, np.diff(data.offsets))
        parts = np.zeros(int(data.offsets[-1]), dtype=np.int64)
        for run in range(len(data.runs)):
            segments, before = data.run_segments(run), 0
            total = sum(int(data.offsets[s + 1] - data.offsets[s]) - 1 for s in segments) + 1
            for s in segments:  # neighbouring segments share a sample
                a, b = int(data.offsets[s]), int(data.offsets[s + 1])
                parts[a:b] = self.count * (before + np.arange(b - a)) // total
                before += b - a - 1
        return parts


def output_error_points(estimate: PointEstimate, parts: Parts) -> Array:
    """Return the shared unknowns of an output-error estimate without each part, (parts, k)."""
    problem, point = estimate.problem, estimate.common_parameters
    of_rows, points = parts.of_rows(problem.data), []
    for left_out in range(parts.count):
        measured = np.where((of_rows == left_out)[:, None], np.nan, problem.data.measured)
        kept = [s for s, (a, b) in enumerate(pairwise(problem.data.offsets)) if np.isfinite(measured[a:b]).any()]
        rest = replace(problem, data=replace(problem.data, measured=measured).selected(np.array(kept)))
        gradient, hessian = rest.normal(point, estimate.optimum.local[kept]).without_local()
        normal = replace(estimate.optimum.normal, gradient=gradient, hessian=hessian)
        points.append(point + step_within((problem.lower - point, problem.upper - point), normal)[0])
    return np.array(points)


def innovation_points(noise: ProcessNoise, parts: Parts) -> Array:
    """Return the same of a prediction-error estimate, (parts, k): likelihoods of samples add up."""
    problem, point, whole = noise.problem, noise.optimum.solution.point, noise.optimum.normal
    exact = problem if problem.steps is not None else replace(
        problem, steps=problem.difference_steps(point, whole.hessian)
    )  # fmt: skip
    of_rows = parts.of_rows(problem.runs.data)
    normals = replace(exact, is_one_sided=True).part_normals(point, of_rows, parts.count)
    room, points = (problem.lower - point, problem.upper - point), []
    for gradient, hessian in normals:
        rest = replace(whole, gradient=-gradient, hessian=whole.hessian - hessian)
        points.append((point + step_within(room, rest)[0])[noise.common_indices])
    return np.array(points)


def left_out_errors(
    problem: OutputError, points: Array, runs: Runs, parts: Parts, seconds: WindowSeconds
) -> Array:  # fmt: skip
    """Return logarithms of rms errors of each part by the unknowns without it, (parts, lengths, kinds).

    Lengths: parts as a whole, and windows, where these are too long the whole again. Kinds: heading and position, or
    without both every channel; NaN where a part has no sample of one. Errors below half the resolution of a channel's
    values count as that, errors beyond the motion itself as it: how far a prediction fails, one step from the estimate,
    says nothing more.
    """
    return np.array([_errors_of_part(problem, points[k], runs, seconds, parts, k) for k in range(parts.count)])


def kinds_of(outputs: Sequence[str]) -> list[tuple[str, ...]]:
    """Return the groups of channels whose errors are pooled."""
    steered = [tuple(c for c in kind if c in outputs) for kind in (_HEADING, _POSITION)]
    return [kind for kind in steered if kind] or [(c,) for c in outputs]


def _errors_of_part(
    problem: OutputError, point: Array, runs: Runs, seconds: WindowSeconds, parts: Parts, k: int
) -> Array:  # fmt: skip
    dt, rows = runs.records[0].dt, parts.rows(runs, k)
    shortest = min(b - a for a, b in rows if b > a)
    steps = max(min(round(seconds.length / dt), shortest // _FEWEST_WINDOWS), 2 * _LEAST_START)
    whole, windows = [[(a, b)] if b > a else [] for a, b in rows], [_cut(a, b, steps) for a, b in rows]
    return np.array([
        _rms_logarithms(problem, point, runs, bounds, max(min(round(seconds.beginning / dt), steps // 2), _LEAST_START))
        for bounds in (whole, windows if any(windows) else whole)
    ])  # fmt: skip


def _cut(first: int, last: int, steps: int) -> list[tuple[int, int]]:
    """Windows of so many steps between two rows; none where only one would fit."""
    count = (last - 1 - first) // steps
    return [(first + n * steps, first + (n + 1) * steps + 1) for n in range(count)] if count > 1 else []


def _rms_logarithms(
    problem: OutputError, point: Array, runs: Runs, bounds: Sequence[Sequence[tuple[int, int]]], beginning: int
) -> Array:
    """Logarithm of the error of each kind over all windows together, the states at their begin searched first."""
    data = segments_between(problem.model, runs.records, problem.data.outputs, bounds, runs.sessions)
    windows = replace(problem, data=data, pinned=point, inflation=None)
    row = np.concatenate([np.arange(n) for n in np.diff(data.offsets)])
    early = replace(windows, data=replace(data, measured=np.where((row < beginning)[:, None], data.measured, np.nan)))
    local = early.measured_initial_states()
    if np.isfinite(early.cost(point, local)):
        local = levenberg_marquardt(early, point, local, evaluations=_EVALUATIONS).local
    error = windows.simulated_outputs(point, local) - data.measured
    floor = 0.5 * np.sqrt(12.0) * problem.data.rounding_noise  # half a step of the values
    logarithms = []
    for kind in kinds_of(data.outputs):
        columns = [data.outputs.index(c) for c in kind]
        is_lost = ~np.isfinite(error[:, columns]) & np.isfinite(data.measured[:, columns])
        counts = np.isfinite(data.measured[:, columns]).sum(axis=0)
        if not np.all(counts):
            logarithms.append(np.nan)
            continue
        motion = float(np.sum(np.nanvar(data.measured[:, columns], axis=0)))
        square = motion if np.any(is_lost) else float(np.sum(np.nansum(error[:, columns] ** 2, axis=0) / counts))
        least = max(float(np.sum(floor[columns] ** 2)), np.finfo(float).tiny)
        logarithms.append(0.5 * np.log(max(min(square, motion), least)))
    return np.array(logarithms)


# Which criterion the records call for: the decision table from an estimate over segments onwards.

PREDICTION_ERROR, WHOLE_RUNS = "prediction error", "output error over whole runs"
_CORRELATED = "coloured residuals mean model error or process noise"
_SEGMENTED = "segments keep it from accumulating"
_COARSE_SAMPLES = "samples too far apart for prediction error, which takes inputs as straight between them"
SET_BY_TRIAL = "the criterion is set by the trial"
"""Reason of an estimate whose criterion nothing else decided."""
_FREE_DECAY = (
    "a free decay, which its initial state explains: whole runs show what one decay has in common with the next"
)
WAVE_FORCES = ("F3", "M5")
"""Inputs that are forces of recorded waves."""

_WHITE = "no process noise was detected"
_FEEDBACK = (
    "inputs follow outputs, so that output error would take answered disturbances for the ship's own response: "
    "a disturbance is estimated, however faint"
)
SPREAD = "intervals cover the spread between the disturbance models"
# residuals over whole runs over those within segments that count as equal, ours
_MAX_RESIDUAL_GROWTH = 1.05
# rad from sample to sample, ours: straight lines between samples then lose 1 % of an input
_MAX_PHASE_STEP = 0.3
# residuals over spread, in every channel, of a free decay that its initial state explains; chosen
_MAX_RESIDUAL_SHARE = 0.5


@dataclass(frozen=True, eq=False)
class CriterionChoice:
    """A criterion's optimum, what it leaves, and why it is used.

    Attributes:
        residuals: simulated minus measured, under prediction error one step ahead, (rows, ny), SI.
        inflation: variance inflation of each channel's residuals, (ny,); rho: their autocorrelations.
        whiteness: tests of the residuals (under prediction error of the normalised innovations).
        disturbances: the disturbance models that were compared; None: none were.
        process_intensities: of process noise that suits the estimate.
        process_noise: the prediction-error optimum, if used.
        implied_noise: what suits an output-error estimate over a few whole runs, where it makes one-step residuals
            white or the runs are free decays.
    """

    estimate: PointEstimate
    residuals: Array
    inflation: Array
    rho: list[Array]
    whiteness: WhitenessTest
    criterion: str
    reasons: tuple[str, ...]
    process_intensities: dict[str, float] = field(default_factory=dict)
    process_noise: ProcessNoise | None = None
    implied_noise: ProcessNoise | None = None
    disturbances: DisturbanceChoice | None = None

    @property
    def is_nearly_white(self) -> bool:
        """Whether residuals are white, or correlated so weakly that each sample counts as one.

        By chance alone the inflation of a few hundred white samples may exceed its limit.
        """
        return self.whiteness.is_white or bool(np.max(self.inflation) <= WHITE_INFLATION)

    @property
    def hints_at_disturbance(self) -> bool:
        """Whether the residuals fail a test of whiteness, or their spectrum rises to low frequencies."""
        if not has_noise(self.estimate):
            return False
        pieces = [self.residuals[a:b] for a, b in pairwise(self.estimate.problem.data.offsets)]
        return not self.whiteness.is_white or spectral_hint(pieces) > HINT

    def with_reasons(self, *reasons: str) -> "CriterionChoice":
        """The same with more reasons."""
        return replace(self, reasons=(*self.reasons, *reasons))


def choose_criterion(
    shooting: PointEstimate,
    seconds: float,
    settings: EstimateSettings,
    noise: Mapping[str, float],
    fit_whole_runs: Callable[[], PointEstimate | None],
    runs: Runs,
    windows: WindowSeconds,
    report_progress: ProgressReporter | None,
    *,
    begun: PointEstimate | None = None,
    is_unforced: bool = False,
    has_feedback: bool = False,
) -> CriterionChoice:
    """The criterion to use; `shooting` is the estimate over segments of `seconds`, `whole_runs` makes the other one.

    runs: the records behind it; windows: in which criteria are judged.
    begun: where the search began, from which prediction error may start too.
    is_unforced: nothing moves the ship but its initial state; has_feedback: inputs follow outputs.
    """
    first = with_input_offsets(with_plausible_start(shooting))
    further = [] if begun is None else [with_input_offsets(with_plausible_start(begun))]
    further += own_starts(further[0] if further else first)
    shot = output_error_choice(shooting, _output_error_name(seconds))
    match settings.criterion:
        case FitCriterion.OUTPUT_ERROR | FitCriterion.MULTIPLE_SHOOTING:
            return _required_choice(shot, settings, noise, SET_BY_TRIAL)
        case FitCriterion.PREDICTION_ERROR:
            white = fit_prediction_error(
                first, noise, further_starts=further, thorough=True, report_progress=report_progress
            )
            disturbances = choose_disturbance(white, [first], report_progress=report_progress)
            reasons = ("it is set by the trial", disturbances.summary)
            return prediction_error_choice(disturbances.chosen.noise, disturbances, *reasons)
        case FitCriterion.AUTO if is_unforced and is_explained(shooting):
            return _required_choice(shot, settings, noise, _FREE_DECAY)
        case FitCriterion.AUTO:
            pass
    if settings.segment_s is not None:
        return _required_choice(shot, settings, noise, "the length of segments is set by the trial")
    whole = fit_whole_runs() if shot.is_nearly_white else None
    over_runs = _whole_runs_choice(shot, whole)
    in_waves = set(WAVE_FORCES) & set(shooting.problem.model.input_names)  # recorded forces explain what moves the ship
    has_filter = has_noise(shooting) and not settings.robust
    is_closed = has_feedback and has_filter and not is_coarsely_sampled(shooting.problem)
    is_plain = over_runs is not None and over_runs.is_nearly_white and not is_closed
    if over_runs is not None and is_plain and (in_waves or not over_runs.hints_at_disturbance):
        return over_runs.with_reasons(_WHITE)
    if shot.is_nearly_white and over_runs is None:
        shot = shot.with_reasons("whole runs do not fit within the noise of the segments")
    if not has_filter:
        return shot.with_reasons(_CORRELATED, _SEGMENTED)
    if is_coarsely_sampled(shooting.problem):
        return shot.with_reasons(_CORRELATED, _COARSE_SAMPLES)
    white = fit_prediction_error(
        first, noise, further_starts=further, thorough=not in_waves, report_progress=report_progress
    )
    if np.isnan(white.newton_decrement):  # not searched: no disturbance makes such innovations white
        return replace(shot.with_reasons(white.test.summary, _SEGMENTED), process_intensities=white.process_intensities)
    parts, plain = Parts.for_runs(runs), list[CriterionChoice]()
    if parts is not None:
        shots = [] if np.isinf(seconds) else [(shooting, shot.criterion)]
        over = whole or fit_whole_runs()
        fitted = [(over, WHOLE_RUNS), *shots] if over is not None else shots
        plain = [output_error_choice(_with_free_zeros(e, noise, report_progress), name) for e, name in fitted]
    disturbances = choose_disturbance(
        white, [first, *(c.estimate for c in plain)], needs_disturbance=is_closed, report_progress=report_progress
    )
    best = disturbances.chosen.noise
    if over_runs is not None and over_runs.whiteness.is_white and not disturbances.chosen.unknown_count:
        return replace(over_runs.with_reasons(disturbances.summary), disturbances=disturbances)
    if is_closed and parts is None:
        return _with_disturbance(shot, disturbances, _FEEDBACK)
    if parts is not None:
        if is_closed and best.test.is_nearly_white:
            plain = []  # output error takes answers of the loop for the craft's own
        return _best_predicting(shot, plain, disturbances, runs, parts, windows, (_FEEDBACK,) if is_closed else ())
    if best.test.is_nearly_white:
        return _with_disturbance(shot, disturbances)
    return _without_filter(shot, disturbances, _SEGMENTED)


def _with_disturbance(shot: CriterionChoice, disturbances: DisturbanceChoice, *reasons: str) -> CriterionChoice:
    """Prediction error with the chosen disturbance."""
    best = disturbances.chosen.noise
    spread = [] if best.test.is_white else [SPREAD]
    return prediction_error_choice(best, disturbances, *shot.reasons, *reasons, disturbances.summary, *spread)


def _without_filter(choice: CriterionChoice, disturbances: DisturbanceChoice, *reasons: str) -> CriterionChoice:
    """Output error although disturbances were fitted, whose intensities serve the floor of predictions."""
    return replace(
        choice.with_reasons(disturbances.summary, *reasons, SPREAD),
        process_intensities=disturbances.chosen.noise.process_intensities, disturbances=disturbances,
    )  # fmt: skip


def _with_free_zeros(
    estimate: PointEstimate, noise: Mapping[str, float], report_progress: ProgressReporter | None
) -> PointEstimate:
    """Output error with the zeros that are free beside disturbances: one that is held would be judged by that."""
    freed = with_input_offsets(with_plausible_start(estimate))
    if freed.problem is estimate.problem:
        return estimate
    begin = freed.common_parameters, freed.optimum.local
    return fit_output_error(freed.problem, *begin, noise, report_progress=report_progress)


def _best_predicting(
    shot: CriterionChoice, plain: Sequence[CriterionChoice], disturbances: DisturbanceChoice, runs: Runs,
    parts: Parts, windows: WindowSeconds, reasons: tuple[str, ...],
) -> CriterionChoice:  # fmt: skip
    """The criterion that predicts left-out parts best; of those that predict alike the likeliest disturbance.

    Candidates are `plain`, by output error, and every disturbance that was searched to its end. reasons: for these.
    """
    plain = [c for c in plain if not is_lost(c.estimate.problem, c.estimate.common_parameters)]
    searched = [f for f in disturbances.fitted if f.unknown_count and f.is_searched]
    candidates = [(c.estimate.problem, output_error_points(c.estimate, parts)) for c in plain]
    candidates += [(f.noise.as_point_estimate().problem, innovation_points(f.noise, parts)) for f in searched]
    of_parts = [np.nanmean(left_out_errors(p, points, runs, parts, windows), axis=(1, 2)) for p, points in candidates]
    errors = [float(np.nanmean(one)) for one in of_parts]
    names = [*(c.criterion for c in plain), *(f"{PREDICTION_ERROR}, {f.noise.disturbance_model}" for f in searched)]
    if not np.any(np.isfinite(errors)):
        return _without_filter(shot, disturbances, _SEGMENTED)
    least = float(np.min(errors))
    text = f"errors on {parts} over the least: " + "; ".join(
        f"{name} {np.exp(error - least):.2f}" for name, error in zip(names, errors, strict=True)
    )
    best, judged = of_parts[int(np.argmin(errors))], {}
    for one, of_part in zip(searched, of_parts[len(plain) :], strict=True):
        excess = (of_part - best)[~np.isnan(best)]
        alike = is_no_worse(excess, np.log1p(ALIKE))
        judged[id(one)] = replace(one, left_out_error=float(np.exp(excess.mean())), predicts_alike=alike)
    fitted = tuple(judged.get(id(f), f) for f in disturbances.fitted)
    close = [f for f in fitted if f.left_out_error is not None and f.predicts_alike]
    if close:
        return _with_disturbance(shot, DisturbanceChoice(likeliest(close), fitted), *reasons, text)
    used = plain[int(np.argmin(errors[: len(plain)]))]
    disturbances = replace(disturbances, fitted=fitted)
    return replace(
        used.with_reasons(*shot.reasons, disturbances.choice_text, text),
        process_intensities=disturbances.chosen.noise.process_intensities, disturbances=disturbances,
    )  # fmt: skip


def is_coarsely_sampled(problem: OutputError) -> bool:
    """Whether a continuous input of a linear model turns by more than 0.3 rad from sample to sample.

    Its power lies below that frequency but for 5 %; straight lines between samples then flatten it by (w dt)^2 / 12.
    """
    model, data = problem.model, problem.data
    if not model.is_affine:
        return False
    for j, channel in enumerate(model.inputs):
        values = data.inputs[:, j]
        if not channel.is_held and np.ptp(values) > 0.0:
            power = np.abs(np.fft.rfft(values - np.mean(values))) ** 2
            # share of the power that counts as band; chosen
            place = int(np.searchsorted(np.cumsum(power), 0.95 * np.sum(power)))
            if 2.0 * np.pi * place / len(values) > _MAX_PHASE_STEP:
                return True
    return False


def _required_choice(
    shooting: CriterionChoice, settings: EstimateSettings, noise: Mapping[str, float], reason: str
) -> CriterionChoice:
    """The user's own choice; what it leaves coloured is measured as process noise, for the floor of predictions."""
    if shooting.is_nearly_white or not has_noise(shooting.estimate):
        return shooting.with_reasons(reason)
    if (
        shooting.criterion == WHOLE_RUNS
        and len(shooting.estimate.problem.data.runs) < RUNS_FOR_JACKKNIFE
        and not settings.robust
    ):
        implied = implied_process_noise(shooting.estimate, noise)
        is_decay = reason == _FREE_DECAY  # nothing that is recorded drives it: what is left is disturbance
        if is_decay and not implied.test.is_white:
            implied = with_whole_run_intensity(implied, shooting.estimate, shooting.residuals)
        return replace(
            shooting.with_reasons(reason, _CORRELATED),
            process_intensities=implied.process_intensities,
            implied_noise=implied if is_decay or implied.test.is_nearly_white else None,
        )
    reasons = (_CORRELATED,) if shooting.criterion == WHOLE_RUNS else (_CORRELATED, _SEGMENTED)
    return replace(
        shooting.with_reasons(reason, *reasons), process_intensities=implied_intensities(shooting.estimate, noise)
    )


def is_explained(estimate: PointEstimate) -> bool:
    """Return whether at most half of each channel's standard deviation is left by an estimate."""
    spread = np.nanstd(estimate.problem.data.measured, axis=0)
    return bool(np.all(np.nanstd(estimate.residuals(), axis=0) <= _MAX_RESIDUAL_SHARE * spread))


def _whole_runs_choice(shooting: CriterionChoice, whole_runs: PointEstimate | None) -> CriterionChoice | None:
    """The estimate over whole runs, if its residuals are no larger (5 %) than within segments."""
    if whole_runs is None:
        return None
    left = output_error_choice(whole_runs, WHOLE_RUNS)
    within, over = (residual_spread(f.estimate.problem, f.residuals) for f in (shooting, left))
    return (
        replace(left, reasons=(*shooting.reasons, *left.reasons))
        if np.all(over <= _MAX_RESIDUAL_GROWTH * within)
        else None
    )


def _output_error_name(seconds: float) -> str:
    return WHOLE_RUNS if np.isinf(seconds) else f"output error, multiple shooting with segments of {seconds:.3g} s"


def output_error_choice(estimate: PointEstimate, criterion: str) -> CriterionChoice:
    """An output-error estimate with tests of what it leaves."""
    problem, residuals = estimate.problem, estimate.residuals()
    rho, inflation = residual_correlation(problem, residuals)
    whiteness = whiteness_test([residuals[a:b] for a, b in pairwise(problem.data.offsets)])
    is_silent = problem.noise <= rounding_level(problem)  # the colour of rounding errors says nothing about the ship
    whiteness = WhitenessTest(np.where(is_silent, 1.0, whiteness.p_values))
    where = "over whole runs" if criterion == WHOLE_RUNS else "within segments"
    p = f"Ljung-Box, p {whiteness.smallest:.2g}"
    text = f"the residuals {where} are white ({p})"
    if not whiteness.is_white:
        text = f"the residuals {where} are not white ({p})"
    if np.max(inflation) > WHITE_INFLATION:
        text += (
            f", their correlation inflates variances by {np.max(inflation):.3g}, and correlated samples count as their "
            "effective number, so that priors keep their weight"
        )
    return CriterionChoice(estimate, residuals, inflation, rho, whiteness, criterion, (text,))


def prediction_error_choice(noise: ProcessNoise, disturbances: DisturbanceChoice, *reasons: str) -> CriterionChoice:
    """The estimate with the chosen disturbance, and tests of its innovations."""
    estimate, innovations = (noise.as_point_estimate(), noise.problem.innovations(noise.optimum.solution.point))
    rho, inflation = residual_correlation(estimate.problem, innovations.normalised)
    return CriterionChoice(
        estimate, -innovations.e, inflation, rho, noise.test.whiteness, PREDICTION_ERROR, reasons,
        noise.process_intensities, noise, disturbances=disturbances,
    )  # fmt: skip


def with_sufficient_steps(choice: CriterionChoice) -> CriterionChoice:
    """Return the choice with so many Runge-Kutta steps in a sample as its own criterion needs.

    They were judged by output error, whose noise is larger where a disturbance moves the craft.
    """
    noise, disturbances = choice.process_noise, choice.disturbances
    if noise is None or disturbances is None:
        return choice
    count = sufficient_steps_of_filter(noise.problem, noise.optimum)
    if count == noise.problem.runs.substeps:
        return choice
    exact, optimum, decrement = refine_by_newton(filter_with_steps(noise.problem, count), noise.optimum)
    normalised = exact.innovations(optimum.solution.point).normalised
    whiteness = whiteness_test([normalised[a:b] for a, b in pairwise(exact.runs.data.offsets)])
    finer = replace(
        noise, problem=exact, optimum=optimum, newton_decrement=decrement,
        test=replace(noise.test, whiteness=whiteness), output_error=replace(noise.output_error, substeps=count),
    )  # fmt: skip
    return prediction_error_choice(finer, disturbances, *choice.reasons)
