"""Sessions: which runs share their offsets, by the names of their files."""

import fnmatch
import re
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.trial.run_data import run_name

RUN, DAY = "run", "day"
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}|\d{1,2}-[A-Z][a-z]{2}-\d{4}|(?<!\d)(?:19|20)\d{6}(?!\d)")
_PLACE = re.compile(r"\{\w+\}")


def valid_session(rule: object) -> object:
    """Return the rule of a trial file.

    Raises:
        ValueError: it is neither `run` nor `day`, nor a template with one place in braces.
    """
    if isinstance(rule, str) and rule not in (RUN, DAY) and len(_PLACE.findall(rule)) != 1:
        raise ValueError(
            f"'{rule}' is no template; give one such as '*_{{day}}_*', whose braces stand for what names the session, "
            "or 'run', or 'day'"
        )
    return rule


def session_of(path: Path, rule: str) -> str:
    """Return the group with which a run shares its offsets: its own name, the day in it, or what a template finds.

    In a template, `*` and `?` stand for any letters and for one; the braces for the first and shortest part that fits.

    Raises:
        InputError: the rule does not fit the name.
    """
    name = run_name(path)
    if rule == RUN:
        return name
    part = _date_in(name) if rule == DAY else _part_in(name, *_PLACE.split(rule))
    if not part:
        reason = "no date is found in" if rule == DAY else f"'{rule}' does not fit"
        raise InputError(f"session: {reason} the file name '{path.name}'; give another rule, or 'run'")
    return part


def _date_in(name: str) -> str:
    match = _DATE.search(name)
    return match[0] if match else ""


def _part_in(name: str, before: str, after: str) -> str:
    """The part of a name between what fits two patterns; empty where nothing fits."""
    starts = [i for i in range(len(name)) if fnmatch.fnmatchcase(name[:i], before)]
    stops = [i for i in range(1, len(name) + 1) if fnmatch.fnmatchcase(name[i:], after)]
    return next((name[start:stop] for start in starts for stop in stops if stop > start), "")
