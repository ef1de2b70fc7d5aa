"""A published method: its values for the coefficients, compared with the package's own estimate."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Coefficient, Fit, Method, Prediction, ReferenceEstimate, Search, Solution
from seatrial.core.values import DivergedError, Finding, InputError, ProgressReporter, Severity
from seatrial.data.trial import EstimateMethod
from seatrial.estimation.predict.open_loop import compare_measures, is_steered, rms_errors
from seatrial.physics.simulate.replay import replay

NO_INTERVALS = "none: the method gives none"
"""What a result says of the intervals of a published method."""


@dataclass(frozen=True, eq=False)
class PublishedEstimate:
    """What a published method gives.

    Attributes:
        solution: its point holds the free coefficients in the model's order.
        method: its name, what it minimises, where it starts, its settings.
        search: what it did, where it is a search; record_rms: of the package's own values, as of its restarts.
    """

    solution: Solution
    method: Method
    findings: tuple[Finding, ...] = ()
    search: Search | None = None
    record_rms: float | None = None


def own_estimate_progress(report_progress: ProgressReporter | None) -> ProgressReporter | None:
    """Return what reports the package's own estimate next to a published method: each line is marked as such."""
    return None if report_progress is None else lambda text: report_progress(f"own estimate: {text}")


def published_fit(reference: Fit, estimate: PublishedEstimate, cpu_s: float) -> Fit:
    """Return the fit of a published method; the package's own stands in it as its reference.

    Every run is simulated from the initial state that the package's own fit has for it, without offsets.

    Args:
        reference: the package's own fit of the same records.
        cpu_s: processor time of the package's own estimate [s].
    """
    names = reference.model.parameters.free_names
    values = dict(zip(names, map(float, estimate.solution.point), strict=True))
    model = reference.model.with_values(values)
    predictions, findings = _predictions(reference, model)
    return replace(
        reference,
        model=model,
        coefficients=tuple(_without_interval(c, values) for c in reference.coefficients),
        covariance=np.empty((0, 0)),
        solution=estimate.solution,
        method=estimate.method,
        offsets=(),
        channel_noise=(),
        residuals=(),
        predictions=predictions,
        findings=(*reference.findings, *estimate.findings, *_outside_bounds(model), *findings),
        identifiability=None,
        noise_model=None,
        candidate_models=(),
        interval_basis=None,
        k_step_errors=(),
        frequency_responses=(),
        seakeeping=None,
        roll=None,
        search=estimate.search,
        reference=_reference(reference, cpu_s, estimate.record_rms),
    )


def _without_interval(c: Coefficient, values: dict[str, float]) -> Coefficient:
    if c.fixed:
        return c
    return replace(c, estimate=values[c.name], standard_error=None, lower=None, upper=None, prior_mean=None,
                   prior_standard_deviation=None)  # fmt: skip


def _outside_bounds(model: Model) -> list[Finding]:
    """A warning for every coefficient that a method which knows no bounds puts beyond them."""
    return [
        Finding(
            Severity.WARNING, "outside-bounds", f"the method puts coefficient {p.name} outside its bounds",
            f"{p.value:g}, bounds {p.lower:g} to {p.upper:g}", "take the package's own estimate, which stays within",
        )
        for p in model.parameters.free
        if not p.lower <= p.value <= p.upper
    ]  # fmt: skip


def _predictions(reference: Fit, model: Model) -> tuple[tuple[Prediction, ...], list[Finding]]:
    """All runs simulated with the method's values, and a warning for each that diverges."""
    predictions, findings = [], []
    length = reference.ship.particulars.get("L", 0.0)
    for p in reference.predictions:
        try:
            simulated = replay(model, p.simulated)
        except DivergedError as error:
            text = f"with the coefficients of the method run '{p.record}' cannot be simulated"
            findings.append(Finding(Severity.WARNING, "diverged", text, str(error), "do not use them"))
            continue
        measures = compare_measures(p.measured, simulated, length) if is_steered(p.measured, model) else {}
        predictions.append(
            Prediction(p.record, p.role, p.measured, simulated, rms_errors(p.measured, simulated), measures,
                       p.initial_seconds, p.extrapolation)
        )  # fmt: skip
    return tuple(predictions), findings


def _reference(fit: Fit, cpu_s: float, record_rms: float | None) -> ReferenceEstimate:
    errors = {p.record: p.rms for p in fit.predictions}
    return ReferenceEstimate(fit.coefficients, fit.method, fit.solution.evaluations, cpu_s, errors, record_rms)


def refuse_options(method: EstimateMethod, *, choose: bool, compare: bool) -> None:
    """Refuse what belongs to the package's own estimate where a published method is named.

    Raises:
        InputError: models are to be chosen from, or other estimators compared.
    """
    if method.is_published and (choose or compare):
        option = "--choose" if choose else "--compare"
        raise InputError(
            f"{option} goes with the package's own estimate, and method '{method}' is compared with that one anyway; "
            f"leave out {option}, or the method"
        )
