from seatrial.api.files import (
    load_fit,
    load_model,
    read_record,
    report,
    save_design,
    save_fit,
    save_outcome,
    save_study,
    save_tuning,
    write_record,
)
from seatrial.api.prediction import extrapolation, measure_intervals, measures, predict, rms_differences
from seatrial.api.simulation import replay, simulate, steering
from seatrial.api.studies import demo, list_models, reproduce
from seatrial.api.trials import check, design, follow, identify, load_trial, prepared_run
from seatrial.api.tuning import load_loop, tune

__all__ = [
    "check",
    "demo",
    "design",
    "extrapolation",
    "follow",
    "identify",
    "list_models",
    "load_fit",
    "load_loop",
    "load_model",
    "load_trial",
    "measure_intervals",
    "measures",
    "predict",
    "prepared_run",
    "read_record",
    "replay",
    "report",
    "reproduce",
    "rms_differences",
    "save_design",
    "save_fit",
    "save_outcome",
    "save_study",
    "save_tuning",
    "simulate",
    "steering",
    "tune",
    "write_record",
]
