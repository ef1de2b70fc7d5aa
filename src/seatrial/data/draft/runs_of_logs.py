"""Which logs belong to one run, and which runs to one session or one speed."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from datetime import UTC, datetime
from itertools import accumulate, pairwise, takewhile
from pathlib import Path

from seatrial.data.check.time_base import INPUT_CHANNELS
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.guess import guess_columns
from seatrial.data.draft.naming import StatedColumns, command_of_topic
from seatrial.data.draft.ship_estimates import StatedSize, speed_in_header
from seatrial.data.draft.survey import LogSurvey, TopicSummary
from seatrial.data.read.layout import TimeSpec
from seatrial.data.trial.run_data import date_in

# Clocks of the sources of one run that differ by whole quarters of an hour: local time beside UTC.

_ZONE_STEP_S = 900.0  # s; time zones differ by quarters of an hour
_LARGEST_ZONE_S = 15.0 * 3600.0  # s; of the zones in use
_LEAST_OVERLAP = 0.5  # of the shorter source, that the shift must give; chosen


def zone_offsets(surveys: Sequence[LogSurvey]) -> list[float]:
    """Return the s to add to the clock of each source of one run so that it runs with the others.

    The others are those that overlap with most; of equal numbers those with stamps in a message's header.
    """
    spans = [time_span(survey) for survey in surveys]
    counts = [
        (sum(_overlap(one, other) > 0.0 for other in spans), _has_header_stamp(survey))
        for one, survey in zip(spans, surveys, strict=True)
    ]
    reference = spans[max(range(len(spans)), key=lambda k: counts[k])]
    return [_zone_offset(span, reference) for span in spans]


def time_span(survey: LogSurvey) -> tuple[float, float]:
    """Return the first and the last stamp [s]; NaN where there is none."""
    topics = [topic for topic in survey.topics if math.isfinite(topic.start)]
    if not topics:
        return math.nan, math.nan
    return min(one.start for one in topics), max(one.start + one.duration for one in topics)


def _overlap(one: tuple[float, float], other: tuple[float, float]) -> float:
    return min(one[1], other[1]) - max(one[0], other[0])


def _has_header_stamp(survey: LogSurvey) -> bool:
    return any(isinstance(topic.time, TimeSpec) and bool(topic.time.nanoseconds) for topic in survey.topics)


def _zone_offset(span: tuple[float, float], reference: tuple[float, float]) -> float:
    """The s to add to a clock so that it runs with the reference; 0 where it does, or where no zone explains it."""
    if not math.isfinite(span[0] + reference[0]) or _overlap(span, reference) > 0.0:
        return 0.0
    offset = _ZONE_STEP_S * round((reference[0] - span[0]) / _ZONE_STEP_S)
    shorter = min(span[1] - span[0], reference[1] - reference[0])
    moved = (span[0] + offset, span[1] + offset)
    return offset if abs(offset) <= _LARGEST_ZONE_S and _overlap(moved, reference) > _LEAST_OVERLAP * shorter else 0.0


def shifted(survey: LogSurvey, offset: float) -> LogSurvey:
    """Return the survey with `offset` s added to its clock."""
    if offset == 0.0:
        return survey
    return replace(survey, topics=tuple(_with_offset(topic, offset) for topic in survey.topics))


def _with_offset(topic: TopicSummary, offset: float) -> TopicSummary:
    time = topic.time
    if time is None:
        return topic
    spec = time if isinstance(time, TimeSpec) else TimeSpec(time.symbol, time.source, time.unit)
    return replace(topic, time=replace(spec, clock_offset=offset), start=topic.start + offset)


# Which logs belong to one run: files that overlap in time, or whose names agree but for what kind they are.

_EPOCH_CLOCK_S = 1e8  # s beyond which a clock counts from 1970 or the like, three years; as in the parts of a run
_SEPARATORS = "_-. /"
_HEADINGS = frozenset({"psi", "psi_magnetic", "q_w"})  # channels that show the heading


@dataclass(frozen=True)
class LogRun:
    """The logs of one run, one for each source, and what the run is called; empty: after its file."""

    name: str
    sources: tuple[LogSurvey, ...]

    @property
    def duration(self) -> float:
        """s of its longest source; 0 without stamps."""
        return max((source.duration for source in self.sources if math.isfinite(source.duration)), default=0.0)


def runs_of_logs(surveys: Sequence[LogSurvey]) -> list[LogRun]:
    """Return the runs, in the order of the files; sheets of one workbook that are logs by themselves are runs.

    Files of one kind (format, topics and columns) with clocks that start anew or do not overlap are runs; files of
    several kinds are sources of one run where their clocks, counting from 1970, overlap, where those of one kind are
    the commands of a craft's thrusters, or where their names are alike but for the kind. Where nothing of this groups
    them, files that each hold heading and input are runs, or else those of one kind that lie in one folder, and the
    others are left out; where there are none, all are sources of one run.
    """
    if len({survey.path for survey in surveys}) < len(surveys):  # sheets of a workbook
        sheets = [next((topic.topic for topic in survey.topics), "") for survey in surveys]
        return [LogRun(sheet or survey.path.stem, (survey,)) for sheet, survey in zip(sheets, surveys, strict=True)]
    kinds: dict[tuple, list[LogSurvey]] = {}
    for survey in surveys:
        kinds.setdefault(survey.kind, []).append(survey)
    if len(kinds) == 1:
        return [LogRun("", (survey,)) for survey in surveys]
    groups = list(kinds.values())
    if all(time_span(survey)[0] > _EPOCH_CLOCK_S for survey in surveys):
        offsets = zone_offsets([_earliest(group) for group in groups])
        moved = [shifted(one, offset) for group, offset in zip(groups, offsets, strict=True) for one in group]
        return _named([[one for one in moved if one in cluster] for cluster in _overlapping(moved)])
    together = [shifted(one, offset) for one, offset in zip(surveys, zone_offsets(surveys), strict=True)]
    series = max((group for group in groups if _is_series(group)), key=len, default=[])
    if any(_is_of_thrusters(group) for group in groups):
        return _named([together])
    if by_name := _by_name(groups):
        return _named(by_name)
    complete = [survey for survey in surveys if _is_complete(survey)]
    if len({survey.kind for survey in complete}) > 1:
        return _named([[survey] for survey in complete])
    return [LogRun("", (survey,)) for survey in series] or _named([together])


def _earliest(group: Sequence[LogSurvey]) -> LogSurvey:
    return min(group, key=lambda one: time_span(one)[0])


def _overlapping(surveys: Sequence[LogSurvey]) -> list[list[LogSurvey]]:
    """Clusters of logs each of which overlaps in time with another one of its cluster, in order of time."""
    clusters: list[list[LogSurvey]] = []
    end = -math.inf
    for survey in sorted(surveys, key=lambda one: time_span(one)[0]):
        start, stop = time_span(survey)
        if clusters and start < end:
            clusters[-1].append(survey)
        else:
            clusters.append([survey])
        end = max(end, stop)
    return clusters


def _is_complete(survey: LogSurvey) -> bool:
    """Whether a log holds a heading and an input, by the names of its columns: a run by itself."""
    symbols = {guess.symbol for guess in guess_columns(survey) if guess.is_used}
    return bool(symbols & _HEADINGS) and not symbols.isdisjoint(INPUT_CHANNELS)


def _is_series(group: Sequence[LogSurvey]) -> bool:
    """Whether several files of one kind lie in one folder."""
    return len(group) > 1 and len({survey.path.parent for survey in group}) == 1


def _is_of_thrusters(group: Sequence[LogSurvey]) -> bool:
    """Whether several files of one kind are called after the thrusters whose commands they hold, each after another."""
    named = [command_of_topic(survey.path.name.partition(".")[0]) for survey in group]
    symbols = {one.symbol for one in named if one is not None}
    return len(group) > 1 and len(symbols) == len(group)


def _by_name(groups: Sequence[Sequence[LogSurvey]]) -> list[list[LogSurvey]]:
    """One log of each kind where the paths of each kind differ by the same parts; empty where they do not."""
    by_key = [_own_parts(group) for group in groups]
    keys = list(by_key[0])
    if len(keys) < 2 or any(set(one) != set(keys) for one in by_key):
        return []
    return [[one[key] for one in by_key] for key in keys]


def _own_parts(group: Sequence[LogSurvey]) -> dict[str, LogSurvey]:
    """Each path without the beginning and the end that all of the kind share."""
    paths = [survey.path.resolve().as_posix() for survey in group]
    head = len(_common_beginning(paths))
    tail = len(_common_beginning([path[head:][::-1] for path in paths]))
    return {path[head : len(path) - tail]: one for path, one in zip(paths, group, strict=True)}


def _common_beginning(texts: Sequence[str]) -> str:
    same = takewhile(lambda letters: len(set(letters)) == 1, zip(*texts, strict=False))
    return "".join(letters[0] for letters in same)


def _named(clusters: Sequence[Sequence[LogSurvey]]) -> list[LogRun]:
    """The runs called after what the names of their files begin with, or numbered where that names none of them."""
    names = [_cluster_name([one.path for one in cluster]) for cluster in clusters]
    if len(set(names)) < len(names) or not all(names):
        names = [f"run{k}" for k in range(1, len(names) + 1)] if len(names) > 1 else ["run"]
    return [LogRun(name, tuple(cluster)) for name, cluster in zip(names, clusters, strict=True)]


def _cluster_name(paths: Sequence[Path]) -> str:
    return paths[0].stem if len(paths) == 1 else _common_beginning([path.name for path in paths]).strip(_SEPARATORS)


# The line of a draft that says which runs share their current and their zeros: those of one day.

_ONE_CLOCK = "clocks without a date go on from run to run: of one day they share its current and zeros"
_ONE_SETUP = 'of one model in a basin: they share the zero of its rudder; write "run" where it was set anew'
_ONE_OUTING = (
    "of one place by their fixes, without dates, and no two show different currents: of one outing, they share its "
    'current and zeros; write "run" where days lie between them'
)
_LARGEST_GAP = 0.05  # deg of latitude, and of longitude, between runs of one outing; chosen: some 5 km
_DAY_S = 86400.0  # s of a day


def session_line(runs: Sequence[LogRun], *, is_in_basin: bool = False, is_one_place: bool = False) -> str:
    """Return ``session = ...`` with its reason; empty where a run has no date, or all days differ.

    is_in_basin: whether they are of one model in a basin: without dates they are then taken for those of one setup.
    is_one_place: whether their fixes lie together and no two of them show different currents: without dates they are
    then taken for those of one outing.
    """
    days = [_day_of(run) for run in runs]
    if len(runs) > 1 and not any(days) and _is_one_clock(runs):
        return f'session = "all"    # {_ONE_CLOCK}'
    if len(runs) > 1 and not any(days) and is_in_basin:
        return f'session = "all"    # {_ONE_SETUP}'
    if len(runs) > 1 and not any(days) and is_one_place:
        return f'session = "all"    # {_ONE_OUTING}'
    if len(runs) < 2 or not all(days):
        return ""
    if len(set(days)) == 1:
        return f'session = "all"    # every run is of {days[0]}: they share the current and the zeros of that day'
    if len(set(days)) == len(days):
        return ""
    return f'session = "day"    # runs of {len(set(days))} days: those of one share its current and its zeros'


def is_one_place(runs: Sequence[LogRun], guesses: Sequence[Sequence[Sequence[ColumnGuess]]]) -> bool:
    """Return whether no run lies more than some kilometres from the others by the fixes, however far they reach.

    guesses: of the columns of each source of each run.
    """
    for symbol in ("lat", "lon"):
        ranges = [_range_of(run, parts, symbol) for run, parts in zip(runs, guesses, strict=True)]
        known = sorted(r for r in ranges if r is not None)
        reach = accumulate((high for _, high in known), max)
        if len(known) < len(ranges) or any(
            low - end > _LARGEST_GAP for (low, _), end in zip(known[1:], reach, strict=False)
        ):
            return False
    return True


def _range_of(run: LogRun, guesses: Sequence[Sequence[ColumnGuess]], symbol: str) -> tuple[float, float] | None:
    """Least and greatest value [deg] of a run's latitude or longitude; None where it has none in degrees."""
    used = [g for part in guesses for g in part if g.is_used and g.symbol == symbol and g.unit == "deg"]
    columns = [
        column
        for source in run.sources
        for topic in source.topics
        for column in topic.columns
        if used and column.name == str(used[0].source).removeprefix(f"{topic.topic}/")
    ]
    return (columns[0].low, columns[0].high) if columns else None


def _is_one_clock(runs: Sequence[LogRun]) -> bool:
    """Whether clocks without a date go on from run to run within a day, and do not start anew."""
    spans = sorted(time_span(max(run.sources, key=lambda source: source.duration)) for run in runs)
    is_known = all(math.isfinite(end) for span in spans for end in span)
    follows = all(before[1] <= after[0] for before, after in pairwise(spans))
    return is_known and follows and spans[-1][1] - spans[0][0] <= _DAY_S


def _day_of(run: LogRun) -> str:
    """The day in the names of its files, else of the first time stamp; empty where there is none."""
    for survey in run.sources:
        start = time_span(survey)[0]
        if named := date_in(survey.path.stem):
            return named
        if math.isfinite(start) and start > _EPOCH_CLOCK_S:
            return f"{datetime.fromtimestamp(start, UTC):%Y-%m-%d}"
    return ""


# Decays and runs in waves at several speeds: damping depends on the speed, so that a trial holds those of one.

_ALIKE = 0.05  # of a speed, by which a carriage misses it from run to run at most; chosen


@dataclass(frozen=True)
class OtherSpeed:
    """Runs that a draft leaves out: their headers state another speed [m/s] than those of its trial.

    options: of init, as stated for the draft, with which these runs are a trial of their own.
    """

    speed: float
    logs: tuple[Path, ...]
    options: tuple[str, ...]

    @property
    def reason(self) -> str:
        """Why they are left out."""
        return f"at {self.speed:g} m/s by its header: damping depends on the speed, fit each by itself"


def runs_by_speed(runs: Sequence[LogRun]) -> list[tuple[float, list[LogRun]]]:
    """Return the speeds [m/s] that headers state, with the runs at each; the one with most runs first, then by size.

    A run whose header states no speed counts as at rest.
    """
    groups = list[tuple[float, list[LogRun]]]()
    for run in sorted(runs, key=_speed):
        if groups and _speed(run) - groups[-1][0] <= _ALIKE * _speed(run):
            groups[-1][1].append(run)
        else:
            groups.append((_speed(run), [run]))
    in_order = [(speed, [run for run in runs if run in group]) for speed, group in groups]
    return sorted(in_order, key=lambda one: -len(one[1]))


def stated_options(size: StatedSize, stated: StatedColumns) -> tuple[str, ...]:
    """Return the options of init that state sizes and columns."""
    sizes = [(field.name, getattr(size, field.name)) for field in fields(size)]
    columns = [f"{heading}={meaning}" for heading, meaning in stated.items()]
    return (
        *(
            part
            for name, value in sizes
            if value
            for part in (f"--{name}", value if isinstance(value, str) else f"{value:g}")
        ),
        *(part for column in columns for part in ("--column", column)),
    )


def _speed(run: LogRun) -> float:
    return speed_in_header(run.sources[0]) or 0.0
