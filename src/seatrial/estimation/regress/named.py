"""Estimators by name: the standard regressions, and those that other packages install under ``seatrial.estimators``."""

from collections.abc import Callable

from seatrial._plugins import failure_text, installed, load_plugin
from seatrial.core.values import InputError, spelling_hint
from seatrial.estimation.regress.estimators import RegressionEstimator
from seatrial.estimation.regress.standard_estimators import standard_estimators

ENTRY_POINT_GROUP = "seatrial.estimators"
# what an entry point names: from the half width of a window [s] to an estimator
EstimatorFactory = Callable[[float], RegressionEstimator]


def available_estimators(half_width: float) -> tuple[RegressionEstimator, ...]:
    """Return the standard estimators, then the installed ones; windows of that half width [s].

    Raises:
        InputError: an installed estimator cannot be made; the sentence says which.
    """
    return (*standard_estimators(half_width), *(_plugin(name, half_width) for name in installed(ENTRY_POINT_GROUP)))


def estimator_named(name: str, half_width: float) -> RegressionEstimator:
    """Return the estimator that tables list under a name; windows of that half width [s].

    Raises:
        InputError: there is no such estimator (the nearest is named), or an installed one cannot be made.
    """
    estimators = {estimator.name: estimator for estimator in available_estimators(half_width)}
    if name not in estimators:
        raise InputError(f"unknown estimator '{name}'{spelling_hint(name, list(estimators))}")
    return estimators[name]


def _plugin(name: str, half_width: float) -> RegressionEstimator:
    create: EstimatorFactory = load_plugin(ENTRY_POINT_GROUP, name, InputError)
    try:
        return create(half_width)
    except Exception as error:
        raise InputError(failure_text(installed(ENTRY_POINT_GROUP)[name], error)) from error
