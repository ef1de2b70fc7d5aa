"""Records and a model in, a fit out: the decision table of the estimator (docs/estimation.md)."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Disturbance
from seatrial.core.values import Array, InputError, Progress, Record
from seatrial.estimation.estimate.assemble import output_error
from seatrial.estimation.estimate.decide import PREDICTION_ERROR, Found, decided
from seatrial.estimation.estimate.disturbed import disturbed
from seatrial.estimation.estimate.estimate import Estimate, estimate
from seatrial.estimation.estimate.intervals import Uncertainty, intervals, of_innovations, refuse_few_runs
from seatrial.estimation.estimate.settings import (
    HUBER,
    SEGMENT_SHIP_LENGTHS,
    WINDOW_SHIP_LENGTHS,
    Criterion,
    Intervals,
    Settings,
)
from seatrial.estimation.estimate.start import start
from seatrial.estimation.information.autocorrelation import whiteness_p
from seatrial.estimation.information.covariance import Interval, inverse
from seatrial.physics.hydro.dispersion import G

# of the period seen: windows of the start then have a half width of some .6 periods
PERIOD_SHARE = 0.4
_STILL = float(np.radians(0.5))


@dataclass(frozen=True, eq=False)
class Identified:
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

    made: Estimate
    shooting: Estimate
    uncertainty: Uncertainty
    residuals: Array
    inflation: Array
    rho: list[Array]
    disturbance: Disturbance
    start: str
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
        return self.made.optimum.normal.reduced()[1] if known is None else known

    @property
    def model(self) -> Model:
        """The model at the estimate."""
        problem = self.made.problem
        values = dict(zip(problem.free, self.made.shared[: len(problem.free)], strict=True))
        return problem.model.with_values(values)

    @property
    def has_process_noise(self) -> bool:
        """Whether the coefficients come from prediction error, with noise in the states."""
        return self.disturbance.method == PREDICTION_ERROR


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


def unit_of_time(model: Model, records: Sequence[Record], length: float, segment_seconds: float | None = None) -> float:
    """s in which the ship changes her motion: L/U where she is steered, sqrt(L/g) for a linear model in waves.

    Where she only swings about a rest (a model without heading that is not linear) it is a share of the period seen.

    Raises:
        InputError: a ship is steered and the records show no speed.
    """
    if model.is_affine:
        return float(np.sqrt(length / G))
    if swings(model):
        return PERIOD_SHARE * float(np.median([swing_period(r[model.states[0]], r.dt) for r in records]))
    return ship_length_seconds(records, length, segment_seconds)


def swings(model: Model) -> bool:
    """Whether the ship swings about a rest, with no heading and no speed of her own."""
    return not {"psi", "u"} & {*model.states, *model.input_names}


def swing_period(values: Array, dt: float) -> float:
    """Period [s] at which the motion (n,) about its mean has most power.

    Raises:
        InputError: it does not move, or never swings.
    """
    power = np.abs(np.fft.rfft(values - values.mean(), 4 * len(values)))
    peak = int(np.argmax(power))
    if not power[peak] > 0.0 or peak < 4:
        raise InputError("the motion never swings about its mean; give a longer record, from the release on")
    return 4 * len(values) * dt / peak


def _moving(model: Model, records: Sequence[Record]) -> list[str]:
    """The inputs that move in any of the records."""
    return [n for n in model.input_names if any(n in r and np.ptp(r[n]) > 0.0 for r in records)]


def refuse_without_excitation(model: Model, records: Sequence[Record]) -> None:
    """Refuse records in which the rudder never moves, or no input of a linear model does.

    Raises:
        InputError: which records, and what manoeuvre is needed.
    """
    if model.is_affine and not _moving(model, records):
        raise InputError(
            f"no excitation: none of {', '.join(model.input_names)} moves in {', '.join(r.name for r in records)}; "
            "give wave forces or fin angles, or the wave elevation with [excitation]"
        )
    still = all("delta" in r and np.ptp(r["delta"]) < _STILL for r in records)
    if "delta" in model.input_names and still:
        raise InputError(
            f"no excitation: 'delta' never moves in {', '.join(r.name for r in records)}; "
            "record a zigzag (10/10 or 20/20) or a turning circle"
        )


def identified(
    model: Model,
    records: Sequence[Record],
    sessions: Sequence[str],
    length: float,
    settings: Settings | None = None,
    progress: Progress | None = None,
) -> Identified:
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
    unit = unit_of_time(model, records, length, settings.segment_seconds)
    tell = progress or (lambda _: None)
    tell("weak-form start")
    seconds = settings.segment_seconds or SEGMENT_SHIP_LENGTHS * unit
    chosen = settings.criterion is Criterion.AUTO and settings.segment_seconds is None
    if settings.criterion is Criterion.OUTPUT_ERROR or ((model.is_affine or swings(model)) and chosen):
        seconds = np.inf  # a ship in waves, or rolling out, is stable: nothing to cut short
    begin = start(output_error(model, records, sessions, seconds, settings), records, WINDOW_SHIP_LENGTHS * unit)
    problem = replace(begin.problem, huber=HUBER) if settings.robust else begin.problem
    shooting = estimate(
        problem, begin.shared, begin.local, settings.noise, evaluations=settings.evaluations, progress=progress
    )

    def whole_runs() -> Estimate | None:
        if np.isinf(seconds):
            return shooting
        return _over_whole_runs(shooting, model, records, sessions, settings, progress)

    is_undriven = swings(model) and not _moving(model, records)
    found = decided(shooting, seconds, settings, whole_runs, progress, is_undriven=is_undriven)
    criterion = f"{found.criterion}, Huber loss" if settings.robust else found.criterion
    known = _uncertainty(found, settings, tell)
    return Identified(
        found.made, shooting, known, found.residuals, found.inflation, found.rho, _disturbance(found), begin.how,
        criterion, found.reasons, time.perf_counter() - began,
    )  # fmt: skip


def _uncertainty(found: Found, settings: Settings, tell: Progress) -> Uncertainty:
    def counted(done: int, total: int) -> None:
        tell(f"{settings.intervals}: fit {done} of {total}")

    if found.beside is not None and settings.intervals in (Intervals.AUTO, Intervals.PROFILE):
        interval = disturbed(found.made, found.beside)
        return Uncertainty(interval, information=inverse(interval.covariance))
    if found.noise is None:
        rng = np.random.default_rng(settings.seed)
        return intervals(found.made, found.inflation, settings.intervals, rng, counted)
    return of_innovations(found.noise, settings.intervals)


def _disturbance(found: Found) -> Disturbance:
    """Noise in states and channels; intensities that do not make the innovations white bound the process noise."""
    data = found.made.problem.data
    samples = np.isfinite(data.measured).sum(axis=0)
    tests = [whiteness_p(r, int(n)) for r, n in zip(found.rho, samples, strict=True)]
    return Disturbance(
        "output error" if found.noise is None else PREDICTION_ERROR,
        float(min(1.0, len(tests) * min(tests))),
        found.process,
        dict(zip(data.outputs, map(float, found.made.problem.noise), strict=True)),
        "; ".join(dict.fromkeys(found.reasons)),
    )


def _over_whole_runs(
    made: Estimate,
    model: Model,
    records: Sequence[Record],
    sessions: Sequence[str],
    settings: Settings,
    progress: Progress | None,
) -> Estimate | None:
    """Whole runs from the segments' optimum; None where they diverge there."""
    problem = replace(
        output_error(model, records, sessions, np.inf, settings), noise=made.problem.noise, huber=made.problem.huber
    )
    firsts = [int(np.flatnonzero(made.problem.data.run == r)[0]) for r in range(len(problem.data.runs))]
    local = made.optimum.local[firsts]
    if not np.isfinite(problem.cost(made.shared, local)):
        return None
    return estimate(problem, made.shared, local, settings.noise, evaluations=settings.evaluations, progress=progress)
