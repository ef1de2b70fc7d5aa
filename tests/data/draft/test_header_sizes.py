"""Sizes in a header are named with the option that states them; nothing is read into other words."""

from pathlib import Path

import pytest

from seatrial.data.draft.draft_text import wave_lines
from seatrial.data.draft.ship_estimates import UNSTATED, StatedSize, sizes_in_header, speed_in_header
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
    options = [one.option for one in sizes_in_header(log(tmp_path / "a.txt", tank), UNSTATED)]
    assert options == ["--length 3.9", "--draught 0.42", "--mass 873", "--gm 0.081", "--scale 8"]


def test_the_speed_of_a_carriage_is_that_of_the_run(tmp_path: Path) -> None:
    assert speed_in_header(log(tmp_path / "a.txt", "# seakeeping\n# Carriage speed\t1.20 m/s")) == 1.2
    assert speed_in_header(log(tmp_path / "b.txt", "# seakeeping\n# speed: 10 kn")) == pytest.approx(5.1444, rel=1e-4)
    assert speed_in_header(log(tmp_path / "c.txt", "# speed 1 m/s\n# later speed 2 m/s")) is None
    assert speed_in_header(log(tmp_path / "d.txt", "# model 12\n# V = 0.810 m/s")) == 0.81
    assert speed_in_header(log(tmp_path / "e.txt", "# model 12\n# run V 2 m/s")) is None
    assert wave_lines(1.2)[-1].startswith("speed = 1.2 ") and "ASSUMED" in wave_lines(None)[-1]


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
