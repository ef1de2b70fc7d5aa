"""Estimators by name: the standard regressions, and those that other packages install under ``seatrial.estimators``."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from seatrial._plugins import failure_text, installed, load_plugin
from seatrial.core.values import InputError, spelling_hint
from seatrial.data.trial.settings import EstimateMethod, SupportVectorSettings
from seatrial.estimation.regress.estimators import RegressionEstimator
from seatrial.estimation.regress.standard_estimators import standard_estimators

ENTRY_POINT_GROUP = "seatrial.estimators"
# what an entry point names: from the half width of a window [s] to an estimator
EstimatorFactory = Callable[[float], RegressionEstimator]
_NAMES: Mapping[EstimateMethod, str] = MappingProxyType({
    EstimateMethod.EULER: "Euler differences, least squares",
    EstimateMethod.EULER_DIFFERENCED: "Euler, differenced",
    EstimateMethod.EULER_CENTRED: "Euler, differenced and centred",
    EstimateMethod.OLS: "central differences, least squares",
    EstimateMethod.RIDGE: "central differences, ridge",
    EstimateMethod.TSVD: "central differences, truncated SVD",
    EstimateMethod.LASSO: "central differences, Lasso",
    EstimateMethod.LS_SVM: "central differences, least-squares SVM",
    EstimateMethod.SVR: "central differences, support vectors",
    EstimateMethod.SMOOTHED: "smoothed derivative, least squares",
    EstimateMethod.WEAK_FORM: "weak form, least squares",
    EstimateMethod.WEAK_FORM_RIDGE: "weak form, ridge",
    EstimateMethod.SONG2025: "published pipeline (Song et al. 2025)",
    EstimateMethod.SONG2025_IMPROVED: "published pipeline, improved (Song et al. 2025)",
    EstimateMethod.INSTRUMENTAL_VARIABLES: "weak form, instrumental variables",
})  # fmt: skip
"""Name in tables of each regression that `[estimate] method` can name."""


def available_estimators(
    half_width: float, svr: SupportVectorSettings | None = None
) -> tuple[RegressionEstimator, ...]:
    """Return the standard estimators, then the installed ones; windows of that half width [s].

    Raises:
        InputError: an installed estimator cannot be made; the sentence says which.
    """
    return (
        *standard_estimators(half_width, svr),
        *(_plugin(name, half_width) for name in installed(ENTRY_POINT_GROUP)),
    )


def estimator_named(name: str, half_width: float, svr: SupportVectorSettings | None = None) -> RegressionEstimator:
    """Return the estimator that tables list under a name; windows of that half width [s].

    Raises:
        InputError: there is no such estimator (the nearest is named), or an installed one cannot be made.
    """
    estimators = {estimator.name: estimator for estimator in available_estimators(half_width, svr)}
    if name not in estimators:
        raise InputError(f"unknown estimator '{name}'{spelling_hint(name, list(estimators))}")
    return estimators[name]


def estimator_of_method(
    method: EstimateMethod, half_width: float, svr: SupportVectorSettings | None = None
) -> RegressionEstimator:
    """Return the regression that `[estimate] method` names; windows of that half width [s].

    Raises:
        InputError: the method is no regression.
    """
    if method not in _NAMES:
        raise InputError(f"method '{method}' is no regression; these are {', '.join(_NAMES)}")
    return estimator_named(_NAMES[method], half_width, svr)


def _plugin(name: str, half_width: float) -> RegressionEstimator:
    create: EstimatorFactory = load_plugin(ENTRY_POINT_GROUP, name, InputError)
    try:
        return create(half_width)
    except Exception as error:
        raise InputError(failure_text(installed(ENTRY_POINT_GROUP)[name], error)) from error
