"""Forces of a box that stand in for a hull's are in the intervals: a hull with others, by equations of its own."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.results import Fit
from seatrial.data.trial import load_trial
from seatrial.estimation.identify.identify import identify
from seatrial.physics.hydro.excitation import BoxForceError, BoxHull, G

TRUTH = {"a33": 71.5, "a35": 1.9, "a55": 20.7, "a53": 1.9, "b33": 256.0, "b35": 110.0, "b55": 140.0, "b53": -122.0}
M, I5, C33, C55, LENGTH, SPEED = 70.0, 29.5, 6830.0, 2550.0, 2.6, 1.6
TRIAL = f"""
[ship]
name = "tank model"
L = {LENGTH}
B = 0.36
d = 0.13
m = {M}
I5 = {I5}
c33 = {C33}
c35 = 0.0
c53 = 0.0
c55 = {C55}
[model]
name = "heave_pitch"
[excitation]
source = "box"
[estimate]
method = "output-error"
[[records]]
files = ["run.csv"]
channels.zeta = {{ column = "zeta", unit = "m" }}
channels.z = {{ column = "z", unit = "m", positive = "up" }}
channels.theta = {{ column = "theta", unit = "rad", positive = "bow down" }}
time = {{ column = "t", unit = "s" }}
[records.waves]
heading = {{ value = 180, unit = "deg" }}
speed = {SPEED}
"""


def motions(lacking: float) -> np.ndarray:
    """Time, elevation, heave and pitch of 120 s in head seas: every component's answer, exact in frequency.

    The hull's forces are the box's, and `lacking` of the static force a quarter period off, as its damping makes it.
    """
    rng, time = np.random.default_rng(3), 0.05 * np.arange(2400)
    omega = np.linspace(2.5, 7.5, 160)
    amplitude = 0.002 * np.exp(-(((omega - 4.3) / 1.3) ** 2)) * np.exp(2j * np.pi * rng.random(160))
    met, k = omega + omega**2 / G * SPEED, omega**2 / G
    F3, M5 = BoxHull(LENGTH, 0.36, 0.13, C33, 0.0, 0.0, C55).forces(omega, SPEED, np.pi)
    force = np.stack([F3 + 1j * lacking * C33, M5 + lacking * k * C55], axis=1) * amplitude[:, None]
    A, B = ([[TRUTH[f"{c}33"], TRUTH[f"{c}35"]], [TRUTH[f"{c}53"], TRUTH[f"{c}55"]]] for c in "ab")
    w = met[:, None, None]
    plant = np.diag([C33, C55]) - w**2 * (np.diag([M, I5]) + np.array(A)) + 1j * w * np.array(B)
    answer = np.linalg.solve(plant, force[:, :, None])[:, :, 0]
    turning = np.exp(1j * met * time[:, None])
    noise = rng.standard_normal((2400, 2)) * [2e-4, 3e-4]
    return np.column_stack([time, (turning @ amplitude).real, (turning @ answer).real + noise])


def write_trial(folder: Path, lacking: float, text: str = TRIAL, seconds: float = 120.0) -> Path:
    """The trial of a hull whose forces lack that share of the static ones, as the text has it."""
    rows = motions(lacking)[: round(20.0 * seconds)]
    np.savetxt(folder / "run.csv", rows, delimiter=",", header="t,zeta,z,theta", comments="")
    (folder / "trial.toml").write_text(text)
    return folder / "trial.toml"


@pytest.fixture(scope="module", params=[pytest.param(0.06, marks=pytest.mark.long), 0.12])
def fit(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """The fit of such a hull."""
    return identify(load_trial(write_trial(tmp_path_factory.mktemp("hull"), request.param)))


def test_intervals_hold_a_hull_whose_forces_are_not_the_boxs(fit: Fit) -> None:
    outside = [
        c.name for c in fit.coefficients
        if c.name in TRUTH and not (c.lower is not None and c.upper is not None and c.lower <= TRUTH[c.name] <= c.upper)
    ]  # fmt: skip
    assert outside == []
    plain = 2.0 * np.sqrt(np.diag(fit.covariance))
    missed = sum(abs(fit.model.parameters[n].value - TRUTH[n]) > h for n, h in zip(TRUTH, plain, strict=True))
    assert missed >= 5, "the records' own errors alone do not hold the truth"


def test_the_finding_names_what_the_forces_leave_open_and_what_to_give(fit: Fit) -> None:
    """The instruments are right: nothing is said of them."""
    assert "sensor-error" not in {f.code for f in fit.findings}
    finding = next(f for f in fit.findings if f.code == "estimated-values")
    assert "wave forces are those of a box" in finding.text
    assert "not determined by these records" in finding.evidence
    assert "a53" in finding.evidence
    assert "capytaine" in finding.advice


def test_ways_to_be_wrong_add_up_to_the_whole_error_at_every_frequency() -> None:
    """In waves beyond either end, where one way alone is at work, the variance is that of both phases."""
    box = BoxHull(LENGTH, 0.36, 0.13, C33, 0.0, 0.0, C55)
    omega = np.sqrt(2.0 * np.pi * G / (LENGTH * np.array([6.0, 3.0, 0.8, 0.5])))
    ways = BoxForceError.all_of(box)
    assert len({w.name for w in ways}) == 8
    power = sum(np.abs(w.forces(omega, SPEED, np.pi)[0]) ** 2 for w in ways)
    np.testing.assert_allclose(power, C33**2 * (0.07**2 + 0.12**2), rtol=1e-12)
