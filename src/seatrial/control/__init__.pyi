from seatrial.control.choose import GainChoice
from seatrial.control.front import grid_front, pareto_front
from seatrial.control.gain_evaluation import GainEvaluation, GainEvaluator, gain_evaluator
from seatrial.control.genetic import GeneticRun, genetic_run, genetic_runs
from seatrial.control.genetic_settings import GeneticTuning, SearchedObjectives
from seatrial.control.record_cost import RecordCost, record_cost
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
    "GeneticRun",
    "GeneticTuning",
    "RecordCost",
    "ScheduleGrid",
    "SearchedObjectives",
    "Seaway",
    "SimulationSettings",
    "SlowDisturbance",
    "TuningTask",
    "gain_evaluator",
    "genetic_run",
    "genetic_runs",
    "grid_front",
    "pareto_front",
    "record_cost",
    "simulate_in_seaway",
]
