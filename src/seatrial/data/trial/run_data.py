"""Where the record of a run stands, and which runs share their offsets as of one session."""

import fnmatch
import re
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path

import numpy as np

from seatrial.core.values import InputError, Record, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.data.read import Layout, Log, LogEvent, read_log
from seatrial.data.read.assemble import LogSource, assemble_record, record_name, record_of_sources
from seatrial.data.read.record_file import file_digest

# Where the record of a run stands: a file, several sources, or a part of either.

_SECONDS = re.compile(r"\s*(\d+\.?\d*)\s*(s|min|h)?\s*")
_UNIT_S = {None: 1.0, "s": 1.0, "min": 60.0, "h": 3600.0}  # s, of each unit
_LOGS_KEPT = 2  # assembled logs that are kept while the parts of one are cut; ours
_EPOCH_CLOCK_S = 1e8  # s beyond which a clock counts from 1970 or the like, three years; ours


def run_name(path: Path) -> str:
    """The name of a run's file without its ending, ``.gz`` included."""
    return record_name(path.name)


@dataclass(frozen=True)
class SourceFile:
    """A file and how to parse it."""

    path: Path
    layout: Layout


@dataclass(frozen=True)
class RunFiles:
    """The file of a run, or several of one run, each with layout and clock of its own; or a part of their record.

    Attributes:
        name: of the run, or of the part.
        files: rate, geometry and scale are those of the first.
        start, stop: ends of the part, times after the first sample (``120 s``, ``2 min``) or events; empty: those of
            the record. An event as `stop` is the first of its name after `start`.
    """

    name: str
    files: tuple[SourceFile, ...]
    start: str = ""
    stop: str = ""

    @classmethod
    def of_file(cls, path: Path, layout: Layout) -> "RunFiles":
        """Return a single file, named without its ending."""
        return cls(run_name(path), (SourceFile(path, layout),))

    def with_differences(self, symbols: Collection[str]) -> "RunFiles":
        """Return the files with what twins differ by as channels, where that is among these symbols."""
        files = (replace(file, layout=file.layout.with_differences(symbols)) for file in self.files)
        return replace(self, files=tuple(files))

    @property
    def states_antenna(self) -> bool:
        """Whether the place of the antenna is stated."""
        return any(source.layout.geometry.is_antenna_stated for source in self.files)

    def read(self, read: "LogReader | None" = None) -> Record:
        """Read and join the files, named as the run.

        read: takes the place of `read_log`, such as one that keeps logs.

        Raises:
            InputError: a file cannot be read as its layout says, several do not overlap, or there is no such part.
        """
        assembled = _assembled(*_with_states(self.files), read or read_log)
        record, events = assembled.record, assembled.events
        if self.start or self.stop:
            first, last = float(record.time[0]), float(record.time[-1])
            start = _time_of(self.start, self.name, events, first, first) if self.start else first
            stop = _time_of(self.stop, self.name, events, first, start) if self.stop else last
            if not start < stop:
                raise InputError(
                    f"part '{self.name}' ends {stop - first:g} s after the first sample, but starts "
                    f"{start - first:g} s after it; give a later 'to'"
                )
            record = record.between(start, stop)
        return record.renamed(self.name)

    def first_day(self) -> str:
        """Return the day of the first time stamp, 2026-05-14; empty where the clock does not count from a date.

        Raises:
            InputError: as `read`.
        """
        return _assembled(*_with_states(self.files), read_log).day


@dataclass(frozen=True, eq=False)
class _Assembled:
    """The record of some files on a clock that starts near zero, the events of their logs, and its first day."""

    record: Record
    events: tuple[LogEvent, ...]
    day: str = ""


_States = tuple[tuple[int, int], ...]
LogReader = Callable[[Path, Layout], Log]
"""Reads a log, as `read_log`."""


def _with_states(files: tuple[SourceFile, ...]) -> tuple[tuple[SourceFile, ...], _States]:
    """The files with their times and sizes: a changed file is read again."""
    states = (file.path.stat() for file in files if is_file(file.path))
    return files, tuple((state.st_mtime_ns, state.st_size) for state in states)


@lru_cache(maxsize=_LOGS_KEPT)
def _assembled(files: tuple[SourceFile, ...], states: _States, read: LogReader) -> _Assembled:  # noqa: ARG001  states: of the key
    sources = [LogSource(read(file.path, file.layout), file.layout, file_digest(file.path)) for file in files]
    if len(sources) == 1:
        record = assemble_record(sources[0].log, sources[0].layout, sources[0].sha256)
    else:
        record = record_of_sources(run_name(files[0].path), sources)
    events = sorted((event for source in sources for event in source.log.events), key=lambda event: event.time)
    first = float(np.nanmin(record.time))
    if first < _EPOCH_CLOCK_S:
        return _Assembled(record, tuple(events))
    start = float(np.floor(first))
    moment = datetime.fromtimestamp(start, UTC)
    step = f"time counted from {moment:%Y-%m-%d %H:%M:%S} of the log's clock"  # whose zone logs seldom state
    record = replace(record, time=record.time - start, provenance=record.provenance.with_step(step))
    shifted = tuple(replace(event, time=event.time - start) for event in events)
    return _Assembled(record, shifted, f"{moment:%Y-%m-%d}")


def seconds_in(text: str) -> float | None:
    """Return the time [s] that a text such as ``2 min`` means; None: it is no time."""
    match = _SECONDS.fullmatch(text)
    return float(match[1]) * _UNIT_S[match[2]] if match else None


def _time_of(text: str, part: str, events: tuple[LogEvent, ...], first: float, after: float) -> float:
    """The time [s] of the record's clock that a text means: after the first sample, or of an event after `after`."""
    seconds = seconds_in(text)
    if seconds is not None:
        return first + seconds
    times = [event.time for event in events if event.name == text and event.time >= after]
    if times:
        return times[0]
    names = sorted({event.name for event in events})
    if not names:
        raise InputError(f"part '{part}': '{text}' is no time such as '120 s', and the log has no events")
    raise InputError(f"part '{part}': no event '{text}' follows{spelling_hint(text, names)}")


# Sessions: which runs share their offsets, by the names of their files or the day of their time stamps.

RUN, DAY, ALL = "run", "day", "all"
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}|\d{1,2}-[A-Z][a-z]{2}-\d{4}|(?<!\d)(?:19|20)\d{6}(?!\d)")
_PLACE = re.compile(r"\{\w+\}")


def valid_session(rule: object) -> object:
    """Return the rule of a trial file.

    Raises:
        ValueError: it is none of `run`, `day`, `all`, nor a template with one place in braces.
    """
    if isinstance(rule, str) and rule not in (RUN, DAY, ALL) and len(_PLACE.findall(rule)) != 1:
        raise ValueError(
            f"'{rule}' is no template; give one such as '*_{{day}}_*', whose braces stand for what names the session, "
            "or 'run', 'day', or 'all' where all runs are of one session"
        )
    return rule


def session_of(path: Path, rule: str, stamped_day: Callable[[], str] = str) -> str:
    """Return the group with which a run shares its offsets: its own name, its day, what a template finds, or all runs.

    In a template, `*` and `?` stand for any letters and for one; the braces for the first and shortest part that fits.
    stamped_day: reads the day of the run's first time stamp, empty where its clock has none; called where the name
    holds no date.

    Raises:
        InputError: the rule does not fit the name, or there is no date in name and time stamps.
    """
    name = run_name(path)
    if rule in (RUN, ALL):
        return name if rule == RUN else ALL
    part = date_in(name) or stamped_day() if rule == DAY else _part_in(name, *_PLACE.split(rule))
    if not part:
        reason = "no date is found in time stamps and" if rule == DAY else f"'{rule}' does not fit"
        raise InputError(
            f"session: {reason} the file name '{path.name}'; give another rule, 'all' where every run is of one "
            "session, or 'run'"
        )
    return part


def date_in(name: str) -> str:
    """Return the first date in a name, as it is written there; empty where there is none."""
    match = _DATE.search(name)
    return match[0] if match else ""


def _part_in(name: str, before: str, after: str) -> str:
    """The part of a name between what fits two patterns; empty where nothing fits."""
    starts = [i for i in range(len(name)) if fnmatch.fnmatchcase(name[:i], before)]
    stops = [i for i in range(1, len(name) + 1) if fnmatch.fnmatchcase(name[i:], after)]
    return next((name[start:stop] for start in starts for stop in stops if stop > start), "")
