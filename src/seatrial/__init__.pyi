from seatrial import control, testing
from seatrial.api import (
    campaign,
    check,
    compare,
    demo,
    design,
    correct_trial,
    draft_trial,
    export,
    follow,
    identify,
    list_models,
    load,
    load_fit,
    load_loop,
    load_model,
    load_trial,
    poster,
    predict,
    read_record,
    report,
    reproduce,
    save,
    simulate,
    survey_log,
    tune,
    write_record,
)
from seatrial.core.equations import Model, Sheet
from seatrial.core.results import Design, Fit, Study
from seatrial.core.results.tuning import Tuning
from seatrial.core.values import Channel, Finding, InputError, Parameters, Prior, Record, Ship
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.trial import EstimateSettings, Role, Trial, TrialRun
from seatrial.estimation import regress as estimators
from seatrial.estimation.estimate.trial_problem import TrialProblem as Problem
from seatrial.numerics import optimise as optimisers
from seatrial.numerics.optimise import Solution
from seatrial.physics import manoeuvres, models, sea

__all__ = [
    "Channel",
    "ColumnSpec",
    "Design",
    "EstimateSettings",
    "Finding",
    "Fit",
    "InputError",
    "Layout",
    "Model",
    "Parameters",
    "Prior",
    "Problem",
    "Record",
    "Role",
    "Sheet",
    "Ship",
    "Solution",
    "Study",
    "Trial",
    "TrialRun",
    "Tuning",
    "campaign",
    "check",
    "compare",
    "control",
    "correct_trial",
    "demo",
    "design",
    "draft_trial",
    "estimators",
    "export",
    "follow",
    "identify",
    "list_models",
    "load",
    "load_fit",
    "load_loop",
    "load_model",
    "load_trial",
    "manoeuvres",
    "models",
    "optimisers",
    "poster",
    "predict",
    "read_record",
    "report",
    "reproduce",
    "save",
    "sea",
    "simulate",
    "survey_log",
    "testing",
    "tune",
    "write_record",
]

__version__: str
