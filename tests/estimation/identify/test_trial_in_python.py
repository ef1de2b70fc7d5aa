"""A trial made in Python from records: the same bits as from its file, without a path."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from seatrial.core.values import Ship
from seatrial.data.trial import EstimateMethod, EstimateSettings, Role, Run, Trial, load_trial
from seatrial.estimation.identify import identify
from seatrial.physics.models import model_named

PLAIN = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)


def trial_in_python(example: Trial) -> Trial:
    """The waterjet example, its records, ship and model as values."""
    ship = Ship("waterjet craft", {"L": 9.8, "d": 0.71, "m": 5540.0})
    held_out = {run.name for run in example.runs if run.role is Role.VALIDATE}
    runs = tuple(Run(run.raw_record(), Role.VALIDATE if run.name in held_out else Role.TRAIN) for run in example.runs)
    model = model_named("waterjet").with_ship(ship)
    parameters = model.parameters
    for p in example.model.parameters.free:
        parameters = parameters.bounded(p.name, p.lower, p.upper)
    return Trial(ship, runs, model.with_parameters(parameters), estimate=PLAIN)


def test_a_trial_made_of_records_gives_the_bits_of_its_file(repository: Path) -> None:
    example = load_trial(repository / "examples" / "waterjet.toml")
    trial = trial_in_python(example)
    assert trial.path is None
    assert all(run.files == () for run in trial.runs)
    by_file, by_records = identify(replace(example, truth={}, estimate=PLAIN)), identify(trial)
    assert [c.name for c in by_file.coefficients] == [c.name for c in by_records.coefficients]
    assert [c.estimate for c in by_file.coefficients] == [c.estimate for c in by_records.coefficients]
    assert [c.standard_error for c in by_file.coefficients] == [c.standard_error for c in by_records.coefficients]
    np.testing.assert_array_equal(by_file.covariance, by_records.covariance)
    assert [p.rms for p in by_file.predictions] == [p.rms for p in by_records.predictions]
    assert [f.code for f in by_file.findings] == [f.code for f in by_records.findings]
