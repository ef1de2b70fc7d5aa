"""From the runs of a trial to checked records in standard frames, signs and units."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.core.values.arrays import with_corner_areas
from seatrial.data.check import canonical_record, examined_record
from seatrial.data.check.consequences import completed
from seatrial.data.check.consistency import ESTIMATE_CURRENT
from seatrial.data.check.examine import copies
from seatrial.data.check.inputs import thruster_findings
from seatrial.data.check.phases import (
    SWINGING,
    about_rest,
    approach_fault,
    begins_before_release,
    first_execution,
    is_in_waves,
    release_findings,
    release_row,
    swing_noise,
    swing_text,
    swinging_channel,
)
from seatrial.data.trial.trial import Role, Run, Trial, Trimming
from seatrial.physics.models.thruster_layout import layout_of
from seatrial.physics.sea.spectrum import WaveEncounter
from seatrial.physics.sensors.measured_outputs import with_timed_receiver
from seatrial.physics.sensors.settings import Late, Sensors

# The approach condition of a set of records: the steady state from which a simulated manoeuvre starts by default.

# how much of each record before its first rudder execution is taken for the approach, s
APPROACH_SECONDS = 2.0
# share of the run's median speed below which a ship begins from rest, and has no approach; chosen
_FROM_REST = 0.5


def approach_condition(records: Sequence[Record], model: Model) -> dict[str, float]:
    """Return surge velocity and inputs other than rudder and wind: median over records of each one's approach.

    Of records whose approach is steady; of all where none is. A ship that begins from rest is judged by the medians of
    its run; craft with thrusters begin so.
    """
    steady = [record for record in records if not approach_fault(record)]
    symbols = ["u", *(name for name in model.input_names if name != "delta" and not name.startswith("wind"))]
    condition = {}
    for symbol in symbols:
        values = [_approach_value(r, symbol, model) for r in steady or records if symbol in r]
        if values:
            condition[symbol] = float(np.median(values))
    return condition


def _approach_value(record: Record, symbol: str, model: Model) -> float:
    stop = float(record.time[0])
    if "delta" in record:
        stop = float(record.time[first_execution(record)])
    stop = max(stop, float(record.time[0]) + APPROACH_SECONDS)
    within = (record.time >= stop - APPROACH_SECONDS) & (record.time <= stop)
    if "u" in record and not model.has_thrusters:
        speed = np.abs(record["u"])
        if np.mean(speed[within]) < _FROM_REST * np.median(speed):
            return float(np.median(record[symbol]))
    return float(np.mean(record[symbol][within]))


# A decay from its release on: what lies before it was held by hand.

# first angle over noise; largest angle of the last third over that of the first, ours
_MIN_SIGNAL_TO_NOISE, _MAX_AMPLITUDE_RATIO = 5.0, 0.9
# share of the largest angle that counts as a swing, and how many before it need as many after it, ours
_EARLY_SWING_FRACTION, _MAX_EARLY_SWINGS = 0.2, 4
# fewest samples of a decay, ours
_MIN_ROWS = 20
# angle [rad] beyond which degrees were given without their unit
_MAX_ANGLE = np.pi / 2.0


def trim_to_decay_start(record: Record) -> Record:
    """The record from its release on: from the row behind a hold, else from its largest motion about its rest.

    The motion is that of roll, pitch and heave which dies out most. People who run from side to side may have driven it
    before.

    Raises:
        InputError: none of these, a start that is not above the noise or beyond 90 deg, a motion that does not decay,
            too little of it.
    """
    channel = swinging_channel(record)
    if not channel:
        raise InputError(f"record '{record.name}': from_release needs a swing, 'phi', 'theta' or 'z'; add the channel")
    if len(record) < _MIN_ROWS:
        raise InputError(f"record '{record.name}': {len(record)} rows are no decay; give a longer record")
    swing, motion = about_rest(record[channel]), SWINGING[channel]
    first = release_row(swing)
    largest, noise = float(np.max(np.abs(swing[first:]))), swing_noise(swing)
    if not largest > _MIN_SIGNAL_TO_NOISE * noise:
        raise InputError(
            f"record '{record.name}': the decay starts at {swing_text(channel, largest)}, within the noise of "
            f"{swing_text(channel, noise)}; release from a larger one"
        )
    if channel != "z" and largest > _MAX_ANGLE:
        raise InputError(
            f"record '{record.name}': the decay starts at {np.degrees(largest):.4g} deg, beyond 90 deg; "
            f"check the unit of channel '{channel}'"
        )
    early, late = (_swing_count(part, _EARLY_SWING_FRACTION * largest) for part in (swing[:first], swing[first:]))
    if early > _MAX_EARLY_SWINGS and (late < _MAX_EARLY_SWINGS or is_in_waves(swing)):
        raise InputError(
            f"record '{record.name}': the {motion} grows, to {swing_text(channel, largest)} at "
            f"{record.time[first]:g} s, instead of decaying from a release; leave the run out"
        )
    if len(record) - first < _MIN_ROWS:
        raise InputError(
            f"record '{record.name}': the {motion} is free from {record.time[first]:g} s on, so that nothing is "
            "left of the decay; give a longer record, or cut it by parts"
        )
    _require_smaller_last_third(record.name, channel, swing[first:])
    step = f"from its release on, at {record.time[first]:g} s"
    kept = record.rows(slice(first, None))
    return kept.with_channel(channel, kept.channel(channel), step)


def need_release(records: Sequence[Record]) -> bool:
    """Return whether records are to be cut at their releases: one begins long before its own, and all have one."""
    try:
        for record in records:
            trim_to_decay_start(record)
    except InputError:
        return False
    return any(map(begins_before_release, records))


def require_decay(record: Record) -> None:
    """Refuse a record whose roll angle is as large at its end as at its beginning.

    Raises:
        InputError: both angles.
    """
    _require_smaller_last_third(record.name, "phi", record["phi"] - np.nanmedian(record["phi"]))


def _require_smaller_last_third(name: str, channel: str, swing: Array) -> None:
    size = np.abs(swing)
    third = len(size) // 3
    first, last = float(np.nanmax(size[:third])), float(np.nanmax(size[-third:]))
    if not last < _MAX_AMPLITUDE_RATIO * first:
        raise InputError(
            f"record '{name}': the {SWINGING[channel]} does not decay: {swing_text(channel, first)} in its first "
            f"third, {swing_text(channel, last)} in its last; leave the run out, or record what drives the ship"
        )


def _swing_count(values: Array, size: float) -> int:
    """How often the motion changes between one side and the other, both beyond `size`."""
    sides = np.sign(values[np.abs(values) > size])
    return int(np.sum(sides[1:] != sides[:-1]))


# speed at the end of an acceleration run over the speed at the first rudder execution; largest standard deviation of
# a sensor over the largest value recorded: chosen
_ACCELERATED_FRACTION, _LARGEST_NOISE = 0.9, 1000.0
_NOT_READ = "not-read"
"""Code of the finding on a validation run whose file cannot be read."""


@dataclass(frozen=True, eq=False)
class TrialRecord:
    """One record ready for use: canonical, trimmed, resampled; with the findings of its checks.

    run: the run that it is, or is a part of.
    """

    record: Record
    role: Role
    session: str
    waves: WaveEncounter | None = None
    findings: tuple[Finding, ...] = ()
    run: str = ""


@dataclass(frozen=True, eq=False)
class CheckedRecords:
    """Records that passed the checks, at the rate of the estimate, and what was found on the trial and on them."""

    records: tuple[TrialRecord, ...]
    findings: tuple[Finding, ...]


def checked_records(trial: Trial) -> CheckedRecords:
    """Load every run that is not left out and refuse errors of training runs that the trial does not accept.

    A validation run with such an error is not predicted, which a finding says: the fit does not rest on it. Where
    nothing says how an input runs between samples, the corners of its ramps keep their area. Readings of a receiver
    that is late are moved by the start value of its lag.

    Raises:
        InputError: as `load_records` and `refuse_errors`.
    """
    records, findings = load_records(trial)
    records, findings = _without_failed_validation(records, findings, trial.accept)
    findings, rate = refuse_errors(findings, trial.accept), trial.estimate.rate
    records = tuple(replace(r, record=with_input_corners(r.record, trial.model)) for r in records)
    if rate is not None:
        records = tuple(replace(r, record=r.record.resampled(rate)) for r in records)
    sensors = Sensors.from_text(trial.model.equations.sensors)
    lag = sensors.late.get(Late.RECEIVER, 0.0)
    records = tuple(replace(r, record=with_timed_receiver(r.record, sensors, lag)) for r in records)
    return CheckedRecords(records, findings)


def with_input_corners(record: Record, model: Model) -> Record:
    """Return the record with inputs that keep the area of the corners that a ramp turns within a sample."""
    for item in model.inputs:
        channel = record.channel(item.name) if item.name in record else None
        if channel is None or item.is_held or channel.between or channel.is_command:
            continue
        if np.all(np.isfinite(channel.values)):
            record = record.with_channel(item.name, channel.with_values(with_corner_areas(channel.values)))
    return record


def _without_failed_validation(
    records: tuple[TrialRecord, ...], findings: tuple[Finding, ...], accept: tuple[str, ...]
) -> tuple[tuple[TrialRecord, ...], tuple[Finding, ...]]:
    """The records without validation runs that fail the checks; their errors as warnings, a finding for each run."""
    failed = {
        index: errors for index, r in enumerate(records)
        if r.role is Role.VALIDATE and (errors := [f for f in r.findings if _is_open_error(f, accept)])
    }  # fmt: skip
    lowered = [f for errors in failed.values() for f in errors] + [f for f in findings if f.code == _NOT_READ]
    skipped = [_failed_validation_finding(records[index], errors) for index, errors in failed.items()]
    kept = tuple(replace(f, severity=Severity.WARNING) if f in lowered else f for f in findings)
    return tuple(r for i, r in enumerate(records) if i not in failed), (*kept, *skipped)


def _failed_validation_finding(run: TrialRecord, errors: Sequence[Finding]) -> Finding:
    codes = tuple(dict.fromkeys(f.code for f in errors))
    accepted = ", ".join(f'"{code}"' for code in codes)
    return Finding(
        Severity.WARNING, "not-predicted",
        f"validation run '{run.record.name}' does not pass the checks and is not predicted; the fit does not rest on "
        "it", ", ".join(codes), f"correct the run; or, if it is right as it is, add accept = [{accepted}] at the top "
        "of the trial file",
    )  # fmt: skip


def load_records(trial: Trial, load: "RunLoader | None" = None) -> tuple[tuple[TrialRecord, ...], tuple[Finding, ...]]:
    """Read, repair and check every run that is not left out; the trial's own findings come first.

    A validation run that cannot be read is left out, which an error finding says.

    load: takes the place of `load_parts`, such as one that keeps runs which have not changed.

    Raises:
        InputError: the trial has no records; a training run's file cannot be parsed, or trimming leaves nothing of it.
    """
    if not trial.runs:
        where = f"{trial.path}: " if trial.path else ""
        raise InputError(f"{where}there are no [[records]] to read; add them, or plan a trial with 'seatrial design'")
    used = (run for run in trial.runs if run.role is not Role.LEAVE_OUT)
    read = [part for run in used for part in _load_unless_bad(run, trial.reference_point, load or load_parts)]
    records = tuple(r for r in read if isinstance(r, TrialRecord))
    unread = tuple(r for r in read if isinstance(r, Finding))
    for channel, deviation in trial.noise.items():
        _refuse_absurd_noise(channel, deviation, [r.record for r in records])
    _refuse_aground(trial.model, [r.record for r in records])
    records, repeated = _without_copies(records)
    of_runs = (_answered(finding, trial) for record in records for finding in record.findings)
    return records, (*trial.findings, *unread, *repeated, *of_runs, *_craft_findings(trial, records))


def _refuse_aground(model: Model, records: Sequence[Record]) -> None:
    draught = model.parameters.value_of("d", 0.0) if "depth" in model.input_names else 0.0
    for record in records:
        depths = record["depth"][record["depth"] > 0.0] if "depth" in record else np.empty(0)
        if depths.size and (least := float(np.min(depths))) <= draught:
            raise InputError(
                f"record '{record.name}': the water is {least:.3g} m deep where the ship draws {draught:.3g} m; depth "
                "is from the surface to the bottom: of a sounder in the keel add "
                f"offset = {draught:.3g} under channels.depth"
            )


def _answered(finding: Finding, trial: Trial) -> Finding:
    """The finding; one that a current explains is a note where the trial estimates one."""
    if finding.advice != ESTIMATE_CURRENT or not trial.estimate.current:
        return finding
    advice = "no action needed: [estimate] current estimates one for each run"
    return replace(finding, severity=Severity.INFO, advice=advice)


def _load_unless_bad(run: Run, reference_point: float, load: "RunLoader") -> tuple[TrialRecord | Finding, ...]:
    """The parts of the run, or of a validation run that cannot be read the finding that says why."""
    try:
        return load(run, reference_point)
    except InputError as error:
        if run.role is not Role.VALIDATE:
            raise
        advice = "correct the file, or leave the run out; the fit does not rest on it"
        return (Finding(Severity.ERROR, _NOT_READ, f"a validation run cannot be read: {error}", "", advice),)


def _craft_findings(trial: Trial, records: tuple[TrialRecord, ...]) -> tuple[Finding, ...]:
    """What all runs together show of the thrusters that the model has."""
    if not trial.model.has_thrusters:
        return tuple(_one_course_findings(trial, records))
    of_thrusters = thruster_findings(layout_of(trial.model), [r.record for r in records])
    return (*of_thrusters, *_one_course_findings(trial, records))


def _one_course_findings(trial: Trial, records: tuple[TrialRecord, ...]) -> tuple[Finding, ...]:
    """A warning where a current is estimated and positions on one course are all that shows a speed."""
    if not trial.estimate.current or not trial.model.has_speed or any("u" in r.record for r in records):
        return ()
    from seatrial.data.check.water_speed import speed_through_water

    sessions = {r.session: [s.record for s in records if s.session == r.session] for r in records}
    by_session = {name: speed_through_water(runs) for name, runs in sessions.items()}
    lone = [name for name, water in by_session.items() if water is not None and not water.shows_current]
    if not lone or any(water is not None and water.shows_current for water in by_session.values()):
        return ()
    return (Finding(
        Severity.WARNING, "velocity-over-ground",
        "speed through the water was not recorded, and one course alone does not separate a current from it",
        f"sessions {enumeration(lone)}", "record a run on the opposite course, or the speed through the water; runs of "
        'one outing share its current: session = "all"',
    ),)  # fmt: skip


def _without_copies(records: tuple[TrialRecord, ...]) -> tuple[tuple[TrialRecord, ...], tuple[Finding, ...]]:
    """The records, each once, and a warning for each copy; a validation run that copies a training run stays."""
    dropped, findings = set(), []
    for index, first in copies([r.record for r in records]).items():
        copy, original = records[index], records[first]
        if copy.role is original.role:
            dropped.add(index)
            consequence, advice = "it counts once", f'add leave_out = ["{copy.record.name}"] to its [[records]]'
        else:
            consequence, advice = "its score is that of a fitted run", "validate on a run that was not trained on"
        findings.append(
            Finding(
                Severity.WARNING, "copied-run",
                f"record '{copy.record.name}' is a copy of '{original.record.name}', sample by sample: {consequence}",
                f"{len(copy.record)} samples", advice,
            )
        )  # fmt: skip
    return tuple(r for i, r in enumerate(records) if i not in dropped), tuple(findings)


def _refuse_absurd_noise(channel: str, deviation: float, records: Sequence[Record]) -> None:
    """Raises:
    InputError: noise of a channel is stated that dwarfs all that its records show.
    """
    largest = max((float(np.nanmax(np.abs(r[channel]), initial=0.0)) for r in records if channel in r), default=0.0)
    if largest and deviation > _LARGEST_NOISE * largest:
        raise InputError(
            f"[noise] {channel} = {deviation:g} is over {_LARGEST_NOISE:g} times the largest value in the records "
            f"({largest:g}, SI); correct the number or its unit"
        )


RunLoader = Callable[[Run, float], tuple[TrialRecord, ...]]
"""Reads and checks a run, as `load_parts`."""


def load_run(run: Run, reference_point: float, load: RunLoader | None = None) -> TrialRecord:
    """Return the longest of `load_parts` under the name of the run, with the findings on all of it.

    Raises:
        InputError: as `load_parts`.
    """
    parts = (load or load_parts)(run, reference_point)
    longest = max(parts, key=lambda part: len(part.record))
    findings = tuple(finding for part in parts for finding in part.findings)
    return replace(longest, record=longest.record.renamed(longest.run), findings=findings)


def load_parts(run: Run, reference_point: float) -> tuple[TrialRecord, ...]:
    """Return one run repaired and checked, in standard conventions, with wave forces, trimmed and resampled.

    Holes longer than the craft's memory cut it into parts that begin anew, called after it and numbered; of a decay
    from its release the longest is kept.

    reference_point: m forward of midship to which velocities and positions are referred.

    Raises:
        InputError: the file cannot be parsed, or trimming leaves nothing.
    """
    examined = examined_record(run.raw_record())
    is_one = run.trimming.from_release or run.trimming.skip_acceleration
    parts = [examined.record] if is_one else examined.parts
    records = [_prepared(part, run, reference_point) for part in parts]
    names = [""] if len(records) == 1 else [f"-{k}" for k in range(1, len(records) + 1)]
    return tuple(
        TrialRecord(
            record.renamed(f"{record.name}{name}"), run.role, run.session, run.waves,
            (*(examined.findings if k == 0 else ()), *completed(release_findings(record), record)), record.name,
        )
        for k, (record, name) in enumerate(zip(records, names, strict=True))
    )  # fmt: skip


def _prepared(record: Record, run: Run, reference_point: float) -> Record:
    """A part of a run as the estimate takes it."""
    record = canonical_record(record, reference_point)
    if run.waves is not None and run.waves.spectrum is None:
        from seatrial.physics.sea.wave_forces import with_wave_forces

        record = with_wave_forces(record, run.waves.excitation, run.waves.U, run.waves.beta)
    return apply_trimming(record, run.trimming)


def apply_trimming(record: Record, trimming: Trimming) -> Record:
    """The part of the record that the rules keep, at their rate.

    Raises:
        InputError: nothing is left, or the channels a rule needs are absent.
    """
    if trimming.skip_acceleration:
        record = record.rows(slice(_acceleration_end_row(record), None))
    if trimming.from_release:
        record = trim_to_decay_start(record)
    return record if trimming.rate is None else record.resampled(trimming.rate)


def _acceleration_end_row(record: Record) -> int:
    speed = record["u"]
    return int(np.argmax(speed >= _ACCELERATED_FRACTION * speed[first_execution(record)]))


def refuse_errors(findings: tuple[Finding, ...], accept: tuple[str, ...]) -> tuple[Finding, ...]:
    """The findings, accepted errors lowered to warnings.

    Raises:
        InputError: an error finding that the trial does not accept.
    """
    open_errors = [f for f in findings if _is_open_error(f, accept)]
    if open_errors:
        first, more = open_errors[0], len(open_errors) - 1
        rest = f" (and {more} more; run 'seatrial check')" if more else ""
        advice = f"; {first.advice}" if first.advice else ""
        raise InputError(
            f"the records do not pass the checks{rest}: {first.text}{advice}; "
            f'or, if it is right as it is, add accept = ["{first.code}"] at the top of the trial file'
        )
    return tuple(replace(f, severity=Severity.WARNING) if f.severity is Severity.ERROR else f for f in findings)


def _is_open_error(finding: Finding, accept: tuple[str, ...]) -> bool:
    return finding.severity is Severity.ERROR and finding.code not in accept
