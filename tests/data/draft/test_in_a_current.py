"""Drafts of logs whose only speed is that of fixes: the speed through the water with the current, or OPEN."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.data.draft import DraftTrial, draft_trial
from seatrial.data.draft.ship_estimates import StatedSize
from seatrial.data.trial import load_trial

_DEGREE_M = 111_320.0  # m of latitude


def _log(path: Path, course: float, circle: float, current: tuple[float, float]) -> Path:
    """A zigzag of 4 min and a circle at 3 m/s that falls in the turns, at 2 Hz."""
    time = 0.5 * np.arange(720)
    delta = np.where(time < 20.0, 0.0, np.radians(15.0) * np.sign(np.sin(2.0 * np.pi * (time - 20.0) / 40.0)))
    delta = np.where(time > 240.0, circle, delta)
    rate, u, psi, north, east = 0.0, 3.0, course, 0.0, 0.0
    rows = []
    for t, d in zip(time, delta, strict=True):
        rows.append(
            f"{t:.1f},{48.0 + north / _DEGREE_M:.8f},{east / _DEGREE_M / np.cos(np.radians(48.0)):.8f},"
            f"{np.degrees(psi) % 360.0:.2f},{np.degrees(d):.2f}"
        )
        rate += 0.5 * (0.2 * d - rate) / 4.0
        u += 0.5 * (3.0 - 60.0 * rate**2 - u) / 10.0
        psi += 0.5 * rate
        v = -2.0 * rate
        north += 0.5 * (u * np.cos(psi) - v * np.sin(psi) + current[0])
        east += 0.5 * (u * np.sin(psi) + v * np.cos(psi) + current[1])
    path.write_text("time [s],lat,lon,heading [deg],rudder [deg]\n" + "\n".join(rows) + "\n")
    return path


def _draft(folder: Path, circle: float, current: tuple[float, float]) -> DraftTrial:
    logs = [_log(folder / f"run{k}.csv", course, circle, current) for k, course in enumerate((0.5, 3.4))]
    return draft_trial(*(logs if circle else logs[:1]), folder=folder, size=StatedSize(length=8.0, antenna=0.0))


def _number(text: str, key: str) -> float:
    (line,) = (one for one in text.splitlines() if one.startswith(f"{key} = "))
    return float(line.split("=")[1].split("#")[0])


def test_a_tide_is_drafted_with_the_speed_through_the_water(tmp_path: Path) -> None:
    text = _draft(tmp_path, np.radians(15.0), (0.4, 1.2)).text
    assert _number(text, "U_n") == pytest.approx(3.0, abs=0.1) and "current of 1.2" in text
    assert _number(text, "current") == pytest.approx(1.3, abs=0.11)
    assert '"U_n"]' in text and "[model.priors.U_n]" in text
    assert 'session = "all"    # of one place' in text


@pytest.mark.parametrize(("third", "is_shared"), [((0.4, 1.2), True), ((0.4, 0.9), False)])
def test_runs_share_a_session_where_no_two_of_them_show_different_currents(
    tmp_path: Path, third: tuple[float, float], *, is_shared: bool
) -> None:
    """The first two agree; the third differs from both or from none."""
    currents = ((0.4, 1.2), (0.4, 1.2), third)
    logs = [_log(tmp_path / f"run{k}.csv", 0.5 + k, np.radians(15.0), current) for k, current in enumerate(currents)]
    text = draft_trial(*logs, folder=tmp_path, size=StatedSize(length=8.0, antenna=0.0)).text
    assert ('session = "all"' in text) == is_shared


def test_one_course_leaves_it_open(tmp_path: Path) -> None:
    draft = _draft(tmp_path, 0.0, (0.4, 1.2))
    assert draft.lacks_speed and "\nU_n" not in draft.text
    (tmp_path / "trial.toml").write_text(draft.text)
    with pytest.raises(InputError, match=r"needs U_n.*'# OPEN U_n' says what to choose"):
        load_trial(tmp_path / "trial.toml")


@pytest.mark.parametrize(("circle", "shows_zero"), [(np.radians(15.0), True), (0.0, False)])
def test_several_courses_show_the_zero_of_the_compass(tmp_path: Path, circle: float, *, shows_zero: bool) -> None:
    logs = []
    for k, course in enumerate((0.5, 3.4) if circle else (0.5,)):
        table = np.loadtxt(_log(tmp_path / "t.csv", course, circle, (0.4, 0.6)), delimiter=",", skiprows=1)
        north, east = table[:, 1] * _DEGREE_M, table[:, 2] * _DEGREE_M * np.cos(np.radians(48.0))
        over_ground = np.gradient(north, 0.5) + 1j * np.gradient(east, 0.5)
        sog, cog = np.abs(over_ground), np.degrees(np.angle(over_ground)) % 360.0
        path = tmp_path / f"fixes{k}.csv"
        names = "time [s],lat,lon,heading [deg],rudder [deg],sog [m/s],cog [deg]"
        np.savetxt(path, np.column_stack([table, sog, cog]), "%.8f", ",", header=names, comments="")
        logs.append(path)
    text = draft_trial(*logs, folder=tmp_path, size=StatedSize(length=8.0, antenna=0.0)).text
    assert 'velocity = "ground"' in text and ('compass = "offset"' in text) == shows_zero
