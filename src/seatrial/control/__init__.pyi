"""Names of this package, imported when first used."""

from seatrial.control.gain_evaluation import GainChoice as GainChoice
from seatrial.control.front import grid_front as grid_front, pareto_front as pareto_front
from seatrial.control.gain_evaluation import GainEvaluation as GainEvaluation, GainEvaluator as GainEvaluator
from seatrial.control.gain_evaluation import gain_evaluator as gain_evaluator
from seatrial.control.front import GeneticRun as GeneticRun, genetic_run as genetic_run, genetic_runs as genetic_runs
from seatrial.control.task import GeneticTuning as GeneticTuning, SearchedObjectives as SearchedObjectives
from seatrial.control.simulation import simulate_in_seaway as simulate_in_seaway
from seatrial.control.task import Demand as Demand, ScheduleGrid as ScheduleGrid, Seaway as Seaway
from seatrial.control.task import SimulationSettings as SimulationSettings, SlowDisturbance as SlowDisturbance
from seatrial.control.task import TuningTask as TuningTask
