"""The model behind a plant estimated anew from the log of its trial, with its covariance as what was known before."""

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtri, ndtri

from seatrial.control.task import TrimmedShip
from seatrial.core.equations import Model
from seatrial.core.results.coefficients import Coefficient
from seatrial.core.results.fit import Fit
from seatrial.core.results.verification import ModelCorrection
from seatrial.core.values import Array, InputError, Parameter, Prior, Record, Ship
from seatrial.data.trial import Feedback, Trial, TrialRun
from seatrial.data.trial.priors import JointPrior
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
    return _corrections(model.parameters.free, ship.covariance, fit)


def _trial(ship: TrimmedShip, model: Model, records: Sequence[Record], length: float, prior: JointPrior) -> Trial:
    """Return the trial of the log: the controller was on, the ship is known as of another day."""
    particulars = {"L": length} | {p.name: p.value for p in model.parameters if not p.free and np.isfinite(p.value)}
    names = {name for record in records for name in record.channels if name.endswith("_ref")}
    runs = tuple(TrialRun(record.without(*(names & set(record.channels)))) for record in records)
    feedback = Feedback(input=ship.actuator, output=ship.output)
    return Trial(Ship(model.name, particulars), runs, model, feedback=feedback, joint_priors=(prior,))


def _corrections(free: Sequence[Parameter], prior: Array, fit: Fit) -> tuple[ModelCorrection, ...]:
    """Return coefficients before the log and with it, and which of them moved; prior: covariance of the former."""
    after = {c.name: c for c in fit.coefficients if not c.fixed}
    deviations, names = np.sqrt(np.diag(prior)), fit.model.parameters.free_names
    judged = [k for k, p in enumerate(free) if p.name in after]
    tested = [k for k in judged if after[free[k].name].lower is not None]
    estimates = [after[free[k].name] for k in tested]
    changes = np.array([one.estimate - free[k].value for one, k in zip(estimates, tested, strict=True)])
    places = [names.index(free[k].name) for k in tested]
    by_log = _log_covariance(estimates, fit.covariance[np.ix_(places, places)])
    moved = {tested[k] for k in moved_places(changes, prior[np.ix_(tested, tested)] + by_log)}
    return tuple(_correction(free[k], float(deviations[k]), after[free[k].name], is_moved=k in moved) for k in judged)


def _correction(before: Parameter, deviation: float, after: Coefficient, *, is_moved: bool) -> ModelCorrection:
    lower, upper = (np.nan if end is None else end for end in (after.lower, after.upper))
    return ModelCorrection(before.name, before.unit, before.value, deviation, after.estimate, lower, upper, is_moved)


def _log_covariance(estimates: Sequence[Coefficient], covariance: Array) -> Array:
    """Return the covariance of estimates, scaled to their intervals, which hold what the covariance does not."""
    # an interval holds 95 % of a normal error
    wide = [((one.upper or 0.0) - (one.lower or 0.0)) / (2.0 * float(ndtri(0.975))) for one in estimates]
    scale = np.array(wide) / np.sqrt(np.diag(covariance))
    return np.asarray(scale[:, None] * covariance * scale, dtype=np.float64)


def moved_places(changes: Array, covariance: Array) -> list[int]:
    """Return the places of changes (n,) that the errors of both estimates do not explain.

    The test of all differences together (Wald). Where it fails, coefficients count as moved one by one, first what
    explains most, until chance explains the others.
    """
    moved: list[int] = []
    weight = np.linalg.inv(covariance) if len(changes) else np.empty((0, 0))

    def unexplained(places: list[int]) -> float:
        """Return the Wald statistic with changes at some places free."""
        pull = weight @ changes
        return float(changes @ pull - pull[places] @ np.linalg.solve(weight[np.ix_(places, places)], pull[places]))

    while len(moved) < len(changes) and unexplained(moved) > float(chdtri(len(changes) - len(moved), _CHANCE)):
        others = [k for k in range(len(changes)) if k not in moved]
        moved.append(min(others, key=lambda k: unexplained([*moved, k])))
    return moved
