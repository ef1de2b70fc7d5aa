"""Outputs and antennas as the parameters of ArduPilot and PX4 state them."""

import pytest

from seatrial.data.draft.naming import guess_by_name
from seatrial.data.draft.stored_parameters import antenna_place, is_disabled, output_setting


@pytest.mark.parametrize(
    ("trim", "is_reversed", "expected"),
    [(1500.0, 0.0, (1500.0, 400.0)), (1500.0, 1.0, (1500.0, 300.0)), (1200.0, 0.0, (1200.0, 700.0)),
     (1200.0, 1.0, (1900.0, 700.0))],
)  # fmt: skip
def test_rest_and_span_of_an_ardupilot_output(trim: float, is_reversed: float, expected: tuple[float, float]) -> None:
    """SRV_Channel::pwm_from_angle: trim + share (max - trim), or trim - share (trim - min); ranges from min."""
    names = {"FUNCTION": 73.0, "TRIM": trim, "MIN": 1200.0, "MAX": 1900.0, "REVERSED": is_reversed}
    setting = output_setting({f"SERVO2_{key}": value for key, value in names.items()}, 2)
    assert setting is not None and setting.drives == "left throttle"
    assert (setting.zero, setting.span, setting.is_reversed) == (*expected, bool(is_reversed))


def test_px4_outputs_have_a_function_a_range_and_a_place() -> None:
    parameters = {"PWM_MAIN_FUNC1": 102.0, "PWM_MAIN_MIN1": 1000.0, "PWM_MAIN_MAX1": 2000.0, "PWM_MAIN_REV": 1.0,
                  "CA_R_REV": 2.0, "CA_ROTOR1_PX": -0.4, "CA_ROTOR1_PY": 0.3, "PWM_MAIN_FUNC2": 0.0}  # fmt: skip
    setting = output_setting(parameters, 1)
    assert setting is not None and (setting.zero, setting.span, setting.is_reversed) == (1500.0, 500.0, True)
    assert "-0.4 m forward and 0.3 m to starboard (CA_ROTOR1_PX, _PY)" in setting.evidence
    one_way = output_setting(parameters | {"CA_R_REV": 0.0}, 1)
    assert one_way is not None and (one_way.zero, one_way.span) == (1000.0, 1000.0)
    assert is_disabled(parameters, 2) and not is_disabled(parameters, 1)
    assert output_setting(parameters, 3) is None


def test_the_antenna_is_where_the_parameters_say() -> None:
    place = antenna_place({"GPS1_POS_X": 1.2, "GPS1_POS_Y": 0.0})
    assert place is not None and (place.x, place.y) == (1.2, 0.0)
    assert antenna_place({"GPS_POS1_X": 0.0, "GPS_POS1_Y": 0.0}) is None


def test_auxiliary_outputs_of_px4_are_counted_on_or_are_the_first_where_main_drives_nothing() -> None:
    auxiliary = {"PWM_AUX_FUNC1": 101.0, "PWM_AUX_MIN1": 1000.0, "PWM_AUX_MAX1": 2000.0, "CA_R_REV": 1.0}
    alone = output_setting(auxiliary | {"PWM_MAIN_FUNC1": 0.0}, 1)
    second = output_setting(auxiliary | {"PWM_MAIN_FUNC1": 201.0}, 9)
    assert alone is not None and alone == second and alone.evidence.startswith("PWM_AUX_FUNC1")
    assert (alone.zero, alone.span, alone.drives) == (1500.0, 500.0, "motor 1")
    named = guess_by_name("actuator_outputs[1]", "output[0]", "", "ulog")
    assert named is not None and named.symbol == "command_9"
    assert guess_by_name("actuator_outputs[1]", "output[7]", "", "ulog") is None, "there are twelve commands"
