"""A page stays small: a megabyte for fifteen runs of eight channels, half as much again for two hundred."""

from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.complete_fit import complete_fit
from tests.reporting.fabricated import fabricated_fit

from seatrial.core.results import Fit, Prediction
from seatrial.core.values import Record
from seatrial.reporting.page import html
from seatrial.reporting.runs import MAX_DRAWN, WORST_DRAWN, drawn_predictions, hidden_runs_sentence

SAMPLES = 4_000


def dense(record: Record, name: str, rng: np.random.Generator) -> Record:
    """The record with many samples of eight channels that move, as a log has."""
    time = np.linspace(record.time[0], record.time[-1], SAMPLES)
    columns = {c: np.interp(time, record.time, record[c]) for c in ("x0", "y0", "psi", "u", "v", "r", "delta")}
    columns["v_j"], columns["n"], columns["phi"] = (rng.standard_normal(SAMPLES) for _ in range(3))
    noisy = {c: values + 0.01 * rng.standard_normal(SAMPLES) for c, values in columns.items()}
    return Record.from_arrays(name, time, noisy)


def with_runs(count: int, held: int) -> Fit:
    """A complete fit with so many runs, the last ones held out, each worse than the one before."""
    rng = np.random.default_rng(3)
    fit = complete_fit(fabricated_fit())
    measured, simulated = (dense(fit.predictions[0].measured, "run", rng) for _ in range(2))

    band = {"psi": np.full(SAMPLES, 0.05)}

    def run(k: int) -> Prediction:
        name, role = f"run_{k:03d}", "validation" if k >= count - held else "training"
        one, rms = replace(measured, name=name), {"psi_deg": 1.0 + k, "position_m": 1.0}
        return replace(fit.predictions[-1], record=name, role=role, rms=rms, measured=one, simulated=simulated,
                       half_width=band)  # fmt: skip

    runs = tuple(run(k) for k in range(count))
    return replace(fit, predictions=runs, records=tuple(p.measured for p in runs))


def test_fifteen_runs_of_eight_channels_take_a_megabyte() -> None:
    fit = with_runs(15, 3)
    text = html(fit)
    assert text.count('"label"') >= 15 * 8
    assert len(text.encode()) < 1_000_000


def test_of_two_hundred_runs_the_worst_are_drawn() -> None:
    fit = with_runs(200, 40)
    drawn = drawn_predictions(fit.predictions)
    assert [p.record for p in drawn if p.role == "training"] == [f"run_{k}" for k in range(160 - WORST_DRAWN, 160)]
    assert sum(p.role == "validation" for p in drawn) == WORST_DRAWN
    text = html(fit)
    assert hidden_runs_sentence(fit.predictions) in text and "run_000" in text
    assert len(text.encode()) < 1_500_000


@pytest.mark.parametrize(("count", "hidden"), [(MAX_DRAWN, False), (MAX_DRAWN + 1, True)])
def test_of_few_runs_all_are_drawn(count: int, hidden: bool) -> None:
    runs = with_runs(count, 1).predictions
    assert bool(hidden_runs_sentence(runs)) == hidden == (len(drawn_predictions(runs)) < count)
