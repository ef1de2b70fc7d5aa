"""The step of the search: as coarse as leaves the errors of a random binary sequence what they are."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.design.manoeuvre_information import ManoeuvreEvaluator
from seatrial.estimation.design.ships import PriorShips
from seatrial.estimation.design.standard_manoeuvres import binary_sequence_inputs
from seatrial.estimation.design.task import DesignTask

# steps in the shortest hold at least; chosen
_STEPS_PER_HOLD = 4
# largest relative change of a ship's worst error that a coarser step may make; chosen
_TOLERANCE = 0.05
# ships that this is tried on, the model itself first; chosen
_SHIPS_TRIED = 7
# share of its range that the sequence moves each actuator by: all, where motions are quickest
_AMPLITUDE = 1.0
# of counts of samples: rounding
_ROUNDING = 1e-6


def search_step(task: DesignTask, ships: PriorShips) -> float:
    """Return the step [s], a whole number of samples that divides every hold; the sensors' own where none is good.

    Steps that divide no hold are none: orders that change between steps put the errors off.
    """
    few = PriorShips(ships.parameters[:_SHIPS_TRIED], ships.precision)
    fine = ManoeuvreEvaluator(task, few, 1.0 / task.request.rate)
    right = _worst_errors(fine)
    kept = np.isfinite(right)
    for samples in _dividing_counts(task):
        coarse = replace(fine, dt=samples / task.request.rate)
        if np.all(np.abs(_worst_errors(coarse) - right)[kept] <= _TOLERANCE * right[kept]):
            return coarse.dt
    return fine.dt


def _dividing_counts(task: DesignTask) -> Iterator[int]:
    """Yield the counts of samples that divide the trial and every hold, largest first."""
    request = task.request
    spans = [request.rate * s for s in (request.duration, *(a.hold for a in request.actuators))]
    for count in range(int(request.rate * task.shortest_hold / _STEPS_PER_HOLD + _ROUNDING), 1, -1):
        if all(abs(span - count * round(span / count)) < _ROUNDING for span in spans):
            yield count


def _worst_errors(evaluator: ManoeuvreEvaluator) -> Array:
    """Return the worst coefficient's relative standard error of each ship; NaN for a lost one."""
    inputs = binary_sequence_inputs(evaluator.task.shortest_hold, _AMPLITUDE, 0, evaluator)
    return evaluator.evaluate(inputs).relative_errors.max(axis=1)
