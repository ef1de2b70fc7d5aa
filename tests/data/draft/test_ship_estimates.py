"""What is stated of a craft is kept, and rules complete it to one hull."""

import math

import pytest

from seatrial.core.values import InputError
from seatrial.data.draft.ship_estimates import (
    EstimatedValue,
    StatedSize,
    added_masses,
    hull_rudder_propeller,
    main_dimensions,
    mass_properties,
    stated_values,
    water_density,
)
from seatrial.physics.hydro.empirical import interaction_wake, propulsion

RHO = 1025.0


@pytest.mark.parametrize(
    "size",
    [
        StatedSize(62.0, mass=1.8e6),
        StatedSize(62.0, beam=13.0, mass=1.8e6),
        StatedSize(62.0, draught=4.4, mass=1.8e6),
        StatedSize(62.0, 13.0, 4.4, 1.8e6),
        StatedSize(62.0, 13.0),
        StatedSize(62.0),
    ],
)
def test_the_hull_displaces_its_mass(size: StatedSize) -> None:
    mass = next(one for one in mass_properties(size) if one.key == "m")
    form = size.form
    assert mass.value == pytest.approx(RHO * form.C_b * form.L * form.B * form.d)
    assert mass.is_stated == bool(size.mass)
    assert (form.B, form.d) == (size.beam or form.B, size.draught or form.d)


def test_what_is_stated_is_not_marked() -> None:
    stated, estimated = (one.line for one in main_dimensions(StatedSize(62.0, 13.0)))
    assert (
        stated == "B = 13.0    # m, breadth, as stated"
        and "ESTIMATED: within 25 %, m, draught, from the length" in estimated
    )
    assert EstimatedValue("m", 1800000.0, "kg", is_stated=True).line == "m = 1800000.0    # kg"
    assert water_density(StatedSize()).value == RHO


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        ({"length": -1.0}, "a length in m is positive"),
        ({"length": 3.0, "rho": -1.0}, r"a rho in kg/m\^3 is positive"),
        ({"mass": 165.0}, "say nothing without the length"),
        ({"length": 10.0, "mass": math.inf}, "a mass in kg is positive"),
    ],
)
def test_sizes_that_nothing_has_are_refused(sizes: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        StatedSize(**sizes)


def test_a_volume_that_no_hull_has_is_refused_where_a_hull_is_needed() -> None:
    """A catamaran's breadth over all holds no block, and its thrusters need none."""
    for sizes in ((3.2, 0.5, 0.1, 900.0), (2.4, 1.25, 0.22, 112.0)):
        size = StatedSize(*sizes)
        assert {one.key for one in stated_values(size)} == {"B", "d", "m"}
        with pytest.raises(InputError, match=r"block coefficient of .* which no hull has"):
            main_dimensions(size)


def test_the_formulas_for_kvlcc2_come_near_its_rudder_and_propeller() -> None:
    """KVLCC2 in full scale (SIMMAN 2008): H_R 15.8 m, A_R 112.5 m^2, D_P 9.86 m, P/D 0.721; 15.5 kn."""
    size = StatedSize(320.0, 58.0, 20.8, 0.81 * 320.0 * 58.0 * 20.8 * RHO)
    value = {one.key: one.value for one in hull_rudder_propeller(size, 7.97, 7.97 / 1.73)}
    published = {"H_R": 15.8, "A_R": 112.5, "D_P": 9.86, "pitch_ratio": 0.721}
    assert value == pytest.approx(value | published, rel=0.25)  # what an estimate of a rudder is good for
    assert (value["D_P"], value["pitch_ratio"]) == pytest.approx((9.86, 0.721), rel=0.12)


def test_the_estimated_propeller_drives_the_hull_at_its_speed() -> None:
    size, U, n = StatedSize(31.0, 8.6, 3.7, 566e3), 6.15, 4.58
    value = {one.key: one.value for one in hull_rudder_propeller(size, U, U / n)}
    form = size.form
    wake = interaction_wake(form)
    series = propulsion(form, value["pitch_ratio"], 0.5, 4).values
    J = U * (1.0 - wake) / (n * value["D_P"])
    K_T = series["k_0"] + series["k_1"] * J + series["k_2"] * J**2
    thrust = (1.0 - series["t_P"]) * n**2 * value["D_P"] ** 4 * K_T
    assert thrust == pytest.approx(0.5 * form.L * form.d * U**2 * series["R_0"], rel=0.05)  # P/D in hundredths


@pytest.mark.parametrize("rho", [1000.0, 1025.0])
def test_a_stated_mass_is_kept_in_water_of_any_density(rho: float) -> None:
    size = StatedSize(3.4, 0.58, 0.21, 265.0, rho=rho)
    lines = [one.line for one in hull_rudder_propeller(size, 1.03, 1.03 / 12.6)]
    assert lines[2].startswith("m = 265.0    # kg, as stated: C_b 0.6") and not any("C_b = " in one for one in lines)
    assert lines[3] == f"rho = {rho}    # kg/m^3, as stated"
    assert size.form.C_b == pytest.approx(265.0 / (rho * 3.4 * 0.58 * 0.21))
    assert [one.key for one in stated_values(size)] == ["B", "d", "m", "rho"] and not stated_values(StatedSize(3.4))


def test_no_propeller_is_estimated_for_what_turns_otherwise() -> None:
    size = StatedSize(9.5)
    assert not hull_rudder_propeller(size, 10.0, 0.2)  # a Froude number of 1
    assert not hull_rudder_propeller(size, 3.0, 0.02)  # an engine at 9000 turns a minute
    assert not hull_rudder_propeller(size, 3.0, 0.0)
    assert all(one.value < 0.0 for one in added_masses(size))


def test_a_stated_propeller_and_rudder_stay_and_the_pitch_is_that_of_the_propeller() -> None:
    """At one advance and thrust a larger propeller is less loaded: its pitch over its diameter is smaller."""
    sizes = [StatedSize(112.0, 19.4, 5.6, 7.48e6, propeller=diameter, rudder=18.0) for diameter in (4.0, 4.4)]
    small, large = ({one.key: one for one in hull_rudder_propeller(size, 5.8, 2.7)} for size in sizes)
    assert large["D_P"].line.startswith("D_P = 4.4 ") and large["A_R"].line.startswith("A_R = 18.0 ")
    assert "ESTIMATED" not in large["D_P"].line + large["A_R"].line
    assert large["pitch_ratio"].value < small["pitch_ratio"].value
    with pytest.raises(InputError, match="propeller = -1"):
        StatedSize(112.0, propeller=-1.0)
    with pytest.raises(InputError, match="antenna = nan"):
        StatedSize(antenna=float("nan"))
