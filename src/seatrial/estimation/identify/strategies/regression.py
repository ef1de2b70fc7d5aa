"""Coefficients by a published regression on the training runs."""

import time
from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Method, Solution, Status
from seatrial.core.text.numbers import significant
from seatrial.core.values import Finding, InputError, Record, Severity
from seatrial.data.trial import EstimateMethod
from seatrial.data.trial.settings import SupportVectorSettings
from seatrial.estimation.identify.strategies.published import NO_INTERVALS, PublishedEstimate
from seatrial.estimation.regress import RegressionEstimate, estimator_of_method


def estimate_by_regression(
    model: Model,
    records: Sequence[Record],
    method: EstimateMethod,
    window_s: float,
    svr: SupportVectorSettings | None = None,
) -> PublishedEstimate:
    """Return what a regression finds for the free coefficients of a model, from the records as they are.

    Args:
        window_s: half width of windows, where the method has any [s].
        svr: settings of the support vectors and of the published pipeline.

    Raises:
        InputError: the model is not linear in its coefficients, or the records do not show every state of it.
    """
    estimator = estimator_of_method(method, window_s, svr)
    began = time.process_time()
    try:
        regression = estimator.estimate(model, records)
    except InputError as error:
        raise InputError(f"method '{method}': {error}") from None
    except np.linalg.LinAlgError:
        raise InputError(f"method '{method}': its equations are singular in these records; add other runs") from None
    seconds = time.process_time() - began
    if not np.all(np.isfinite(regression.values)):
        raise InputError(f"method '{method}': its coefficients are no finite numbers; take another method")
    text = Method(
        estimator.name, "none: linear equations", NO_INTERVALS, ("the method is named by the trial",),
        {"processor time, s": round(seconds, 3)}, method.value,
    )  # fmt: skip
    solution = Solution(regression.values, np.nan, Status.CONVERGED, 1)
    return PublishedEstimate(solution, text, (*regression.findings, *_bias_findings(regression)))


def _bias_findings(regression: RegressionEstimate) -> list[Finding]:
    """What each equation was given besides the model's terms."""
    return [
        Finding(Severity.INFO, "constant", f"the {equation} equation was given a constant besides the model's terms",
                significant(bias, 3))
        for equation, bias in regression.bias.items()
        if bias
    ]  # fmt: skip
