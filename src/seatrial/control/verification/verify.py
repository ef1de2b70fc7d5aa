"""A tuned controller and the log of its trial in, a verification out."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.control.task import TuningTask
from seatrial.control.verification.course_changes import verify_changes
from seatrial.control.verification.followed_gains import GainTest
from seatrial.control.verification.model_corrections import model_corrections
from seatrial.control.verification.refitted_model import refitted_coefficients
from seatrial.control.verification.stabiliser import StabiliserLog, prior_deviations, verify_stabiliser
from seatrial.core.results.verification import (
    ModelCorrection,
    ReductionEstimate,
    Verification,
    VerifiedChange,
    VerifiedLeg,
    VerifiedQuantity,
)
from seatrial.core.values import Array, Finding, InputError, Record, Severity, spelling_hint
from seatrial.core.values.versions import versions
from seatrial.data.folder.gains_file import channel_display_unit
from seatrial.physics.loops import margins

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
        findings = (Finding(Severity.INFO, "model-as-it-was", text, "", "identify it from a trial of its own"),)
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
            f"95 % interval {c.lower:.3g} to {c.upper:.3g}", "tune again with the corrected value",
        )
        for c in corrections if c.is_moved
    ]  # fmt: skip


def _leg_findings(task: TuningTask, log: StabiliserLog) -> list[Finding]:
    """Return what to warn of in the legs of a stabiliser."""
    found = [
        Finding(
            Severity.WARNING, "gains-differ",
            f"record '{leg.record}': from {leg.start:.0f} s on '{task.loop.actuator}' moves {leg.gain_ratio:.2f} times "
            "as much as these gains order", f"coherence {leg.correlation:.2f}",
            "check that these gains were on, and whether the actuator was at its limits",
        )
        for leg in log.legs if leg.is_controlled and abs(leg.gain_ratio - 1.0) > _GAIN_TOLERANCE
    ]  # fmt: skip
    if all(leg.is_controlled for leg in log.legs):
        found.append(Finding(
            Severity.INFO, "no-leg-off", "no leg has the controller off: the reduction rests on the model alone", "",
            "log a leg of the same length without control, before or after",
        ))  # fmt: skip
    if not log.fit.is_converged:
        found.append(Finding(
            Severity.WARNING, "not-converged", "the search for ship and seas did not converge", "",
            "look at the spectra of the legs: is the heading to the waves that of the loop file's first sea?",
        ))  # fmt: skip
    return found
