"""A tuned controller and the log of its trial in, a verification out, with what in the model was wrong."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import chdtri, ndtri

from seatrial.control.task import TrimmedShip, TuningTask
from seatrial.control.verification.course_changes import GainTest, verify_changes
from seatrial.control.verification.stabiliser import (
    OTHER_DAY,
    StabiliserLog,
    departure_frequencies,
    prior_deviations,
    verify_stabiliser,
)
from seatrial.core.equations import Model
from seatrial.core.results.coefficients import Coefficient
from seatrial.core.results.fit import Fit
from seatrial.core.results.verification import (
    ModelCorrection,
    ReductionEstimate,
    Verification,
    VerifiedChange,
    VerifiedLeg,
    VerifiedQuantity,
    normal_interval,
)
from seatrial.core.values import Array, Finding, InputError, Parameter, Prior, Record, Severity, Ship, spelling_hint
from seatrial.core.values.versions import versions
from seatrial.data.folder.gains_file import channel_display_unit
from seatrial.data.trial import Feedback, Run, Trial
from seatrial.data.trial.priors import JointPrior
from seatrial.estimation.identify import identify
from seatrial.estimation.sea import PLANT_FACTORS, LegFit
from seatrial.physics.loops import TransferLoop, margins

# What in the model was wrong: its properties before the log and with it.


def model_corrections(loop: TransferLoop, deviations: Array, fit: LegFit) -> tuple[ModelCorrection, ...]:
    """Return effectiveness of the fins, natural frequency and damping ratio of the plant, before the log and with it.

    deviations: of the logarithms of the factors before the log, (3,).
    """
    pole = loop.plant.poles[np.argmin(np.abs(loop.plant.poles.real) / np.abs(loop.plant.poles))]
    effect = loop.plant.gain / loop.disturbance.gain
    values = (
        ("effectiveness of the fins, K_alpha", "1", effect),
        ("natural frequency", "rad/s", float(np.abs(pole))),
        ("damping ratio", "1", float(-pole.real / np.abs(pole))),
    )
    return tuple(
        _correction(name, unit, value, float(deviations[k]), float(fit.ship[k]), float(fit.ship_deviations[k]))
        for k, ((name, unit, value), _) in enumerate(zip(values, PLANT_FACTORS, strict=True))
    )


def _correction(
    name: str, unit: str, value: float, deviation: float, factor: float, factor_deviation: float
) -> ModelCorrection:
    """Return a property times a factor whose logarithm is normal."""
    low, high = (value * math.exp(end) for end in normal_interval(factor, factor_deviation))
    return ModelCorrection(
        name, unit, value, value * deviation, value * math.exp(factor), low, high, not low <= value <= high
    )


# The model behind a plant estimated anew from the log of its trial, with its covariance as what was known before.

_SOURCE = "the model that was tuned on"
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
    covariance = ship.covariance + np.diag((OTHER_DAY * values) ** 2)
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
    runs = tuple(Run(record.without(*(names & set(record.channels)))) for record in records)
    feedback = Feedback(input=ship.actuator, output=ship.output)
    return Trial(Ship(model.name, particulars), runs, model, feedback=feedback, joint_priors=(prior,))


def _corrections(free: Sequence[Parameter], prior: Array, fit: Fit) -> tuple[ModelCorrection, ...]:
    """Return coefficients before the log and with it, and which of them moved; prior: covariance of the former."""
    after = {c.name: c for c in fit.coefficients if not c.fixed}
    deviations, names = np.sqrt(np.diag(prior)), fit.model.parameters.free_names
    judged = [k for k, p in enumerate(free) if p.name in after]
    tested = [k for k in judged if after[free[k].name].lower is not None]
    estimates = [after[free[k].name] for k in tested]
    changes = np.array([estimate.estimate - free[k].value for estimate, k in zip(estimates, tested, strict=True)])
    places = [names.index(free[k].name) for k in tested]
    by_log = _log_covariance(estimates, fit.covariance[np.ix_(places, places)])
    moved = {tested[k] for k in moved_places(changes, prior[np.ix_(tested, tested)] + by_log)}
    return tuple(
        _coefficient_correction(free[k], float(deviations[k]), after[free[k].name], is_moved=k in moved) for k in judged
    )


def _coefficient_correction(
    before: Parameter, deviation: float, after: Coefficient, *, is_moved: bool
) -> ModelCorrection:
    lower, upper = (np.nan if end is None else end for end in (after.lower, after.upper))
    return ModelCorrection(before.name, before.unit, before.value, deviation, after.estimate, lower, upper, is_moved)


def _log_covariance(estimates: Sequence[Coefficient], covariance: Array) -> Array:
    """Return the covariance of estimates, scaled to their intervals, which hold what the covariance does not."""
    # an interval holds 95 % of a normal error
    wide = [((estimate.upper or 0.0) - (estimate.lower or 0.0)) / (2.0 * float(ndtri(0.975))) for estimate in estimates]
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
        candidates = [k for k in range(len(changes)) if k not in moved]
        moved.append(min(candidates, key=lambda k: unexplained([*moved, k])))
    return moved


# A tuned controller and the log of its trial in, a verification out.

_GAIN_TOLERANCE = 0.15  # of what a stabiliser's gains order, beyond which the fins did something else; chosen


def verify(task: TuningTask, gains: Mapping[str, float], records: Sequence[Record]) -> Verification:
    """Return what was predicted beside what the records show, and what in the model was wrong.

    gains: those that were on, by name.

    Raises:
        InputError: gains of another loop, an unstable loop, a log without legs or too short, or an actuator that does
            not follow the gains.
    """
    values = gains_of_loop(task, gains)
    if not margins(task.loop.with_gains(values)).is_stable:
        raise InputError(f"loop '{task.name}' is unstable with these gains: nothing is predicted of them; check them")
    return (_of_changes if task.demand is not None else _of_legs)(task, values, records)


def _of_legs(task: TuningTask, gains: Array, records: Sequence[Record]) -> Verification:
    """Return the verification of a stabiliser."""
    log = verify_stabiliser(task, gains, records)
    corrections = model_corrections(task.loop, prior_deviations(task), log.fit)
    findings = (*_leg_findings(task, log), *_moved_findings(corrections))
    return _verification(task, gains, log.quantities, corrections, findings, legs=log.legs, reductions=log.reductions)


def _of_changes(task: TuningTask, gains: Array, records: Sequence[Record]) -> Verification:
    """Return the verification of a loop that follows a demand."""
    log = verify_changes(task, gains, records)
    corrections: tuple[ModelCorrection, ...] = ()
    findings: tuple[Finding, ...] = ()
    try:
        if task.trimmed_ship is None or task.demand is None:
            raise InputError("the plant is a transfer function, of which nothing is estimated")
        length = task.U * task.demand.time_constant  # its default is length over speed
        corrections = refitted_coefficients(task.trimmed_ship, records, length)
    except InputError as error:
        text = f"the model was not estimated anew from the log: {error}"
        findings = (Finding(Severity.INFO, "model-as-it-was", text),)
    followed = _followed_findings(task, log.gains)
    return _verification(
        task, gains, log.quantities, corrections, (*findings, *followed, *_moved_findings(corrections)),
        changes=log.changes,
    )  # fmt: skip


def _followed_findings(task: TuningTask, test: GainTest) -> list[Finding]:
    """Return whether other gains were on than those that are verified, or the actuator stopped short of its limit."""
    actuator, followed = task.loop.actuator, test.followed
    if test.stops is not None:
        factor, unit = channel_display_unit(actuator)
        least, most, limit = (factor * angle for angle in (*test.stops, task.constraints.limit))
        text = (
            f"'{actuator}' stops at {least:.3g} and {most:.3g} {unit} where these gains order more, short of the "
            f"declared {limit:.3g} {unit}"
        ).replace(" 1 ", " ")
        advice = "look for what stops it, or declare that limit and tune again"
        return [Finding(Severity.WARNING, "actuator-stopped", text, "", advice)]
    if test.is_followed:
        return []
    ratio, rest = test.simulated.mean(axis=0)
    text = (
        f"'{actuator}' moves {followed.ratio:.2f} times as much as these gains order of what was measured, with a "
        f"coherence of {followed.coherence:.3f}, where ships with these gains have {ratio:.2f} and "
        f"{math.sqrt(1.0 - math.exp(rest)):.3f} in this weather"
    )
    advice = "check that these gains were on, and the actuator's limits, servo and dead time in the loop file"
    return [Finding(Severity.WARNING, "gains-differ", text, "", advice)]


def _verification(
    task: TuningTask,
    gains: Array,
    quantities: tuple[VerifiedQuantity, ...],
    corrections: tuple[ModelCorrection, ...],
    findings: tuple[Finding, ...],
    *,
    legs: tuple[VerifiedLeg, ...] = (),
    reductions: tuple[ReductionEstimate, ...] = (),
    changes: tuple[VerifiedChange, ...] = (),
) -> Verification:
    return Verification(
        name=task.name,
        plant=task.plant,
        output=task.loop.output,
        actuator=task.loop.actuator,
        gains=dict(zip(task.loop.gains.names, gains.tolist(), strict=True)),
        legs=legs,
        quantities=quantities,
        reductions=reductions,
        corrections=corrections,
        findings=findings,
        versions=versions(),
        changes=changes,
    )


def gains_of_loop(task: TuningTask, gains: Mapping[str, float]) -> Array:
    """Return the values (g,) in the loop's order.

    Raises:
        InputError: other names than those of the loop.
    """
    names = task.loop.gains.names
    if unknown := [name for name in gains if name not in names]:
        hint = spelling_hint(unknown[0], list(names))
        raise InputError(f"loop '{task.name}' has no gain '{unknown[0]}'{hint}; its gains are {', '.join(names)}")
    if missing := [name for name in names if name not in gains]:
        raise InputError(f"loop '{task.name}' needs a value for gain {missing[0]}; give those that were on")
    return np.array([gains[name] for name in names])


def _moved_findings(corrections: Sequence[ModelCorrection]) -> list[Finding]:
    """Return what the log moves beyond its interval, a warning each."""
    return [
        Finding(
            Severity.WARNING, "model-moved", f"the log moves the {c.name} from {c.model:.3g} to {c.log:.3g}",
            f"95 % interval {c.lower:.3g} to {c.upper:.3g}",
        )
        for c in corrections if c.is_moved
    ]  # fmt: skip


def _leg_findings(task: TuningTask, log: StabiliserLog) -> list[Finding]:
    """Return what to warn of in the legs of a stabiliser."""
    findings = [
        Finding(
            Severity.WARNING, "gains-differ",
            f"record '{leg.record}': from {leg.start:.0f} s on '{task.loop.actuator}' moves {leg.gain_ratio:.2f} times "
            "as much as these gains order", f"coherence {leg.correlation:.2f}",
        )
        for leg in log.legs if leg.is_controlled and abs(leg.gain_ratio - 1.0) > _GAIN_TOLERANCE
    ]  # fmt: skip
    if all(leg.is_controlled for leg in log.legs):
        findings.append(Finding(
            Severity.INFO, "no-leg-off", "no leg has the controller off: the reduction rests on the model alone",
        ))  # fmt: skip
    departures = log.fit.departures
    if log.fit.departure_evidence > float(chdtri(len(departures), _CHANCE)):
        place = int(np.argmax(np.abs(departures)))
        findings.append(Finding(
            Severity.WARNING, "model-moved",
            f"waves move '{task.loop.output}' otherwise than the assumed spectrum and effective slope, most at "
            f"{departure_frequencies(task.loop)[place]:.2g} rad/s",
            f"a factor of {math.exp(departures[place]):.2g} in energy", "check heading, hull and spectrum of the loop "
            "file; the other values were found with the excitation that the log shows",
        ))  # fmt: skip
    if not log.fit.is_converged:
        findings.append(Finding(
            Severity.WARNING, "not-converged", "the search for ship and seas did not converge", "",
            "look at the spectra of the legs: is the heading to the waves that of the loop file's first sea?",
        ))  # fmt: skip
    return findings
