"""Records and a model in, a fit out: the decision table of the estimator (docs/estimation.md)."""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import NoiseModel, SearchAttempt
from seatrial.core.values import NOTATION, Array, InputError, ProgressReporter, Record, display_unit
from seatrial.data.check.phases import is_free_decay
from seatrial.data.trial import EstimateMethod, EstimateSettings, FitCriterion
from seatrial.estimation.estimate.assemble import Runs, output_error_problem
from seatrial.estimation.estimate.closed_loop import LoopEvidence, closed_loop, loop_evidence
from seatrial.estimation.estimate.criterion_choice import (
    PREDICTION_ERROR,
    SPREAD,
    WAVE_FORCES,
    CriterionChoice,
    WindowSeconds,
    choose_criterion,
    output_error_choice,
    prediction_error_choice,
    with_sufficient_steps,
)
from seatrial.estimation.estimate.disturbance_models import refuse_short_runs
from seatrial.estimation.estimate.intervals import (
    RUNS_FOR_JACKKNIFE,
    Uncertainty,
    estimate_uncertainty,
    innovations_uncertainty,
    process_noise_interval,
    refuse_few_runs,
    with_slow_forces,
    with_spread,
)
from seatrial.estimation.estimate.newton_refinement import newton_optimum
from seatrial.estimation.estimate.plausibility import implausible_coefficients, refuse_implausible
from seatrial.estimation.estimate.point_estimate import (
    PointEstimate,
    fit_output_error,
    integration_text,
    refuse_unstarted,
    with_steps_of_start,
)
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.estimate.settings import (
    HUBER_LIMIT,
    INITIAL_STATE_SHIP_LENGTHS,
    JUDGED_SHIP_LENGTHS,
    SEGMENT_SHIP_LENGTHS,
    WHITE_INFLATION,
    EstimatorOptions,
    IntervalMethod,
    characteristic_time,
    resolved_time,
    weak_form_half_width,
)
from seatrial.estimation.estimate.start import (
    SearchStart,
    SeveralStarts,
    continued_start,
    find_start,
    number_of_starts,
    search_from_several,
)
from seatrial.estimation.information.covariance import Interval, inverse
from seatrial.estimation.information.whiteness import WhitenessTest, whiteness_test
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import over_runs
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import Optimum

# Records of more samples than a choice needs: decide on a stated part of them, then take one step over all.

MOST_SAMPLES = 100_000
"""Samples of all runs up to which everything is done with all of them; chosen."""

CHOICE_SAMPLES, _STRETCHES = 20_000, 3
"""Samples on which start, disturbance and criterion are chosen beyond that, and stretches of a single run; chosen."""

PIECE_SAMPLES = 20_000
"""Samples of the pieces in which all of them are filtered: each forgets its initial state within a few; chosen."""

_MOST_GROWTH = 10.0
"""Samples of a Newton step over those of the one before, at most; chosen: a step then leaves 0.1 standard errors."""

_FAR, _MOST_REPEATS = 4.0, 2
"""Decrement of the last step from which on it is taken again, and how often at most: from 2.8 standard errors a step
leaves a tenth of one; chosen."""

_LATER_EVALUATIONS = 6
"""Most evaluations of output error over all samples, from the optimum over some; chosen."""


def choice_runs(runs: Runs) -> Runs | None:
    """Return stretches of all runs with some twenty thousand samples; None where all runs together are short enough."""
    return _part(runs, CHOICE_SAMPLES) if _sample_count(runs) > MOST_SAMPLES else None


def _sample_count(runs: Runs) -> int:
    return sum(len(r) for r in runs.records)


def _part(runs: Runs, samples: int) -> Runs:
    """Stretches of all runs with about so many samples together."""
    count = max(1, round(_STRETCHES / len(runs)))
    length = max(samples // (count * len(runs)), 2)
    stretches = [(s, session) for r, session in zip(runs.records, runs.sessions, strict=True)
                 for s in _stretches(r, count, length)]  # fmt: skip
    return replace(runs, records=tuple(s for s, _ in stretches), sessions=tuple(n for _, n in stretches))


def _stretches(record: Record, count: int, length: int) -> Iterator[Record]:
    """Yield stretches of a record from its beginning to its end."""
    length = min(length, len(record))
    for number, first in enumerate(np.linspace(0, len(record) - length, count).round().astype(int).tolist()):
        yield record.rows(slice(first, first + length)).renamed(f"{record.name}, stretch {number + 1}")


def choice_over_all(choice: CriterionChoice, runs: Runs) -> CriterionChoice:
    """Return a choice moved to its optimum over all samples.

    Prediction error takes Newton steps: the point comes from so many samples that what a step leaves is far below its
    standard error. Output error searches on from the point.
    """
    few = choice.estimate.problem
    total, part = _sample_count(runs), len(few.data.inputs)
    reason = f"criterion and disturbance were chosen on {part} of {total} samples, the estimate is that of all"
    if choice.disturbances is None or choice.process_noise is None:
        problem = _with_all_samples(few, runs, None)  # whole: without a disturbance nothing is forgotten
        estimate = fit_output_error(problem, choice.estimate.common_parameters, problem.measured_initial_states(),
                                    runs.noise, rounds=1, evaluations=_LATER_EVALUATIONS)  # fmt: skip
        return output_error_choice(estimate, choice.criterion).with_reasons(reason)
    noise = _noise_over_all(choice.process_noise, runs)
    reasons = (f"{choice.disturbances.choice_text}; over all samples {noise.test.innovations_text}", reason)
    more = () if noise.test.is_white else (SPREAD,)
    return prediction_error_choice(noise, choice.disturbances, *reasons, *more)


def _noise_over_all(few: ProcessNoise, runs: Runs) -> ProcessNoise:
    """The optimum over all samples, by way of parts that grow by one factor, ten at most.

    What a Newton step leaves grows with the square of its distance, and this with the root of that factor; where the
    last one still came from far away, it is taken again.
    """
    part = len(few.problem.runs.data.inputs)
    factor = _sample_count(runs) / part
    steps = max(1, math.ceil(math.log(factor) / math.log(_MOST_GROWTH)))
    growth, noise = factor ** (1.0 / steps), few
    for step in range(1, steps):
        noise = _one_step(few, noise.optimum, _part(runs, round(part * growth**step)), growth)
    noise = _one_step(few, noise.optimum, runs, growth)
    for _ in range(_MOST_REPEATS):
        if noise.newton_decrement <= _FAR:
            break
        noise = _one_step(few, noise.optimum, runs, 1.0)
    normalised = noise.problem.innovations(noise.optimum.solution.point).normalised
    pieces = [normalised[a:b] for a, b in pairwise(noise.problem.runs.data.offsets)]
    return replace(noise, newton_decrement=0.0, test=replace(few.test, whiteness=whiteness_test(pieces)))


def _one_step(few: ProcessNoise, before: Optimum, runs: Runs, growth: float) -> ProcessNoise:
    """One Newton step over these runs from an optimum of `growth` times fewer samples; its decrement is kept."""
    output_error = _with_all_samples(few.output_error, runs, PIECE_SAMPLES * few.output_error.data.dt)
    problem = over_runs(few.problem, output_error)
    optimum, decrement = newton_optimum(problem, before, growth)
    return replace(few, problem=problem, optimum=optimum, newton_decrement=decrement, output_error=output_error)


def _with_all_samples(problem: OutputError, runs: Runs, seconds: float | None) -> OutputError:
    """The problem with all samples, in pieces of so many seconds; None: whole runs."""
    return replace(
        problem, data=cut_segments(problem.model, runs.records, problem.data.outputs, seconds, runs.sessions)
    )


# Records and a model in, a fit out: the decision table of the estimator (docs/estimation.md).

_MIN_RUDDER_RANGE = float(np.radians(0.5))
"""Range of rudder angle [rad] that counts as a manoeuvre: 0.5 deg, chosen."""


@dataclass(frozen=True, eq=False)
class Estimation:
    """An estimate with its interval and how it came about.

    Attributes:
        estimate: problem and optimum.
        shooting: the estimate over segments that came first, by which models are compared.
        uncertainty: intervals of all shared unknowns, and the estimates they rest on.
        residuals: simulated minus measured, under prediction error one step ahead, (rows, ny), SI.
        inflation: variance inflation of each channel's residuals; rho: their autocorrelations.
        whiteness: tests of the residuals.
        noise_model: what is between model and records, and why this criterion.
        start_method: where the search began, in words.
        criterion, reasons: what was used, and why.
        process_noise: the Kalman filter that suits the estimate; None: none was needed, or multiple shooting was used.
        search_attempts: short searches from several starting points, the best first; empty: there was one.
        abandoned: which criterion led outside physics, so that whole runs took its place; empty: none did.
    """

    estimate: PointEstimate
    shooting: PointEstimate
    uncertainty: Uncertainty
    residuals: Array
    inflation: Array
    rho: list[Array]
    whiteness: WhitenessTest
    noise_model: NoiseModel
    start_method: str
    criterion: str
    reasons: tuple[str, ...]
    elapsed_s: float
    process_noise: ProcessNoise | None = None
    search_attempts: tuple[SearchAttempt, ...] = ()
    abandoned: str = ""

    @property
    def interval(self) -> Interval:
        """Of all shared unknowns."""
        return self.uncertainty.interval

    @property
    def information(self) -> Array:
        """Of all shared unknowns, as the interval has it where that comes from one."""
        known = self.uncertainty.information
        return self.estimate.optimum.normal.without_local()[1] if known is None else known

    @property
    def model(self) -> Model:
        """The model at the estimate."""
        return self.estimate.model

    def widened(self, added: Array, reason: str) -> "Estimation":
        """Return the estimation with more covariance of its coefficients; added: (k, k), of the first k unknowns."""
        interval, count = self.interval, len(added)
        covariance = interval.covariance.copy()
        covariance[:count, :count] += added
        wider = replace(interval, covariance=covariance, meaning=f"{interval.meaning}, with {reason}")
        return replace(self, uncertainty=replace(self.uncertainty, interval=wider))

    @property
    def has_process_noise(self) -> bool:
        """Whether the coefficients come from prediction error, with noise in the states."""
        return self.noise_model.method == PREDICTION_ERROR


def moving_inputs(model: Model, records: Sequence[Record]) -> list[str]:
    """Return the inputs that move in any of the records."""
    return [n for n in model.input_names if any(n in r and np.ptp(r[n]) > 0.0 for r in records)]


def refuse_without_excitation(model: Model, records: Sequence[Record]) -> None:
    """Refuse records in which the rudder never moves, or no input of a linear model does.

    Raises:
        InputError: which records, and what manoeuvre is needed.
    """
    if model.has_thrusters and not moving_inputs(model, records):
        raise InputError(
            f"no excitation: none of {', '.join(model.input_names)} moves in {', '.join(r.name for r in records)}; "
            "record spins, straights ahead and astern, and steps of each thruster"
        )
    is_driven = bool(moving_inputs(model, records)) or (
        not model.has_course and all(is_free_decay(record) for record in records)
    )
    if model.is_affine and not is_driven:
        raise InputError(
            f"no excitation: none of {', '.join(model.input_names)} moves in {', '.join(r.name for r in records)}; "
            "give wave forces or fin angles, the wave elevation with [excitation], or decays from a release"
        )
    still = all("delta" in r and np.ptp(r["delta"]) < _MIN_RUDDER_RANGE for r in records)
    if model.has_rudder and still:
        raise InputError(
            f"no excitation: 'delta' never moves in {', '.join(r.name for r in records)}; "
            "record a zigzag (10/10 or 20/20) or a turning circle"
        )


def with_segment_seconds(settings: EstimateSettings, model: Model, runs: Runs) -> EstimateSettings:
    """Return the settings with a segment length in ship lengths expressed in seconds.

    Raises:
        InputError: the length is in ship lengths and the runs show no speed.
    """
    if settings.segment_lengths is None:
        return settings
    seconds = settings.segment_lengths * characteristic_time(model, runs.records, runs.length)
    return replace(settings, segment_s=seconds, segment_lengths=None)


@dataclass(frozen=True, eq=False)
class Beginning:
    """What every criterion begins from.

    Attributes:
        runs: those on which criterion and disturbance are chosen: the training runs, or stretches of long ones.
        settings: as the trial has them, segments in seconds; unit: the ship's characteristic time [s].
        starts: where the search began; shooting: the estimate over segments.
    """

    runs: Runs
    settings: EstimateSettings
    unit: float
    starts: SeveralStarts
    shooting: PointEstimate


def begin_estimate(
    model: Model,
    runs: Runs,
    settings: EstimateSettings,
    options: EstimatorOptions,
    report_progress: ProgressReporter | None = None,
    *,
    near: Beginning | None = None,
) -> Beginning:
    """Return the estimate over segments by multiple shooting with re-estimated noise, begun by the weak form.

    near: of the same runs, of which inputs or instruments were taken otherwise: the search begins at its end.

    Raises:
        InputError: no excitation, no free parameter, outputs that cannot be compared, runs too short for a disturbance
            that is required, or a search that cannot begin.
    """
    settings = with_segment_seconds(settings, model, runs)
    if not model.parameters.free:
        raise InputError(f"model '{model.name}' has no free parameter; free some under [model]")
    refuse_without_excitation(model, runs.records)
    refuse_few_runs(options.intervals, len(runs))
    if settings.criterion is FitCriterion.PREDICTION_ERROR or (
        settings.criterion is FitCriterion.AUTO and runs.feedback is not None
    ):
        refuse_short_runs(runs.records)
    runs = (choice_runs(runs) if _is_free(settings) else None) or runs
    unit = resolved_time(model, runs.records, runs.length, settings.segment_s)
    problem = output_error_problem(model, runs, segment_seconds(model, settings, unit), settings, options.workers)
    begun = continued_start(near.starts, problem, near.shooting) if near else None
    begun = begun or _first_starts(problem, runs, settings, options, unit, report_progress)
    start = begun.start
    shooting = fit_output_error(
        start.problem,
        start.common_parameters,
        start.initial_states,
        runs.noise,
        evaluations=options.evaluations,
        report_progress=report_progress,
    )
    refuse_unstarted(shooting)
    return Beginning(runs, settings, unit, begun, shooting)


def _first_starts(
    problem: OutputError, runs: Runs, settings: EstimateSettings, options: EstimatorOptions, unit: float,
    report_progress: ProgressReporter | None,
) -> SeveralStarts:  # fmt: skip
    """Where a search begins that nothing is known of: by the weak form, and by several searches where it takes them."""
    if report_progress:
        report_progress("start values: weak form")
    half_width = weak_form_half_width(problem.model, runs.records, unit)
    begun = SeveralStarts(find_start(problem, runs.records, half_width), ())
    if settings.robust:
        begun = replace(begun, start=replace(begun.start, problem=replace(begun.start.problem, huber=HUBER_LIMIT)))
    count = number_of_starts(problem.model, settings.starts)
    return search_from_several(begun.start, runs.noise, count, options.seed, report_progress) if count > 1 else begun


def _is_free(settings: EstimateSettings) -> bool:
    """Whether criterion and segments are left to the decision table."""
    return settings.criterion is FitCriterion.AUTO and settings.segment_s is None and not settings.robust


def estimate_model(
    model: Model,
    runs: Runs,
    settings: EstimateSettings | None = None,
    options: EstimatorOptions | None = None,
    report_progress: ProgressReporter | None = None,
    *,
    beginning: Beginning | None = None,
) -> Estimation:
    """Estimate the free parameters of `model` from training runs.

    After the beginning, by the decision table, output error over whole runs or prediction error with process noise,
    unless a criterion or a segment length is set. Of long records all this is done on some stretches, and the estimate
    then moved to the optimum of all samples. Where it ends outside physics and nothing is set, output error over whole
    runs takes its place, which does not take what the model leaves unexplained for a craft without damping.

    beginning: of this model and these runs, where it is known already.

    Raises:
        InputError: what `begin_estimate` raises, or a search that ends outside physics.
    """
    began = time.perf_counter()
    options = options or EstimatorOptions()
    beginning = beginning or begin_estimate(model, runs, settings or EstimateSettings(), options, report_progress)
    report, settings = report_progress or (lambda _: None), beginning.settings
    is_part = beginning.runs is not runs
    evidence = loop_evidence(runs.records, runs.feedback, beginning.runs.records if is_part else None)
    choice = _choice(model, beginning, options, evidence, report_progress)
    if is_part:
        report("start values: all samples")
        choice = choice_over_all(choice, runs)
    if more := integration_text(choice.estimate.problem):
        choice = choice.with_reasons(more)
    criterion = f"{choice.criterion}, Huber loss" if settings.robust else choice.criterion
    uncertainty = _uncertainty(choice, options, report)
    estimate = choice.estimate
    if _is_unforced(model, runs.records) and len(runs) < RUNS_FOR_JACKKNIFE and not choice.whiteness.is_white:
        interval = with_slow_forces(uncertainty.interval, estimate, choice.residuals)
        uncertainty = replace(uncertainty, interval=interval, information=inverse(interval.covariance))
    lost = implausible_coefficients(estimate, uncertainty.interval.standard_error)
    if lost and _is_free(settings):
        over_runs = replace(settings, method=EstimateMethod.OUTPUT_ERROR)
        report("start values: whole runs, as the search ended outside physics")
        kept = estimate_model(model, runs, over_runs, options, report_progress)
        reason = f"{criterion} ended outside physics ({lost})"
        return replace(kept, abandoned=reason, reasons=(reason, *kept.reasons))
    refuse_implausible(estimate, uncertainty.interval.standard_error)
    return Estimation(
        estimate, beginning.shooting, uncertainty, choice.residuals, choice.inflation, choice.rho, choice.whiteness,
        _noise_model(choice, evidence), beginning.starts.start.origin, criterion, choice.reasons,
        time.perf_counter() - began, choice.process_noise or choice.implied_noise, beginning.starts.attempts,
    )  # fmt: skip


def _choice(
    model: Model, beginning: Beginning, options: EstimatorOptions, evidence: LoopEvidence,
    report_progress: ProgressReporter | None,
) -> CriterionChoice:  # fmt: skip
    """The criterion's choice from a beginning."""
    runs, settings, shooting, unit = beginning.runs, beginning.settings, beginning.shooting, beginning.unit
    seconds = segment_seconds(model, settings, unit)

    def whole_runs() -> PointEstimate | None:
        if np.isinf(seconds):
            return shooting
        return _fit_whole_runs(shooting, model, runs, settings, options, report_progress)

    choice = choose_criterion(
        shooting, seconds, settings, runs.noise, whole_runs, runs,
        WindowSeconds(JUDGED_SHIP_LENGTHS * unit, INITIAL_STATE_SHIP_LENGTHS * unit), report_progress,
        is_unforced=_is_unforced(model, runs.records),
        begun=_begun(shooting, beginning.starts.start),
        has_feedback=evidence.is_closed,
    )  # fmt: skip
    return with_sufficient_steps(choice)


def _is_unforced(model: Model, records: Sequence[Record]) -> bool:
    """Whether the ship rolls out from a release, and nothing that was recorded moves it."""
    return not model.has_course and not moving_inputs(model, records)


def segment_seconds(model: Model, settings: EstimateSettings, unit: float) -> float:
    """Return the length of segments [s], infinite for whole runs; unit: the ship's characteristic time [s]."""
    is_automatic = settings.criterion is FitCriterion.AUTO and settings.segment_s is None
    is_stable = model.is_affine or not model.has_course  # in waves or rolling out: nothing to cut short
    if settings.criterion is FitCriterion.OUTPUT_ERROR or (is_stable and is_automatic):
        return np.inf
    return settings.segment_s or SEGMENT_SHIP_LENGTHS * unit


def _uncertainty(choice: CriterionChoice, options: EstimatorOptions, report_progress: ProgressReporter) -> Uncertainty:
    def counted(done: int, total: int) -> None:
        report_progress(f"{options.intervals}: fit {done} of {total}")

    is_refitted = options.intervals in (IntervalMethod.JACKKNIFE, IntervalMethod.BOOTSTRAP)
    if choice.implied_noise is not None and not is_refitted:
        interval = process_noise_interval(choice.estimate, choice.implied_noise)
        return Uncertainty(interval, information=inverse(interval.covariance))
    if choice.disturbances is not None and choice.process_noise is not None:
        return innovations_uncertainty(choice.process_noise, choice.disturbances, options.intervals)
    rng = np.random.default_rng(options.seed)
    uncertainty = estimate_uncertainty(choice.estimate, choice.inflation, options.intervals, rng, counted)
    if choice.disturbances is None or not choice.disturbances.rivals or choice.whiteness.is_white:
        return uncertainty
    estimate = choice.estimate
    widened = with_spread(uncertainty.interval, choice.disturbances, estimate.problem.free, estimate.common_parameters)
    return replace(uncertainty, interval=widened)


def _noise_model(choice: CriterionChoice, evidence: LoopEvidence) -> NoiseModel:
    """Noise in states and channels; intensities that do not make the innovations white bound the process noise."""
    noise, compared = choice.process_noise, choice.disturbances
    return NoiseModel(
        "output error" if noise is None else PREDICTION_ERROR,
        choice.whiteness.smallest,
        choice.process_intensities,
        dict(zip(choice.estimate.problem.data.outputs, map(float, choice.estimate.problem.noise), strict=True)),
        "; ".join(dict.fromkeys(choice.reasons)),
        is_white=choice.whiteness.is_white,
        disturbance="none" if noise is None else noise.disturbance_model,
        added={} if noise is None else noise.added_parameters,
        candidates=() if compared is None else compared.rows(is_used=noise is not None),
        closed_loop=closed_loop(evidence, compared, noise),
        waves=() if noise is None else noise.waves,
        wave_cost=None if noise is None else noise.wave_cost,
    )


def _begun(shooting: PointEstimate, start: SearchStart) -> PointEstimate:
    """The start of the search as an estimate of its own, with the noise that the search ended with."""
    solution = replace(shooting.optimum.solution, point=start.common_parameters)
    return PointEstimate(shooting.problem, replace(shooting.optimum, solution=solution, local=start.initial_states))


def _fit_whole_runs(
    shooting: PointEstimate,
    model: Model,
    runs: Runs,
    settings: EstimateSettings,
    options: EstimatorOptions,
    report_progress: ProgressReporter | None,
) -> PointEstimate | None:
    """Whole runs from the segments' optimum; None where they diverge there."""
    problem = replace(
        output_error_problem(model, runs, np.inf, settings, options.workers),
        noise=shooting.problem.noise,
        huber=shooting.problem.huber,
        substeps=shooting.problem.substeps,
    )
    firsts = [int(np.flatnonzero(shooting.problem.data.run == r)[0]) for r in range(len(problem.data.runs))]
    local = shooting.optimum.local[firsts]
    problem = with_steps_of_start(problem, shooting.common_parameters, local)
    if not np.isfinite(problem.cost(shooting.common_parameters, local)):
        return None
    return fit_output_error(
        problem,
        shooting.common_parameters,
        local,
        runs.noise,
        evaluations=options.evaluations,
        report_progress=report_progress,
    )


# Waves that nobody measured: a fit that takes their motions for the ship's response to something else is refused.


def refuse_unmeasured_waves(estimation: Estimation, records: Sequence[Record]) -> None:
    """Refuse records without any wave force whose motions the other inputs do not explain.

    Unmeasured waves lie in the band of the ship's own motions: as process noise they make coefficients several times
    too large, with small errors.

    Raises:
        InputError: how much is left unexplained, and what to give.
    """
    forces = [name for name in WAVE_FORCES if name in estimation.model.input_names]
    if not forces or any(name in record for name in forces for record in records):
        return
    if np.max(estimation.inflation) <= WHITE_INFLATION and not estimation.has_process_noise:
        return
    remaining, moved = _remaining_and_moved(estimation)
    raise InputError(
        f"the ship moves although no wave is recorded: {_unexplained_text(estimation, remaining, moved)}; "
        "give the elevation zeta with [excitation], or F3 and M5, or the sea under [records.waves], "
        "or record in calm water"
    )


_LEFT_BY_FINS = 0.5  # of the roll, which the fins and the start do not explain: waves roll the ship; chosen


def refuse_roll_in_unmeasured_waves(estimation: Estimation, records: Sequence[Record]) -> None:
    """Refuse records of roll that neither fins nor the start explain, and without the slope of the waves.

    Fins that follow the roll in waves nobody measured make damping of what they do, or a ship that they roll as they
    answer it: one that does not swing.

    Raises:
        InputError: how much is left unexplained, or the damping, and what to give.
    """
    if any("alpha_w" in record for record in records):
        return
    remaining, moved = _remaining_and_moved(estimation)
    share = _share_of_critical_damping(estimation.model)
    if np.all(remaining > _LEFT_BY_FINS * moved):
        cause = _unexplained_text(estimation, remaining, moved)
    elif share > 1.0:
        cause = f"{share:.2g} times critical damping would explain it"
    else:
        return
    raise InputError(
        f"the ship rolls although no wave is recorded: {cause}; "
        "give the wave slope alpha_w, or record with held fins or in calm water"
    )


def _share_of_critical_damping(model: Model) -> float:
    """Return the linear damping over that of a roll that just does not swing, b_1 / (2 sqrt(c_1))."""
    b_1, c_1 = (model.parameters.value_of(name, 0.0) for name in ("b_1", "c_1"))
    return b_1 / (2.0 * math.sqrt(c_1)) if c_1 > 0.0 else math.inf


def _remaining_and_moved(estimation: Estimation) -> tuple[Array, Array]:
    """Root mean squares of what the model leaves by the better of both estimates, and of the motion, (ny,), SI."""
    estimates = (estimation.shooting, estimation.estimate)
    remaining = [np.sqrt(np.nanmean(estimate.residuals() ** 2, axis=0)) for estimate in estimates]
    return np.min(remaining, axis=0), np.nanstd(estimation.shooting.problem.data.measured, axis=0)


def _unexplained_text(estimation: Estimation, remaining: Array, moved: Array) -> str:
    outputs = estimation.shooting.problem.data.outputs
    texts = [_residual_text(channel, r, m) for channel, r, m in zip(outputs, remaining, moved, strict=True)]
    return f"the model leaves {' and '.join(texts)} unexplained"


def _residual_text(channel: str, residual: float, motion: float) -> str:
    factor, unit = display_unit(NOTATION[channel].unit)
    return f"{residual * factor:.2g} of {motion * factor:.2g} {unit} of {NOTATION[channel].meaning}"
