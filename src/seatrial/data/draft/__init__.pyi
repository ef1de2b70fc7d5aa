from seatrial.data.draft.behaviour import checked_by_behaviour
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.draft import DraftTrial, draft_trial
from seatrial.data.draft.draft_text import run_text
from seatrial.data.draft.guess import guess_columns
from seatrial.data.draft.manoeuvres import find_stretches
from seatrial.data.draft.naming import not_needed_text, stated_columns, unit_in_heading
from seatrial.data.draft.runs_of_logs import LogRun, runs_of_logs
from seatrial.data.draft.ship_estimates import StatedSize
from seatrial.data.draft.stretches import LogStretch, name_contradiction
from seatrial.data.draft.survey import ColumnSummary, LogSurvey, SurveyedLogs, TopicSummary, survey_log, survey_logs

__all__ = [
    "ColumnGuess",
    "ColumnSummary",
    "DraftTrial",
    "LogRun",
    "LogStretch",
    "LogSurvey",
    "StatedSize",
    "SurveyedLogs",
    "TopicSummary",
    "checked_by_behaviour",
    "draft_trial",
    "find_stretches",
    "guess_columns",
    "name_contradiction",
    "not_needed_text",
    "run_text",
    "runs_of_logs",
    "stated_columns",
    "survey_log",
    "survey_logs",
    "unit_in_heading",
]
