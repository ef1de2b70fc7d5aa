"""Repair of a record: wild samples, held positions, empty cells; everything is reported."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from seatrial.core.text.words import counted
from seatrial.core.values import Channel, Finding, InputError, Record, Severity
from seatrial.core.values.arrays import unwrapped
from seatrial.data.check.jumps import spike_rows, track_jumps
from seatrial.data.check.lost_samples import (
    INPUT_CHANNELS,
    BridgedRecord,
    bridged,
    complete_parts,
    lost_sample_findings,
    usual_rows,
)
from seatrial.data.check.run_clock import moment
from seatrial.data.check.signal import RowIndices
from seatrial.data.check.timestamps import without_empty_ends


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
    is_angle = channel.unit == "rad"
    smooth = unwrapped(channel.values) if is_angle else channel.values
    finite = np.setdiff1d(np.flatnonzero(np.isfinite(smooth)), rows)
    values = np.array(channel.values)
    values[rows] = np.interp(rows, finite, smooth[finite])
    if is_angle:
        left = finite[np.clip(np.searchsorted(finite, rows) - 1, 0, len(finite) - 1)]
        values[rows] += channel.values[left] - smooth[left]
    return channel.with_values(values)


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
    due = [np.arange(a + usual, b, usual) for a, b in pairwise(rows.tolist()) if b - a > usual]
    return np.unique(np.concatenate([rows, *due]))
