"""Simulations with the columns of table 2: zigzags and a turn compared with the truth's: accuracy, forces, drift."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record
from seatrial.data.example_series import JET_VELOCITY
from seatrial.physics.simulate import forces, trajectory
from seatrial_studies.song2025.craft_models import (
    CoefficientSet,
    ManoeuvreRun,
    drift_angle,
    reference_record,
    replay_inputs,
    simulate_manoeuvre,
)
from seatrial_studies.song2025.published import APPROACH_SPEED, Accuracy, PublishedManoeuvre

CHANNELS = ("u", "v", "r")
FORCES = {"X": "X_sum", "Y": "Y_sum", "N": "N_sum"}
STEADY_SECONDS, STEP = 1500.0, 0.1


@dataclass(frozen=True, eq=False)
class RunComparison:
    """One run of one craft, a column of table 2 or our own, and the truth's.

    Attributes:
        title: whose coefficients.
        reference: the truth, helmsman in the loop.
        steered: the column's, helmsman in the loop, so that nozzle angles differ as in figures 4c and 7c.
        replayed: the column's on the reference's nozzle history; shorter than the reference where it diverges.
        steered_accuracy, replayed_accuracy: over what reference and prediction have in common; None where one diverges.
        largest_drift: of the replayed motion, deg.
    """

    title: str
    craft: Model
    run: PublishedManoeuvre
    reference: Record
    steered: ManoeuvreRun
    replayed: Record
    steered_accuracy: Accuracy | None
    replayed_accuracy: Accuracy | None
    largest_drift: float

    @property
    def divergence_time(self) -> float:
        """Return the seconds after which the replayed motion leaves all bounds; infinite where it does not."""
        return math.inf if len(self.replayed) == len(self.reference) else float(self.replayed.time[-1])


def compare_runs(
    coefficient_sets: Sequence[CoefficientSet], runs: Sequence[PublishedManoeuvre]
) -> tuple[RunComparison, ...]:
    """Compare every reading in every run: some 0.1 s each, 3 s where the consecutive zigzags are never finished."""
    references = {run: reference_record(run) for run in runs}
    return tuple(compare_run(reading, run, references[run]) for reading in coefficient_sets for run in runs)


def compare_run(coefficient_set: CoefficientSet, run: PublishedManoeuvre, truth: Record) -> RunComparison:
    """Compare one column in one run with the record `truth`."""
    return compare_craft(coefficient_set.title, coefficient_set.craft(), run, truth)


def compare_craft(title: str, craft: Model, run: PublishedManoeuvre, truth: Record) -> RunComparison:
    """Compare one craft in one run with the record `truth`."""
    steered, again = simulate_manoeuvre(craft, run), replay_inputs(craft, truth)
    return RunComparison(
        title,
        craft,
        run,
        truth,
        steered,
        again,
        None if steered.record is None else prediction_accuracy(truth, steered.record),
        prediction_accuracy(truth, again) if len(again) == len(truth) else None,
        float(np.max(np.abs(drift_angle(again)))),
    )


def prediction_accuracy(truth: Record, other: Record) -> Accuracy:
    """Return root mean square errors and correlation coefficients (Pearson) of u, v, r over the samples both have."""
    n = min(len(truth), len(other))
    pairs = {c: (truth[c][:n], other[c][:n]) for c in CHANNELS}
    return Accuracy(
        {c: float(np.sqrt(np.mean((b - a) ** 2))) for c, (a, b) in pairs.items()},
        {c: float(np.corrcoef(a, b)[0, 1]) for c, (a, b) in pairs.items()},
    )


def hull_and_jet_forces(craft: Model, record: Record) -> dict[str, Array]:
    """Return X, Y [N] and N [N m] of hull and jet along a record by a model, by letter, each (n,)."""
    of_model = forces(craft, record)
    return {letter: of_model[binding] for letter, binding in FORCES.items()}


def steady_drift_angle(coefficient_set: CoefficientSet, degrees: float) -> float:
    """Return the steady drift angle [deg] of a turn with the nozzle held at `degrees`; NaN where it diverges."""
    craft = coefficient_set.craft()
    count = round(STEADY_SECONDS / STEP)
    held = {"delta": math.radians(degrees), "v_j": JET_VELOCITY}
    inputs = np.tile([-held[i.name] if i.is_reversed else held[i.name] for i in craft.inputs], (count, 1))
    start = np.array([APPROACH_SPEED if state == "u" else 0.0 for state in craft.states])
    states, _ = trajectory(craft, inputs, STEP, start)
    u, v = (states[-1, craft.states.index(s)] for s in "uv")
    return math.degrees(math.atan2(-v, u))
