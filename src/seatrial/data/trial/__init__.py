"""Trials: ship, runs and their roles, model and settings, from a trial file or made in Python."""

from seatrial.data.trial.load import load_trial
from seatrial.data.trial.records import TrialRecord, load_records, refuse_errors
from seatrial.data.trial.settings import EstimateSettings, FitCriterion, ModelFamily
from seatrial.data.trial.trial import Role, Trial, TrialRun, Trimming

__all__ = [
    "EstimateSettings",
    "FitCriterion",
    "ModelFamily",
    "Role",
    "Trial",
    "TrialRecord",
    "TrialRun",
    "Trimming",
    "load_records",
    "load_trial",
    "refuse_errors",
]
