"""A fit answers as a results object of statsmodels does, and simulates itself."""

from dataclasses import replace

import numpy as np
import pandas
import pytest
from scipy import stats
from tests.reporting.fabricated import fabricated_fit

from seatrial.core.results import Fit, IntervalBasis
from seatrial.core.values import InputError
from seatrial.physics.simulate import replay


@pytest.fixture(scope="module")
def fit() -> Fit:
    return fabricated_fit()


def test_a_coefficient_is_found_by_its_name(fit: Fit) -> None:
    assert fit["Y_v"].estimate == fit.params["Y_v"]
    assert fit["L"].fixed and "L" not in fit.params
    with pytest.raises(InputError, match=r"no coefficient 'Y_w'; did you mean"):
        fit["Y_w"]


def test_a_level_has_no_sign_to_show(fit: Fit) -> None:
    one = replace(fit.coefficients[0], standard_error=0.1, lower=-0.1, upper=0.2)
    assert one.is_sign_open and not replace(one, unit="rad").is_sign_open


def test_the_table_holds_every_coefficient(fit: Fit) -> None:
    table = fit.to_dataframe()
    assert list(table.index) == [c.name for c in fit.coefficients]
    assert table.loc["N_r", "estimate"] == fit["N_r"].estimate
    assert table.loc["N_r", "unit"] == "1"


def test_intervals_at_95_per_cent_are_those_of_the_fit(fit: Fit) -> None:
    table = fit.conf_int()
    assert list(table.index) == list(fit.model.parameters.free_names) == list(fit.params)
    assert all(tuple(table.loc[name]) == (fit[name].lower, fit[name].upper) for name in fit.params)


@pytest.mark.parametrize("degrees", [4.0, np.inf])
def test_intervals_at_another_level_follow_student_s_t(fit: Fit, degrees: float) -> None:
    given = replace(fit, interval_basis=IntervalBasis(fit.covariance, degrees))
    factor = stats.t.ppf(0.75, degrees) / stats.t.ppf(0.975, degrees)
    narrow, usual = (given.conf_int(level) for level in (0.5, 0.95))
    estimate = pandas.Series(fit.params)
    pandas.testing.assert_series_equal(
        narrow["upper"] - estimate, factor * (usual["upper"] - estimate), check_names=False
    )
    pandas.testing.assert_series_equal(
        narrow["lower"] - estimate, factor * (usual["lower"] - estimate), check_names=False
    )


@pytest.mark.parametrize("level", [0.0, 1.0, 95.0])
def test_a_level_that_is_no_probability_is_refused(fit: Fit, level: float) -> None:
    with pytest.raises(InputError, match=r"not between 0 and 1; give a probability such as 0\.95"):
        fit.conf_int(level)


def test_a_prediction_is_the_model_under_the_record_s_inputs(fit: Fit) -> None:
    record = fit.records[0]
    predicted = fit.predict(record)
    assert np.array_equal(predicted["r"], replay(fit.model, record)["r"])
    assert np.array_equal(predicted.time, record.time)


def test_the_summary_has_a_row_for_each_free_coefficient(fit: Fit) -> None:
    summary = fit.summary()
    assert [row[0] for row in summary.rows] == list(fit.params)
    assert summary.rows[3][2] == f"{fit['Y_v'].estimate:.5g}"
    assert "4, of these 1 for validation" in str(summary)
