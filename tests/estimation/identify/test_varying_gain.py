"""A gain that falls with the yaw rate is a term held at zero, named with the edit; one that does not is none."""

import numpy as np
import pytest

from seatrial.core.values import Finding, Record, Ship
from seatrial.data.trial import Run, Trial, load_records
from seatrial.estimation.estimate import EstimatorOptions
from seatrial.estimation.estimate.assemble import training_runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.identify.terms import held_couplings
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate import manoeuvre

GAIN = 1.0
"""1/s: with alpha 2 s^2/rad^2, a boat of 6 m; the gain of large angles is then a fifth smaller."""


def runs(alpha: float) -> list[Record]:
    """Zigzags at 8 and 25 deg with the noise of a boat's compass and gyro."""
    rng = np.random.default_rng(5)
    boat = nomoto().with_values({"K": GAIN, "T": 1.0, "alpha": alpha, "U": 4.0})
    noisy = []
    for angle in (8, 25):
        run = manoeuvre(boat, programme(f"zigzag:{angle}/{angle}"), duration=60.0, slew_rate=0.2).renamed(f"{angle}")
        for name, deviation in (("psi", 0.005), ("r", 0.003)):  # rad, rad/s
            samples = run[name] + deviation * rng.standard_normal(len(run))
            run = run.with_channel(name, run.channel(name).with_values(samples))
        noisy.append(run.without("x0", "y0"))
    return noisy


def fitted(records: list[Record], *free: str) -> Estimation:
    model = nomoto()
    model = model.with_parameters(model.parameters.freed(*free))
    trial = Trial(Ship("boat", {"L": 6.0}), tuple(Run(r) for r in records), model)
    return estimate_model(model, training_runs(trial, load_records(trial)[0]), trial.estimate, EstimatorOptions())


def finding(alpha: float, *free: str) -> tuple[Finding, ...]:
    records = runs(alpha)
    return held_couplings(fitted(records, *free), (), records)


def test_a_gain_that_falls_with_the_yaw_rate_is_a_warning() -> None:
    (warning,) = finding(2.0)
    assert warning.code == "held-coupling"
    assert warning.message.startswith("alpha is held at 0")
    assert 'free = ["K", "T", "alpha"]' in warning.advice


@pytest.mark.parametrize(("alpha", "free"), [(0.0, ()), (2.0, ("alpha",))])
def test_a_constant_gain_and_a_free_cubic_are_none(alpha: float, free: tuple[str, ...]) -> None:
    assert finding(alpha, *free) == ()
