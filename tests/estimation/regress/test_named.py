"""Estimators by the name that tables give them."""

import pytest

from seatrial.core.values import InputError
from seatrial.estimation.regress.named import available_estimators, estimator_named


def test_names_are_unique_and_lead_to_their_estimator() -> None:
    names = [estimator.name for estimator in available_estimators(5.0)]
    assert len(set(names)) == len(names) > 10
    assert estimator_named(names[3], 5.0).name == names[3]


def test_an_unknown_name_gets_the_nearest() -> None:
    with pytest.raises(InputError, match=r"unknown estimator 'weak form, rigde'; did you mean 'weak form, ridge'"):
        estimator_named("weak form, rigde", 5.0)
