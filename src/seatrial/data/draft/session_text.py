"""The line of a draft that says which runs share their current and their zeros: those of one day."""

import math
from collections.abc import Sequence
from datetime import UTC, datetime
from itertools import pairwise

from seatrial.data.draft.clocks import time_span
from seatrial.data.draft.runs_of_logs import LogRun
from seatrial.data.trial.session import date_in

_ONE_CLOCK = "clocks without a date go on from run to run: of one day they share its current and zeros"
_ONE_SETUP = 'of one model in a basin: they share the zero of its rudder; write "run" where it was set anew'
_DAY_S = 86400.0  # s of a day
_EPOCH_CLOCK_S = 1e8  # s beyond which a clock counts from 1970 or the like, three years; as in the parts of a run


def session_line(runs: Sequence[LogRun], *, is_in_basin: bool = False) -> str:
    """Return ``session = ...`` with its reason; empty where a run has no date, or all days differ.

    is_in_basin: whether they are of one model in a basin: without dates they are then taken for those of one setup.
    """
    days = [_day_of(run) for run in runs]
    if len(runs) > 1 and not any(days) and _is_one_clock(runs):
        return f'session = "all"    # {_ONE_CLOCK}'
    if len(runs) > 1 and not any(days) and is_in_basin:
        return f'session = "all"    # {_ONE_SETUP}'
    if len(runs) < 2 or not all(days):
        return ""
    if len(set(days)) == 1:
        return f'session = "all"    # every run is of {days[0]}: they share the current and the zeros of that day'
    if len(set(days)) == len(days):
        return ""
    return f'session = "day"    # runs of {len(set(days))} days: those of one share its current and its zeros'


def _is_one_clock(runs: Sequence[LogRun]) -> bool:
    """Whether clocks without a date go on from run to run within a day, and do not start anew."""
    spans = sorted(time_span(max(run.sources, key=lambda one: one.duration)) for run in runs)
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
