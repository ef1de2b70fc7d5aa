"""Records and a model in, a fit out: the decision table of the estimator (docs/estimation.md)."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.equations import Model
from seatrial.identify.estimate import Estimate, colour, estimate, residual_spread
from seatrial.identify.intervals import intervals
from seatrial.identify.settings import HUBER, SEGMENT_SHIP_LENGTHS, WHITE_INFLATION, WINDOW_SHIP_LENGTHS, Settings
from seatrial.identify.start import weak_start
from seatrial.identify.states import hidden_states
from seatrial.information.covariance import Interval
from seatrial.problem.output_error import Nuisance, OutputError
from seatrial.problem.segments import compared_outputs, cut
from seatrial.simulate.batch import InputCorrection
from seatrial.values import Array, InputError, Prior, Record

Progress = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Identified:
    """An estimate with its interval and how it came about.

    Attributes:
        made: problem and optimum.
        interval: of all shared unknowns.
        inflation: variance inflation of each channel's residuals; rho: their autocorrelations.
        criterion, reasons: what was used, and why.
    """

    made: Estimate
    interval: Interval
    inflation: Array
    rho: list[Array]
    criterion: str
    reasons: tuple[str, ...]
    elapsed_s: float

    @property
    def model(self) -> Model:
        """The model at the estimate."""
        problem = self.made.problem
        values = dict(zip(problem.free, self.made.shared[: len(problem.free)], strict=True))
        return problem.model.with_values(values)


def ship_length_seconds(records: Sequence[Record], length: float) -> float:
    """L/U: the time in which the ship travels her length at the records' median speed.

    Raises:
        InputError: the records show no speed.
    """
    speeds = []
    for record in records:
        if "u" in record:
            speeds.append(np.nanmedian(np.abs(record["u"])))
        elif {"x0", "y0"} <= set(record.channels):
            speeds.append(np.median(np.hypot(np.diff(record["x0"]), np.diff(record["y0"]))) / record.dt)
    if not speeds or np.median(speeds) <= 0:
        raise InputError("the records show no forward speed; give u or positions, or set estimate.segment_s")
    return length / float(np.median(speeds))


def refuse_without_excitation(model: Model, records: Sequence[Record]) -> None:
    """Refuse records in which no steering input ever moves.

    Raises:
        InputError: which input, and what manoeuvre is needed.
    """
    for name in [i.name for i in model.inputs if i.name == "delta"]:
        if all(name in r and np.ptp(r[name]) < np.radians(0.5) for r in records):
            raise InputError(
                f"no excitation: '{name}' never moves in {', '.join(r.name for r in records)}; "
                "record a zigzag (10/10 or 20/20) or a turning circle"
            )


def _nuisances(settings: Settings) -> tuple[Nuisance, ...]:
    return tuple(
        Nuisance(InputCorrection(i, kind), Prior(1.0 if kind == "gain" else 0.0, spread, "house default"), unit)
        for i, kind, spread, unit in settings.corrections
    )


def _current(settings: Settings) -> tuple[tuple[str, Prior], ...]:
    if settings.current <= 0:
        return ()
    prior = Prior(0.0, settings.current, "house default")
    return (("current_north", prior), ("current_east", prior))


def _problem(
    model: Model, records: Sequence[Record], sessions: Sequence[str], seconds: float, settings: Settings
) -> OutputError:
    outputs = compared_outputs(model, records, settings.channels)
    data = cut(model, records, outputs, None if np.isinf(seconds) else seconds, sessions)
    spread = np.nanstd(data.measured, axis=0)
    return OutputError(model, data, np.maximum(0.1 * spread, 1e-9), _nuisances(settings), _current(settings),
                          substeps=settings.substeps, workers=settings.workers)  # fmt: skip


def _started(problem: OutputError, point: Array) -> Array:
    shared = problem.start()
    names = problem.model.parameters.free_names
    shared[: len(problem.free)] = [point[names.index(n)] for n in problem.free]
    return shared


def identified(
    model: Model,
    records: Sequence[Record],
    sessions: Sequence[str],
    length: float,
    settings: Settings | None = None,
    progress: Progress | None = None,
) -> Identified:
    """Estimate the free parameters of `model` from training records.

    Start by the weak form, then multiple shooting with re-estimated noise; if the residuals are white, whole runs.
    length: ship length in m, which sets the segment length. Sessions name the group of each record's nuisances.

    Raises:
        InputError: no excitation, no free parameter, outputs that cannot be compared, or a search that cannot begin.
    """
    settings = settings or Settings()
    began = time.perf_counter()
    if not model.parameters.free:
        raise InputError(f"model '{model.name}' has no free parameter; free some under [model]")
    refuse_without_excitation(model, records)
    unit = ship_length_seconds(records, length)
    tell = progress or (lambda _: None)
    seconds = settings.segment_seconds or SEGMENT_SHIP_LENGTHS * unit
    problem = _problem(model, records, sessions, seconds, settings)
    tell("weak-form start")
    point = weak_start(model, records, WINDOW_SHIP_LENGTHS * unit)
    local = problem.measured_starts()
    shared = _started(problem, point)
    first = problem.simulated(shared, local)
    if not np.all(np.isfinite(first)):
        shared = problem.start()
        first = problem.simulated(shared, local)
    if np.all(np.isfinite(first)):
        problem = replace(problem, noise=residual_spread(replace(problem, huber=1.0), first - problem.data.measured))
    if settings.robust:
        problem = replace(problem, huber=HUBER)
    made = estimate(problem, shared, local, settings.noise, evaluations=settings.evaluations, progress=progress)
    rho, inflation = colour(made)
    reasons = [f"segments of {seconds:.3g} s: the residuals' correlation inflates variances by {np.max(inflation):.3g}"]
    hidden = hidden_states(model, records)
    if hidden:
        reasons.append(
            f"started at the model's own values: nobody measures {', '.join(hidden)}, a state of the weak form"
        )
    criterion = f"output error, multiple shooting with segments of {seconds:.3g} s"
    if np.isinf(seconds):
        criterion = "output error over whole runs"
    elif settings.segment_seconds is None and np.max(inflation) <= WHITE_INFLATION:
        whole = _whole(made, model, records, sessions, settings, progress)
        if whole is not None:
            made, criterion = whole, "output error over whole runs"
            rho, inflation = colour(made)
            reasons.append(
                "residuals within segments are white and stay so over whole runs: no process noise to guard against"
            )
        else:
            reasons.append("whole runs do not fit within the noise of the segments")
    else:
        reasons.append("coloured residuals mean model error or process noise: short segments keep it from accumulating")
    if np.max(inflation) > WHITE_INFLATION:
        reasons.append("correlated samples count as their effective number, so that priors keep their weight")
    if settings.robust:
        criterion += ", Huber loss"
    interval = intervals(made, inflation)
    return Identified(made, interval, inflation, rho, criterion, tuple(reasons), time.perf_counter() - began)


def _whole(
    made: Estimate,
    model: Model,
    records: Sequence[Record],
    sessions: Sequence[str],
    settings: Settings,
    progress: Progress | None,
) -> Estimate | None:
    """Whole runs from the segments' optimum, if their residuals are no larger (5 %) than within segments."""
    problem = replace(
        _problem(model, records, sessions, np.inf, settings), noise=made.problem.noise, huber=made.problem.huber
    )
    firsts = [int(np.flatnonzero(made.problem.data.run == r)[0]) for r in range(len(problem.data.runs))]
    local = made.optimum.local[firsts]
    if not np.isfinite(problem.cost(made.shared, local)):
        return None
    whole = estimate(problem, made.shared, local, settings.noise, evaluations=settings.evaluations, progress=progress)
    return whole if np.all(whole.problem.noise <= 1.05 * made.problem.noise) else None
