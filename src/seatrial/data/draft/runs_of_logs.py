"""Which logs belong to one run: files that overlap in time, or whose names agree but for what kind they are."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

from seatrial.data.draft.clocks import shifted, time_span, zone_offsets
from seatrial.data.draft.naming import command_of_topic
from seatrial.data.draft.survey import LogSurvey

_EPOCH_CLOCK_S = 1e8  # s beyond which a clock counts from 1970 or the like, three years; as in the parts of a run
_SEPARATORS = "_-. /"


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
    them, the files of one kind that lie in one folder are runs and the other kinds are left out; where there are none,
    all are sources of one run.
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
