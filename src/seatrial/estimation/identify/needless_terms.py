"""Terms of a fitted model without which the runs that were held out would be predicted better."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Prediction
from seatrial.core.results.fit import Stability
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Finding, InputError, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.predict.holdout_windows import HoldoutProtocol, split_windows
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop

_ERRORS = {"psi_deg": ("heading", " deg"), "position_m": ("position", " m")}
"""Errors that are compared -> their name and unit; where a run has neither, nothing is."""
LEAST_GAIN = 0.7
"""Mean error without a term over that with it, from which on it is named: 30 % are beyond what one run scatters by
chance between models that predict alike; chosen."""
_DAMPING = frozenset({"X_u", "Y_v", "N_r", "R_0", "K_p"})
"""Resistance and linear damping on the diagonal, which every craft has: water takes energy from motion."""


def needless_term_findings(
    estimation: Estimation, predictions: Sequence[Prediction], course: Stability | None = None
) -> tuple[Finding, ...]:
    """Return a warning `term-worsens-prediction` for the term whose removal helps the held-out runs most; else nothing.

    A term is removed by setting its coefficient to 0 and moving the others with it, as the information has them at
    the least cost (Seber & Wild 1989, Nonlinear Regression, section 5.4: to first order, not fitted again). Terms with
    a prior, those whose bounds exclude 0, and the resistance and damping that every craft has stay.

    course: of a craft that is course unstable, nothing is said: its runs leave any model.
    """
    if course is not None and course.is_unstable:
        return ()
    held = judged_runs(predictions)
    if not held:
        return ()
    names, parameters = estimation.estimate.problem.free, estimation.model.parameters
    removable = [n for n in names if n not in _DAMPING
                 and parameters[n].prior is None and parameters[n].lower <= 0.0 <= parameters[n].upper]  # fmt: skip
    ratios = {name: error_ratio(estimation, _without(estimation, name), held) for name in removable}
    best = min(ratios, key=lambda name: ratios[name], default="")
    if not best or ratios[best] > LEAST_GAIN:
        return ()
    without = _errors(estimation, _without(estimation, best), held)
    texts = [
        f"{label} {significant(max(p.rms[key] for p in held if key in p.rms), 2)}{unit} with it, "
        f"{significant(max(errors[key] for errors in without if key in errors), 2)}{unit} without"
        for key, (label, unit) in _ERRORS.items()
        if any(key in p.rms for p in held) and any(key in errors for errors in without)
    ]
    runs = enumeration([p.record for p in held], 3)  # names that a message holds, chosen
    return (Finding(
        Severity.WARNING, "term-worsens-prediction", f"{runs} would be predicted better with {best} at 0",
        f"{'; '.join(texts)}; the other coefficients moved with it to first order",
        _advice(is_needed=_is_needed(estimation, best)),
        "it follows the training runs and leads away from others",
    ),)  # fmt: skip


def judged_runs(predictions: Sequence[Prediction]) -> list[Prediction]:
    """Return the held-out runs by which models are compared: those that the fit follows, heading or position known."""
    return [p for p in predictions if p.role == "validation" and p.divergence is None and set(_ERRORS) & set(p.rms)]


def in_windows(estimation: Estimation, held: Sequence[Prediction]) -> list[Prediction]:
    """Return each held-out run cut into its longest windows, with the fit's errors there; runs that have none whole."""
    pieces = list[Prediction]()
    for p in held:
        length = max((w.seconds for w in p.windows), default=0.0)
        cut = split_windows(p.measured, HoldoutProtocol(window_s=length)) if length else []
        pieces += [replace(p, measured=piece) for piece in cut or [p.measured]]
    errors = _errors(estimation, estimation.model, pieces)
    return [replace(p, rms=e) for p, e in zip(pieces, errors, strict=True) if np.all(np.isfinite(list(e.values())))]


def _is_needed(estimation: Estimation, name: str) -> bool:
    """Whether the training runs determine the term: its 95 % interval does not contain 0."""
    place = estimation.estimate.problem.free.index(name)
    return abs(estimation.estimate.common_parameters[place]) > float(estimation.interval.half_width[place])


def _advice(*, is_needed: bool) -> str:
    if is_needed:
        return (
            "do not fix it: the training runs determine it; held-out and training runs ask for different models, so "
            "look for what differs between them (a larger angle, another speed, the other side), and for terms that "
            "grow with it"
        )
    return (
        "fix it at 0 and compare; so that the held-out runs stay a test, let training runs left out decide: "
        "seatrial identify TRIAL.toml --choose"
    )


def _without(estimation: Estimation, name: str) -> Model:
    """The model with a coefficient at 0 and the others where the cost is then least, to second order of the cost."""
    free = estimation.estimate.problem.free
    covariance = inverse(estimation.information)[: len(free), : len(free)]
    place = free.index(name)
    values = estimation.estimate.common_parameters[: len(free)]
    moved = values - covariance[:, place] / covariance[place, place] * values[place]
    parameters = estimation.model.parameters
    limits = [(parameters[n].lower, parameters[n].upper) for n in free]
    kept = [float(np.clip(value, *ends)) for value, ends in zip(moved, limits, strict=True)]
    return estimation.model.with_values(dict(zip(free, kept, strict=True)) | {name: 0.0})


def _errors(estimation: Estimation, model: Model, held: Sequence[Prediction]) -> list[dict[str, float]]:
    """Errors of each held-out run as the fit predicts it, by another model; infinite where it diverges."""
    problem, errors = estimation.estimate.problem, list[dict[str, float]]()
    for p in held:
        offsets = np.array([p.offsets[name] for name in problem.session_unknowns])
        try:
            run = simulate_open_loop(problem, model, p.measured, offsets, p.initial_seconds)
        except InputError:
            errors.append(dict.fromkeys(p.rms, np.inf))
        else:
            errors.append(rms_errors(p.measured, run.record))
    return errors


def error_ratio(estimation: Estimation, model: Model, held: Sequence[Prediction]) -> float:
    """Return the geometric mean over runs and quantities of the error by another model over that by the fit."""
    ratios = [
        errors.get(key, np.inf) / p.rms[key]
        for p, errors in zip(held, _errors(estimation, model, held), strict=True)
        for key in _ERRORS
        if p.rms.get(key, 0.0) > 0.0
    ]
    return float(np.exp(np.mean(np.log(ratios)))) if ratios else np.inf
