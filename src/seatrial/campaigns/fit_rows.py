"""A fit as rows of a campaign's table: free coefficients, and scores of runs held out."""

from collections.abc import Mapping
from types import MappingProxyType

from seatrial.campaigns.work import Row
from seatrial.core.results import Fit

COEFFICIENT, SCORE = "coefficient", "score"
_NO_BOUND: Mapping[str, float] = MappingProxyType({})


def fit_rows(fit: Fit, bound: Mapping[str, float] = _NO_BOUND) -> list[Row]:
    """Return a row for each free coefficient, and one for each error of a run that was not fitted.

    Args:
        bound: coefficient -> Cramer-Rao bound of its standard error, SI.
    """
    return [*_coefficients(fit, bound), *_scores(fit)]


def _coefficients(fit: Fit, bound: Mapping[str, float]) -> list[Row]:
    return [
        {
            "row": COEFFICIENT, "run": None, "name": c.name, "unit": c.unit, "estimate": c.estimate,
            "standard_error": c.standard_error, "lower": c.lower, "upper": c.upper, "truth": c.truth,
            "bound": bound.get(c.name),
        }
        for c in fit.coefficients if not c.fixed
    ]  # fmt: skip


def _scores(fit: Fit) -> list[Row]:
    units = {"psi_deg": "deg", "theta_deg": "deg", "phi_deg": "deg", "position_m": "m", "r": "rad/s", "z": "m"}
    rows: list[Row] = []
    for prediction in fit.validation:
        rows += [
            {"row": SCORE, "run": prediction.record, "name": f"rms {key}", "unit": units.get(key, "m/s"),
             "estimate": value}
            for key, value in prediction.rms.items()
        ]  # fmt: skip
        if prediction.divergence is not None:
            seconds = prediction.divergence.seconds
            rows.append({"row": SCORE, "run": prediction.record, "name": "diverged after", "unit": "s",
                         "estimate": seconds})  # fmt: skip
    return rows
