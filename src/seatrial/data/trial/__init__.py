"""Trial files, model files and result folders."""

from seatrial.data.trial.load import load_trial
from seatrial.data.trial.records import TrialRecord, records_of, refuse_errors
from seatrial.data.trial.trial import Estimate, Family, Role, Run, Trial, Trimming

__all__ = [
    "Estimate",
    "Family",
    "Role",
    "Run",
    "Trial",
    "TrialRecord",
    "Trimming",
    "load_trial",
    "records_of",
    "refuse_errors",
]
