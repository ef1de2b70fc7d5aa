"""Other estimators on the records of a fit: their coefficients, and the runs simulated with them.

Every estimator gets the training runs as they are: no offsets, no priors, no bounds. Its model then simulates every run
open loop from the recorded inputs and from the initial state that the fit gave that run: coefficients alone differ.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Baseline, Coefficient, Fit, OpenLoopScores, Prediction
from seatrial.core.results.prediction import NO_COMPARISON
from seatrial.core.values import Finding, InputError, ProgressReporter, Record, Severity
from seatrial.data.trial import SEARCHES, SearchFitness, SearchSettings, Trial
from seatrial.data.trial.settings import SupportVectorSettings
from seatrial.estimation.identify.search import estimate_by_search, simulated_starts, training_predictions
from seatrial.estimation.predict.open_loop import rms_errors
from seatrial.estimation.regress.estimators import RegressionEstimator
from seatrial.estimation.regress.operators import RegressionMotion, Weak, features
from seatrial.estimation.regress.pipeline import available_estimators
from seatrial.estimation.regress.term_selection import select_terms
from seatrial.numerics.optimise import SEARCH_METHODS
from seatrial.physics.simulate.replay import replay

_CORRELATED_CHANNELS = ("u", "v", "r")
_NO_COMPARISON_TEXT = "no other estimators to compare: "


def with_baselines(
    fit: Fit,
    train: Sequence[Record],
    seconds: float,
    report_progress: ProgressReporter | None = None,
    svr: SupportVectorSettings | None = None,
) -> Fit:
    """The fit with the regressions on its training runs, or with a finding that says why there can be none."""
    try:
        estimators = available_estimators(seconds, svr)
        return replace(fit, baselines=compare_estimators(fit, train, estimators, report_progress))
    except InputError as error:
        said = Finding(Severity.INFO, NO_COMPARISON, f"{_NO_COMPARISON_TEXT}{error}")
        return replace(fit, findings=(*fit.findings, said))


def with_term_selection(fit: Fit, train: Sequence[Record], seconds: float) -> Fit:
    """The fit with Lasso's choice of terms beside its own, or with a finding that says why there is none."""
    try:
        return replace(fit, term_selection=select_terms(fit.model, train, Weak(seconds)))
    except InputError as error:
        reason = Finding(Severity.INFO, NO_COMPARISON, f"no terms to select: {error}")
        return replace(fit, findings=(*fit.findings, reason))


def with_search_baselines(fit: Fit, trial: Trial, seed: int, report_progress: ProgressReporter | None = None) -> Fit:
    """The fit with one search of each published kind over its training runs, behind the regressions if there are any.

    A search that cannot begin says why.

    Args:
        trial: its bounds, iterations and population are those of the searches.
        seed: of their random numbers.
    """
    settings = replace(trial.estimate.search or SearchSettings(), restarts=1, fitness=SearchFitness.RECORD)
    baselines = list(fit.baselines) or [*_fit_as_baselines(fit), *_failed_regressions(fit)]
    runs = training_predictions(fit)
    records, starts = [run.measured for run in runs], simulated_starts(fit.model, runs)
    for method in SEARCHES:
        named = replace(trial, estimate=replace(trial.estimate, method=method, search=settings))
        title = f"{SEARCH_METHODS[method].title} ({method})"
        try:
            found = estimate_by_search(named, records, starts, seed, report_progress)
        except InputError as error:
            baselines.append(Baseline(title, note=str(error)))
            continue
        names = fit.model.parameters.free_names
        values = dict(zip(names, found.solution.point.tolist(), strict=True))
        baselines.append(_with_differences(fit, _simulated_baseline(fit, Baseline(title, values))))
    findings = tuple(f for f in fit.findings if f.code != NO_COMPARISON)
    return replace(fit, baselines=tuple(baselines), findings=findings)


def _failed_regressions(fit: Fit) -> list[Baseline]:
    """Why the regressions could not be compared."""
    return [Baseline("regressions", note=f.message.removeprefix(_NO_COMPARISON_TEXT)) for f in fit.findings
            if f.code == NO_COMPARISON]  # fmt: skip


def _simulated_baseline(fit: Fit, baseline: Baseline, model: Model | None = None) -> Baseline:
    """With the errors of all runs that are simulated with its values, or with a `model` of terms beyond the fit's."""
    ship = model or fit.model.with_values(dict(baseline.values))
    training, validation = (
        simulation_errors(ship, _predictions_of_role(fit, role)) for role in ("training", "validation")
    )
    return replace(baseline, training=training, validation=validation)


def compare_estimators(
    fit: Fit,
    train: Sequence[Record],
    estimators: Sequence[RegressionEstimator],
    report_progress: ProgressReporter | None = None,
) -> tuple[Baseline, ...]:
    """The fit, then each estimator on the training runs; one that fails says why and stops none of the others.

    A fit with offsets stands there again without them: the others have none, so that this is like for like.

    Raises:
        InputError: the model is not linear in its free coefficients, or the runs do not show every state of it.
    """
    for record in train:
        features(fit.model, RegressionMotion.from_record(fit.model, record))
    report = report_progress or (lambda _: None)
    baselines = _fit_as_baselines(fit)
    for estimator in estimators:
        report(f"other estimators: {estimator.name}")
        baselines.append(_baseline(fit, train, estimator))
    return tuple(baselines)


def simulation_errors(model: Model, predictions: Sequence[Prediction]) -> OpenLoopScores:
    """The runs of a fit's predictions simulated with another model of the same equations."""
    runs, diverged = [], []
    for p in predictions:
        try:
            runs.append((p.measured, replay(model, p.simulated)))
        except InputError:
            diverged.append(p.record)
    return OpenLoopScores(diverged=tuple(diverged)) if diverged else pooled_errors(runs)


def pooled_errors(runs: Sequence[tuple[Record, Record]]) -> OpenLoopScores:
    """What pairs of measured and simulated runs say together."""
    errors = [rms_errors(measured, simulated) for measured, simulated in runs]
    likeness = [correlation(measured, simulated) for measured, simulated in runs]
    return OpenLoopScores(
        {key: float(np.sqrt(np.mean([e[key] ** 2 for e in errors if key in e]))) for key in _common_keys(errors)},
        {key: float(np.mean([c[key] for c in likeness if key in c])) for key in _common_keys(likeness)},
    )


def correlation(measured: Record, simulated: Record) -> dict[str, float]:
    """Pearson's coefficient of u, v and r, as far as measured and not constant (Song et al. 2025 call it CC)."""
    coefficients = {}
    for symbol in _CORRELATED_CHANNELS:
        if symbol in measured and symbol in simulated:
            a, b = measured[symbol], simulated[symbol]
            known = np.isfinite(a) & np.isfinite(b)
            if known.any() and np.ptp(a[known]) > 0.0 and np.ptp(b[known]) > 0.0:
                coefficients[symbol] = float(np.corrcoef(a[known], b[known])[0, 1])
    return coefficients


def _common_keys(tables: Sequence[dict[str, float]]) -> list[str]:
    return list(dict.fromkeys(key for table in tables for key in table))


def _fit_as_baselines(fit: Fit) -> list[Baseline]:
    """The fit as it stands, and with offsets at zero where it has any."""
    train, held = _predictions_of_role(fit, "training"), _predictions_of_role(fit, "validation")
    as_it_stands = [pooled_errors([(p.measured, p.simulated) for p in runs]) for runs in (train, held)]
    pairs = {f"this fit: {fit.method.criterion}": as_it_stands}
    if fit.offsets:
        pairs["this fit, its offsets set to zero"] = [simulation_errors(fit.model, runs) for runs in (train, held)]
    values = {c.name: c.estimate for c in _free_coefficients(fit)}
    return [
        _with_differences(fit, Baseline(name, values, training=fitted, validation=kept, is_fit=True))
        for name, (fitted, kept) in pairs.items()
    ]


def _baseline(fit: Fit, train: Sequence[Record], estimator: RegressionEstimator) -> Baseline:
    try:
        regression = estimator.estimate(fit.model, train)
    except InputError as error:
        return Baseline(estimator.name, note=str(error))
    except np.linalg.LinAlgError:
        return Baseline(estimator.name, note="its equations are singular in these records")
    if not np.all(np.isfinite(regression.values)):
        return Baseline(estimator.name, note="its coefficients are no finite numbers", findings=regression.findings)
    values = dict(zip(fit.model.parameters.free_names, regression.values.tolist(), strict=True))
    rival = Baseline(estimator.name, values, bias=regression.bias, test=regression.test, findings=regression.findings)
    return _with_differences(fit, _simulated_baseline(fit, rival, regression.in_model(fit.model)))


def _with_differences(fit: Fit, baseline: Baseline) -> Baseline:
    """With its distances from the fit and, where it is known, from the truth."""
    gap = {
        c.name: (baseline.values[c.name] - c.estimate) / c.standard_error
        for c in _free_coefficients(fit)
        if c.standard_error
    }
    error = {c.name: baseline.values[c.name] / c.truth - 1.0 for c in _free_coefficients(fit) if c.truth}
    return replace(baseline, normalised_difference=gap, error=error)


def _free_coefficients(fit: Fit) -> list[Coefficient]:
    return [c for c in fit.coefficients if not c.fixed]


def _predictions_of_role(fit: Fit, role: str) -> list[Prediction]:
    return [p for p in fit.predictions if p.role == role]
