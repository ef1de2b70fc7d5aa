"""Warnings on a design: limits, ships that leave them, unidentified coefficients, trials that do not confirm it."""

import math

import numpy as np

from seatrial.core.results import Confirmation, ManoeuvrePrecision
from seatrial.core.results.design import count_outside_limits, is_within_limits
from seatrial.core.values import Finding, InputError, Severity
from seatrial.estimation.design.task import DesignTask

# drift angle [rad] beyond which hull models are extrapolated, ours
_FAR_DRIFT = math.radians(45.0)
# share of drawn ships that leave the limits, and of fits that must converge, ours
_MANY_LEAVING, _ENOUGH_CONVERGED = 0.2, 0.8


def refuse_violated_limits(task: DesignTask, designed: ManoeuvrePrecision) -> None:
    """Refuse limits that no orders found keep."""
    if is_within_limits(designed, task.request.limits):
        return
    every = task.request.limits.for_every_ship
    drift = float(np.max([designed.drift, *(designed.sampled_drift if every else ())]))
    room = float(np.max([designed.distance, *(designed.sampled_distance if every else ())]))
    limits = task.request.limits
    if drift > limits.drift:
        excess = f"a drift angle of {math.degrees(drift):.3g} deg, {math.degrees(limits.drift):.3g} deg are allowed"
    else:
        excess = f"{room:.3g} m from the start, {limits.sea_room:.3g} m are allowed"
    whom = "some ship of the prior reaches" if every else "the ship reaches"
    raise InputError(
        f"[design] cannot be kept: under the best of all orders tried {whom} {excess}; widen that limit, shorten the "
        "trial, or narrow the inputs' ranges"
    )


def findings(
    task: DesignTask, designed: ManoeuvrePrecision, confirmation: Confirmation | None, *, is_interrupted: bool
) -> tuple[Finding, ...]:
    """Return everything worth a warning, the gravest first."""
    findings = list[Finding]()
    if is_interrupted:
        findings.append(_warning("interrupted", "the work was interrupted; this is the best so far",
                              "let it finish for a better manoeuvre"))  # fmt: skip
        if not is_within_limits(designed, task.request.limits):
            findings.append(_warning("leaves-limits", "these orders leave the limits", "let the search finish"))
    return (
        *findings,
        *_unidentifiable(task, designed),
        *_limit_violations(task, designed),
        *_confirmation_findings(designed, confirmation),
    )


def _warning(code: str, text: str, advice: str) -> Finding:
    return Finding(Severity.WARNING, code, text, "", advice)


def _unidentifiable(task: DesignTask, designed: ManoeuvrePrecision) -> list[Finding]:
    names = task.model.parameters.free_names
    by_model = designed.relative_error > 1.0
    some = (
        np.any(np.nan_to_num(designed.sampled_relative_error) > 1.0, axis=0) & ~by_model
        if len(designed.sampled_relative_error)
        else np.zeros_like(by_model)
    )
    findings = []
    if by_model.any():
        listed = ", ".join(n for n, bad in zip(names, by_model, strict=True) if bad)
        findings.append(_warning("not-identifiable",
                              f"even this manoeuvre does not identify {listed}: the standard error exceeds the value",
                              "better sensors, a longer trial, wider limits, or give a prior for them"))  # fmt: skip
    if some.any():
        listed = ", ".join(n for n, bad in zip(names, some, strict=True) if bad)
        findings.append(_warning("not-identifiable-drawn",
                              f"for some ship of the prior this manoeuvre does not identify {listed}",
                              "design again after a first trial, with --from and its model file"))  # fmt: skip
    return findings


def _limit_violations(task: DesignTask, designed: ManoeuvrePrecision) -> list[Finding]:
    findings, count = [], len(designed.sampled_relative_error)
    farthest = max([designed.drift, *designed.sampled_drift.tolist()])
    if straying := count_outside_limits(designed, task.request.limits):
        severity = Severity.WARNING if straying > _MANY_LEAVING * count else Severity.INFO
        findings.append(Finding(severity, "straying", f"{straying} of {count} ships drawn from the prior leave the "
                             f"limits under these orders, with up to {_drift_text(farthest)}"
                             f"{max(designed.sampled_distance.tolist()):.0f} m from the start", "",
                             "watch both and abort there; design.every_ship = true binds them, too"))  # fmt: skip
    elif farthest > _FAR_DRIFT:
        findings.append(_warning("drift", f"the manoeuvre reaches a drift angle of {math.degrees(farthest):.0f} deg "
                              "for some ship of the prior", "few models hold so far; give a smaller design.drift, or "
                              "abort there"))  # fmt: skip
    return findings


def _drift_text(farthest: float) -> str:
    return f"{math.degrees(farthest):.0f} deg of drift and " if math.isfinite(farthest) else ""


def _confirmation_findings(designed: ManoeuvrePrecision, confirmation: Confirmation | None) -> list[Finding]:
    findings = []
    if lost := designed.diverged:
        findings.append(
            _warning(
                "lost",
                f"{lost} of {len(designed.sampled_relative_error)} ships drawn from the prior cannot be simulated "
                "under these orders",
                "narrow the prior or the inputs' ranges",
            )
        )
    if confirmation is not None and confirmation.converged_runs < _ENOUGH_CONVERGED * confirmation.runs:
        findings.append(
            _warning(
                "unconfirmed",
                f"only {confirmation.converged_runs} of {confirmation.runs} simulated trials "
                "could be fitted, so that the errors predicted are not confirmed",
                "narrow the prior, measure more channels, or lengthen the trial",
            )
        )
    return findings
