"""Claims and checks of a study with their statuses; figures refuse values that do not fit their names or axis."""

import math

import numpy as np
import pytest

from seatrial.core.results import Bars, Check, CheckStatus, Claim, Matrix, Study, Verdict
from seatrial.core.values import InputError


def test_bars_need_a_value_for_each_label_and_positive_ones_on_a_logarithmic_axis() -> None:
    with pytest.raises(InputError, match="series 'x' has 1 values for 2 labels"):
        Bars("b", ("a", "c"), {"x": (1.0,)}, "1")
    with pytest.raises(InputError, match="logarithmic axis"):
        Bars("b", ("a",), {"x": (-1.0,)}, "1", is_logarithmic=True)


def test_a_matrix_needs_a_name_for_each_row_and_column() -> None:
    with pytest.raises(InputError, match=r"shape \(2, 3\)"):
        Matrix("m", ("X_uu", "Y_v", "N_r"), ("v", "r"), np.zeros((2, 3)))


def test_a_claim_names_the_setting_in_which_alone_it_holds() -> None:
    assert Claim("c", Verdict.HOLDS_IN_OWN_SETTING, "1.0 %", "box about the truth").setting == "box about the truth"
    with pytest.raises(InputError, match="has no setting"):
        Claim("c", Verdict.HOLDS_IN_OWN_SETTING, "1.0 %")
    with pytest.raises(InputError, match="has a setting"):
        Claim("c", Verdict.REFUTED, "1.0 %", "box about the truth")


def test_a_check_holds_up_to_its_limit_and_never_with_nan() -> None:
    assert [Check.at_most("c", value, 2.0).holds for value in (2.0, 2.1, math.nan)] == [True, False, False]
    assert [Check.at_least("c", value, 2.0).holds for value in (2.0, 1.9, math.nan)] == [True, False, False]
    between = [Check.between("c", value, 0.7, 1.3) for value in (0.7, 1.3, 1.4, math.nan)]
    assert [check.holds for check in between] == [True, True, False, False]
    assert between[0].limit == "0.7 to 1.3"


def test_a_withdrawn_check_stays_listed_with_its_derivation() -> None:
    failing = Check.at_most("time, s", 3.0, 2.0, "the machine was busy")
    withdrawn = failing.withdrawn("a time is no property of the result")
    assert (failing.status, failing.remark) == (CheckStatus.FAILS, "the machine was busy")
    assert (withdrawn.status, withdrawn.remark) == (CheckStatus.WITHDRAWN, "a time is no property of the result")
    assert Check.at_most("c", 1.0, 0.0).remark == "The reason is not known."
    with pytest.raises(InputError, match="without a derivation"):
        failing.withdrawn("")
    study = Study("s", "paper", (), (failing, withdrawn, Check.at_most("c", 0.0, 1.0)))
    assert study.check_counts == "1 holding, 1 failing, 1 withdrawn" and study.claim_counts == ""


def test_counts_of_claims_are_grammatical() -> None:
    assert Verdict.HOLDS_IN_OWN_SETTING.counted(1) == "1 holds in its own setting"
    assert Verdict.HOLDS_IN_OWN_SETTING.counted(6) == "6 hold in their own setting"
    assert Verdict.REFUTED.counted(2) == "2 refuted"
