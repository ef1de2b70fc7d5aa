"""The model behind a plant estimated anew from the log of its trial, with its covariance as what was known before."""

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import ndtri

from seatrial.control.task import TrimmedShip
from seatrial.core.equations import Model
from seatrial.core.results.coefficients import Coefficient
from seatrial.core.results.verification import ModelCorrection
from seatrial.core.values import InputError, Prior, Record, Ship
from seatrial.data.trial import Feedback, Trial, TrialRun
from seatrial.data.trial.earlier_result import JointPrior
from seatrial.estimation.identify import identify

_SOURCE = "the model that was tuned on"
# standard deviation of a coefficient of a ship that may have changed, as a share of it: a prior so wide that where the
# log knows a coefficient to 5 % it draws the estimate by no more than 1 % of the difference; chosen
_OTHER_DAY = 0.5
_CHANCE = 0.01  # share of unchanged ships of which some coefficient is blamed; chosen


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
    values = np.array([p.value for p in model.parameters.free])
    covariance = ship.covariance + np.diag((_OTHER_DAY * values) ** 2)
    deviations = np.sqrt(np.diag(covariance))
    priors = {
        p.name: Prior(p.value, float(sd), _SOURCE) for p, sd in zip(model.parameters.free, deviations, strict=True)
    }
    prior = JointPrior(names, values, covariance)
    fit = identify(_trial(ship, model.with_parameters(model.parameters.with_priors(priors)), records, length, prior))
    after = {c.name: c for c in fit.coefficients if not c.fixed}
    known = dict(zip(names, np.sqrt(np.diag(ship.covariance)).tolist(), strict=True))
    judged = [p for p in model.parameters.free if p.name in after]
    return tuple(_correction(p.name, p.unit, p.value, known[p.name], after[p.name], len(judged)) for p in judged)


def _trial(ship: TrimmedShip, model: Model, records: Sequence[Record], length: float, prior: JointPrior) -> Trial:
    """Return the trial of the log: the controller was on, the ship is known as of another day."""
    particulars = {"L": length} | {p.name: p.value for p in model.parameters if not p.free and np.isfinite(p.value)}
    names = {name for record in records for name in record.channels if name.endswith("_ref")}
    runs = tuple(TrialRun(record.without(*(names & set(record.channels)))) for record in records)
    feedback = Feedback(input=ship.actuator, output=ship.output)
    return Trial(Ship(model.name, particulars), runs, model, feedback=feedback, joint_priors=(prior,))


def _correction(
    name: str, unit: str, value: float, deviation: float, after: Coefficient, count: int
) -> ModelCorrection:
    """Return a coefficient before the log and with it; moved where both errors together do not explain the difference.

    The test of a difference of two estimates (Wald), over all `count` coefficients together (Bonferroni).
    """
    if after.lower is None or after.upper is None:
        return ModelCorrection(name, unit, value, deviation, after.estimate, np.nan, np.nan, is_moved=False)
    one = (after.upper - after.lower) / (2.0 * float(ndtri(0.975)))  # the interval holds 95 % of a normal error
    most = float(ndtri(1.0 - 0.5 * _CHANCE / count)) * math.hypot(one, deviation)
    is_moved = abs(after.estimate - value) > most
    return ModelCorrection(name, unit, value, deviation, after.estimate, after.lower, after.upper, is_moved)
