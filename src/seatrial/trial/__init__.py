"""Trial files, model files and result folders."""

from seatrial.trial.load import load_trial
from seatrial.trial.records import TrialRecord, records_of, refuse_errors
from seatrial.trial.trial import Estimate, Role, Run, Trial, Trimming

__all__ = [
    "Estimate",
    "Role",
    "Run",
    "Trial",
    "TrialRecord",
    "Trimming",
    "load_trial",
    "records_of",
    "refuse_errors",
]
