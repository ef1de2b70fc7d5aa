"""Trial files, model files and result folders."""

from seatrial.data.trial.load import load_trial
from seatrial.data.trial.records import TrialRecord, load_records, refuse_errors
from seatrial.data.trial.trial import Estimate, Family, Role, Trial, TrialRun, Trimming

__all__ = [
    "Estimate",
    "Family",
    "Role",
    "Trial",
    "TrialRecord",
    "TrialRun",
    "Trimming",
    "load_records",
    "load_trial",
    "refuse_errors",
]
