"""Fed sample by sample: a craft that is steered, a ship that rolls out, and outages in waves, against the batch fit."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.estimation.identify.online.streams import feed, sea_stream

from seatrial.core.results import Fit
from seatrial.core.results.online import EstimatorPhase, Snapshot
from seatrial.core.values import Channel, Record
from seatrial.data.trial import Role, Trial, load_trial
from seatrial.data.trial.records import trim_to_decay_start
from seatrial.data.trial.settings import Stream, StreamSource
from seatrial.estimation.identify.identify import identify
from seatrial.estimation.identify.online import OnlineEstimator

EXAMPLES = Path(__file__).parents[4] / "examples"


def _stream(name: str) -> tuple[Trial, Record]:
    """An example's trial without its runs, following the columns of its training run; and that run."""
    trial = load_trial(EXAMPLES / f"{name}.toml")
    (run,) = [r for r in trial.runs if r.role is Role.TRAIN]
    raw = run.raw_record()
    return replace(
        trial,
        runs=(),
        stream=Stream(source=StreamSource.STDIN, layout=run.files[0].layout, rate=1.0 / raw.dt, name=run.name),
    ), raw


def _off(snapshot: Snapshot, fit: Fit) -> np.ndarray:
    """Differences in standard errors, of what ends on a bound and has none in prior ones."""
    batch = {c.name: c for c in fit.coefficients}
    pairs = zip(snapshot.names, snapshot.value, strict=True)
    errors = {n: c.standard_error or c.prior_standard_deviation or abs(c.estimate) or 1.0 for n, c in batch.items()}
    return np.array([(v - batch[n].estimate) / errors[n] for n, v in pairs])


@pytest.fixture(scope="module")
def zigzags():
    """The waterjet craft's first zigzags, 10/10 and some 15/15; the last snapshot, and one from a search at the end."""
    trial, raw = _stream("waterjet")
    estimator = OnlineEstimator(trial)
    assert trial.stream is not None
    snapshot = feed(estimator, raw, trial, slice(0, 600))
    return trial, estimator, snapshot, estimator.relinearise()


def test_zigzags_end_at_the_batch_estimate(zigzags):
    trial, estimator, _, ended = zigzags
    fit = identify(replace(trial, runs=estimator.raw_runs()))
    assert np.max(np.abs(_off(ended, fit))) < 0.01
    inside = [c.standard_error is not None for c in fit.coefficients if not c.fixed]  # none of what ends on a bound
    known = np.column_stack([ended.standard_error, np.sqrt(np.diag(fit.covariance))])[inside]
    assert len(known) >= len(ended.names) - 1
    np.testing.assert_allclose(known[:, 0], known[:, 1], rtol=0.02)


def test_what_small_zigzags_do_not_tell_is_said(zigzags):
    *_, ended = zigzags
    assert "X_rr" in ended.unidentified
    assert not {"X_uu", "Y_v", "N_v", "N_r"} & set(ended.unidentified)


def test_the_truth_lies_within_the_errors(zigzags):
    trial, _, _, ended = zigzags
    truth = np.array([trial.truth[n] for n in ended.names])
    assert np.all(np.abs(ended.value - truth) < 4.0 * ended.standard_error)


def test_a_straight_run_first_is_not_fatal():
    trial, raw = _stream("waterjet")
    assert trial.stream is not None
    estimator = OnlineEstimator(trial)
    straight = raw.rows(slice(0, 120))
    straight = straight.with_channel("delta", straight.channel("delta").with_values(np.zeros(120)))
    early = feed(estimator, straight, trial)
    assert early.phase is EstimatorPhase.WAITING
    assert "never moves" in early.advice


def test_a_roll_decay_ends_at_the_batch_estimate():
    trial, raw = _stream("fin_decay")
    assert trial.stream is not None
    estimator = OnlineEstimator(trial)
    snapshot = feed(estimator, trim_to_decay_start(raw), trial)
    ended = estimator.relinearise()
    fit = identify(replace(trial, runs=estimator.raw_runs()))
    assert np.max(np.abs(_off(ended, fit))) < 0.01
    assert np.max(np.abs(_off(snapshot, fit))) < 1.5
    truth = np.array([trial.truth[n] for n in ended.names])
    assert np.all(np.abs(ended.value - truth) < 4.0 * ended.standard_error)


def _held_before(record: Record, seconds: float, noise: float) -> Record:
    """A decay of a ship that is held at its first angle for so long, with noise [rad]."""
    rows, phi = round(seconds / record.dt), record["phi"]
    held = phi[0] + noise * np.random.default_rng(1).standard_normal(rows)
    time = record.time[0] + record.dt * np.arange(rows + len(phi))
    return Record(record.name, time, {"phi": Channel.from_notation("phi", np.concatenate([held, phi]))})


def test_a_ship_that_is_held_is_estimated_from_its_release_on():
    trial, raw = _stream("fin_decay")
    decay = trim_to_decay_start(raw)
    held = _held_before(decay, 6.0, 5e-4)
    estimator = OnlineEstimator(trial)
    waiting = feed(estimator, held, trial, slice(0, round(9.0 / held.dt)))  # released for 3 s
    assert waiting.phase is EstimatorPhase.WAITING
    assert "may still be held" in waiting.advice
    feed(estimator, held, trial, slice(round(9.0 / held.dt), None))
    ended = estimator.relinearise()
    fit = identify(replace(trial, runs=estimator.raw_runs()))
    assert np.max(np.abs(_off(ended, fit))) < 0.01
    truth = np.array([trial.truth[n] for n in ended.names])
    assert np.all(np.abs(ended.value - truth) < 4.0 * ended.standard_error)


@pytest.fixture(scope="module")
def outages():
    """Two minutes in waves with a fin; the motion sensor loses a second three times, the whole logger once."""
    stream = sea_stream(135, 120.0, seed=3)
    return stream.trial, stream.record, stream.truth


def _with_outages(record: Record, symbols: tuple[str, ...], starts: tuple[int, ...]) -> Record:
    for symbol in symbols:
        values = np.array(record[symbol])
        for first in starts:
            values[first : first + 10] = np.nan
        record = record.with_channel(symbol, record.channel(symbol).with_values(values))
    return record


def test_a_second_without_motions_costs_its_samples_alone(outages):
    """Cells that were filled are no measurements: errors grow by about as much as information is lost."""
    trial, record, truth = outages
    best = feed(OnlineEstimator(trial), record, trial)
    snapshot = feed(OnlineEstimator(trial), _with_outages(record, ("z", "theta"), (200, 555, 900)), trial)
    assert snapshot.phase is EstimatorPhase.WINDOW
    assert np.all(np.abs(snapshot.value - truth) < 4.0 * snapshot.standard_error)
    growth = snapshot.standard_error / best.standard_error
    assert np.all((growth > 1.0) & (growth < 1.1))  # 30 of 1201 samples; 1.3 % if all were worth the same


def test_a_logger_that_stops_for_a_second_goes_on_in_a_new_run(outages):
    trial, record, truth = outages
    estimator = OnlineEstimator(trial)
    feed(estimator, record, trial, slice(0, 600))
    estimator.begin_run()
    snapshot = feed(estimator, record, trial, slice(610, None))
    assert snapshot.runs == 2
    assert np.mean(np.abs(snapshot.value / truth - 1.0)) < 0.01
