"""Runs left out decide where residuals stay coloured: zigzags of a nonlinear craft, fitted by a linear model."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate import Estimation, EstimatorOptions, Runs, estimate_model
from seatrial.estimation.estimate.criterion_choice import WHOLE_RUNS
from seatrial.estimation.identify.criterion_by_whole_runs import (
    WholeRunErrors,
    is_better,
    is_preferred,
    left_out_errors,
    lost_count,
    mean_text,
    preferred_estimation,
    whole_run_errors,
)
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.steer import manoeuvre

OPTIONS, SETTINGS, START_S = EstimatorOptions(workers=1), EstimateSettings(), 5.0
NOISE = {"psi": 1e-3, "r": 3e-4}


@pytest.fixture(scope="module")
def runs() -> Runs:
    """Five zigzags of a craft that turns less than in proportion to its rudder."""
    truth = nomoto().with_values({"K": 0.15, "T": 8.0, "U": 1.0, "alpha": 30.0})
    rng, records = np.random.default_rng(0), []
    for helm, heading in ((10, 5), (15, 10), (20, 10), (25, 15), (30, 20)):
        run = manoeuvre(truth, programme(f"zigzag:{helm}/{heading}"), dt=0.5, speed=1.0, duration=100.0)
        for channel, size in NOISE.items():
            noisy = run[channel] + size * rng.standard_normal(len(run.time))
            run = run.with_channel(channel, run.channel(channel).with_values(noisy))
        records.append(run.renamed(f"zigzag {helm}/{heading}"))
    return Runs.one_session_each(records, 7.0)


@pytest.fixture(scope="module")
def estimation(runs: Runs) -> Estimation:
    """By the decision table."""
    return estimate_model(nomoto().with_values({"K": 0.1, "T": 10.0, "U": 1.0}), runs, SETTINGS, OPTIONS)


def test_every_run_is_predicted_by_the_others(estimation: Estimation, runs: Runs) -> None:
    errors = left_out_errors(estimation, runs, START_S)
    assert len(errors) == len(runs)
    assert all(0.1 < e["psi_deg"] < 10.0 for e in errors)
    none = replace(estimation, uncertainty=replace(estimation.uncertainty, leave_one_out=None))
    assert left_out_errors(none, runs, START_S) == []


def test_what_is_not_worse_is_kept_and_the_comparison_is_in_the_reasons(estimation: Estimation, runs: Runs) -> None:
    assert estimation.criterion != WHOLE_RUNS
    kept = preferred_estimation(estimation, runs, SETTINGS, OPTIONS, START_S)
    assert kept.estimate is estimation.estimate
    assert "is not better beyond the scatter over runs" in kept.reasons[-1]
    assert kept.reasons[-1] in kept.noise_model.text


def test_output_error_takes_the_place_of_what_misses_the_runs_left_out(estimation: Estimation, runs: Runs) -> None:
    """Estimates without a run whose gain and time constant are 30 % off: the comparison must see it."""
    points = estimation.uncertainty.leave_one_out
    assert points is not None
    poor = replace(estimation, uncertainty=replace(estimation.uncertainty, leave_one_out=1.3 * points))
    used = preferred_estimation(poor, runs, SETTINGS, OPTIONS, START_S)
    assert used.criterion == WHOLE_RUNS
    assert "left out in turn and predicted as a whole" in used.reasons[0]
    assert used.reasons[0] in used.noise_model.text
    assert not any("set by the trial" in reason for reason in used.reasons), "nobody set it"
    assert not any(c.is_chosen for c in used.noise_model.candidates)


def test_what_a_user_sets_is_not_compared(estimation: Estimation, runs: Runs) -> None:
    for change in ({"method": "multiple-shooting"}, {"segment_s": 10.0}, {"robust": True}):
        settings = EstimateSettings(**change)
        assert preferred_estimation(estimation, runs, settings, OPTIONS, START_S) is estimation


def swinging(deg: float) -> list[Record]:
    """Four runs whose heading has this standard deviation."""
    time = np.arange(100) * 1.0
    psi = np.radians(deg) * np.sqrt(2.0) * np.sin(2.0 * np.pi * time / 50.0)
    return [Record.from_arrays(f"run {k}", time, {"psi": psi}) for k in range(4)]


def test_better_is_judged_by_pairs() -> None:
    records, rivals = swinging(20.0), [{"psi_deg": 2.0}, {"psi_deg": 4.0}, {"psi_deg": 1.0}, {"psi_deg": 9.0}]
    less = [{"psi_deg": 0.8 * e["psi_deg"] * f} for e, f in zip(rivals, (0.9, 1.1, 1.0, 1.0), strict=True)]
    alike = [{"psi_deg": e["psi_deg"] * f} for e, f in zip(rivals, (0.5, 1.6, 1.0, 0.9), strict=True)]
    assert is_better(less, rivals, records) and not is_better(alike, rivals, records)


def test_fewer_runs_that_diverge_are_better() -> None:
    records, lasting, one_lost = swinging(20.0), [{"psi_deg": 9.0}] * 4, [{}, *[{"psi_deg": 1.0}] * 3]
    assert is_better(lasting, one_lost, records)
    assert not is_better(one_lost, lasting, records) and not is_better(one_lost, one_lost, records)
    assert mean_text(one_lost) == "heading 1.00 deg and 1 diverged"
    assert mean_text([{}, {}]) == "all diverge"


def test_a_simulation_that_is_further_off_than_the_mean_of_the_motion_counts_as_lost() -> None:
    """Two circles missed by 200 deg beside two zigzags hit alike: no t-test of four sees the difference."""
    good, poor = [{"psi_deg": e} for e in (3.0, 4.0, 3.0, 3.0)], [{"psi_deg": e} for e in (3.1, 3.6, 200.0, 160.0)]
    assert is_better(good, poor, swinging(100.0)) and not is_better(poor, good, swinging(100.0))
    assert not is_better(good, poor, swinging(1.0)), "all are lost by both, and the test has the word"


def test_what_loses_fitted_runs_gives_way_to_what_reproduces_them() -> None:
    records, good, lost = swinging(20.0), [{"psi_deg": 3.0}] * 4, [{"psi_deg": 2.0}] * 3 + [{"psi_deg": 120.0}]
    assert lost_count(good, records) == 0 and lost_count(lost, records) == 1
    assert is_preferred(WholeRunErrors(good, []), WholeRunErrors(lost, []), records), "however few the runs"
    assert not is_preferred(WholeRunErrors(lost, []), WholeRunErrors(good, []), records)
    worse = [{"psi_deg": 9.0 + k} for k in range(4)]
    assert not is_preferred(WholeRunErrors(good, worse), WholeRunErrors(lost, good), records), "left out, it is worse"
    assert is_preferred(WholeRunErrors(good, good), WholeRunErrors(good, worse), records)


def test_fitted_runs_are_simulated_with_their_own_offsets(estimation: Estimation, runs: Runs) -> None:
    errors = whole_run_errors(estimation, runs, START_S)
    assert [0.0 < e["psi_deg"] < 10.0 for e in errors.fitted] == [True] * 5
    assert errors.left_out == left_out_errors(estimation, runs, START_S)


def test_errors_are_named_with_their_units() -> None:
    assert mean_text([{"psi_deg": 1.0, "u": 3.0}, {"psi_deg": 2.0, "u": 3.0}]) == "heading 1.50 deg"
    assert mean_text([{"phi": 0.25}]) == "phi 0.250"
