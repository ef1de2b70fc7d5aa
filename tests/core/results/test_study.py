"""Figures of a study refuse values that do not fit their names or their axis."""

import numpy as np
import pytest

from seatrial.core.results import Bars, Matrix
from seatrial.core.values import InputError


def test_bars_need_a_value_for_each_label_and_positive_ones_on_a_logarithmic_axis() -> None:
    with pytest.raises(InputError, match="series 'x' has 1 values for 2 labels"):
        Bars("b", ("a", "c"), {"x": (1.0,)}, "1")
    with pytest.raises(InputError, match="logarithmic axis"):
        Bars("b", ("a",), {"x": (-1.0,)}, "1", is_logarithmic=True)


def test_a_matrix_needs_a_name_for_each_row_and_column() -> None:
    with pytest.raises(InputError, match=r"shape \(2, 3\)"):
        Matrix("m", ("X_uu", "Y_v", "N_r"), ("v", "r"), np.zeros((2, 3)))
