"""Repair of a record: wild samples, held positions, empty cells; everything is reported."""

from dataclasses import replace

import numpy as np

from seatrial.core.text.words import counted
from seatrial.core.values import Channel, Finding, InputError, Record, Severity
from seatrial.core.values.notation import COMMANDS, REFERENCES
from seatrial.data.check.jumps import spike_rows, track_jumps
from seatrial.data.check.run_clock import moment
from seatrial.data.check.signal import RowIndices, mask_intervals, unwrapped
from seatrial.data.check.timestamps import without_empty_ends

INPUT_CHANNELS = ("delta", "n", "v_j", *COMMANDS, *REFERENCES)
# holes up to so many s or samples are interpolated; chosen: what a sensor loses now and then
SHORT_GAP_S, SHORT_GAP_SAMPLES = 1.0, 5


def repair(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Return the record without holes and wild samples, and a finding for each kind of change.

    Empty rows at the ends are cut; single wild samples and positions a receiver held are interpolated, as are holes
    of up to one second or five samples; of a record with longer holes the longest complete part is kept
    (`complete_segments` gives them all). Inputs are never smoothed. The time base should be even (`rebuild_time_base`).

    Raises:
        InputError: a channel holds no value, or nothing complete remains.
    """
    record, findings = without_empty_ends(record)
    _require_values(record)
    record, spiked = _interpolate_spikes(record)
    record, jumped = _repair_position_jumps(record)
    record, filled = _fill_short_gaps(record)
    record, cut = _longest_complete_segment(record)
    return record, findings + spiked + jumped + filled + cut


def complete_segments(record: Record) -> tuple[Record, ...]:
    """Return the complete stretches of a record, in order: no NaN in any channel or stamp."""
    holes = np.any([np.isnan(c.values) for c in record.channels.values()], axis=0) | np.isnan(record.time)
    return tuple(record.rows(slice(first, last)) for first, last in mask_intervals(~holes))


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
    jumps = track_jumps(record["x0"][finite], record["y0"][finite])
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
    repaired = {s: interpolate_rows(record.channel(s), held) for s in ("x0", "y0")}
    return replace(record, channels={**record.channels, **repaired}).with_step(step), (finding,)


def _fill_short_gaps(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Short holes between known samples interpolated, channel by channel."""
    steps = np.diff(record.time)
    dt = float(np.nanmedian(steps)) if steps.size else 1.0
    limit = max(SHORT_GAP_SAMPLES, round(SHORT_GAP_S / dt)) if dt > 0 else SHORT_GAP_SAMPLES
    counts: dict[str, int] = {}
    for symbol, channel in record.channels.items():
        empty = mask_intervals(np.isnan(channel.values))
        short = [np.arange(a, b) for a, b in empty if b - a <= limit and a > 0 and b < len(record)]
        if short:
            rows = np.concatenate(short)
            counts[symbol] = rows.size
            record = record.with_channel(symbol, interpolate_rows(channel, rows))
    if not counts:
        return record, ()
    named = ", ".join(f"{s} {n}" for s, n in counts.items())
    text = f"record '{record.name}': {counted(sum(counts.values()), 'cell')} in short holes interpolated"
    evidence = f"{named}; holes of up to {limit} samples"
    finding = Finding(Severity.WARNING, "empty-cells", text, evidence, "no action needed for a few")
    return record.with_step(f"{counted(sum(counts.values()), 'empty cell')} interpolated"), (finding,)


def _longest_complete_segment(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    segments = complete_segments(record)
    if not segments:
        raise InputError(f"record '{record.name}': no sample has a value in every channel; leave out the emptiest one")
    best = max(segments, key=len)
    if len(best) == len(record):
        return record, ()
    empty = {s: int(np.isnan(c.values).sum()) for s, c in record.channels.items() if np.isnan(c.values).any()}
    text = f"record '{record.name}' has long holes; of {counted(len(segments), 'complete part')} the longest is kept"
    ends, cells = f"{best.time[0]:.6g} to {best.time[-1]:.6g} s", ", ".join(f"{s} {n}" for s, n in empty.items())
    evidence = f"{moment(best.time[0], best.time[-1])}, {len(best)} of {len(record)} samples; empty cells: {cells}"
    advice = "split the file at the holes to use the other parts, or leave out the channel that is empty"
    finding = Finding(Severity.WARNING, "empty-rows", text, evidence, advice)
    step = f"longest complete part kept: {ends}"
    return best.with_step(step), (finding,)
