"""Which criterion the records call for: the decision table from an estimate over segments onwards."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, ProgressReporter
from seatrial.data.trial import EstimateSettings, FitCriterion
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.disturbance_choice import ALIKE, DisturbanceChoice, choose_disturbance, likeliest
from seatrial.estimation.estimate.disturbance_screen import HINT, spectral_hint
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE
from seatrial.estimation.estimate.left_out_parts import (
    Parts,
    WindowSeconds,
    innovation_points,
    left_out_errors,
    output_error_points,
)
from seatrial.estimation.estimate.newton_refinement import refine_by_newton
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
from seatrial.estimation.estimate.process_noise_interval import with_whole_run_intensity
from seatrial.estimation.estimate.settings import WHITE_INFLATION
from seatrial.estimation.information.whiteness import WhitenessTest, is_no_worse, whiteness_test
from seatrial.estimation.problem.output_error import OutputError

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
