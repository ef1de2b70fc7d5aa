"""What a sheet refuses, each in one sentence."""

import pytest
import sympy as sp

from seatrial.core.equations import Sheet
from seatrial.core.values import InputError, Parameters, Ship


@pytest.fixture
def sheet() -> Sheet:
    made = Sheet("mine")
    made.states("r psi")
    made.input("delta")
    made.parameter("K", 0.1)
    return made


r, psi, K, delta = sp.symbols("r psi K delta", real=True)


def test_a_finished_sheet_is_a_model(sheet: Sheet) -> None:
    sheet.rate(r, K * delta - r)
    sheet.rate(psi, r)
    model = sheet.model()
    assert model.states == ("r", "psi")
    assert model.input_names == ("delta",)
    assert model.inputs[0].direction == "starboard"
    assert model.observables == ("r", "psi")


def test_a_name_used_twice(sheet: Sheet) -> None:
    with pytest.raises(InputError, match="'mine': the name 'r' is used twice"):
        sheet.parameter("r")


def test_a_name_that_is_no_identifier(sheet: Sheet) -> None:
    with pytest.raises(InputError, match="'Y v' is no ASCII identifier"):
        sheet.bind("Y v", K)


def test_an_unknown_symbol(sheet: Sheet) -> None:
    with pytest.raises(InputError, match=r"rate of 'r': unknown symbol 'T'; declare it first"):
        sheet.rate(r, r / sp.Symbol("T"))


def test_a_binding_cannot_rest_on_a_later_one(sheet: Sheet) -> None:
    with pytest.raises(InputError, match="binding 'Y': unknown symbol 'U'"):
        sheet.bind("Y", sp.Symbol("U") * r)


def test_a_missing_rate(sheet: Sheet) -> None:
    sheet.rate(r, K * delta)
    with pytest.raises(InputError, match="no rate given for state 'psi'"):
        sheet.model()


def test_a_rate_given_twice(sheet: Sheet) -> None:
    sheet.rate(r, K * delta)
    with pytest.raises(InputError, match="rate of 'r' is given twice"):
        sheet.rate(r, K)


def test_a_rate_of_something_else(sheet: Sheet) -> None:
    with pytest.raises(InputError, match="'K' is no state"):
        sheet.rate(K, r)


def test_particulars_come_from_the_ship(sheet: Sheet) -> None:
    L = sheet.parameter("L", unit="m")
    sheet.rate(r, K * delta / L)
    sheet.rate(psi, r)
    model = sheet.model()
    with pytest.raises(InputError, match="model 'mine' needs L; give them under"):
        model.with_ship(Ship("none"))
    made = model.with_ship(Ship("tanker", {"L": 7.0, "B": 1.2}, "drawing"))
    assert (made.parameters["L"].value, made.parameters["L"].source) == (7.0, "drawing")


def test_parameters_of_another_model_are_refused(sheet: Sheet) -> None:
    sheet.rate(r, K * delta)
    sheet.rate(psi, r)
    with pytest.raises(InputError, match="do not belong to model 'mine'"):
        sheet.model().with_parameters(Parameters(()))
