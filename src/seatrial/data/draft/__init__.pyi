from seatrial.data.draft.draft import DraftTrial, draft_trial
from seatrial.data.draft.guess import ColumnGuess, checked_by_behaviour, guess_columns
from seatrial.data.draft.manoeuvres import LogStretch, find_stretches
from seatrial.data.draft.survey import ColumnSummary, LogSurvey, TopicSummary, survey_log

__all__ = [
    "ColumnGuess",
    "ColumnSummary",
    "DraftTrial",
    "LogStretch",
    "LogSurvey",
    "TopicSummary",
    "checked_by_behaviour",
    "draft_trial",
    "find_stretches",
    "guess_columns",
    "survey_log",
]
