"""Records and a model in, a fit out: the decision table of the estimator (docs/estimation.md)."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import NoiseModel
from seatrial.core.values import Array, InputError, ProgressReporter, Record
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.estimation.estimate.criterion_choice import PREDICTION_ERROR, CriterionChoice, choose_criterion
from seatrial.estimation.estimate.intervals import (
    Uncertainty,
    estimate_uncertainty,
    innovations_uncertainty,
    refuse_few_runs,
)
from seatrial.estimation.estimate.point_estimate import PointEstimate, fit_output_error
from seatrial.estimation.estimate.process_noise_interval import process_noise_interval
from seatrial.estimation.estimate.settings import (
    HUBER_LIMIT,
    SEGMENT_SHIP_LENGTHS,
    WEAK_FORM_SHIP_LENGTHS,
    FitCriterion,
    IntervalMethod,
    Settings,
)
from seatrial.estimation.estimate.start import find_start
from seatrial.estimation.information.autocorrelation import whiteness_p
from seatrial.estimation.information.covariance import Interval, inverse
from seatrial.physics.hydro.dispersion import G

# of the period seen: windows of the start then have a half width of some .6 periods
PERIOD_SHARE = 0.4
_MIN_RUDDER_RANGE = float(np.radians(0.5))


@dataclass(frozen=True, eq=False)
class Estimation:
    """An estimate with its interval and how it came about.

    Attributes:
        made: problem and optimum.
        shooting: the estimate over segments that came first, by which models are compared.
        uncertainty: intervals of all shared unknowns, and the estimates they rest on.
        residuals: simulated minus measured, under prediction error one step ahead, (rows, ny), SI.
        inflation: variance inflation of each channel's residuals; rho: their autocorrelations.
        disturbance: what is between model and records, and why this criterion.
        start: where the search began, in words.
        criterion, reasons: what was used, and why.
    """

    estimate: PointEstimate
    shooting: PointEstimate
    uncertainty: Uncertainty
    residuals: Array
    inflation: Array
    rho: list[Array]
    noise_model: NoiseModel
    start_method: str
    criterion: str
    reasons: tuple[str, ...]
    elapsed_s: float

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
        problem = self.estimate.problem
        values = dict(zip(problem.free, self.estimate.common_parameters[: len(problem.free)], strict=True))
        return problem.model.with_values(values)

    @property
    def has_process_noise(self) -> bool:
        """Whether the coefficients come from prediction error, with noise in the states."""
        return self.noise_model.method == PREDICTION_ERROR


def ship_length_seconds(records: Sequence[Record], length: float, segment_seconds: float | None = None) -> float:
    """L/U: the time in which the ship travels her length at the records' median speed.

    Records without any speed take it from the segment length that was asked for, if it is finite.

    Raises:
        InputError: the records show no speed.
    """
    speeds = []
    for record in records:
        if "u" in record:
            speeds.append(np.nanmedian(np.abs(record["u"])))
        elif {"x0", "y0"} <= set(record.channels):
            speeds.append(np.median(np.hypot(np.diff(record["x0"]), np.diff(record["y0"]))) / record.dt)
    if not speeds and segment_seconds is not None and np.isfinite(segment_seconds):
        return segment_seconds / SEGMENT_SHIP_LENGTHS
    if not speeds or np.median(speeds) <= 0:
        raise InputError("the records show no forward speed; give u or positions, or set estimate.segment_s")
    return length / float(np.median(speeds))


def characteristic_time(
    model: Model, records: Sequence[Record], length: float, segment_seconds: float | None = None
) -> float:
    """s in which the ship changes her motion: L/U where she is steered, sqrt(L/g) for a linear model in waves.

    Where she only swings about a rest (a model without heading that is not linear) it is a share of the period seen.

    Raises:
        InputError: a ship is steered and the records show no speed.
    """
    if model.is_affine:
        return float(np.sqrt(length / G))
    if is_pure_roll(model):
        return PERIOD_SHARE * float(np.median([dominant_period(r[model.states[0]], r.dt) for r in records]))
    return ship_length_seconds(records, length, segment_seconds)


def is_pure_roll(model: Model) -> bool:
    """Whether the ship swings about a rest, with no heading and no speed of her own."""
    return not {"psi", "u"} & {*model.states, *model.input_names}


def dominant_period(values: Array, dt: float) -> float:
    """Period [s] at which the motion (n,) about its mean has most power.

    Raises:
        InputError: it does not move, or never swings.
    """
    power = np.abs(np.fft.rfft(values - values.mean(), 4 * len(values)))
    peak = int(np.argmax(power))
    if not power[peak] > 0.0 or peak < 4:
        raise InputError("the motion never swings about its mean; give a longer record, from the release on")
    return 4 * len(values) * dt / peak


def _moving_inputs(model: Model, records: Sequence[Record]) -> list[str]:
    """The inputs that move in any of the records."""
    return [n for n in model.input_names if any(n in r and np.ptp(r[n]) > 0.0 for r in records)]


def refuse_without_excitation(model: Model, records: Sequence[Record]) -> None:
    """Refuse records in which the rudder never moves, or no input of a linear model does.

    Raises:
        InputError: which records, and what manoeuvre is needed.
    """
    if model.is_affine and not _moving_inputs(model, records):
        raise InputError(
            f"no excitation: none of {', '.join(model.input_names)} moves in {', '.join(r.name for r in records)}; "
            "give wave forces or fin angles, or the wave elevation with [excitation]"
        )
    still = all("delta" in r and np.ptp(r["delta"]) < _MIN_RUDDER_RANGE for r in records)
    if "delta" in model.input_names and still:
        raise InputError(
            f"no excitation: 'delta' never moves in {', '.join(r.name for r in records)}; "
            "record a zigzag (10/10 or 20/20) or a turning circle"
        )


def estimate_model(
    model: Model,
    records: Sequence[Record],
    sessions: Sequence[str],
    length: float,
    settings: Settings | None = None,
    report_progress: ProgressReporter | None = None,
) -> Estimation:
    """Estimate the free parameters of `model` from training records.

    Start by the weak form, then multiple shooting with re-estimated noise; then, by the decision table, output error
    over whole runs or prediction error with process noise, unless a criterion or a segment length was asked for.
    length: ship length in m, which sets the segment length. Sessions name the group of each record's nuisances.

    Raises:
        InputError: no excitation, no free parameter, outputs that cannot be compared, or a search that cannot begin.
    """
    settings = settings or Settings()
    began = time.perf_counter()
    if not model.parameters.free:
        raise InputError(f"model '{model.name}' has no free parameter; free some under [model]")
    refuse_without_excitation(model, records)
    refuse_few_runs(settings.intervals, len(records))
    unit = characteristic_time(model, records, length, settings.segment_seconds)
    tell = report_progress or (lambda _: None)
    tell("weak-form start")
    seconds = settings.segment_seconds or SEGMENT_SHIP_LENGTHS * unit
    chosen = settings.criterion is FitCriterion.AUTO and settings.segment_seconds is None
    if settings.criterion is FitCriterion.OUTPUT_ERROR or ((model.is_affine or is_pure_roll(model)) and chosen):
        seconds = np.inf  # a ship in waves, or rolling out, is stable: nothing to cut short
    begin = find_start(
        output_error_problem(model, records, sessions, seconds, settings), records, WEAK_FORM_SHIP_LENGTHS * unit
    )
    problem = replace(begin.problem, huber=HUBER_LIMIT) if settings.robust else begin.problem
    shooting = fit_output_error(
        problem,
        begin.common_parameters,
        begin.initial_states,
        settings.noise,
        evaluations=settings.evaluations,
        report_progress=report_progress,
    )

    def whole_runs() -> PointEstimate | None:
        if np.isinf(seconds):
            return shooting
        return _fit_whole_runs(shooting, model, records, sessions, settings, report_progress)

    is_undriven = is_pure_roll(model) and not _moving_inputs(model, records)
    found = choose_criterion(shooting, seconds, settings, whole_runs, report_progress, is_unforced=is_undriven)
    criterion = f"{found.criterion}, Huber loss" if settings.robust else found.criterion
    known = _uncertainty(found, settings, tell)
    return Estimation(
        found.estimate, shooting, known, found.residuals, found.inflation, found.rho, _noise_model(found), begin.origin,
        criterion, found.reasons, time.perf_counter() - began,
    )  # fmt: skip


def _uncertainty(choice: CriterionChoice, settings: Settings, report_progress: ProgressReporter) -> Uncertainty:
    def counted(done: int, total: int) -> None:
        report_progress(f"{settings.intervals}: fit {done} of {total}")

    if choice.implied_noise is not None and settings.intervals in (IntervalMethod.AUTO, IntervalMethod.PROFILE):
        interval = process_noise_interval(choice.estimate, choice.implied_noise)
        return Uncertainty(interval, information=inverse(interval.covariance))
    if choice.process_noise is None:
        rng = np.random.default_rng(settings.seed)
        return estimate_uncertainty(choice.estimate, choice.inflation, settings.intervals, rng, counted)
    return innovations_uncertainty(choice.process_noise, settings.intervals)


def _noise_model(choice: CriterionChoice) -> NoiseModel:
    """Noise in states and channels; intensities that do not make the innovations white bound the process noise."""
    data = choice.estimate.problem.data
    samples = np.isfinite(data.measured).sum(axis=0)
    tests = [whiteness_p(r, int(n)) for r, n in zip(choice.rho, samples, strict=True)]
    return NoiseModel(
        "output error" if choice.process_noise is None else PREDICTION_ERROR,
        float(min(1.0, len(tests) * min(tests))),
        choice.process_intensities,
        dict(zip(data.outputs, map(float, choice.estimate.problem.noise), strict=True)),
        "; ".join(dict.fromkeys(choice.reasons)),
    )


def _fit_whole_runs(
    shooting: PointEstimate,
    model: Model,
    records: Sequence[Record],
    sessions: Sequence[str],
    settings: Settings,
    report_progress: ProgressReporter | None,
) -> PointEstimate | None:
    """Whole runs from the segments' optimum; None where they diverge there."""
    problem = replace(
        output_error_problem(model, records, sessions, np.inf, settings),
        noise=shooting.problem.noise,
        huber=shooting.problem.huber,
    )
    firsts = [int(np.flatnonzero(shooting.problem.data.run == r)[0]) for r in range(len(problem.data.runs))]
    local = shooting.optimum.local[firsts]
    if not np.isfinite(problem.cost(shooting.common_parameters, local)):
        return None
    return fit_output_error(
        problem,
        shooting.common_parameters,
        local,
        settings.noise,
        evaluations=settings.evaluations,
        report_progress=report_progress,
    )
