"""Repair of a record: wild samples, held positions, empty cells; everything is reported."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.text.words import counted
from seatrial.core.values import Array, Channel, Finding, InputError, Record, Severity
from seatrial.core.values.arrays import EMPTIED, sentinel_value, smeared_wraps, unwrapped
from seatrial.data.check.consequences import moment
from seatrial.data.check.motion import RowIndices
from seatrial.data.check.time_base import (
    INPUT_CHANNELS,
    BridgedRecord,
    bridged,
    complete_parts,
    lost_sample_findings,
    run_on,
    usual_rows,
    without_empty_ends,
)
from seatrial.numerics.resolution import local_resolution

# Jumps of position (held and catching up, or staying) and single wild samples.

# samples on each side over which the mean step of the track is taken, ours
HALF_WINDOW = 15
# a step is a jump beyond these multiples of the mean and of the median step, ours
STEP_RATIO, MEDIAN_STEP_RATIO = 4.0, 6.0
_STEPS = 1.5  # resolutions that a step may be which is no jump; chosen, between one and two
# a position is held where it moves by less than this share of the mean step, for so many samples at most, ours
HELD_RATIO, LONGEST_HOLD = 0.35, 50
# a jump matches the distance missed while the position was held between these shares of it; chosen
MATCHING = (0.3, 2.5)
# least step of a wild sample: over the quantile of all steps, and over the resolution; chosen
STEP_QUANTILE, OVER_QUANTILE, OVER_STEP = 0.95, 3.0, 5.0
# a sample is wild where it leaves and returns by this multiple of the largest of so many neighbouring steps, ours
SPIKE_RATIO, NEIGHBOURS = 4.0, 8
_NO_ROWS: RowIndices = np.empty(0, dtype=np.intp)


@dataclass(frozen=True)
class Jumps:
    """Jumps of a track.

    Attributes:
        rows: index of the sample after each jump.
        sizes: length of each jump [m].
        held: samples to replace: the position stood still there before it caught up.
    """

    rows: RowIndices
    sizes: Array
    held: RowIndices


def track_jumps(x: Array, y: Array) -> Jumps:
    """Return steps of more than four times the mean step around them, six times the median step and two resolutions.

    x, y: shape (n,), no NaN. A receiver that holds its last position and then catches up shows small steps first.
    """
    steps = np.hypot(np.diff(x), np.diff(y))
    rows = np.arange(len(steps))
    first, last = np.maximum(rows - HALF_WINDOW, 0), np.minimum(rows + 1 + HALF_WINDOW, len(x) - 1)
    mean = np.hypot(x[last] - x[first], y[last] - y[first]) / np.maximum(last - first, 1)
    moving = steps[steps > 0]
    typical = float(np.median(moving)) if moving.size else 0.0
    jumped = np.flatnonzero((steps > STEP_RATIO * mean) & (steps > MEDIAN_STEP_RATIO * typical))
    if jumped.size:  # the resolution takes a sort
        coarse = np.hypot(*(np.maximum(step[1:], step[:-1]) for step in map(local_resolution, (x, y))))
        jumped = jumped[steps[jumped] > _STEPS * coarse[jumped]]
    held = [_held_before(j, steps, mean) for j in jumped.tolist()]
    return Jumps(jumped + 1, steps[jumped], np.unique(np.concatenate([*held, _NO_ROWS])))


def _held_before(j: int, steps: Array, mean: Array) -> RowIndices:
    """Samples held before step j, or none where the jump does not match the distance missed."""
    count = 0
    while count < LONGEST_HOLD and j - 1 - count >= 0 and steps[j - 1 - count] < HELD_RATIO * mean[j]:
        count += 1
    missed = (count + 1) * mean[j]
    if count == 0 or not MATCHING[0] * missed < steps[j] < MATCHING[1] * missed:
        return _NO_ROWS
    return np.arange(j - count + 1, j + 1, dtype=np.intp)


def spike_rows(values: Array) -> RowIndices:
    """Return rows of single samples that leave and return in steps over four times any other within eight samples.

    values: shape (n,), no NaN. The step must also exceed three times the record's 95 % step, and five times its
    resolution.
    """
    steps = np.diff(values)
    sizes = np.abs(steps)
    moving = sizes[sizes > 0]
    if moving.size == 0 or len(values) < 2 * NEIGHBOURS:
        return _NO_ROWS
    both = np.minimum(sizes[:-1], sizes[1:])
    large = both > OVER_QUANTILE * float(np.quantile(sizes, STEP_QUANTILE))
    candidates = np.flatnonzero((steps[:-1] * steps[1:] < 0) & large)
    if not candidates.size:  # the resolution takes a sort
        return _NO_ROWS
    candidates = candidates[both[candidates] > OVER_STEP * local_resolution(values)[candidates + 1]]
    spikes = []
    for c in candidates.tolist():
        before, after = sizes[max(0, c - NEIGHBOURS) : c], sizes[c + 2 : c + 2 + NEIGHBOURS]
        if both[c] > SPIKE_RATIO * max(before.max(initial=0.0), after.max(initial=0.0)):
            spikes.append(c + 1)
    return np.array(spikes, dtype=np.intp)


# Repair of a record: wild samples, held positions, empty cells; everything is reported.


def repair(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Return the longest part of `repaired_parts`, and its findings.

    Raises:
        InputError: as `repaired_parts`.
    """
    parts, findings = repaired_parts(record)
    return max(parts, key=len), findings


def repaired_parts(record: Record) -> tuple[tuple[Record, ...], tuple[Finding, ...]]:
    """Return the parts of a record without holes and wild samples, and a finding for each kind of change.

    Empty rows at the ends are cut; single wild samples and positions a receiver held are interpolated. What is missing
    for no longer than the craft remembers is interpolated and counts as not measured; where a hole is longer a new part
    begins (`bridged`). Inputs are never smoothed. The time base should be even (`rebuild_time_base`).

    Raises:
        InputError: a channel holds no value, or nothing complete remains.
    """
    record, findings = _without_wild_samples(record)
    bridge = bridged(record)
    parts = complete_parts(bridge)
    if not parts:
        raise InputError(f"record '{record.name}': no sample has a value in every channel; leave out the emptiest one")
    return _with_steps(record, bridge, parts), findings + lost_sample_findings(record, bridge, parts)


def repaired_whole(record: Record) -> Record:
    """Return a record without wild samples that runs on over all holes between its first and last complete samples.

    Raises:
        InputError: as `repaired_parts`.
    """
    bridge = bridged(_without_wild_samples(record)[0])
    complete = np.flatnonzero(~bridge.is_hole)
    if complete.size == 0:
        raise InputError(f"record '{record.name}': no sample has a value in every channel; leave out the emptiest one")
    return bridge.record.rows(slice(int(complete[0]), int(complete[-1]) + 1))


def _without_wild_samples(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    record, findings = without_empty_ends(record)
    _require_values(record)
    record, spiked = _interpolate_spikes(record)
    record, jumped = _repair_position_jumps(record)
    return record, findings + spiked + jumped


def _with_steps(record: Record, bridge: BridgedRecord, parts: tuple[Record, ...]) -> tuple[Record, ...]:
    """The parts with what was done in their provenance."""
    total = sum(bridge.filled.values())
    filled = record.with_step(f"{counted(total, 'empty cell')} interpolated") if total else record
    return tuple(
        replace(part, provenance=filled.provenance)
        if len(part) == len(record)
        else replace(part, provenance=filled.provenance).with_step(
            f"complete part: {part.time[0]:.6g} to {part.time[-1]:.6g} s"
        )
        for part in parts
    )


def interpolate_rows(channel: Channel, rows: RowIndices) -> Channel:
    """Return the channel with the given rows interpolated linearly (angles along the shorter arc)."""
    values = np.array(channel.values)
    values[rows] = np.nan
    straight = run_on(channel.with_values(values))
    return channel.with_values(np.where(np.isin(np.arange(len(values)), rows), straight, channel.values))


def _require_values(record: Record) -> None:
    for symbol, channel in record.channels.items():
        if np.all(np.isnan(channel.values)):
            raise InputError(f"record '{record.name}': channel '{symbol}' holds no value at all; leave it out")


def _interpolate_spikes(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    findings = []
    measured = [s for s, channel in record.channels.items() if s not in INPUT_CHANNELS and not channel.is_command]
    for symbol in measured:
        channel = record.channel(symbol)
        known = np.flatnonzero(np.isfinite(channel.values))
        smooth = unwrapped(channel.values) if channel.unit == "rad" else channel.values
        rows = known[spike_rows(smooth[known])]
        if rows.size:
            repaired = interpolate_rows(channel, rows)
            off = np.max(np.abs(smooth[rows] - interpolate_rows(channel.with_values(smooth), rows).values[rows]))
            record = record.with_channel(
                symbol, repaired, f"{counted(rows.size, 'wild sample')} of {symbol} interpolated"
            )
            text = (
                f"record '{record.name}', channel '{symbol}': {counted(rows.size, 'single wild sample')} interpolated"
            )
            evidence = f"off by up to {off:.4g} {channel.unit}, first at {moment(float(record.time[rows[0]]))}"
            advice = "no action needed unless they are real"
            findings.append(Finding(Severity.WARNING, "outlier", text, evidence, advice))
    return record, tuple(findings)


def _repair_position_jumps(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Positions held and caught up with are interpolated; jumps that stay are only reported."""
    if "x0" not in record or "y0" not in record:
        return record, ()
    finite = np.flatnonzero(np.isfinite(record["x0"]) & np.isfinite(record["y0"]))
    if len(finite) < 3:
        return record, ()
    known, finite = finite, _without_gaps(finite)  # a lost row is no jump
    jumps = track_jumps(*(np.interp(finite, known, record[s][known]) for s in ("x0", "y0")))
    if jumps.rows.size == 0:
        return record, ()
    held = finite[jumps.held]
    largest = int(np.argmax(jumps.sizes))
    remaining = int(np.sum(~np.isin(jumps.rows - 1, jumps.held)))
    text = (
        f"record '{record.name}': the position jumps {'once' if jumps.rows.size == 1 else f'{jumps.rows.size} times'}"
    )
    text += f"; {counted(held.size, 'held sample')} before a jump interpolated" if held.size else ""
    text += f"; of the jumps {remaining} cannot be repaired and stay" if remaining else ""
    evidence = f"up to {jumps.sizes[largest]:.3g} m, at {moment(float(record.time[finite[jumps.rows[largest]]]))}"
    advice = "weight positions robustly" + ("; split the run at a jump that stays" if remaining else "")
    finding = Finding(Severity.WARNING, "jump", text, evidence, advice)
    if held.size == 0:
        return record, (finding,)
    step = f"{held.size} held positions interpolated"
    is_read = np.isin(np.arange(len(record)), np.setdiff1d(known, held))
    repaired = {s: interpolate_rows(record.channel(s), held).with_measured(is_read) for s in ("x0", "y0")}
    return replace(record, channels={**record.channels, **repaired}).with_step(step), (finding,)


def _without_gaps(rows: RowIndices) -> RowIndices:
    """Rows of readings, and those in which readings were due."""
    usual = round(usual_rows(rows))
    holes = np.flatnonzero(np.diff(rows) > usual).tolist()
    due = [np.arange(rows[k] + usual, rows[k + 1], usual) for k in holes]
    return np.sort(np.concatenate([rows, *due])) if due else rows


# Readings that stand for none, such as -999: one value far outside all others, again and again.

_ADVICE = "no action needed for a few"
_HEADINGS = ("psi", "psi_magnetic")


def without_sentinels(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Return the record with readings that stand for none made empty, and a finding for each channel that has such.

    Judged by behaviour, whatever the unit: commands are left alone. What was emptied as the log was read is found too.
    """
    emptied = [step for step in record.provenance.steps if step.endswith(EMPTIED)]
    findings = [
        Finding(Severity.WARNING, "no-reading", f"record '{record.name}', {step}", "", _ADVICE) for step in emptied
    ]
    for symbol in [s for s in _HEADINGS if s in record]:
        record, smeared = _without_smeared_wraps(record, symbol)
        findings += smeared
    for symbol in [s for s in record.channels if s not in INPUT_CHANNELS]:
        values = record[symbol]
        sentinel = sentinel_value(values, record.channel(symbol).unit)
        if sentinel is None:
            continue
        rows = values == sentinel
        channel = record.channel(symbol)
        record = record.with_channel(
            symbol, channel.with_values(np.where(rows, np.nan, values)), f"{rows.sum()} readings of {symbol} made empty"
        )
        text = f"record '{record.name}', channel '{symbol}': {rows.sum()} readings of {sentinel:.6g} {channel.unit} "
        text += "stand for none; they count as empty"
        rest = values[~rows & np.isfinite(values)]
        times = record.time[rows]
        evidence = f"the first and the last at {moment(times[0], times[-1])}; all others lie between "
        evidence += f"{rest.min():.4g} and {rest.max():.4g}"
        findings.append(Finding(Severity.WARNING, "no-reading", text, evidence, _ADVICE))
    return record, tuple(findings)


def _without_smeared_wraps(record: Record, symbol: str) -> tuple[Record, list[Finding]]:
    """Headings made empty where they run the wrong way round: averaged or interpolated as numbers across north."""
    channel, is_smeared = record.channel(symbol), np.zeros(len(record), dtype=bool)
    smeared = smeared_wraps(channel.values)
    if not smeared:
        return record, []
    for a, b in smeared:
        is_smeared[a:b] = True
    emptied = channel.with_values(np.where(is_smeared, np.nan, channel.values))
    count = counted(int(is_smeared.sum()), "reading")
    finding = Finding(
        Severity.ERROR,
        "angle-wrap",
        f"record '{record.name}': '{symbol}' was averaged or interpolated as a number where it jumps by a whole turn",
        f"it runs the wrong way round {counted(len(smeared), 'time')}, first at {moment(record.time[smeared[0][0]])}; "
        f"{count} made empty",
        f"log '{symbol}' as the sensor gives it, or average its sine and cosine",
    )
    return record.with_channel(symbol, emptied, f"{count} of {symbol} that run the wrong way round made empty"), [
        finding
    ]


# How much of a run its repair leaves: a repair never destroys quietly.

# share of the rows of a run that a repair may drop as a warning; the project's rule
LARGEST_DROPPED_SHARE = 0.05


def dropped_rows_findings(record: Record, parts: Sequence[Record]) -> tuple[Finding, ...]:
    """An error where the repair leaves less than 95 % of the rows that hold a value.

    record: as it was read; parts: what the repair keeps.
    """
    filled = ~np.all([np.isnan(c.values) for c in record.channels.values()], axis=0) & np.isfinite(record.time)
    rows, kept = int(np.sum(filled)), 0
    for part in parts:
        half = 0.5 * part.dt if len(part) > 1 else 0.0
        inside = (record.time >= part.time[0] - half) & (record.time <= part.time[-1] + half) & filled
        kept += min(int(np.sum(inside)), len(part))
    complete = max(parts, key=len)
    if rows == 0 or kept >= (1.0 - LARGEST_DROPPED_SHARE) * rows:
        return ()
    return (
        Finding(
            Severity.ERROR,
            "rows-dropped",
            f"record '{record.name}': the repair drops {1.0 - kept / rows:.0%} of its rows",
            f"{kept} of {rows} rows remain, {moment(complete.time[0], complete.time[-1])}",
            _advice(record),
        ),
    )


def _advice(record: Record) -> str:
    """The emptiest channel to leave out."""
    empty = {symbol: int(np.sum(np.isnan(channel.values))) for symbol, channel in record.channels.items()}
    emptiest = max(empty, key=lambda symbol: empty[symbol])
    if empty[emptiest]:
        return f"remove channels.{emptiest}, which is empty in {empty[emptiest]} rows, from the trial file"
    return "check the unit of time and the time column; the stamps are too uneven to keep the rows"
