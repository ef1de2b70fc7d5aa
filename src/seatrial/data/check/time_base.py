"""The time base: stamps repeated, rounded or missing, samples lost; rebuilt evenly, never silently."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.text.words import counted
from seatrial.core.values import Array, Channel, Finding, InputError, Record, Severity
from seatrial.core.values.arrays import Mask, mask_intervals, unwrapped
from seatrial.core.values.notation import COMMANDS, REFERENCES
from seatrial.data.check.consequences import moment
from seatrial.data.check.motion import RowIndices
from seatrial.numerics.resolution import local_resolution

# The even time base behind rounded stamps: its step, and the place of each sample on it.

# steps of time beyond which samples are missing, and roundings of the stamps by which such a step must exceed the mean
# one; chosen: a single lost sample is no gap
GAP_STEPS, GAP_QUANTA = 2.5, 1.5
# samples over which the mean step is taken; chosen: rounded stamps average out
STEP_LAG = 20
# distance of a stamp from the even base, in steps and in roundings, up to which the samples are even; chosen
LARGEST_JITTER, LARGEST_ROUNDING = 0.6, 1.01
# distance of a step of the clock from a whole number of the usual one, in steps, up to which samples between are lost;
# chosen: ten standard deviations of stamps that jitter by 3 ms at 10 Hz
_WHOLE_STEPS = 0.3


@dataclass(frozen=True, eq=False)
class EvenBase:
    """An even time base and where the samples of a record stand on it.

    Attributes:
        index: place of each sample, counted from the first.
        start, step: s.
        jitter: largest distance of a stamp from its place [s].
        is_even: whether every stamp lies at its place, within rounding.
        repeated: number of stamps that repeat the one before.
        gaps: rows after which samples are missing.
    """

    index: RowIndices
    start: float
    step: float
    jitter: float
    is_even: bool
    repeated: int
    gaps: RowIndices


def even_base(time: Array) -> EvenBase:
    """Return the even base of stamps in order, shape (n,), n >= 2.

    Without gaps where every stamp then lies within its rounding (that of a fixed number of decimals, or of significant
    digits, which grows with the clock); otherwise stretches between gaps share one step, each with its own place.
    """
    steps = np.diff(time)
    if (counted := _counted_base(time, steps)) is not None:
        return counted
    repeated = int(np.sum(steps == 0))
    quantum = float(np.min(steps[steps > 0], initial=np.inf)) if repeated else 0.0
    rounding = np.maximum(local_resolution(time), quantum) if repeated else np.zeros(len(time))
    gapless = _base(time, np.empty(0, dtype=np.intp), rounding, repeated)
    if repeated and gapless.is_even:
        return gapless
    lag = min(STEP_LAG, len(time) - 1)
    nominal = float(np.median((time[lag:] - time[:-lag]) / lag))
    gaps = np.flatnonzero((steps > GAP_STEPS * nominal) & (steps > nominal + GAP_QUANTA * rounding[1:]))
    return _base(time, gaps, rounding, repeated)


def _counted_base(time: Array, steps: Array) -> EvenBase | None:
    """The base of stamps that are whole numbers of one step apart, so that each lost sample counts; None of others."""
    usual = float(np.median(steps))
    if not usual > 0.0:
        return None
    counts = np.round(steps / usual)
    if np.any(counts < 1.0) or np.any(np.abs(steps - counts * usual) > _WHOLE_STEPS * usual):
        return None
    index = np.concatenate([[0.0], np.cumsum(counts)])
    step, start = (float(one) for one in np.polyfit(index, time - time[0], 1))
    jitter = float(np.max(np.abs(time - time[0] - start - step * index)))
    if jitter > LARGEST_JITTER * step:
        return None
    gaps = np.flatnonzero(counts > GAP_STEPS)
    return EvenBase(index.astype(np.intp), float(time[0]) + start, step, jitter, True, 0, gaps)


def _base(time: Array, gaps: RowIndices, rounding: Array, repeated: int) -> EvenBase:
    """The base whose step the stretches between the gaps share, by least squares; later stretches count from it."""
    rows = np.arange(len(time), dtype=np.float64)
    stretch = np.zeros(len(time), dtype=np.intp)
    stretch[gaps + 1] = 1
    stretch = np.cumsum(stretch)
    weights = 1.0 / np.where(rounding > 0, rounding, 1.0) ** 2
    total = np.bincount(stretch, weights)
    mean_row, mean_time = (np.bincount(stretch, weights * x) / total for x in (rows, time))
    off_row, off_time = rows - mean_row[stretch], time - mean_time[stretch]
    power = float(np.sum(weights * off_row**2))
    step = float(np.sum(weights * off_row * off_time)) / power if power > 0 else 0.0
    if not step > 0.0:
        step = float(time[-1] - time[0]) / (len(time) - 1)
    places = mean_time - step * mean_row
    shift = np.round((places - places[0]) / step) if step > 0 else np.zeros(len(places))
    index = rows + shift[stretch]
    start = float(np.sum(weights * (time - step * index)) / np.sum(weights))
    deviation = np.abs(time - start - step * index)
    is_even = bool(np.all(deviation <= np.maximum(LARGEST_JITTER * step, LARGEST_ROUNDING * rounding)))
    return EvenBase(index.astype(np.intp), start, step, float(np.max(deviation)), is_even, repeated, gaps)


# Samples that are missing: channels run on where the craft has not forgotten what went before; other holes are cut.

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
        channels[symbol] = _run_on(symbol, channel)
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
    motion = run_on(record.channel(symbol))
    motion = np.gradient(unwrapped(motion)) if symbol in _RATES_OF else motion
    spectrum = np.abs(np.fft.rfft(motion - motion.mean(), 2 * len(motion))) ** 2
    correlation = np.fft.irfft(spectrum)[: len(motion)]
    least = 2  # rows, as said above
    if not correlation[least] > 0.0:
        return 0
    return least + int(np.argmax(correlation[least:] < _FORGOTTEN * correlation[least]))


def run_on(channel: Channel) -> Array:
    """Return values without NaN: angles along the shorter arc, commands held, the ends as the nearest reading."""
    is_known = np.isfinite(channel.values)
    readings, missing = np.flatnonzero(is_known), np.flatnonzero(~is_known)
    before = readings[np.clip(np.searchsorted(readings, missing) - 1, 0, None)]
    values = np.array(channel.values)
    values[missing] = channel.values[before]
    if not channel.is_command:
        smooth = unwrapped(channel.values) if channel.unit == "rad" else channel.values
        values[missing] += np.interp(missing, readings, smooth[readings]) - smooth[before]
    return values


def _run_on(symbol: str, channel: Channel) -> Channel:
    """The channel without NaN; of one that is measured, where it was."""
    is_known = np.isfinite(channel.values)
    if is_known.all():
        return channel
    whole = channel.with_values(run_on(channel))
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
    return [Finding(Severity.WARNING, "empty-cells", text, evidence)]


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


# The time base: repeated, rounded or missing stamps, gaps; rebuilt evenly, never silently.

# differences of steps over the mean step that are rounding, and that are worth a warning; chosen
SMALL_UNEVENNESS, LARGE_UNEVENNESS = 1e-3, 0.5
# share of the rows that may be missing as a note; the project's rule for rows that are dropped
MOST_LOST = 0.05
# rows of the even base over those of the record, counted as so many at least, from which on its clock jumps; chosen
MOST_GROWTH, FEWEST_ROWS = 20, 10_000


def without_empty_ends(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """The record without wholly empty rows at its ends.

    Raises:
        InputError: every row is empty.
    """
    empty = np.all([np.isnan(c.values) for c in record.channels.values()], axis=0) & np.ones(len(record), bool)
    filled = np.flatnonzero(~empty)
    if filled.size == 0:
        raise InputError(f"record '{record.name}' holds no values at all; leave it out")
    first, last = int(filled[0]), int(filled[-1]) + 1
    count = first + len(record) - last
    if count == 0:
        return record, ()
    cells = count * len(record.channels) + int(np.sum(np.isnan(record.time[np.r_[:first, last : len(record)]])))
    where = " and ".join(w for w, n in (("begins", first), ("ends", len(record) - last)) if n)
    finding = Finding(
        Severity.WARNING,
        "empty-rows",
        f"record '{record.name}' {where} with {counted(count, 'empty row')}, cut off",
        f"{counted(cells, 'empty cell')}, {last - first} of {len(record)} rows remain",
    )
    return record.rows(slice(first, last)).with_step(f"{counted(count, 'empty row')} cut off"), (finding,)


def rebuild_time_base(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """The record on an even time base, and what was found on the way.

    Repeated or rounded stamps are spread evenly, missing stamps counted in, duplicate rows dropped; samples lost in
    gaps become NaN rows (`repair` closes short ones); truly uneven sampling is interpolated linearly.

    Raises:
        InputError: fewer than two samples remain, or fewer than two have a stamp.
    """
    record, findings = without_empty_ends(record)
    record, more = _fill_missing_stamps(record)
    record, again = _without_duplicates(record)
    findings += more + again
    if len(record) < 2:
        raise InputError(f"record '{record.name}' has one sample; at least two are needed")
    if record.is_uniform:
        return record, findings
    grid = even_base(record.time)
    _refuse_jumping_clock(record, grid)
    grid = grid if grid.is_even or grid.repeated else replace(grid, step=_whole_rate(grid.step))
    rebuilt = _placed_on_grid(record, grid) if grid.is_even else _interpolated_on_grid(record, grid)
    return rebuilt.with_step("time base rebuilt"), findings + _time_base_findings(record, grid)


def _whole_rate(step: float) -> float:
    """The step [s] of the nearest whole number of samples a second, or of seconds: the same of all parts of a log."""
    return 1.0 / round(1.0 / step) if step < 1.0 else float(round(step))


def _refuse_jumping_clock(record: Record, grid: EvenBase) -> None:
    """Raises:
    InputError: the even base would have very many more rows than the record, as after a jump of the clock by days.
    """
    if grid.index[-1] <= MOST_GROWTH * max(len(record), FEWEST_ROWS):
        return
    row = int(np.argmax(np.diff(record.time)))
    start, before, after = (float(t) for t in record.time[[0, row, row + 1]])
    raise InputError(
        f"record '{record.name}': the clock jumps by {after - before:.6g} s after {before - start:.6g} s; cut the run "
        f'there: parts = [{{ name = "{record.name}-1", to = "{before - start:.6g} s" }}, '
        f'{{ name = "{record.name}-2", from = "{after - start:.6g} s" }}]'
    )


def _placed_on_grid(record: Record, grid: EvenBase) -> Record:
    """Every sample kept as it is, at its place on the even base."""
    index = grid.index
    channels = {}
    for symbol, channel in record.channels.items():
        values = np.full(index[-1] + 1, np.nan)
        values[index] = channel.values
        channels[symbol] = channel.with_values(values)
    return replace(record, time=grid.start + grid.step * np.arange(index[-1] + 1), channels=channels)


def _interpolated_on_grid(record: Record, grid: EvenBase) -> Record:
    """Values straight between the readings of each channel; nothing in its gaps, nor between those of a slower one."""
    count = int(np.floor((record.time[-1] - record.time[0]) / grid.step * (1 + 1e-12))) + 1  # rounding of the division
    even = record.time[0] + grid.step * np.arange(count)
    channels = {}
    for symbol, channel in record.channels.items():
        known = np.flatnonzero(np.isfinite(channel.values))
        time, first = np.unique(record.time[known], return_index=True)
        readings = channel.values[known[first]]
        values = (
            np.interp(even, time, unwrapped(readings) if channel.unit == "rad" else readings) if known.size else even
        )
        right = np.clip(np.searchsorted(time, even), 1, max(len(time) - 1, 1))
        if usual_rows(known) >= SLOWER:
            is_read = np.zeros(count, dtype=np.bool_)
            is_read[np.clip(np.round((time - even[0]) / grid.step).astype(int), 0, count - 1)] = True
        elif len(time) > 1:
            is_read = (time[right] - time[right - 1] <= GAP_STEPS * grid.step) | np.isin(even, time)
            is_read &= (even >= time[0] - grid.step) & (even <= time[-1] + grid.step)
        else:
            is_read = np.isin(even, time)
        values = np.where(is_read, values, np.nan)
        channels[symbol] = channel.with_values(values)
    return replace(record, time=even, channels=channels)


def _fill_missing_stamps(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Missing stamps counted in between their neighbours."""
    missing = np.isnan(record.time)
    if not missing.any():
        return record, ()
    rows = np.arange(len(record))
    stamped = np.flatnonzero(~missing)
    if stamped.size < 2:
        raise InputError(f"record '{record.name}' has fewer than two time stamps; leave it out")
    step = (record.time[stamped[-1]] - record.time[stamped[0]]) / (stamped[-1] - stamped[0])
    time = np.interp(rows, stamped, record.time[stamped])
    time[: stamped[0]] = record.time[stamped[0]] + step * (rows[: stamped[0]] - stamped[0])
    time[stamped[-1] + 1 :] = record.time[stamped[-1]] + step * (rows[stamped[-1] + 1 :] - stamped[-1])
    finding = Finding(
        Severity.WARNING,
        "time-base",
        f"record '{record.name}': {counted(int(missing.sum()), 'time stamp')} missing, counted in by the row",
        f"first at row {int(np.flatnonzero(missing)[0]) + 1} of {len(record)}",
        "check that no rows were lost there",
    )
    return replace(record, time=time), (finding,)


def _without_duplicates(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Rows dropped that repeat the stamp and every value of the row before, unless the rows are even as they are.

    Readings and stamps of few digits repeat by rounding: dropped, they would be missing.
    """
    same = [(np.diff(c.values) == 0) | np.isnan(c.values[1:]) for c in record.channels.values()]
    repeat = np.concatenate([[False], (np.diff(record.time) == 0) & np.all(same, axis=0) & bool(same)])
    if not repeat.any():
        return record, ()
    keep = ~repeat
    if _is_full(record.time) and not _is_full(record.time[keep]):
        return record, ()
    channels = {s: c.with_values(c.values[keep]) for s, c in record.channels.items()}
    finding = Finding(
        Severity.WARNING,
        "repeated-rows",
        f"record '{record.name}': {counted(int(repeat.sum()), 'row')} dropped: stamp and values of the row before",
        f"first at {moment(record.time[repeat][0])}",
    )
    kept = replace(record, time=record.time[keep], channels=channels)
    return kept.with_step(f"{repeat.sum()} repeated rows dropped"), (finding,)


def _is_full(time: Array) -> bool:
    """Whether stamps are even, and no row is missing between them."""
    if len(time) < 2:
        return True
    base = even_base(time)
    return base.is_even and int(base.index[-1]) == len(time) - 1


def _time_base_findings(record: Record, grid: EvenBase) -> tuple[Finding, ...]:
    steps = np.diff(record.time)
    findings = []
    lost = np.maximum(np.diff(grid.index) - 1, 0) if grid.is_even else np.zeros(len(steps), dtype=np.intp)
    regular = np.delete(steps - lost * grid.step, grid.gaps)  # as without the rows that are lost
    if regular.size and not grid.is_even and not grid.repeated:
        text = f"record '{record.name}' is sampled unevenly; values are interpolated at even steps of {grid.step:.4g} s"
        evidence = f"steps {regular.min():.4g} to {regular.max():.4g} s"
        advice = "nothing to do where the stamps are those of the samples"
        findings.append(Finding(Severity.INFO, "uneven-sampling", text, evidence, advice))
    elif regular.size and np.ptp(regular) > SMALL_UNEVENNESS * grid.step:
        kind = f"{grid.repeated} repeated or rounded time stamps" if grid.repeated else "uneven time stamps"
        is_rough = grid.repeated or np.ptp(regular) > LARGE_UNEVENNESS * grid.step
        text = f"record '{record.name}' has {kind}; the time base is rebuilt with even steps of {grid.step:.4g} s"
        evidence = f"steps {regular.min():.4g} to {regular.max():.4g} s, stamps off by up to {grid.jitter:.3g} s"
        advice = "give more decimals of time if the logger has them"
        severity = Severity.WARNING if is_rough else Severity.INFO
        findings.append(Finding(severity, "time-base", text, evidence, advice))
    lost[grid.gaps] = np.maximum(np.round(steps[grid.gaps] / grid.step).astype(int) - 1, 1)
    return (*findings, *_lost_row_findings(record, grid, lost))


def _lost_row_findings(record: Record, grid: EvenBase, lost: RowIndices) -> tuple[Finding, ...]:
    """One line on the rows that are missing; lost: so many behind each row."""
    count = int(lost.sum())
    if count == 0:
        return ()
    total = len(record) + count
    longest = int(np.argmax(lost))
    text = f"record '{record.name}': {count} of {total} rows are missing; the others stay where they are"
    ends = moment(record.time[longest], record.time[longest + 1])
    evidence = f"{count * grid.step:.4g} s lost in {counted(int(np.sum(lost > 0)), 'place')}, the longest from {ends}"
    advice = "no action needed: nothing is compared there, and a hole longer than the craft's memory begins a new run"
    severity = Severity.WARNING if count > MOST_LOST * total else Severity.INFO
    return (Finding(severity, "time-gap", text, evidence, advice),)
