"""Estimators by the name that tables give them."""

import pytest

from seatrial.core.values import InputError
from seatrial.data.trial import EstimateMethod
from seatrial.estimation.regress.pipeline import (
    available_estimators,
    estimator_named,
    estimator_of_method,
    standard_estimators,
)


def test_names_are_unique_and_lead_to_their_estimator() -> None:
    names = [estimator.name for estimator in available_estimators(5.0)]
    assert len(set(names)) == len(names) > 10
    assert estimator_named(names[3], 5.0).name == names[3]


def test_an_unknown_name_gets_the_nearest() -> None:
    with pytest.raises(InputError, match=r"unknown estimator 'weak form, rigde'; did you mean 'weak form, ridge'"):
        estimator_named("weak form, rigde", 5.0)


def test_every_method_that_is_a_regression_leads_to_an_estimator_of_its_own() -> None:
    regressions = [m for m in EstimateMethod if m.is_published and not m.is_search]
    names = [estimator_of_method(method, 5.0).name for method in regressions]
    assert sorted(names) == sorted(e.name for e in standard_estimators(5.0))
    with pytest.raises(InputError, match="method 'iwho' is no regression; these are euler, "):
        estimator_of_method(EstimateMethod.IWHO, 5.0)
