"""Held inputs that change within samples: when they do is estimated where records show it, and nothing else moves."""

import math
from itertools import pairwise

import numpy as np

from seatrial.core.results import Fit
from seatrial.core.values import Record, Ship
from seatrial.data.trial import EstimateSettings, Run, Trial
from seatrial.estimation.identify import identify
from seatrial.physics.models import model_named

K, T, DT, ROWS = 0.12, 9.0, 1.0, 321


def rudder(steps: np.ndarray, time: float | np.ndarray) -> np.ndarray:
    """Rudder to one side and the other in turn, rad, from each of these times on [samples]."""
    return math.radians(10.0) * (np.searchsorted(steps, time, side="right") % 2 * 2 - 1)


def steered(shares: np.ndarray, rng: np.random.Generator, late: EstimateSettings) -> Fit:
    """Fit a boat whose rudder goes from side to side so much of a sample before the row that shows it."""
    rows = 20 * (1 + np.arange(len(shares)))
    switched = rows - shares
    motion, x = [np.zeros(2)], np.zeros(2)
    edges = np.unique(np.concatenate([np.arange(ROWS), switched]))
    for a, b in pairwise(edges.tolist()):
        h, held = b - a, rudder(switched, a)
        r = K * held + (x[0] - K * held) * math.exp(-h / T)  # T r' + r = K delta, solved over a time h
        x = np.array([r, x[1] + K * held * h + (x[0] - K * held) * T * (1.0 - math.exp(-h / T))])
        if b == round(b):
            motion.append(x)
    delta = rudder(rows, np.arange(ROWS))
    noisy = np.array(motion) + np.radians([0.02, 0.04]) * rng.standard_normal((ROWS, 2))
    record = Record.from_arrays("run", DT * np.arange(ROWS), {"delta": delta, "r": noisy[:, 0], "psi": noisy[:, 1]})
    return identify(Trial(Ship("boat", {"L": 8.0}), (Run(record),), model_named("nomoto"), estimate=late))


def errors(fit: Fit) -> dict[str, float]:
    """Errors of K and T in half widths of their intervals."""
    rows = {c.name: c for c in fit.coefficients if c.upper is not None and c.lower is not None}
    return {n: abs(rows[n].estimate - v) / (0.5 * (rows[n].upper - rows[n].lower)) for n, v in (("K", K), ("T", T))}


def test_times_of_steps_within_samples_are_estimated(rng: np.random.Generator) -> None:
    fit = steered(rng.uniform(0.0, 1.0, 15), rng, EstimateSettings())
    notes = [f for f in fit.findings if f.code == "stepped-input"]
    assert [f.message.count("15 steps") for f in notes] == [1]
    assert max(errors(fit).values()) <= 1.0


def test_steps_at_samples_stay_there(rng: np.random.Generator) -> None:
    fit = steered(np.zeros(15), rng, EstimateSettings())
    assert not any("steps are estimated" in f.message for f in fit.findings)
    assert max(errors(fit).values()) <= 1.5


def test_declared_timing_is_believed(rng: np.random.Generator) -> None:
    fit = steered(rng.uniform(0.0, 1.0, 15), rng, EstimateSettings(delays={"delta": 0.0}))
    assert not any("steps are estimated" in f.message for f in fit.findings)
