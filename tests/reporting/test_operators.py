"""What a fit means to operators: values with units and intervals, nothing where there is nothing to say."""

from dataclasses import replace

from tests.reporting.test_roll_chapter import KNOWN
from tests.reporting.test_thruster_chapter import CRAFT

from seatrial.core.results import CraftMeasure, Fit, IntervalEstimate, PointMotion, Seakeeping
from seatrial.reporting.key_facts import operators_sentence


def test_a_roll_model_gives_period_and_damping(fit: Fit) -> None:
    text = operators_sentence(replace(fit, roll=KNOWN))
    assert text.startswith(
        "The natural period at small angles is 2.5512 s (2.5475 to 2.5550 s). The linear damping is "
    )
    assert " of critical, the equivalent damping at " in text
    assert "11° 0.81 % (0.70 to 0.91 %): damping is not shown to change with it" in text
    assert ". GM would be " in text
    assert operators_sentence(replace(fit, roll=replace(KNOWN, metacentric_height=None))).endswith("to change with it.")
    given = replace(KNOWN, metacentric_height=IntervalEstimate(0.07, 0.07, 0.07))
    assert "GM" not in operators_sentence(replace(fit, roll=given))


def test_a_craft_with_thrusters_makes_turns_and_stops(fit: Fit) -> None:
    text = operators_sentence(replace(fit, thruster_craft=CRAFT))
    assert text == "At full command, beyond the training runs, it makes 2.56 m/s (2.55 to 2.57 m/s)."
    turning = CraftMeasure(-44.0, None, None, "turn")
    craft = replace(CRAFT, measures={"yaw_rate_deg_s": turning})
    assert operators_sentence(replace(fit, thruster_craft=craft)) == (
        "At full command it turns at −44°/s (interval not determined)."
    )
    assert operators_sentence(replace(fit, thruster_craft=replace(CRAFT, measures={}))) == ""


def test_what_rests_on_a_guessed_thrust_is_no_headline(fit: Fit) -> None:
    stops = CraftMeasure(1.7, 1.6, 1.8, "stop:100")
    craft = replace(CRAFT, measures={"top_speed": CraftMeasure(2.5, 2.4, 2.6, "straight:100"),
                                     "stopping_distance_m": stops})  # fmt: skip
    whole = replace(fit, thruster_craft=craft)
    assert operators_sentence(whole).endswith(" and stops within 1.70 m (1.60 to 1.80 m).")
    ahead_only = replace(whole, findings=(replace(fit.findings[0], code="no-thrust-astern"),))
    assert "makes 2.50 m/s" in operators_sentence(ahead_only) and "stops" not in operators_sentence(ahead_only)
    one_order = replace(whole, findings=(replace(fit.findings[0], code="single-order"),))
    assert operators_sentence(one_order) == ""


def test_motions_in_waves_have_the_sea_and_the_heading(fit: Fit) -> None:
    curve = (0.0, 1.0)
    sea = Seakeeping("run", 9.26, 180.0, "a sea of 3 m", curve, curve, curve, curve, curve, curve, curve, curve, curve,
                     1.234, 2.0, (7.0, 6.0), (PointMotion("bow", 50.0, 2.0, 1.0, 0.1),))  # fmt: skip
    assert operators_sentence(replace(fit, seakeeping=sea)) == (
        "In a sea of 3 m, at 9.26 m/s and 180° to the waves, significant amplitudes are 1.2 m of heave and 2.0° of "
        "pitch."
    )


def test_of_a_steered_ship_the_verdict_says_all(fit: Fit) -> None:
    assert operators_sentence(fit) == ""
