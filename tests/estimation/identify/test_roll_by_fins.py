"""Roll that fins drive, simulated by its own steps: in calm water determined, in waves nobody measured refused."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.data.draft.draft import draft_trial
from seatrial.data.draft.ship_estimates import StatedSize
from seatrial.data.trial import load_trial
from seatrial.estimation.identify import identify

DAMPING, RESTORING, BY_FINS = 0.12, 0.45, -0.1  # 1/s, 1/s^2, 1/s^2 by a radian
STEP, EVERY, PERIOD = 0.02, 10, 41.0  # s, steps between samples, s of the fins' square wave
SMALLEST, LARGEST = 0.35, 1.6  # rad/s, of the waves


def wave_slopes(time: np.ndarray, size: float, rng: np.random.Generator) -> np.ndarray:
    """Slopes of a sea with a peak of 0.65 rad/s, rms `size` [rad]."""
    omega = np.linspace(SMALLEST, LARGEST, 200)
    amplitude = np.sqrt(np.exp(-1.25 * (0.65 / omega) ** 4) / omega)
    amplitude *= size * np.sqrt(2.0) / np.linalg.norm(amplitude)
    phase = rng.uniform(0.0, 2.0 * np.pi, len(omega))
    return np.asarray(np.cos(np.outer(time, omega) + phase) @ amplitude)


def write_log(path: Path, seconds: float, waves: float, *, in_loop: bool, seed: int) -> None:
    """Roll, its rate and the angle of fins behind a servo of 0.4 s, which follow the rate or a square wave."""
    rng, time = np.random.default_rng(seed), STEP * np.arange(int(seconds / STEP))
    slope, ordered = wave_slopes(time, waves, rng), 0.3 * np.sign(np.sin(2.0 * np.pi * time / PERIOD))
    roll = rate = fins = 0.0
    rows = []
    for k in range(len(time)):
        order = min(max(1.6 * rate, -0.4), 0.4) if in_loop else ordered[k]
        fins += STEP * min(max((order - fins) / 0.4, -0.5), 0.5)
        rate += STEP * (RESTORING * (slope[k] - roll) - DAMPING * rate + BY_FINS * fins)
        roll += STEP * rate
        rows.append((roll, rate, fins))
    table = np.degrees(np.array(rows[::EVERY])) + 0.03 * rng.standard_normal((len(rows[::EVERY]), 3))
    columns = np.column_stack([STEP * EVERY * np.arange(len(table)), table])
    np.savetxt(path, columns, "%.3f", ",", header="time [s],roll [deg],roll rate [deg/s],fin angle [deg]", comments="")


def drafted(folder: Path, *logs: Path) -> Path:
    draft = draft_trial(*logs, folder=folder, size=StatedSize(length=60.0))
    assert "channels.alpha_f" in draft.text
    path = folder / "trial.toml"
    path.write_text(draft.text)
    return path


def test_steps_of_fins_in_calm_water_give_the_coefficients_and_leave_list_and_zero_apart_open(tmp_path: Path) -> None:
    """A zero of the fins and a list do the same: intervals follow the ridge."""
    logs = [tmp_path / f"steps_{number}.csv" for number in (1, 2)]
    for seed, log in enumerate(logs):
        write_log(log, 200.0, 0.0, in_loop=False, seed=seed)
    fit = identify(load_trial(drafted(tmp_path, *logs)))
    found = {c.name: c for c in fit.coefficients if not c.fixed}
    for name, truth in (("c_1", RESTORING), ("K_alpha", BY_FINS / RESTORING), ("b_1", DAMPING)):
        assert found[name].estimate == pytest.approx(truth, rel=0.02)
    ends = (found["phi_0"].lower, found["phi_0"].upper)  # None: the profile did not end
    assert ends[0] is None or ends[0] < -0.01
    assert ends[1] is None or ends[1] > 0.01


def test_fins_that_follow_the_roll_in_waves_nobody_measured_are_refused(tmp_path: Path) -> None:
    log = tmp_path / "loop.csv"
    write_log(log, 500.0, 0.05, in_loop=True, seed=3)
    with pytest.raises(InputError, match=r"the ship rolls although no wave is recorded.*record with held fins"):
        identify(load_trial(drafted(tmp_path, log)))
