"""The order of a steering model: do the records show a second pole and a zero?"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.results import Prediction
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, InputError, Severity
from seatrial.data.trial import EstimateMethod
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.terms import COMPARED_ERRORS, judged_runs
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop
from seatrial.estimation.predict.session_offsets import new_session_offsets
from seatrial.physics.models.candidate_structures import POLES, SECOND_ORDER_TERMS, ZERO, with_second_order

_APART = 3.0  # standard errors of what lies between zero and pole, from which on they are two; chosen
_MOST_LEFT = 0.95  # of the residuals' standard deviation that is left where no runs are held out; chosen


def second_order_finding(
    task: Identification, estimation: Estimation, predictions: Sequence[Prediction]
) -> tuple[Finding, ...]:
    """Return a warning `held-coupling` where the training runs show a second pole and a zero; else nothing.

    Both orders are fitted by output error over whole runs. The second is named where its zero lies at neither pole and
    held-out runs, simulated whole, are predicted better; where none are held out, it leaves clearly less of the others.
    """
    model = task.trial.model
    wide = with_second_order(model)
    if wide is model or (estimation.whiteness.is_white and not estimation.has_process_noise):
        return ()
    settings = replace(task.settings, method=EstimateMethod.OUTPUT_ERROR)
    try:
        first, second = (estimate_model(m, task.runs, settings, task.options) for m in (model, wide))
        held = _held_out_ratio(second, judged_runs(predictions))
    except InputError:
        return ()
    left = _rms(second.residuals, first) / _rms(first.residuals, first)
    if not _is_shown(second) or (left > _MOST_LEFT if np.isnan(held) else held >= 1.0):
        return ()
    free = second.estimate.problem.free
    values = [
        f"{n} {significant(v, 3)}" for n, v in zip(free, second.estimate.common_parameters.tolist(), strict=False)
    ]
    error = "" if np.isnan(held) else f" and {significant(held, 2)} of the held-out error"
    names = ", ".join(f'"{n}"' for n in free)
    return (Finding(
        Severity.WARNING, "held-coupling",
        f"{enumeration(SECOND_ORDER_TERMS)} are no terms of the model and the training runs speak against it",
        f"tried here: with them {significant(left, 2)} of the residuals{error} are left, with {enumeration(values)}",
        f'under [model] write name = "{wide.name}", free = [{names}]',
    ),)  # fmt: skip


def _is_shown(estimation: Estimation) -> bool:
    """Return whether the zero lies at neither pole: there it leaves a model of first order."""
    free, interval = estimation.estimate.problem.free, estimation.interval
    values = estimation.estimate.common_parameters
    zero, *poles = (free.index(n) for n in (ZERO, *POLES))
    sizes = [abs(values[zero] - values[pole]) for pole in poles]
    weights = [np.eye(1, len(interval.covariance), zero)[0] - np.eye(1, len(interval.covariance), p)[0] for p in poles]
    errors = [float(np.sqrt(w @ interval.covariance @ w)) for w in weights]
    return all(size > _APART * error for size, error in zip(sizes, errors, strict=True))


def _rms(residuals: Array, weights: Estimation) -> float:
    """Return the rms over the noise of an estimate."""
    return float(np.sqrt(np.nanmean((residuals / weights.estimate.problem.noise) ** 2)))


def _held_out_ratio(estimation: Estimation, held: Sequence[Prediction]) -> float:
    """Return the geometric mean over runs, simulated whole, of the errors over those of the fit; NaN: none is held."""
    ratios = list[float]()
    for p in held:
        offsets = new_session_offsets(estimation.estimate, p.measured).expected
        run = simulate_open_loop(estimation.estimate.problem, estimation.model, p.measured, offsets, p.initial_seconds)
        errors = rms_errors(p.measured, run.record)
        ratios += [errors[key] / p.rms[key] for key in COMPARED_ERRORS if p.rms.get(key, 0.0) > 0.0]
    return float(np.exp(np.mean(np.log(ratios)))) if ratios else np.nan
