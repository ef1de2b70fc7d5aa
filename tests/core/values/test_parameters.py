"""Parameters: immutable, ordered, and clear about unknown names and crossed bounds."""

import math

import numpy as np
import pytest

from seatrial.core.values import InputError, Parameter, Parameters, Prior


@pytest.fixture
def parameters() -> Parameters:
    return Parameters(
        (
            Parameter("X_uu", -0.03, free=True),
            Parameter("Y_v", -0.28, free=True, scale=0.1),
            Parameter("L", unit="m"),
        )
    )


def test_order_names_and_values(parameters: Parameters) -> None:
    assert parameters.names == ("X_uu", "Y_v", "L")
    assert parameters.free_names == ("X_uu", "Y_v")
    assert parameters.missing == ("L",)
    assert len(parameters) == 3
    assert "Y_v" in parameters and "N_r" not in parameters
    np.testing.assert_array_equal(parameters.values, [-0.03, -0.28, math.nan])


def test_every_change_returns_a_new_set(parameters: Parameters) -> None:
    changed = parameters.with_values({"L": 7.0}, source="drawing").fixed("X_uu").bounded("Y_v", -1.0, 0.0)
    assert changed["L"].value == 7.0 and changed["L"].source == "drawing"
    assert changed.free_names == ("Y_v",)
    assert (changed["Y_v"].lower, changed["Y_v"].upper) == (-1.0, 0.0)
    assert parameters["L"].source == "" and parameters.free_names == ("X_uu", "Y_v")


def test_freeing_and_fixing(parameters: Parameters) -> None:
    assert parameters.freed("L").free_names == ("X_uu", "Y_v", "L")
    assert parameters.only_free(["L"]).free_names == ("L",)
    assert parameters.only_free([]).free_names == ()


def test_a_point_of_free_values_goes_in_by_order(parameters: Parameters) -> None:
    moved = parameters.with_free_values(np.array([1.0, 2.0]))
    assert (moved["X_uu"].value, moved["Y_v"].value) == (1.0, 2.0)
    with pytest.raises(ValueError, match="shorter"):
        parameters.with_free_values(np.array([1.0]))


def test_priors_come_and_go(parameters: Parameters) -> None:
    prior = Prior(-0.3, 0.03, "literature")
    with_prior = parameters.with_priors({"Y_v": prior})
    assert with_prior["Y_v"].prior == prior
    assert with_prior.without_priors() == parameters.with_priors({"Y_v": None})  # type: ignore[dict-item]


@pytest.mark.parametrize(("scale", "value", "expected"), [(0.1, -0.3, 0.3), (0.0, -0.3, 0.3), (0.0, 0.0, 1.0)])
def test_characteristic_scale(scale: float, value: float, expected: float) -> None:
    assert Parameter("a", value, scale=scale).characteristic_scale == expected


@pytest.mark.parametrize("change", ["with_values", "fixed", "freed", "only_free", "bounded", "with_priors"])
def test_an_unknown_name_is_refused_and_the_nearest_named(parameters: Parameters, change: str) -> None:
    arguments = {
        "with_values": ({"Y_vv": 1.0},),
        "fixed": ("Y_vv",),
        "freed": ("Y_vv",),
        "only_free": (["Y_vv"],),
        "bounded": ("Y_vv", 0.0, 1.0),
        "with_priors": ({"Y_vv": Prior(0.0, 1.0)},),
    }[change]
    with pytest.raises(InputError, match=r"'Y_vv'.*did you mean 'Y_v'"):
        getattr(parameters, change)(*arguments)


def test_crossed_bounds_are_refused() -> None:
    with pytest.raises(InputError, match=r"'K'.*lower bound 2 exceeds upper bound 1"):
        Parameter("K", 1.0, lower=2.0, upper=1.0)
