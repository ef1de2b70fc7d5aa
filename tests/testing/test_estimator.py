"""Estimators of others are checked as the built-in ones; each violation has its sentence."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.estimation.regress.estimators import LinearRegression, OrdinaryLeastSquares, RegressionEstimate
from seatrial.estimation.regress.operators import Central
from seatrial.estimation.regress.pipeline import available_estimators
from seatrial.testing import ConformanceError, check_estimator

HALF_WIDTH = 5.0  # s; a window of a quarter of the check's rudder period
GOOD = LinearRegression("central differences", Central(), OrdinaryLeastSquares())


@pytest.mark.parametrize("estimator", available_estimators(HALF_WIDTH), ids=lambda e: e.name)
def test_built_in_estimators_conform(estimator) -> None:
    check_estimator(estimator)


@dataclass
class Broken:
    """A conforming estimator but for one defect."""

    defect: str
    name: str = "broken"
    generator: np.random.Generator = field(default_factory=lambda: np.random.default_rng(1))

    def estimate(self, model: Model, records: Sequence[Record]) -> RegressionEstimate:
        if self.defect == "accepts anything" and "r" not in records[0]:
            return RegressionEstimate(np.zeros(3))
        values = GOOD.estimate(model, records).values
        start = np.array([p.value for p in model.parameters.free])
        results = {
            "short": values[:2],
            "not a number": np.where(values > 0.0, np.nan, values),
            "far off": 2.0 * values,
            "random": values * (1.0 + 1e-3 * self.generator.normal(size=3)),
            "start": 0.9 * values + 0.1 * start,
        }
        return RegressionEstimate(results.get(self.defect, values))


@pytest.mark.parametrize(
    ("defect", "sentence"),
    [
        ("short", r"shape \(2,\) for the 3"),
        ("not a number", "coefficient a_delta is not a finite number"),
        ("far off", "a coefficient is 10[0-9]% off"),
        ("random", "same records give other coefficients"),
        ("start", "depend on the values that the model comes with"),
        ("accepts anything", "a record without any state of the model is accepted"),
    ],
)
def test_violations_are_named(defect: str, sentence: str) -> None:
    with pytest.raises(ConformanceError, match=sentence):
        check_estimator(Broken(defect))


def test_an_estimator_without_a_name_is_refused() -> None:
    with pytest.raises(ConformanceError, match="name is empty"):
        check_estimator(Broken("", name=""))
