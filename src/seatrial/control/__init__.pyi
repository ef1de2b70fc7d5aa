from seatrial.control.choose import GainChoice
from seatrial.control.front import grid_front, pareto_front
from seatrial.control.gain_evaluation import GainEvaluation, GainEvaluator, gain_evaluator
from seatrial.control.seaway_simulation import simulate_in_seaway
from seatrial.control.task import (
    Demand,
    ScheduleGrid,
    Seaway,
    SimulationSettings,
    SlowDisturbance,
    TuningTask,
)

__all__ = [
    "Demand",
    "GainChoice",
    "GainEvaluation",
    "GainEvaluator",
    "ScheduleGrid",
    "Seaway",
    "SimulationSettings",
    "SlowDisturbance",
    "TuningTask",
    "gain_evaluator",
    "grid_front",
    "pareto_front",
    "simulate_in_seaway",
]
