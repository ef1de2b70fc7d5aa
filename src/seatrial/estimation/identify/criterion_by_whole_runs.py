"""Where no disturbance explains the residuals, whole runs decide between the criterion and output error.

Prediction error is efficient where a disturbance makes its innovations white. Where none does, model error is taken for
a disturbance that each sample or segment corrects, and what the coefficients predict without corrections is judged by
nothing. So the training runs are simulated as a whole: by the estimate itself, which must not lose runs that output
error over whole runs reproduces, and each by the estimate without it (Stone 1974, J. R. Stat. Soc. B 36, 111). Output
error is used where it does better.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from seatrial.core.equations import Model
from seatrial.core.results.motion_spread import is_lost
from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, InputError, ProgressReporter, Record
from seatrial.data.trial import EstimateMethod, EstimateSettings, FitCriterion
from seatrial.estimation.estimate import Estimation, EstimatorOptions, Runs, estimate_model
from seatrial.estimation.estimate.criterion_choice import SET_BY_TRIAL, WHOLE_RUNS
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop
from seatrial.estimation.predict.prediction_intervals import holdout_model
from seatrial.estimation.predict.session_offsets import session_offsets
from seatrial.estimation.problem.output_error import OutputError

_LEVEL = 0.95
"""One-sided level at which output error must predict better, 1; chosen."""

_WORDS = {"psi_deg": "heading {} deg", "position_m": "position {} m"}


def preferred_estimation(
    estimation: Estimation,
    runs: Runs,
    settings: EstimateSettings,
    options: EstimatorOptions,
    seconds: float,
    report_progress: ProgressReporter | None = None,
) -> Estimation:
    """Return the estimate, or that by output error over whole runs where it reproduces or predicts them better.

    Args:
        estimation: by the decision table; one whose residuals are white, or over whole runs, is returned as it is.
        seconds: of a run's beginning, for its initial state.

    Raises:
        InputError: what `estimate_model` raises.
    """
    is_free = settings.criterion is FitCriterion.AUTO and settings.segment_s is None and not settings.robust
    if not is_free or estimation.whiteness.is_white or estimation.criterion == WHOLE_RUNS:
        return estimation
    incumbent = whole_run_errors(estimation, runs, seconds)
    if not incumbent.left_out and not lost_count(incumbent.fitted, runs.records):
        return estimation
    model = estimation.estimate.problem.model
    try:
        other = estimate_model(
            model, runs, replace(settings, method=EstimateMethod.OUTPUT_ERROR), options, report_progress
        )
    except InputError:  # whole runs diverge from every start: there is nothing to compare
        return estimation
    rival = whole_run_errors(other, runs, seconds)
    reason = _comparison_text(rival, incumbent, estimation.criterion, runs.records)
    if not is_preferred(rival, incumbent, runs.records):
        reason = f"{reason}; {WHOLE_RUNS} is not better beyond the scatter over runs, and is not used"
        noise_model = replace(estimation.noise_model, text=f"{estimation.noise_model.text}; {reason}")
        return replace(estimation, reasons=(*estimation.reasons, reason), noise_model=noise_model)
    noise_model = replace(
        other.noise_model,
        text=f"{estimation.noise_model.text}; {reason}",
        candidates=tuple(replace(c, is_chosen=False) for c in estimation.noise_model.candidates),
    )
    why = (reason, *(r for r in other.reasons if r != SET_BY_TRIAL))
    return replace(other, reasons=why, noise_model=noise_model)


@dataclass(frozen=True)
class WholeRunErrors:
    """Errors of the training runs, each simulated as a whole from its inputs; a run without errors diverges.

    Attributes:
        fitted: by the estimate itself.
        left_out: by the estimates without them, as `left_out_errors`.
    """

    fitted: list[dict[str, float]]
    left_out: list[dict[str, float]]


def whole_run_errors(estimation: Estimation, runs: Runs, seconds: float) -> WholeRunErrors:
    """Return the errors of the training runs by an estimate; seconds: of a beginning, for the initial state."""
    problem, fitted = estimation.estimate.problem, []
    for session, record in zip(runs.sessions, runs.records, strict=True):
        nuisances = session_offsets(estimation, session, record).expected
        fitted.append(_errors_of_run(problem, estimation.model, nuisances, record, seconds))
    return WholeRunErrors(fitted, left_out_errors(estimation, runs, seconds))


def is_preferred(rival: WholeRunErrors, incumbent: WholeRunErrors, records: Sequence[Record]) -> bool:
    """Return whether a rival loses fewer of the runs that it is fitted to and none more left out, or predicts better.

    Coefficients that miss a run although it was fitted, where others reproduce it, are none of that craft.
    """
    if lost_count(rival.fitted, records) < lost_count(incumbent.fitted, records):
        return not (incumbent.left_out and rival.left_out and is_better(incumbent.left_out, rival.left_out, records))
    return bool(incumbent.left_out and rival.left_out) and is_better(rival.left_out, incumbent.left_out, records)


def lost_count(errors: Sequence[dict[str, float]], records: Sequence[Record]) -> int:
    """Return how many runs are lost: they diverge, or are further off than the mean of their motion."""
    return sum(is_lost(each, record) for each, record in zip(errors, records, strict=True))


def left_out_errors(estimation: Estimation, runs: Runs, seconds: float) -> list[dict[str, float]]:
    """Return the rms errors of each run simulated as a whole by the estimate without it; none of one that diverges.

    The estimates are those of the jackknife; an empty list where runs were too few for one.
    """
    problem, points = estimation.estimate.problem, estimation.uncertainty.leave_one_out
    if points is None:
        return []
    errors = []
    for point, session, record in zip(points, runs.sessions, runs.records, strict=True):
        without = holdout_model(problem, point, session, record)
        errors.append(_errors_of_run(problem, without.model, without.nuisances, record, seconds))
    return errors


def _errors_of_run(
    problem: OutputError, model: Model, nuisances: Array, record: Record, seconds: float
) -> dict[str, float]:
    """The rms errors of a run simulated from its inputs; none where the simulation diverges."""
    try:
        run = simulate_open_loop(problem, model, record, nuisances, seconds)
    except InputError:
        return {}
    return rms_errors(record, run.record)


def is_better(
    errors: Sequence[dict[str, float]], rivals: Sequence[dict[str, float]], records: Sequence[Record]
) -> bool:
    """Return whether errors are less than those of a rival beyond their scatter over runs, by a paired t-test.

    Compared are logarithms of ratios, averaged over what each run compares, so that no unit and no run prevails. Where
    simulations diverge, or are further off than the mean of the motion, fewer of them are better: a few runs lost
    among others scatter so much that no test would see them.
    """
    lost, by_rival = lost_count(errors, records), lost_count(rivals, records)
    if lost != by_rival:
        return lost < by_rival
    pairs = [(a, b) for a, b in zip(errors, rivals, strict=True) if a and b]
    if len(pairs) < RUNS_FOR_JACKKNIFE:
        return False
    gains = np.array([np.mean([np.log(b[k] / a[k]) for k in a if k in b]) for a, b in pairs])
    error = float(np.std(gains, ddof=1) / np.sqrt(len(gains)))
    return bool(gains.mean() > stdtrit(len(gains) - 1, _LEVEL) * error)


def mean_text(errors: Sequence[dict[str, float]]) -> str:
    """Return the mean errors over runs of heading and position, or of what a model has in their place."""
    lasting = [e for e in errors if e]
    if not lasting:
        return "all diverge"
    common = [k for k in lasting[0] if all(k in e for e in lasting)]
    shown = [k for k in _WORDS if k in common] or common
    means = {k: float(np.mean([e[k] for e in lasting])) for k in shown}
    texts = [_WORDS.get(k, f"{k} {{}}").format(significant(mean)) for k, mean in means.items()]
    return " and ".join([*texts, *([f"{len(errors) - len(lasting)} diverged"] if len(lasting) < len(errors) else [])])


def _comparison_text(
    rival: WholeRunErrors, incumbent: WholeRunErrors, criterion: str, records: Sequence[Record]
) -> str:
    """What was compared, and the errors: of runs left out where there are enough, else of those that were fitted."""
    lost, by_rival = lost_count(incumbent.fitted, records), lost_count(rival.fitted, records)
    texts = []
    if lost or by_rival:
        texts.append(
            f"simulated as a whole, {lost} of the {len(records)} runs that were fitted are missed by more than their "
            f"own motion by {criterion}, {by_rival} by {WHOLE_RUNS}"
        )
    if incumbent.left_out and rival.left_out:
        texts.append(
            f"left out in turn and predicted as a whole, each by one step of the search without it, which keeps what "
            f"no other run identifies: {mean_text(rival.left_out)} by {WHOLE_RUNS}, "
            f"{mean_text(incumbent.left_out)} by {criterion}; what was held out judges the fit itself"
        )
    return f"no disturbance makes the residuals white, so whole runs were compared: {'; '.join(texts)}"
