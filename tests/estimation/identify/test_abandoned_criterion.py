"""Runs that a model cannot have together give an estimate with a warning that names them, and no refusal."""

from dataclasses import replace

import numpy as np

from seatrial.core.values import Record, Ship
from seatrial.data.trial import Run, Trial, load_records
from seatrial.estimation.estimate import EstimatorOptions
from seatrial.estimation.estimate.assemble import training_runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.identify.warnings import abandoned_criterion_finding
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate import manoeuvre


def runs() -> list[Record]:
    """Two zigzags at constant speed, and one that loses half of its speed, of a boat of 6 m."""
    rng = np.random.default_rng(5)
    boat = nomoto().with_values({"K": 1.0, "T": 1.0, "U": 4.0})
    records = []
    for angle in (8, 12, 20):
        run = manoeuvre(boat, programme(f"zigzag:{angle}/{angle}"), duration=40.0, slew_rate=0.2)
        noisy = {s: run[s] + sd * rng.standard_normal(len(run)) for s, sd in (("psi", 0.005), ("r", 0.003))}
        speed = np.linspace(4.0, 2.0, len(run)) if angle == 20 else np.full(len(run), 4.0)
        channels = {"delta": run["delta"], "u": speed, **noisy}
        records.append(Record.from_arrays(f"z{angle}", run.time, channels))
    return records


def estimation(records: list[Record]) -> Estimation:
    trial = Trial(Ship("boat", {"L": 6.0}), tuple(Run(r) for r in records), nomoto())
    return estimate_model(trial.model, training_runs(trial, load_records(trial)[0]), None, EstimatorOptions())


def test_runs_that_lose_speed_or_fit_badly_are_named_with_the_edit() -> None:
    records = runs()
    found = estimation(records)
    assert abandoned_criterion_finding(found, records) == ()
    (finding,) = abandoned_criterion_finding(
        replace(found, abandoned="prediction error ended outside physics"), records
    )
    assert "z20 loses 46 % of its speed" in finding.evidence  # 3.9 to 2.1 m/s, medians over a tenth at either end
    assert 'leave_out = ["z20"] under [[records]], or take a model with surge' in finding.advice
    constant = [r.without("u") for r in records]
    worse = replace(found, abandoned="it ended outside physics", residuals=found.residuals.copy())
    data = worse.estimate.problem.data
    for segment in data.run_segments(0):
        worse.residuals[data.offsets[segment] : data.offsets[segment + 1]] *= 100.0
    (finding,) = abandoned_criterion_finding(worse, constant)
    assert "z8 has " in finding.evidence
    assert 'leave_out = ["z8"]' in finding.advice
