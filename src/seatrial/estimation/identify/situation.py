"""What the records of a trial are: by it `identify` picks its strategy."""

from collections.abc import Callable, Sequence
from enum import StrEnum

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.check.phases import is_free_decay
from seatrial.data.trial import TrialRecord
from seatrial.estimation.estimate.criterion_choice import WAVE_FORCES
from seatrial.estimation.estimate.fit import moving_inputs
from seatrial.estimation.estimate.time_scale import is_pure_roll

WAVE_SLOPE = "alpha_w"
"""The input by which waves drive roll."""


class Situation(StrEnum):
    """What moves the ship in the records, and how that is known."""

    STEERED = "steered"
    STATIC_FORCES = "steered, with static force points"
    RECORDED_WAVES = "in waves, forces or elevation recorded"
    WAVE_SPECTRUM = "in waves of which only the spectrum is known"
    UNKNOWN_WAVES = "rolling in waves of which nothing is known"
    FREE_DECAY = "rolling out from a release"
    DRIVEN_ROLL = "rolling by recorded inputs"


def situation_of(
    model: Model,
    runs: Sequence[TrialRecord],
    *,
    has_force_points: bool,
    is_criterion_free: bool,
    is_explained: Callable[[], bool],
) -> Situation:
    """Return the situation of training runs.

    Args:
        has_force_points: whether static force points are fitted with the runs.
        is_criterion_free: whether the criterion is left to the decision table.
        is_explained: whether the initial states explain the motion; called for roll without any input only. Roll
            that dies out from a release is a decay even so: one that was held, or several that no one model has.
    """
    if any(run.waves is not None and run.waves.spectrum is not None for run in runs):
        return Situation.WAVE_SPECTRUM
    if model.is_affine or set(WAVE_FORCES) & set(model.input_names):
        return Situation.RECORDED_WAVES
    if not is_pure_roll(model):
        return Situation.STATIC_FORCES if has_force_points else Situation.STEERED
    if not is_unforced_roll(model, [run.record for run in runs]):
        return Situation.DRIVEN_ROLL
    if is_explained() or all(is_free_decay(run.record) for run in runs):
        return Situation.FREE_DECAY
    return Situation.UNKNOWN_WAVES if is_criterion_free else Situation.DRIVEN_ROLL


def is_unforced_roll(model: Model, records: Sequence[Record]) -> bool:
    """Return whether all records hold the roll of a model that waves can drive, and no input of it moves."""
    if not is_pure_roll(model) or WAVE_SLOPE not in model.input_names or not all("phi" in r for r in records):
        return False
    return not moving_inputs(model, records)
