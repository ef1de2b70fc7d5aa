"""Sizes in a header are named with the option that states them; nothing is read into other words."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.api import draft_trial
from seatrial.data.draft.draft_text import wave_lines
from seatrial.data.draft.ship_estimates import UNSTATED, StatedSize, header_statements, sizes_in_header, speed_in_header
from seatrial.data.draft.survey import LogSurvey, survey_log

TANK = "# Free-running model, feeder 1:40\n# LPP 3.400 m  B 580 mm  T 0.210 m  displacement 0.265 t  LCG -0.027 m"


def log(path: Path, header: str) -> LogSurvey:
    rows = "".join(f"{k / 10:.1f};{k}\n" for k in range(20))
    path.write_text(f"{header}\nt;psi\n{rows}")
    return survey_log(path)


def test_a_header_names_the_options(tmp_path: Path) -> None:
    found = sizes_in_header(log(tmp_path / "a.txt", TANK), UNSTATED)
    assert [one.option for one in found] == [
        "--length 3.4", "--beam 0.58", "--draught 0.21", "--mass 265", "--scale 40",
    ]  # fmt: skip
    assert found[0].text == "LPP 3.400 m"
    stated = StatedSize(3.4, 0.58, 0.21, 265.0)
    assert [one.option for one in sizes_in_header(log(tmp_path / "b.txt", TANK), stated)] == ["--scale 40"]


def test_a_header_of_lines_with_tabs_names_displacement_and_metacentric_height(tmp_path: Path) -> None:
    tank = "Scale\t1:8\nLpp\t3.90 m\nT\t0.42 m\nDispl.\t873 kg\nGM\t0.081 m"
    tank += "\nfresh water 1000 kg/m3"
    options = [one.option for one in sizes_in_header(log(tmp_path / "a.txt", tank), UNSTATED)]
    assert options == ["--length 3.9", "--draught 0.42", "--mass 873", "--gm 0.081", "--rho 1000", "--scale 8"]


def test_the_speed_of_a_carriage_is_that_of_the_run(tmp_path: Path) -> None:
    assert speed_in_header(log(tmp_path / "a.txt", "# seakeeping\n# Carriage speed\t1.20 m/s")) == 1.2
    assert speed_in_header(log(tmp_path / "b.txt", "# seakeeping\n# speed: 10 kn")) == pytest.approx(5.1444, rel=1e-4)
    assert speed_in_header(log(tmp_path / "c.txt", "# speed 1 m/s\n# later speed 2 m/s")) is None
    assert speed_in_header(log(tmp_path / "d.txt", "# model 12\n# V = 0.810 m/s")) == 0.81
    assert speed_in_header(log(tmp_path / "e.txt", "# model 12\n# run V 2 m/s")) is None
    assert wave_lines(1.2)[-1].startswith("speed = 1.2 ") and "ASSUMED" in wave_lines(None)[-1]


PROSE = """# Wave probe 1.95 m fwd of midship; heave positive up, pitch bow down positive
# +ve rudder to port. AIS/GPS antenna 34 m aft of midship.
# ROT in degrees per minute, positive to starboard (clockwise)"""


def test_sentences_above_a_table_say_sides_and_places(tmp_path: Path) -> None:
    said = header_statements(log(tmp_path / "a.txt", PROSE))
    assert {symbol: one.positive for symbol, one in said.items() if one.positive} == {
        "z": "up", "theta": "bow down", "delta": "port", "r": "starboard"
    }  # fmt: skip
    assert (said["zeta"].place, said["antenna"].place, said["z"].place) == (1.95, -34.0, None)
    assert [one.option for one in sizes_in_header(log(tmp_path / "b.txt", PROSE), UNSTATED)] == ["--antenna -34"]
    assert header_statements(log(tmp_path / "c.txt", "# positive results, 3 m ahead")) == {}
    spaced = "# V = 1.2 m/s   wave probe 1.20 m fwd of midship   heave positive down, pitch bow up positive"
    apart = header_statements(log(tmp_path / "s.txt", f"# tank 2\n{spaced}"))
    assert (apart["zeta"].place, apart["z"].positive, apart["theta"].positive) == (1.2, "down", "bow up")
    carried = header_statements(log(tmp_path / "d.txt", "# tank 2\n# probe on carriage, 1.900 m fwd of midship"))
    assert carried["zeta"].place == 1.9


@pytest.mark.parametrize(("side", "is_open"), [("starboard", False), ("port", True)])
def test_a_side_that_the_turn_contradicts_is_a_question(side: str, is_open: bool, tmp_path: Path) -> None:
    time = np.arange(0.0, 200.0, 0.5)
    rudder = 10.0 * np.sign(np.sin(0.1 * time))
    psi = np.degrees(np.cumsum(np.cumsum(0.0002 * rudder)))
    rows = "".join(f"{t};{a:.3f};{b:.2f}\n" for t, a, b in zip(time, psi, rudder, strict=True))
    (tmp_path / "zz.csv").write_text(f"Zigzag\nrudder positive to {side}\n\ntime;heading [deg];rudder [deg]\n{rows}")
    draft = draft_trial(tmp_path / "zz.csv", length=50.0)
    (rudder_guess,) = [g for part in draft.guesses for g in part if g.symbol == "delta"]
    assert rudder_guess.is_open is is_open and ("positive" in rudder_guess.other_reading) is is_open


@pytest.mark.parametrize(
    "header",
    [
        "# run T01 zigzag 10/10 at 1.2 m/s",
        "# D 0.135 m, t 20 kg",
        "# 2026-10-08 11:40:20",
        "# L 3.4 m, later L 3.5 m",
        "x",
    ],
)
def test_other_words_say_nothing(header: str, tmp_path: Path) -> None:
    assert sizes_in_header(log(tmp_path / "a.txt", header), UNSTATED) == ()
