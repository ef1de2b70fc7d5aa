"""The logs among files and folders: each surveyed, and what is none with the reason."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.core.values.files import is_folder
from seatrial.data.draft.stated_columns import NOTHING_STATED, TIME, StatedColumns, refuse_absent
from seatrial.data.draft.survey import LogSurvey, survey_log
from seatrial.data.read import FORMATS


@dataclass(frozen=True, eq=False)
class SurveyedLogs:
    """The logs among files and folders, in order, and the files of folders that are none: path -> reason."""

    logs: tuple[LogSurvey, ...]
    left_out: Mapping[Path, str]


def survey_logs(paths: Sequence[Path], stated: StatedColumns = NOTHING_STATED) -> SurveyedLogs:
    """Survey the files, and those of known endings in the folders; a file that is named must be a log.

    Raises:
        InputError: there is none, one that is named cannot be read, or no log has a stated column.
    """
    named = {path for path in paths if not is_folder(path)}
    surveys, reasons = list[LogSurvey](), dict[Path, str]()
    for path in _log_files(paths):
        try:
            survey = survey_log(path, stated)
        except InputError as error:
            if path in named:
                raise
            reasons[path] = str(error)
            continue
        if path in named or any(topic.time is not None for topic in survey.topics):
            surveys.append(survey)
        else:
            reasons[path] = f"no column is a time{_how_to_state(survey, TIME)}"
    if not surveys:
        first = next(iter(reasons.items()))
        raise InputError(f"there is no log to draft a trial of: {first[0]}: {first[1]}")
    refuse_absent(stated, (name for one in surveys for table in one.log.tables for name in table.names))
    return SurveyedLogs(tuple(surveys), reasons)


def _how_to_state(survey: LogSurvey, meaning: str) -> str:
    """The end of a sentence that says how a column is named: with the first one of text, or else of all."""
    topic = next((one for one in survey.topics if one.text_columns or one.columns), None)
    if topic is None:
        return ""
    heading = topic.text_columns[0] if topic.text_columns else topic.columns[0].name
    return f"; if it is '{heading}', add --column '{heading}={meaning}'"


def _log_files(paths: Sequence[Path]) -> list[Path]:
    """The files, and those of known endings in the folders."""
    known = {suffix for one in FORMATS.values() for suffix in one.suffixes}
    files = []
    for one in paths:
        if is_folder(one):
            inside = sorted(path for path in one.rglob("*") if path.is_file())
            files += [path for path in inside if Path(path.name.removesuffix(".gz")).suffix.lower() in known]
        else:
            files.append(one)
    if not files:
        raise InputError("there is no log to draft a trial of; name files, or a folder with logs")
    return files
