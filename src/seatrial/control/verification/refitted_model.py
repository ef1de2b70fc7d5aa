"""The model behind a plant estimated anew from the log of its trial, with its covariance as what was known before."""

from collections.abc import Sequence

import numpy as np

from seatrial.control.task import TrimmedShip
from seatrial.core.equations import Model
from seatrial.core.results.coefficients import Coefficient
from seatrial.core.results.verification import ModelCorrection
from seatrial.core.values import InputError, Prior, Record, Ship
from seatrial.data.trial import Feedback, Trial, TrialRun
from seatrial.data.trial.earlier_result import JointPrior
from seatrial.estimation.identify import identify

_SOURCE = "the model that was tuned on"


def refitted_coefficients(ship: TrimmedShip, records: Sequence[Record], length: float) -> tuple[ModelCorrection, ...]:
    """Return each free coefficient before the log and with it, by the estimator of `identify`.

    length: m, of the ship, where its model does not say.

    Raises:
        InputError: the model states no covariance, or the log does not allow an estimate (which channel, which check).
    """
    model = ship.model
    names = model.parameters.free_names
    if ship.covariance.shape != (len(names), len(names)) or not names:
        raise InputError(f"model '{model.name}' states no covariance, which is the prior of an estimate from the log")
    deviations = np.sqrt(np.diag(ship.covariance))
    priors = {
        p.name: Prior(p.value, float(sd), _SOURCE) for p, sd in zip(model.parameters.free, deviations, strict=True)
    }
    fit = identify(_trial(ship, model.with_parameters(model.parameters.with_priors(priors)), records, length))
    after = {c.name: c for c in fit.coefficients if not c.fixed}
    return tuple(
        _correction(p.name, p.unit, p.value, priors[p.name].standard_deviation, after[p.name])
        for p in model.parameters.free if p.name in after
    )  # fmt: skip


def _trial(ship: TrimmedShip, model: Model, records: Sequence[Record], length: float) -> Trial:
    """Return the trial of the log: the controller was on, the joint covariance is known."""
    free = model.parameters.free
    prior = JointPrior(tuple(p.name for p in free), np.array([p.value for p in free]), ship.covariance)
    particulars = {"L": length} | {p.name: p.value for p in model.parameters if not p.free and np.isfinite(p.value)}
    names = {name for record in records for name in record.channels if name.endswith("_ref")}
    runs = tuple(TrialRun(record.without(*(names & set(record.channels)))) for record in records)
    feedback = Feedback(input=ship.actuator, output=ship.output)
    return Trial(Ship(model.name, particulars), runs, model, feedback=feedback, joint_priors=(prior,))


def _correction(name: str, unit: str, value: float, deviation: float, after: Coefficient) -> ModelCorrection:
    low = np.nan if after.lower is None else after.lower
    high = np.nan if after.upper is None else after.upper
    return ModelCorrection(name, unit, value, deviation, after.estimate, low, high, bool(value < low or value > high))
