"""What a trial file states that does not go together: warnings and notes."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from seatrial.core.equations import Model
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import NOT_MEASURED, Finding, InputError, Prior, Severity, Ship
from seatrial.core.values.files import is_file
from seatrial.data.read.record_file import file_digest
from seatrial.data.trial.priors import EarlierResult
from seatrial.data.trial.run_data import RunFiles
from seatrial.data.trial.schema import RecordsTable
from seatrial.data.trial.trial import Role, Run, Trial
from seatrial.physics.hydro.empirical import OOSTERVELD
from seatrial.physics.hydro.excitation import SEA_WATER
from seatrial.physics.sensors import Sensors, VelocityReference

# A warning where velocities over ground are fitted as if through the water: a current then ends in coefficients.


def ground_velocity_findings(
    model: Model, sensors: Sensors | None, blocks: Sequence[RecordsTable]
) -> tuple[Finding, ...]:
    """Return a warning `velocity-over-ground` where a receiver's velocities are those of a model of u and v."""
    is_stated = sensors is not None and sensors.velocity is VelocityReference.GROUND
    if is_stated or not {"u", "v"} <= set(model.states) or not any(map(_is_over_ground, blocks)):
        return ()
    return (Finding(
        Severity.WARNING, "velocity-over-ground",
        "u and v are a receiver's, over ground, and fitted as if through the water",
    ),)  # fmt: skip


def _is_over_ground(block: RecordsTable) -> bool:
    return any("sog" in columns for columns in (block.channels, *(source.channels for source in block.sources)))


# A warning where stated particulars do not belong to one hull: an inertia of another length, more mass than water.

_GYRADII = (0.2, 0.3)  # of the length, in yaw and pitch; chosen: ITTC 7.5-02-07-02.1 takes 0.25 where nothing is known
_USUAL_GYRADIUS = 0.25
_FULLEST = 1.1  # C_b of a box, and a tenth for appendages and trim; chosen
_INERTIAS = ("I_z", "I5")
_DIGITS = 4  # significant, of an advised value


def hull_value_findings(ship: Ship) -> tuple[Finding, ...]:
    """Return warnings `hull-values`: a radius of gyration that ships do not have, more mass than a box of water."""
    values = ship.particulars
    mass, length = values.get("m"), values.get("L")
    if not mass or not length:
        return ()
    findings = [
        _gyradius_finding(name, values[name], mass, length) for name in _INERTIAS if values.get(name, 0.0) > 0.0
    ]
    box = values.get("rho", SEA_WATER) * length * values.get("B", math.inf) * values.get("d", math.inf)
    if mass > _FULLEST * box:
        water = significant(box, _DIGITS)
        message = f"m = {significant(mass, _DIGITS)} kg is more than the {water} kg of water in a box of L, B and d"
        findings.append(_finding(message, "correct m, L, B or d under [ship]"))
    return tuple(finding for finding in findings if finding is not None)


def _gyradius_finding(name: str, inertia: float, mass: float, length: float) -> Finding | None:
    radius = math.sqrt(inertia / mass) / length
    low, high = _GYRADII
    if low <= radius <= high:
        return None
    usual = significant(mass * (_USUAL_GYRADIUS * length) ** 2, _DIGITS)
    stated = f"{name} = {significant(inertia, _DIGITS)} kg m^2 with m = {significant(mass, _DIGITS)} kg"
    return _finding(
        f"{stated} is a radius of gyration of {significant(radius, 2)} L, ships have {low:g} to {high:g}",
        f"{name} = {usual} under [ship] for {_USUAL_GYRADIUS:g} L; or correct m or L",
    )


def _finding(message: str, advice: str) -> Finding:
    return Finding(Severity.WARNING, "hull-values", message, "", advice)


# Values that a trial file marks as estimated: the fit rests on them, and says so.

ESTIMATED = "ESTIMATED"
"""Marks a line of a trial file whose number is not measured, in a comment, as `seatrial init` writes it."""
_TABLE = re.compile(r"^\[+(?P<name>[\w.]+)\]+")
_MARKED = re.compile(rf"^(?P<key>\w+)\s*=[^#]*# {ESTIMATED}: (?:within (?P<percent>\d+\.?\d*) ?%,? )?(?P<text>[^;]*)")
_THRUSTER_NAME = re.compile(r'^name\s*=\s*"(?P<name>[^"]*)"')
ESTIMATED_VALUES = "estimated-values"
_FOLLOWING = {"pitch_ratio": ("k_0", "k_1", "k_2")}
"""Particulars of a ship that no model holds -> its parameters that formulas take from them."""


def with_estimates_named(trial: Trial, text: str) -> Trial:
    """Return the trial of a file with this text: marked values say that they are estimated, as does a warning.

    What a mark says that the value is within is the standard deviation of its prior: a part of every interval. Where
    the mark is removed with the number, nothing is said of it.
    """
    marks = dict(_marks(text))
    if not marks:
        return trial
    return replace(
        trial, model=_with_sources(trial.model, marks), findings=(*trial.findings, _estimated_finding(list(marks)))
    )


@dataclass(frozen=True)
class _Mark:
    """How a value was estimated, and its standard deviation over the value; 0: not stated."""

    text: str
    error: float


def _marks(text: str) -> Iterator[tuple[str, _Mark]]:
    """Keys of marked lines, those of a thruster as its parameters are named, with their marks."""
    table, thruster = "", ""
    for line in text.splitlines():
        if heading := _TABLE.match(line):
            table = heading["name"]
        elif table == "thruster" and (name := _THRUSTER_NAME.match(line)):
            thruster = name["name"]
        elif mark := _MARKED.match(line):
            key = f"{mark['key']}_{thruster}" if table == "thruster" else mark["key"]
            yield key, _Mark(mark["text"].strip(), float(mark["percent"] or 0.0) / 100.0)


def _with_sources(model: Model, marks: Mapping[str, _Mark]) -> Model:
    """The model whose marked values say so, and those that follow from a marked particular of the ship."""
    following = {
        name: _Mark(f"of {key}: {mark.text}", 0.0) for key, mark in marks.items() for name in _FOLLOWING.get(key, ())
    }
    from_series = {n for n in following if n in model.parameters and OOSTERVELD in model.parameters[n].source}
    for name, mark in {**marks, **{n: following[n] for n in from_series}}.items():
        if name in model.parameters and not model.parameters[name].free:
            value, source = model.parameters[name].value, f"{NOT_MEASURED}: {mark.text}"
            model = model.with_values({name: value}, source=source)
            if mark.error and value:
                prior = Prior(value, mark.error * abs(value), source)
                model = model.with_parameters(model.parameters.with_priors({name: prior}))
    return model


def _estimated_finding(names: list[str]) -> Finding:
    is_one, listed = len(names) == 1, enumeration(names, len(names))
    return Finding(
        Severity.WARNING, ESTIMATED_VALUES, f"{listed} {'is' if is_one else 'are'} {NOT_MEASURED}",
        f"marked {ESTIMATED} in the trial file",
    )  # fmt: skip


# Records that the priors were estimated from.


def refuse_used_records(runs: Iterable[Run], results: Mapping[str, EarlierResult]) -> None:
    """Refuse training runs from files that a result behind the priors was estimated from: they would count twice.

    Raises:
        InputError: which run, and which result.
    """
    for run in runs if results else ():
        is_whole = isinstance(run.data, RunFiles) and not (run.data.start or run.data.stop)
        files = run.files if is_whole and run.role is Role.TRAIN else ()
        digests = {file_digest(file.path) for file in files if is_file(file.path)}
        for name, result in results.items():
            if digests & result.digests:
                raise InputError(
                    f"run '{run.data.name}' was already used for '{name}', which gives the priors: its samples would "
                    "count twice; leave the run out, or take other priors"
                )
