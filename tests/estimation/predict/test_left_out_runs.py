"""Bands in windows against what a craft then does whose moments no model has: own equations, Euler steps of 10 ms."""

from typing import cast

import numpy as np
import pytest

from seatrial.core.results import Fit
from seatrial.core.values import Record, Ship
from seatrial.data.trial import EstimateSettings, Role, Run, Trial
from seatrial.estimation.identify import identify
from seatrial.estimation.information.discrepancy import NO_DISCREPANCY, HoldoutError
from seatrial.estimation.predict.draws import PredictionUncertainty
from seatrial.estimation.predict.prediction_intervals import HoldoutModel, HoldoutRun, HoldoutRuns, RunErrors
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.models.nomoto import nomoto

STEP, EVERY = 0.01, 50
"""Step of the integration [s], and steps between samples."""
NOISE = {"r": 5e-4, "psi": 1e-3}


def run(number: int, wander: float, seconds: float = 240.0) -> Record:
    """A zigzag of a first-order ship, K 0.15/s and T 8 s, moved by a moment that forgets itself in 20 s."""
    rng, count = np.random.default_rng((7, number)), round(seconds / STEP / EVERY)
    time = STEP * EVERY * np.arange(count, dtype=np.float64)
    size = 5 * number % 8
    delta = np.radians(10.0 + size) * np.sign(np.sin(2.0 * np.pi * (time + 3.0 * number) / (50.0 + 3.0 * size)))
    r, psi, moment, rates, headings = 0.0, 0.0, 0.0, [], []
    for angle in delta:
        rates.append(r)
        headings.append(psi)
        for _ in range(EVERY):
            moment += -STEP / 20.0 * moment + wander * np.sqrt(2.0 * STEP / 20.0) * rng.standard_normal()
            r += STEP * ((0.15 * angle - r) / 8.0 + moment)
            psi += STEP * r
    read = {"r": np.array(rates), "psi": np.array(headings)}
    noisy = {c: v + NOISE[c] * rng.standard_normal(count) for c, v in read.items()}
    return Record.from_arrays(f"run {number}", time, {"delta": delta, "u": np.full(count, 2.0), **noisy})


def fit_of(wander: float, held_out: int = 4) -> Fit:
    """Return the fit of eight runs over segments of 20 s, further ones held out."""
    runs = tuple(
        Run(run(k, wander), Role.TRAIN if k < 8 else Role.VALIDATE) for k in range(8 + held_out)
    )  # fmt: skip
    settings = EstimateSettings(segment_s=20.0, delays={"delta": 0.0})
    trial = Trial(Ship("craft", {"L": 8.0}), runs, nomoto(), estimate=settings)
    return identify(trial, windows="5s,20s,60s")


@pytest.fixture(scope="module")
def wandering() -> Fit:
    return fit_of(3e-4)


def shares(fit: Fit, window: int) -> tuple[float, float]:
    """Share of the heading inside its band, and rms half width of the band over rms error, of all runs held out."""
    scores = [p.windows[window].scores["psi_deg"] for p in fit.validation]
    inside = [s.inside_band or 0.0 for s in scores]
    half = [s.rms * (s.band_over_error or 0.0) for s in scores]
    return float(np.mean(inside)), float(np.linalg.norm(half) / np.linalg.norm([s.rms for s in scores]))


@pytest.mark.parametrize("window", [0, 1, 2])
def test_bands_of_every_length_hold_what_no_model_explains(wandering: Fit, window: int) -> None:
    inside, width = shares(wandering, window)
    assert 0.88 <= inside <= 1.0
    assert 1.4 <= width <= 2.9


def test_the_noise_of_sensors_counts_once() -> None:
    """Without a moment all that is missed is noise of the compass and of the start: bands of two errors, not three."""
    inside, width = shares(fit_of(0.0, held_out=2), 0)
    assert 0.92 <= inside <= 0.98
    assert width < 2.5


def known(size: float, kind: str, number: int) -> RunErrors:
    """One window of ten samples, missed by so much, nothing of it foreseen."""
    sides = size * np.where(np.arange(10) % 2, 1.0, -1.0)
    return RunErrors(kind, (HoldoutError(f"{kind} {number}", 0.5, {"psi": sides}, {"psi": np.zeros(10)}),))


def test_a_kind_of_manoeuvre_with_runs_enough_is_calibrated_by_itself() -> None:
    kinds = [known(1.0, "zigzag", k) for k in range(3)] + [known(7.0, "turning-circle", k) for k in range(2)]
    record = Record.from_arrays("run", 0.5 * np.arange(100.0), {"psi": np.zeros(100)})
    held = HoldoutRun(record, cast(HoldoutModel, None), cast(PredictionUncertainty, None), 1.0)
    runs = HoldoutRuns(cast(OutputError, None), (held,), 1.0, NO_DISCREPANCY, 0, of_length={10: kinds})
    pooled = np.sqrt((3.0 * 1.0 + 2.0 * 49.0) / 5.0)
    for kind, expected in (("zigzag", 1.0), ("turning-circle", pooled), ("", pooled)):
        assert runs.discrepancy(5.0, kind).sd_by_time["psi"] == pytest.approx(np.full(10, expected))
