"""Sessions: which runs share their offsets, by the names of their files or the day of their time stamps."""

import fnmatch
import re
from collections.abc import Callable
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.trial.run_data import run_name

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
