from seatrial.api.benchmarks import benchmark
from seatrial.api.campaigns import campaign, campaign_status, gather_campaign, retry_campaign
from seatrial.api.comparison import compare
from seatrial.api.exports import export, export_targets, replay_fmu
from seatrial.api.files import (
    load,
    load_fit,
    load_model,
    read_record,
    report,
    save,
    write_record,
)
from seatrial.api.poster import poster, write_poster
from seatrial.api.prediction import extrapolation, measure_intervals, measures, predict, rms_differences
from seatrial.api.simulation import (
    course_findings,
    in_waves,
    propeller_rate_text,
    replay,
    rudder_rate_of,
    simulate,
    steering,
)
from seatrial.api.studies import demo, list_models, model_guide, reproduce
from seatrial.api.trials import (
    check,
    correct_trial,
    design,
    draft_trial,
    follow,
    identify,
    load_trial,
    prepared_run,
    survey_log,
    survey_logs,
)
from seatrial.api.tuning import load_loop, tune, verify

__all__ = [
    "benchmark", "campaign", "campaign_status", "check", "compare", "correct_trial", "course_findings", "demo",
    "design", "draft_trial", "export", "export_targets", "extrapolation", "follow", "gather_campaign", "identify",
    "in_waves",
    "list_models", "load", "load_fit", "load_loop", "load_model", "load_trial", "measure_intervals", "measures",
    "model_guide", "poster", "predict", "prepared_run", "propeller_rate_text", "read_record", "replay", "replay_fmu",
    "report", "reproduce", "retry_campaign", "rms_differences", "rudder_rate_of", "save", "simulate", "steering",
    "survey_log", "survey_logs", "tune", "verify", "write_poster", "write_record",
]  # fmt: skip
