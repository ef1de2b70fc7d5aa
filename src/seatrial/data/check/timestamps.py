"""The time base: repeated, rounded or missing stamps, gaps; rebuilt evenly, never silently."""

from dataclasses import replace

import numpy as np

from seatrial.core.text.words import counted
from seatrial.core.values import Finding, InputError, Record, Severity
from seatrial.core.values.arrays import unwrapped
from seatrial.data.check.even_base import GAP_STEPS, EvenBase, even_base
from seatrial.data.check.lost_samples import SLOWER, usual_rows
from seatrial.data.check.run_clock import moment
from seatrial.data.check.signal import RowIndices

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
        "nothing to do if the run ended there; otherwise look for the lost samples",
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
    """Rows dropped that repeat the stamp and every value of the row before."""
    same = [(np.diff(c.values) == 0) | np.isnan(c.values[1:]) for c in record.channels.values()]
    repeat = np.concatenate([[False], (np.diff(record.time) == 0) & np.all(same, axis=0) & bool(same)])
    if not repeat.any():
        return record, ()
    keep = ~repeat
    channels = {s: c.with_values(c.values[keep]) for s, c in record.channels.items()}
    finding = Finding(
        Severity.WARNING,
        "repeated-rows",
        f"record '{record.name}': {counted(int(repeat.sum()), 'row')} dropped: stamp and values of the row before",
        f"first at {moment(record.time[repeat][0])}",
        "see whether the logger wrote twice",
    )
    kept = replace(record, time=record.time[keep], channels=channels)
    return kept.with_step(f"{repeat.sum()} repeated rows dropped"), (finding,)


def _time_base_findings(record: Record, grid: EvenBase) -> tuple[Finding, ...]:
    steps = np.diff(record.time)
    findings = []
    lost = np.maximum(np.diff(grid.index) - 1, 0) if grid.is_even else np.zeros(len(steps), dtype=np.intp)
    regular = np.delete(steps - lost * grid.step, grid.gaps)  # as without the rows that are lost
    if regular.size and not grid.is_even and not grid.repeated:
        text = f"record '{record.name}' is sampled unevenly; values are interpolated at even steps of {grid.step:.6g} s"
        evidence = f"steps {regular.min():.4g} to {regular.max():.4g} s"
        advice = "nothing to do where the stamps are those of the samples"
        findings.append(Finding(Severity.INFO, "uneven-sampling", text, evidence, advice))
    elif regular.size and np.ptp(regular) > SMALL_UNEVENNESS * grid.step:
        kind = f"{grid.repeated} repeated or rounded time stamps" if grid.repeated else "uneven time stamps"
        is_rough = grid.repeated or np.ptp(regular) > LARGE_UNEVENNESS * grid.step
        text = f"record '{record.name}' has {kind}; the time base is rebuilt with even steps of {grid.step:.6g} s"
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
