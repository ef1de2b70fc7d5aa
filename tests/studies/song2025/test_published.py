"""What the paper prints, held against itself and against the model's truth."""

import pytest

from seatrial.physics.models.waterjet import TABLE_2, waterjet
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.song2025.published import (
    CORRECTED,
    DRAUGHT,
    LENGTH,
    MASS,
    MISPRINTED_SIGNS,
    PRINTED,
    TRUTH,
    Table2Column,
    printed_coefficients,
)


def test_the_cfd_column_with_n_v_turned_is_the_model_s_truth():
    assert TRUTH.craft().parameters.values == pytest.approx(waterjet().parameters.values, abs=0.0)
    differing = [n for n in COEFFICIENTS if printed_coefficients(Table2Column.CFD)[n] != TABLE_2[n]]
    assert differing == ["N_v"]


def test_particulars_are_the_model_s():
    p = waterjet().parameters
    assert [p[n].value for n in ("L", "d", "m")] == [LENGTH, DRAUGHT, MASS]


def test_mending_turns_only_the_signs_named():
    for printed, corrected in zip(PRINTED, CORRECTED, strict=True):
        turned = tuple(
            n for n in COEFFICIENTS if printed.craft().parameters[n].value == -corrected.craft().parameters[n].value
        )
        assert turned == tuple(n for n in COEFFICIENTS if n in MISPRINTED_SIGNS[printed.column])


def test_improved_is_nearer_than_original_but_for_y_vv():
    true, *columns = (printed_coefficients(column) for column in Table2Column)
    original, improved = ({n: 100.0 * (of[n] / true[n] - 1.0) for n in COEFFICIENTS} for of in columns)
    farther = [n for n in COEFFICIENTS if abs(improved[n]) > abs(original[n])]
    assert farther == ["Y_vv"]
    assert improved["Y_vv"] == pytest.approx(-160.4, abs=0.1)
