"""Cross-validation over whole runs: what is held out stays out, and a true model predicts its own windows."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate import EstimatorOptions, Runs
from seatrial.estimation.predict.session_offsets import session_offsets
from seatrial.estimation.predict.windows import HoldoutProtocol, WindowError, split_windows, window_errors
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.steer import manoeuvre
from seatrial_studies.cross_validation import (
    CrossValidation,
    Fold,
    assign_folds,
    cross_validate,
    cross_validate_unfitted,
    fit_folds,
)

RUNS = ("zigzag:20/20", "zigzag:10/10", "turning-circle:20", "turning-circle:15:port")
LABELS = ("zigzag", "zigzag", "turning", "turning")
SESSIONS = ("monday", "tuesday", "monday", "wednesday")
SETTINGS, OPTIONS = EstimateSettings(segment_s=60.0, offsets={"delta": 0.05}), EstimatorOptions(workers=1)
PROTOCOL = HoldoutProtocol(window_s=40.0)


@pytest.fixture(scope="module")
def truth() -> Model:
    return nomoto().with_values({"K": 0.15, "T": 8.0, "U": 1.0})


@pytest.fixture(scope="module")
def records(truth: Model) -> list[Record]:
    return [
        manoeuvre(truth, programme(text), dt=0.5, speed=1.0, duration=130.0).renamed(f"{label}_{i}")
        for i, (text, label) in enumerate(zip(RUNS, LABELS, strict=True))
    ]


def runs_of(records: list[Record]) -> Runs:
    return Runs(tuple(records), SESSIONS, 7.0)


@pytest.fixture(scope="module")
def folds(truth: Model, records: list[Record]) -> tuple[Fold, ...]:
    return fit_folds(truth.with_values({"K": 0.1, "T": 10.0}), runs_of(records), LABELS, SETTINGS, OPTIONS, folds=2)


def test_every_fold_holds_out_its_share_of_every_label() -> None:
    labels = ["turning"] * 5 + ["zigzag"] * 4
    dealt = assign_folds(labels, 4)
    assert dealt == [0, 1, 2, 3, 0, 0, 1, 2, 3]
    with pytest.raises(InputError, match=r"'zigzag' has 1 runs, fewer than 2 folds"):
        assign_folds(["turning", "turning", "zigzag"], 2)
    with pytest.raises(InputError, match="1 folds hold nothing out"):
        assign_folds(labels, 1)


def test_windows_follow_one_another_and_the_remainder_is_dropped(records: list[Record]) -> None:
    made = split_windows(records[2], PROTOCOL)
    assert [w.time[0] for w in made] == [0.0, 40.0, 80.0]
    assert all(w.duration == 40.0 for w in made)
    assert len(split_windows(records[2], replace(PROTOCOL, max_windows=2))) == 2
    assert split_windows(records[2], HoldoutProtocol(window_s=500.0)) == []


def test_a_model_of_the_right_form_predicts_runs_it_has_not_seen(
    folds: tuple[Fold, ...], records: list[Record]
) -> None:
    made = cross_validate(folds, runs_of(records), LABELS, PROTOCOL)
    assert {w.run for w in made.windows} == {r.name for r in records}
    for label in made.labels:
        assert made.pooled(label).heading_deg < 1e-3
        assert made.pooled(label).position_m < 1e-3


def test_only_the_first_seconds_of_a_window_are_used(folds: tuple[Fold, ...], records: list[Record]) -> None:
    fold = folds[0]
    record = records[fold.held_out[0]].between(0.0, 40.0)
    psi = record.channel("psi")
    shifted = psi.with_values(psi.values + np.where(record.time > 5.0, np.radians(10.0), 0.0))
    own = session_offsets(fold.estimation, SESSIONS[fold.held_out[0]], record).expected
    found = window_errors(
        fold.estimation.estimate.problem,
        fold.estimation.model,
        [record.with_channel("psi", shifted)],
        [own],
        ["zigzag"],
        PROTOCOL,
    )
    assert found[0].heading_deg == pytest.approx(10.0 * np.sqrt(np.mean(record.time > 5.0)), rel=1e-3)


def test_the_first_sample_as_it_is_and_models_as_they_are(truth: Model, records: list[Record]) -> None:
    raw = cross_validate_unfitted(truth, runs_of(records), LABELS, replace(PROTOCOL, initial_s=0.0))
    assert raw.pooled("turning").position_m < 1e-9
    assert (
        cross_validate_unfitted(truth.with_values({"K": 0.1}), runs_of(records), LABELS, PROTOCOL)
        .pooled("turning")
        .heading_deg
        > 5.0
    )


def test_errors_are_pooled_by_label_and_scatter_between_folds() -> None:
    errors = [(0, 1.0, 3.0), (0, 2.0, 4.0), (1, 4.0, 5.0)]
    made = CrossValidation(tuple(WindowError("run", "turning", f, 0.0, p, h) for f, p, h in errors))
    pooled = made.pooled("turning")
    assert (pooled.windows, pooled.position_m, pooled.heading_deg) == (3, pytest.approx(7 / 3), 4.0)
    assert pooled.rms_position_m == pytest.approx(np.sqrt(7.0))
    assert made.fold_spread("turning") == (pytest.approx(2.5 / np.sqrt(2)), pytest.approx(1.5 / np.sqrt(2)))
    with pytest.raises(InputError, match="no window of 'zigzag' in fold 1"):
        made.pooled("zigzag", 1)


def test_what_cannot_be_judged_is_refused(truth: Model, records: list[Record]) -> None:
    with pytest.raises(InputError, match="no run is as long as a window of 500 s"):
        cross_validate_unfitted(truth, runs_of(records), LABELS, HoldoutProtocol(window_s=500.0))
    with pytest.raises(InputError, match="has no 'x0'; windows are judged by position and heading"):
        cross_validate_unfitted(truth, runs_of([r.without("x0") for r in records]), LABELS, PROTOCOL)
