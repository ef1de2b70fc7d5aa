"""Commands of thrusters: what the motion and the autopilot's parameters say of them."""

from pathlib import Path

import numpy as np
import pytest
from tests.data.draft.craft import two_thrusters
from tests.data.draft.test_draft import guesses, write
from tests.data.read.samples import dataflash

from seatrial.api import draft_trial
from seatrial.core.values import Record
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.guess import command_directions, command_guess
from seatrial.data.draft.survey import ColumnSummary, survey_log

CRAFT = two_thrusters()


def _log(left_sign: float, right_sign: float) -> dict[str, np.ndarray]:
    motion = {"time": CRAFT["t"], "x_ned": CRAFT["x0"], "y_ned": CRAFT["y0"], "yaw": np.degrees(CRAFT["psi"])}
    body = {"surge": CRAFT["u"], "sway": 0.0 * CRAFT["u"], "yaw_rate": CRAFT["r"]}
    pulses = {f"thr_{side}": 1500.0 + sign * 400.0 * np.where(CRAFT["t"] % 20.0 < 9.0, 0.0, CRAFT[side])
              for side, sign in (("left", left_sign), ("right", right_sign))}  # fmt: skip
    return motion | body | pulses


@pytest.mark.parametrize(("left", "right"), [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])
def test_the_direction_of_a_command_follows_from_the_motion(left: float, right: float) -> None:
    channels = {symbol: CRAFT[symbol] for symbol in ("u", "r", "psi")}
    channels |= {"command_1": left * CRAFT["left"], "command_2": right * CRAFT["right"]}
    changes = command_directions(Record.from_arrays("run", CRAFT["t"], channels))
    for symbol, sign, side in (("command_1", left, "port"), ("command_2", right, "starboard")):
        guess = changes[symbol](ColumnGuess("thr", symbol, "us"))
        assert guess.is_open == (sign < 0.0)
        unsigned = ColumnGuess("thr", symbol, "us", other_reading='positive = "astern", and which side it drives: '
                               "the log does not say")  # fmt: skip
        decided = changes[symbol](unsigned)
        assert (decided.positive, decided.is_open) == ("" if sign > 0.0 else "astern", False)
        assert f"as a thruster on the {side} side" in decided.evidence[-1]


def test_commands_that_the_motion_does_not_follow_stay_open(tmp_path: Path) -> None:
    columns = _log(1.0, 1.0) | {"surge": np.full(CRAFT["t"].size, 1.0), "yaw_rate": 0.0 * CRAFT["t"]}
    result = guesses(write(tmp_path / "run.csv", columns))
    assert result["command_1"].is_open and result["command_2"].is_open
    assert command_directions(Record.from_arrays("run", CRAFT["t"], {"u": CRAFT["u"]})) == {}


def _autopilot(path: Path, parameters: dict[str, float]) -> Path:
    micro = [round(1e6 * t) for t in CRAFT["t"]]
    pulses = (1500.0 + 400.0 * CRAFT["left"]).round().astype(int).tolist()
    path.write_bytes(dataflash({
        "PARM": ("QNf", "TimeUS,Name,Value", [(0, name.encode(), value) for name, value in parameters.items()]),
        "RCOU": ("QHHH", "TimeUS,C1,C3,C4", [(t, p, p, p) for t, p in zip(micro, pulses, strict=True)]),
        "GPS": ("QLLf", "TimeUS,Lat,Lng,Spd", [(t, 500000000 + k, 80000000, 1.0) for k, t in enumerate(micro)]),
    }))  # fmt: skip
    return path


def test_parameters_of_the_autopilot_say_what_its_outputs_are(tmp_path: Path) -> None:
    servos = {"SERVO1_FUNCTION": 26.0, "SERVO1_TRIM": 1510.0, "SERVO1_MIN": 1100.0, "SERVO1_MAX": 1900.0}
    servos |= {"SERVO3_FUNCTION": 70.0, "SERVO3_TRIM": 1500.0, "SERVO3_MIN": 1050.0, "SERVO3_MAX": 1850.0}
    servos |= {"SERVO3_REVERSED": 1.0, "SERVO4_FUNCTION": 0.0, "GPS_POS1_X": 0.6, "GPS_POS1_Y": -0.2}
    draft = draft_trial(_autopilot(tmp_path / "run.bin", servos), folder=tmp_path)
    used = {g.symbol: g for part in draft.guesses for g in part if g.is_used}
    assert "command_4" not in used and used["delta"].is_open and used["delta"].zero == 1510.0
    throttle = used["command_3"]
    assert (throttle.zero, throttle.span, throttle.positive, throttle.is_open) == (1500.0, 450.0, "astern", False)
    assert "SERVO3_FUNCTION, _TRIM, _MIN, _MAX, _REVERSED of the log (throttle)" in draft.text
    assert "antenna = { x = 0.6, y = -0.2 }    # GPS_POS1_X and GPS_POS1_Y, from the autopilot" in draft.text
    assert 'kind = "command", zero = 1510, span = 390, scale = 35' in draft.text


def test_a_share_of_the_range_needs_no_parameters(tmp_path: Path) -> None:
    survey = survey_log(write(tmp_path / "run.csv", {"time": CRAFT["t"], "left": CRAFT["left"]}))
    share = ColumnSummary("left", "", -1.0, 1.0, 0.0, is_constant=False, common=0.0)
    guess = command_guess(ColumnGuess("left", "command_1", ""), share, survey)
    assert guess is not None and (guess.unit, guess.is_open) == ("1", False)
    percent = ColumnSummary("left", "", -100.0, 100.0, 0.0, is_constant=False, common=0.0)
    guess = command_guess(ColumnGuess("left", "command_1", ""), percent, survey)
    assert guess is not None and guess.other_reading.startswith("positive")
    to_one_side = ColumnSummary("left", "", 0.0, 100.0, 0.0, is_constant=False, common=0.0)
    guess = command_guess(ColumnGuess("left", "command_1", ""), to_one_side, survey)
    assert guess is not None and "set zero and span" in guess.other_reading


@pytest.mark.parametrize(("common", "other"), [(1500.0, "positive"), (1512.0, "zero = 1500"), (1100.0, "zero = 1000")])
def test_a_rest_that_is_not_1500_is_open_with_both_readings(common: float, other: str, tmp_path: Path) -> None:
    survey = survey_log(write(tmp_path / "run.csv", {"time": CRAFT["t"], "left": CRAFT["left"]}))
    pulses = ColumnSummary("left", "", 1100.0, 1900.0, 0.0, is_constant=False, common=common)
    guess = command_guess(ColumnGuess("left", "command_1", ""), pulses, survey)
    assert guess is not None and guess.other_reading.startswith(other)
    assert guess.zero == (common if abs(common - 1500.0) < 60.0 else 1500.0)


@pytest.mark.parametrize("unit", ["%", ""])
def test_commands_in_per_cent(tmp_path: Path, unit: str) -> None:
    """Stated, or to both sides of a rest that is then 0; the motion shows which way each drives."""
    header = {"thr_left": f"thr_left [{unit}]" if unit else "thr_left"}
    columns = {header.get(key, key): values for key, values in _log(1.0, 1.0).items()}
    left = next(key for key in columns if key.startswith("thr_left"))
    columns[left] = (columns[left] - 1500.0) / 4.0
    guess = guesses(write(tmp_path / "run.csv", columns))["command_1"]
    assert (guess.unit, guess.zero, guess.span) == ("percent", 0.0, 1.0)
    assert not guess.is_open


def test_a_rudder_in_per_cent_is_an_angle_whose_full_travel_is_a_question(tmp_path: Path) -> None:
    rows = "".join(f"{0.1 * k:.1f},{80.0 * np.sin(0.02 * k):.1f}\n" for k in range(300))
    (tmp_path / "run.csv").write_text(f"time,rudder_pct\n{rows}")
    draft = draft_trial(tmp_path / "run.csv", folder=tmp_path, length=8.0)
    line = '# channels.delta = { column = "rudder_pct", unit = "deg", span = 100, scale = 35 }'
    assert line in draft.text and "scale = the angle at 100 per cent in deg" in draft.text
    (record,) = (one for one in draft.records if one is not None)
    assert np.degrees(np.max(record["delta"])) == pytest.approx(28.0, abs=0.1)


@pytest.mark.parametrize(("common", "other"), [(1406.0, "positive"), (1549.0, "zero = 1500")])
def test_pulses_to_both_sides_of_1500_are_about_it_unless_another_rest_is_near(
    tmp_path: Path, common: float, other: str
) -> None:
    (tmp_path / "run.csv").write_text("time,motor1\n0,1\n1,2\n2,3\n")
    column = ColumnSummary("motor1", "us", 1337.0, 1900.0, 0.0, is_constant=False, common=common)
    guess = command_guess(ColumnGuess("motor1", "command_1", ""), column, survey_log(tmp_path / "run.csv"))
    assert guess is not None and guess.other_reading.startswith(other)
