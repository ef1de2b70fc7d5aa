"""A trial file drafted from logs: every guess with its evidence, what is unsure as a commented line."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.draft.behaviour import checked_by_behaviour
from seatrial.data.draft.clocks import with_common_clock
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.draft_text import trial_text
from seatrial.data.draft.guess import guess_columns, without_conflicts
from seatrial.data.draft.manoeuvres import LogStretch, find_stretches
from seatrial.data.draft.survey import LogSurvey, survey_log
from seatrial.data.read import FORMATS


@dataclass(frozen=True, eq=False)
class DraftTrial:
    """A drafted trial file.

    Attributes:
        text: the TOML file.
        surveys: the logs, in order.
        guesses: of the columns of each kind of log.
        stretches: manoeuvres found, of the first log of each kind.
    """

    text: str
    surveys: tuple[LogSurvey, ...]
    guesses: tuple[tuple[ColumnGuess, ...], ...]
    stretches: tuple[LogStretch, ...] = ()

    @property
    def open_questions(self) -> tuple[ColumnGuess, ...]:
        """The columns for which a person must choose."""
        return tuple(g for part in self.guesses for g in part if g.is_used and g.is_open)


def draft_trial(*logs: str | Path, folder: str | Path = ".") -> DraftTrial:
    """Draft a trial file for logs: files, or folders whose logs are taken.

    Args:
        logs: files of one kind are runs; files of several kinds are sources of one run.
        folder: where the trial file will lie; the paths in it count from there.

    Raises:
        InputError: no logs, or one that cannot be read.
    """
    paths = _log_files([Path(log) for log in logs])
    surveys = tuple(survey_log(path) for path in paths)
    kinds: dict[tuple, list[LogSurvey]] = {}
    for survey in surveys:
        kinds.setdefault(_signature(survey), []).append(survey)
    groups = list(kinds.values())
    if len(groups) == 1:
        group = max(groups[0], key=lambda one: one.duration if math.isfinite(one.duration) else 0.0)
        (guesses,) = checked_by_behaviour([group], [guess_columns(group)])
        all_guesses, examined = (tuple(guesses),), [group]
    else:
        examined = with_common_clock(surveys)
        groups = [[survey] for survey in examined]
        parts = without_conflicts([guess_columns(one) for one in examined])
        all_guesses = tuple(map(tuple, checked_by_behaviour(examined, parts)))
    stretches = find_stretches(examined, all_guesses)
    text = trial_text(groups, all_guesses, stretches, Path(folder).resolve())
    return DraftTrial(text, surveys, all_guesses, stretches)


def _log_files(logs: Sequence[Path]) -> list[Path]:
    """The files, and those of known endings in the folders."""
    known = {suffix for one in FORMATS.values() for suffix in one.suffixes}
    files = []
    for log in logs:
        if log.is_dir():
            inside = sorted(path for path in log.rglob("*") if path.is_file())
            files += [path for path in inside if Path(path.name.removesuffix(".gz")).suffix.lower() in known]
        else:
            files.append(log)
    if not files:
        raise InputError("there is no log to draft a trial of; name files, or a folder with logs")
    return files


def _signature(survey: LogSurvey) -> tuple:
    """What files of one kind share: topics and columns."""
    return (survey.layout.format, *(table.names for table in survey.log.tables))
