"""Records and a model in, a fit out: the decision table of the estimator (docs/estimation.md)."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.equations import Model
from seatrial.identify.assemble import output_error
from seatrial.identify.estimate import Estimate, colour, estimate
from seatrial.identify.intervals import Uncertainty, intervals, refuse_few_runs
from seatrial.identify.settings import HUBER, SEGMENT_SHIP_LENGTHS, WHITE_INFLATION, WINDOW_SHIP_LENGTHS, Settings
from seatrial.identify.start import start
from seatrial.information.covariance import Interval
from seatrial.values import Array, InputError, Progress, Record

_STILL = float(np.radians(0.5))


@dataclass(frozen=True, eq=False)
class Identified:
    """An estimate with its interval and how it came about.

    Attributes:
        made: problem and optimum.
        uncertainty: intervals of all shared unknowns, and the estimates they rest on.
        inflation: variance inflation of each channel's residuals; rho: their autocorrelations.
        start: where the search began, in words.
        criterion, reasons: what was used, and why.
    """

    made: Estimate
    uncertainty: Uncertainty
    inflation: Array
    rho: list[Array]
    start: str
    criterion: str
    reasons: tuple[str, ...]
    elapsed_s: float

    @property
    def interval(self) -> Interval:
        """Of all shared unknowns."""
        return self.uncertainty.interval

    @property
    def model(self) -> Model:
        """The model at the estimate."""
        problem = self.made.problem
        values = dict(zip(problem.free, self.made.shared[: len(problem.free)], strict=True))
        return problem.model.with_values(values)


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


def refuse_without_excitation(model: Model, records: Sequence[Record]) -> None:
    """Refuse records in which the rudder never moves.

    Raises:
        InputError: which records, and what manoeuvre is needed.
    """
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

    Start by the weak form, then multiple shooting with re-estimated noise; whole runs if the residuals are white and
    nobody asked for a segment length.
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
    unit = ship_length_seconds(records, length, settings.segment_seconds)
    tell = progress or (lambda _: None)
    seconds = settings.segment_seconds or SEGMENT_SHIP_LENGTHS * unit
    tell("weak-form start")
    begin = start(output_error(model, records, sessions, seconds, settings), records, WINDOW_SHIP_LENGTHS * unit)
    problem = replace(begin.problem, huber=HUBER) if settings.robust else begin.problem
    made = estimate(
        problem, begin.shared, begin.local, settings.noise, evaluations=settings.evaluations, progress=progress
    )
    rho, inflation = colour(made)
    reasons = [f"segments of {seconds:.3g} s: the residuals' correlation inflates variances by {np.max(inflation):.3g}"]
    criterion = f"output error, multiple shooting with segments of {seconds:.3g} s"
    if np.isinf(seconds):
        criterion = "output error over whole runs"
    elif np.max(inflation) > WHITE_INFLATION:
        reasons.append("coloured residuals mean model error or process noise: short segments keep it from accumulating")
    elif settings.segment_seconds is not None:
        reasons.append("residuals within segments are white; their length was asked for")
    elif (whole := _over_whole_runs(made, model, records, sessions, settings, progress)) is not None:
        made, criterion = whole, "output error over whole runs"
        rho, inflation = colour(made)
        reasons.append("residuals are white within segments and over whole runs: no process noise to guard against")
    else:
        reasons.append("whole runs do not fit within the noise of the segments")
    if np.max(inflation) > WHITE_INFLATION:
        reasons.append("correlated samples count as their effective number, so that priors keep their weight")
    if settings.robust:
        criterion += ", Huber loss"

    def counted(done: int, total: int) -> None:
        tell(f"{settings.intervals}: fit {done} of {total}")

    known = intervals(made, inflation, settings.intervals, np.random.default_rng(settings.seed), counted)
    return Identified(made, known, inflation, rho, begin.how, criterion, tuple(reasons), time.perf_counter() - began)


def _over_whole_runs(
    made: Estimate,
    model: Model,
    records: Sequence[Record],
    sessions: Sequence[str],
    settings: Settings,
    progress: Progress | None,
) -> Estimate | None:
    """Whole runs from the segments' optimum, if their residuals are no larger (5 %) than within segments."""
    problem = replace(
        output_error(model, records, sessions, np.inf, settings), noise=made.problem.noise, huber=made.problem.huber
    )
    firsts = [int(np.flatnonzero(made.problem.data.run == r)[0]) for r in range(len(problem.data.runs))]
    local = made.optimum.local[firsts]
    if not np.isfinite(problem.cost(made.shared, local)):
        return None
    whole = estimate(problem, made.shared, local, settings.noise, evaluations=settings.evaluations, progress=progress)
    return whole if np.all(whole.problem.noise <= 1.05 * made.problem.noise) else None
