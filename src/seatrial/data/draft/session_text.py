"""The line of a draft that says which runs share their current and their zeros: those of one day."""

import math
from collections.abc import Sequence
from datetime import UTC, datetime
from itertools import pairwise

from seatrial.data.draft.clocks import time_span
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.runs_of_logs import LogRun
from seatrial.data.trial.session import date_in

_ONE_CLOCK = "clocks without a date go on from run to run: of one day they share its current and zeros"
_ONE_SETUP = 'of one model in a basin: they share the zero of its rudder; write "run" where it was set anew'
_ONE_OUTING = (
    "of one place by their fixes, without dates, and no two show different currents: of one outing, they share its "
    'current and zeros; write "run" where days lie between them'
)
_LARGEST_AREA = 0.05  # deg of latitude, and of longitude, in which the fixes of one outing lie; chosen: some 5 km
_DAY_S = 86400.0  # s of a day
_EPOCH_CLOCK_S = 1e8  # s beyond which a clock counts from 1970 or the like, three years; as in the parts of a run


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
    """Return whether the fixes of all runs lie within some kilometres.

    guesses: of the columns of each source of each run.
    """
    for symbol in ("lat", "lon"):
        ranges = list[tuple[float, float]]()
        for run, parts in zip(runs, guesses, strict=True):
            used = [g for part in parts for g in part if g.is_used and g.symbol == symbol and g.unit == "deg"]
            columns = [
                column
                for source in run.sources
                for topic in source.topics
                for column in topic.columns
                if used and column.name == str(used[0].source).removeprefix(f"{topic.topic}/")
            ]
            if not columns:
                return False
            ranges.append((columns[0].low, columns[0].high))
        if max(high for _, high in ranges) - min(low for low, _ in ranges) > _LARGEST_AREA:
            return False
    return True


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
