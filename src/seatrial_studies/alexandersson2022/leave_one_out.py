"""Leave one run out: the others train, the one left out is predicted whole and in windows, the turns once more."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Prediction
from seatrial.core.values import ProgressReporter
from seatrial.data.trial import Trial, TrialRecord
from seatrial.estimation.estimate import (
    INITIAL_STATE_SHIP_LENGTHS,
    EstimatorOptions,
    ship_length_seconds,
    training_runs,
)
from seatrial.estimation.predict import HoldoutProtocol, predict_run, session_offsets, simulate_open_loop
from seatrial_studies.alexandersson2022.published import Turn
from seatrial_studies.cross_validation import cross_validate, fit_folds

# s, length of the windows that are predicted; our choice
WINDOW_S = 30.0


@dataclass(frozen=True, eq=False)
class LeftOutRun:
    """One training run left out.

    Attributes:
        prediction: the run open loop from beginning to end, offsets from the runs that trained.
        window_count: number of windows of 30 s in it.
        window_heading_deg, window_position_m: mean of the windows' rms errors.
        turns: side -> the 35 deg turn of the model without this run.
    """

    run: str
    prediction: Prediction
    window_count: int
    window_heading_deg: float
    window_position_m: float
    turns: Mapping[str, Turn]


def leave_one_out(
    trial: Trial,
    train: Sequence[TrialRecord],
    simulate_turns: Callable[[Model], Mapping[str, Turn]],
    report_progress: ProgressReporter | None = None,
) -> tuple[LeftOutRun, ...]:
    """Every training run left out in turn, on one core; settings are the trial's, nothing is chosen.

    Raises:
        InputError: fewer than two training runs, or what the estimate and the predictions raise.
    """
    runs, labels = training_runs(trial, train), ["zigzag"] * len(train)
    records, sessions, length = runs.records, runs.sessions, runs.length
    folds = fit_folds(
        trial.model, runs, labels, trial.estimate, EstimatorOptions(workers=1), folds=len(train),
        report_progress=report_progress,
    )  # fmt: skip
    scored = cross_validate(folds, runs, labels, HoldoutProtocol(window_s=WINDOW_S))
    seconds = trial.estimate.initial_s or INITIAL_STATE_SHIP_LENGTHS * ship_length_seconds(records, length)
    made = []
    for fold in folds:
        (held,) = fold.held_out
        own = session_offsets(fold.estimation, sessions[held], records[held]).expected
        problem = fold.estimation.estimate.problem
        run = simulate_open_loop(problem, fold.estimation.model, records[held], own, seconds)
        whole = predict_run(fold.estimation.model, records[held], "validation", run, seconds, length)
        windows = [w for w in scored.windows if w.run == records[held].name]
        made.append(
            LeftOutRun(
                run=records[held].name,
                prediction=whole,
                window_count=len(windows),
                window_heading_deg=float(np.mean([w.heading_deg for w in windows])),
                window_position_m=float(np.mean([w.position_m for w in windows])),
                turns=simulate_turns(fold.estimation.model),
            )
        )
    return tuple(made)


def jackknife_error(values: Sequence[float]) -> float:
    """Return the standard error from values with one run left out each (Tukey 1958, Ann. Math. Stat. 29, 614)."""
    given = np.asarray(values, dtype=float)
    count = len(given)
    return math.sqrt((count - 1) / count * float(np.sum((given - given.mean()) ** 2)))
