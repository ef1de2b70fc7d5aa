"""Samples that are missing: channels run on where the craft has not forgotten what went before; other holes are cut."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.text.words import counted
from seatrial.core.values import Array, Channel, Finding, Record, Severity
from seatrial.core.values.arrays import Mask, unwrapped
from seatrial.core.values.notation import COMMANDS, REFERENCES
from seatrial.data.check.run_clock import moment
from seatrial.data.check.signal import RowIndices, mask_intervals

INPUT_CHANNELS = ("delta", "n", "v_j", *COMMANDS, *REFERENCES)
# holes up to so many s or samples are bridged in any case; chosen: what a sensor loses now and then
SHORT_GAP_S, SHORT_GAP_SAMPLES = 1.0, 5
# usual distances of the readings of a channel, beyond which readings are missing; chosen: one lost is no hole
_GAP_STEPS = 2.5
SLOWER = 1.5  # rows between two readings of a channel, from which on it is slower than the table; chosen
_FORGOTTEN = 1.0 / np.e  # autocorrelation of the motion at the time that counts as its memory; a Markov process's
_LONGEST_SHARE = 0.1  # of a run that counts as memory at most; chosen
_SHORTEST_PART = 20  # samples of a part that is worth a run of its own; chosen, as the least of a check
_MOTION = ("r", "psi", "phi", "theta", "z", "u")  # the first that is recorded shows how long motions last
_RATES_OF = frozenset({"psi"})  # angles without a rest, of which the rate is looked at


@dataclass(frozen=True, eq=False)
class BridgedRecord:
    """A record whose channels run on over what is missing.

    Attributes:
        record: without NaN; what was not measured is marked in its channels but for inputs.
        is_hole: (n,), where an input or every output is missing for longer than the craft remembers, or a channel has
            not begun.
        filled: channel -> number of cells that are missing in rows that hold others.
        longest: rows of the longest hole that is bridged.
    """

    record: Record
    is_hole: Mask
    filled: dict[str, int]
    longest: int


def bridged(record: Record) -> BridgedRecord:
    """Return an evenly sampled record with values straight between readings; commands stay as they were.

    Each channel must hold a value.
    """
    limit = bridged_rows(record)
    is_hole = np.zeros(len(record), dtype=np.bool_)
    is_empty = np.all([np.isnan(c.values) for c in record.channels.values()], axis=0)
    channels, filled, unread = {}, {}, []
    for symbol, channel in record.channels.items():
        known = np.flatnonzero(np.isfinite(channel.values))
        is_hole[: known[0]] = is_hole[known[-1] + 1 :] = True
        is_missing = _long_holes(channel.values, limit)
        if _is_input(symbol, channel):
            is_hole |= is_missing
        else:
            unread.append(is_missing)
        channels[symbol] = _run_on(symbol, channel, known)
        count = int(np.sum(np.isnan(channel.values) & ~is_empty))
        if count and usual_rows(known) < SLOWER:
            filled[symbol] = count
    is_hole |= np.all(unread, axis=0) if unread else _long_holes(np.where(is_empty, np.nan, 0.0), limit)
    return BridgedRecord(
        Record(record.name, record.time, channels, record.kind, record.provenance), is_hole, filled, limit
    )


def read_stretch(record: Record) -> Record:
    """Return the longest stretch of a bridged record in which no channel is unread for longer than what is bridged."""
    limit = bridged_rows(record)
    is_unread = np.zeros(len(record), dtype=np.bool_)
    for channel in record.channels.values():
        if channel.is_measured is not None:
            is_unread |= _long_holes(channel.measured, limit)
    stretches = mask_intervals(~is_unread)
    return record.rows(slice(*max(stretches, key=lambda ends: ends[1] - ends[0]))) if is_unread.any() else record


def _long_holes(values: Array, limit: int) -> Mask:
    """Rows (n,) in holes of more than `limit` rows, and more than a few usual distances of the readings."""
    result = np.isnan(values)
    longest = max(limit, _GAP_STEPS * usual_rows(np.flatnonzero(~result)))
    for a, b in mask_intervals(result):
        if b - a <= longest:
            result[a:b] = False
    return result


def _is_input(symbol: str, channel: Channel) -> bool:
    return symbol in INPUT_CHANNELS or channel.is_command


def usual_rows(readings: RowIndices) -> float:
    """Return the usual distance of two readings of a channel [rows]."""
    return float(np.median(np.diff(readings))) if len(readings) > 1 else 1.0


def bridged_rows(record: Record) -> int:
    """Return the longest hole that is bridged [rows]: what the craft remembers, at least a second or five rows."""
    return max(_short_rows(record), min(_memory_rows(record), int(_LONGEST_SHARE * len(record))))


def _short_rows(record: Record) -> int:
    steps = np.diff(record.time)
    dt = float(np.nanmedian(steps)) if steps.size else 1.0
    return max(SHORT_GAP_SAMPLES, round(SHORT_GAP_S / dt)) if dt > 0 else SHORT_GAP_SAMPLES


def _memory_rows(record: Record) -> int:
    """Rows in which the motion falls out of step with itself; 0 where none is recorded.

    By the autocorrelation of the yaw rate, or of what else moves, over that at two rows: noise of a sensor is gone.
    """
    symbol = next((s for s in _MOTION if s in record and np.isfinite(record[s]).sum() > _SHORTEST_PART), "")
    if not symbol:
        return 0
    channel = record.channel(symbol)
    motion = _run_on(symbol, channel, np.flatnonzero(np.isfinite(channel.values))).values
    motion = np.gradient(unwrapped(motion)) if symbol in _RATES_OF else motion
    spectrum = np.abs(np.fft.rfft(motion - motion.mean(), 2 * len(motion))) ** 2
    correlation = np.fft.irfft(spectrum)[: len(motion)]
    least = 2  # rows, as said above
    if not correlation[least] > 0.0:
        return 0
    return least + int(np.argmax(correlation[least:] < _FORGOTTEN * correlation[least]))


def _run_on(symbol: str, channel: Channel, readings: RowIndices) -> Channel:
    """The channel without NaN: angles along the shorter arc, commands held, the ends as the nearest reading."""
    rows = np.arange(len(channel.values))
    is_known = np.isfinite(channel.values)
    if is_known.all():
        return channel
    if channel.is_command:
        before = np.clip(np.searchsorted(readings, rows, side="right") - 1, 0, None)
        return channel.with_values(channel.values[readings[before]])
    values = np.array(channel.values)
    smooth = unwrapped(channel.values) if channel.unit == "rad" else channel.values
    missing = np.flatnonzero(~is_known)
    before = readings[np.clip(np.searchsorted(readings, missing) - 1, 0, None)]
    values[missing] = np.interp(missing, readings, smooth[readings]) + channel.values[before] - smooth[before]
    whole = channel.with_values(values)
    if _is_input(symbol, channel):
        return whole
    return whole.with_measured(is_known if channel.is_measured is None else is_known & channel.is_measured)


def complete_parts(bridge: BridgedRecord) -> tuple[Record, ...]:
    """Return the stretches between holes, in order, but for short ones beside longer ones."""
    parts = [bridge.record.rows(slice(a, b)) for a, b in mask_intervals(~bridge.is_hole)]
    longest = max((len(part) for part in parts), default=0)
    return tuple(part for part in parts if len(part) >= min(_SHORTEST_PART, longest))


def lost_sample_findings(record: Record, bridge: BridgedRecord, parts: tuple[Record, ...]) -> tuple[Finding, ...]:
    """Return what is said of slower channels, empty cells and long holes; record: before it was bridged."""
    return (*_slower_findings(record), *_cell_findings(bridge), *_hole_findings(record, parts))


def _slower_findings(record: Record) -> list[Finding]:
    """One note on the channels with a rate of their own."""
    slower = {
        symbol: usual * float(np.nanmedian(np.diff(record.time)))
        for symbol, channel in record.channels.items()
        if (usual := usual_rows(np.flatnonzero(np.isfinite(channel.values)))) >= SLOWER
    }
    if not slower:
        return []
    named = ", ".join(f"{symbol} every {period:.3g} s" for symbol, period in slower.items())
    text = f"record '{record.name}': {', '.join(slower)} come more slowly than the rows"
    evidence = f"{named}, a row every {float(np.nanmedian(np.diff(record.time))):.3g} s"
    advice = "no action needed: they count where they are new, at their own rate"
    return [Finding(Severity.INFO, "slower-channel", text, evidence, advice)]


def _cell_findings(bridge: BridgedRecord) -> list[Finding]:
    if not bridge.filled:
        return []
    record, total = bridge.record, sum(bridge.filled.values())
    named = ", ".join(f"{s} {n}" for s, n in bridge.filled.items())
    text = f"record '{record.name}': {counted(total, 'cell')} empty beside others; what lies between is interpolated"
    evidence = f"{named}; holes of up to {bridge.longest} samples"
    return [Finding(Severity.WARNING, "empty-cells", text, evidence, "no action needed for a few")]


def _hole_findings(record: Record, parts: tuple[Record, ...]) -> list[Finding]:
    kept = sum(map(len, parts))
    if len(parts) < 2 and kept >= len(record) - _ends(record):
        return []
    empty = {s: int(np.isnan(c.values).sum()) for s, c in record.channels.items() if np.isnan(c.values).any()}
    best = max(parts, key=len)
    text = f"record '{record.name}' has long holes; its {counted(len(parts), 'complete part')} begin anew"
    cells = ", ".join(f"{s} {n}" for s, n in empty.items())
    evidence = (
        f"{kept} of {len(record)} samples; the longest part {moment(best.time[0], best.time[-1])}; empty cells: {cells}"
    )
    advice = "no action needed: each part is a run of its own; or leave out the channel that is empty"
    return [Finding(Severity.WARNING, "empty-rows", text, evidence, advice)]


def _ends(record: Record) -> int:
    """Rows at the ends that slower channels leave out, as they have not begun there."""
    known = [np.flatnonzero(np.isfinite(channel.values)) for channel in record.channels.values()]
    return round(2.0 * max(usual_rows(one) for one in known)) if len(known) else 0
