"""A ship that changes while a stream is followed to its end: the result is of the ship as she is at last."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.trial import load_trial
from seatrial.onboard.follow import follow
from seatrial_studies.seaway import SeawayScenario, ship, simulate_seaway_run

GROWTH, CHANGED, SECONDS, HEADING = 1.3, 60.0, 160.0, 135  # 1, s, s, deg
TRIAL = """
[ship]
name = "ship"
L = 60.0
m = 4.42e5
I5 = 9.945e7
c33 = 3.15e6
c35 = 6.83e6
c53 = 6.83e6
c55 = 6.54e8

[follow]
source = "file"
file = "voyage.csv"
rate = 10
time = { column = "time", unit = "s" }

[follow.channels]
F3 = { column = "F3", unit = "N" }
M5 = { column = "M5", unit = "N m" }
delta_f1 = { column = "delta_f1", unit = "rad", positive = "up" }
z = { column = "z", unit = "m", positive = "down" }
theta = { column = "theta", unit = "rad", positive = "bow up" }

[model]
name = "heave_pitch"
fixed = { lift_1 = 791060.0, x_f1 = -25.0 }
"""
CHANNELS = ("F3", "M5", "delta_f1", "z", "theta")


def voyage(factor: float, seed: int) -> Record:
    """The same sea, the added mass in heave times a factor."""
    scenario = SeawayScenario(HEADING, duration=SECONDS)
    loaded = ship(HEADING).with_values({"a33": factor * ship(HEADING).parameters["a33"].value})
    run = simulate_seaway_run(scenario, np.random.default_rng(5), loaded)
    return run.with_sensor_noise(np.random.default_rng(seed), scenario)


def test_the_fit_is_of_the_samples_behind_a_change_and_names_it(tmp_path: Path) -> None:
    before, after = voyage(1.0, 1), voyage(GROWTH, 2)
    columns = [np.where(before.time < CHANGED, before[c], after[c]) for c in CHANNELS]
    np.savetxt(
        tmp_path / "voyage.csv", np.column_stack([before.time, *columns]), "%.8g", ",",
        header=",".join(("time", *CHANNELS)), comments="",
    )  # fmt: skip
    (tmp_path / "trial.toml").write_text(TRIAL)
    outcome = follow(load_trial(tmp_path / "trial.toml"), once=True)
    assert outcome.fit is not None
    finding = next(f for f in outcome.fit.findings if f.code == "coefficients-changed")
    assert "a33 by +30 %" in finding.evidence
    a33 = next(c for c in outcome.fit.coefficients if c.name == "a33")
    truth = GROWTH * ship(HEADING).parameters["a33"].value
    assert a33.standard_error is not None
    assert abs(a33.estimate - truth) < 4.0 * a33.standard_error
    assert a33.standard_error == pytest.approx(0.0, abs=0.02 * truth)
