"""Decays and runs in waves at several speeds are drafted as one trial for each speed, those in calm water as none."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.api import draft_trial
from seatrial.data.draft.runs_of_logs import runs_by_speed, runs_of_logs, stated_options
from seatrial.data.draft.ship_estimates import StatedSize
from seatrial.data.draft.survey import survey_log

TIME = np.arange(0.0, 40.0, 0.1)


def decay(path: Path, angle_deg: float, speed: str) -> Path:
    """A decay from an angle that is held for 4 s, under a header that states a speed."""
    since = TIME - 4.0
    swing = np.where(since < 0.0, 1.0, np.exp(-0.05 * since) * np.cos(2.5 * since))
    rows = "".join(f"{t:.1f}\t{angle_deg * x:.4f}\n" for t, x in zip(TIME, swing, strict=True))
    path.write_text(f"Towing tank\nSpeed\t{speed}\nGM\t0.08 m\nTime\tRoll angle\n[s]\t[deg]\n{rows}")
    return path


@pytest.fixture
def logs(tmp_path: Path) -> list[Path]:
    runs = {"a": (12.0, "0.00 m/s"), "b": (-9.0, "1.10 m/s"), "c": (15.0, "0.00 m/s"), "d": (12.0, "1.12 m/s")}
    return [decay(tmp_path / f"{name}.txt", *one) for name, one in {**runs, "e": (10.0, "unknown")}.items()]


def test_the_speed_with_most_decays_is_drafted_and_the_others_are_named(logs: list[Path], tmp_path: Path) -> None:
    draft = draft_trial(*logs, folder=tmp_path, length=4.0, gm=0.08)
    assert 'files = ["a.txt", "c.txt", "e.txt"]' in draft.text and "# left out: b.txt: at 1.1 m/s" in draft.text
    assert "GM = 0.08 " in draft.text and "from_release = true" in draft.text and "parts" not in draft.text
    (other,) = draft.other_speeds
    assert [one.name for one in other.logs] == ["b.txt", "d.txt"]
    assert other.options == ("--length", "4", "--gm", "0.08")


def test_a_speed_is_missed_by_little_and_none_is_rest(logs: list[Path]) -> None:
    runs = runs_of_logs([survey_log(one) for one in logs])
    assert [(speed, len(group)) for speed, group in runs_by_speed(runs)] == [(0.0, 3), (1.1, 2)]
    assert stated_options(StatedSize(), {"Rolle": "phi"}) == ("--column", "Rolle=phi")


def in_waves(path: Path, amplitude: float, speed: float) -> Path:
    """A model in waves of this amplitude [mm] whose header states a speed."""
    wave = amplitude * (np.cos(3.0 * TIME) + 0.5 * np.cos(4.1 * TIME))
    rows = "".join(f"{t:.1f}\t{0.8 * w:.3f}\t{w:.3f}\n" for t, w in zip(TIME, wave, strict=True))
    path.write_text(f"Towing tank\nV = {speed:.2f} m/s\nTime [s]\tHeave [mm]\tWave [mm]\n{rows}")
    return path


def test_runs_in_waves_are_of_one_speed_and_those_in_calm_water_are_named(tmp_path: Path) -> None:
    runs = {"a": (10.0, 0.8), "b": (9.0, 0.8), "c": (10.0, 1.4), "calm": (0.1, 0.8)}
    for name, one in runs.items():
        in_waves(tmp_path / f"{name}.txt", *one)
    draft = draft_trial(tmp_path, folder=tmp_path, length=3.0)
    assert 'files = ["a.txt", "b.txt"]' in draft.text and "\nspeed = 0.8    # m/s, as the header says" in draft.text
    assert [[one.name for one in other.logs] for other in draft.other_speeds] == [["c.txt"]]
    ((path, reason),) = draft.left_out.items()
    assert path.name == "calm.txt" and reason.startswith("no waves in it")
