"""Trials: ship, runs and their roles, model and settings, from a trial file or made in Python."""

from seatrial.data.trial.craft_tables import ControllerGains, Feedback
from seatrial.data.trial.load import corrected_trial, load_runs, load_trial, parse_tables, trial_of_tables
from seatrial.data.trial.records import (
    CheckedRecords,
    TrialRecord,
    approach_condition,
    checked_records,
    load_records,
    refuse_errors,
    with_input_corners,
)
from seatrial.data.trial.run_data import RunFiles
from seatrial.data.trial.settings import (
    SEARCHES,
    EstimateMethod,
    EstimateSettings,
    FitCriterion,
    ModelFamily,
    OwnEstimate,
    SearchFitness,
    SearchSettings,
)
from seatrial.data.trial.trial import Role, Run, Trial, Trimming

__all__ = [
    "SEARCHES",
    "CheckedRecords",
    "ControllerGains",
    "EstimateMethod",
    "EstimateSettings",
    "Feedback",
    "FitCriterion",
    "ModelFamily",
    "OwnEstimate",
    "Role",
    "Run",
    "RunFiles",
    "SearchFitness",
    "SearchSettings",
    "Trial",
    "TrialRecord",
    "Trimming",
    "approach_condition",
    "checked_records",
    "corrected_trial",
    "load_records",
    "load_runs",
    "load_trial",
    "parse_tables",
    "refuse_errors",
    "trial_of_tables",
    "with_input_corners",
]  # fmt: skip
