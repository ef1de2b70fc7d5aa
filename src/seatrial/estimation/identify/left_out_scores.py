"""Runs predicted in windows by estimates without them: without their session, and without their kind of manoeuvre."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.resampling import fits_without, one_step_jackknife
from seatrial.estimation.predict.holdout_windows import HoldoutProtocol, split_windows, window_errors
from seatrial.estimation.predict.prediction_intervals import holdout_model
from seatrial.physics.manoeuvres.recognition import recognise_manoeuvre


def holdout_scores(estimate: PointEstimate, model: Model, records: Sequence[Record], window_s: float) -> Array:
    """Mean window error of each run by estimates without it, (runs, 2): heading [deg], position [m].

    Left out is each session, or each run where sessions are fewer than a jackknife needs (one step), and each kind of
    manoeuvre where there are several (fitted again); a run's errors are averaged over the two. Runs shorter than a
    window are not judged, unless all are.

    Raises:
        InputError: a window diverges, or a run lacks position or heading in all of its windows.
    """
    data, protocol, scores = estimate.problem.data, HoldoutProtocol(window_s=window_s), []
    template = replace(estimate.problem, model=model)
    of_run = [data.sessions[data.session[data.run_segments(r)[0]]] for r in range(len(records))]
    sessions = groups_of(of_run) if len(set(of_run)) >= RUNS_FOR_JACKKNIFE else [[r] for r in range(len(records))]
    kinds = groups_of([_kind(record) for record in records])
    points = [dict(_by_run(sessions, one_step_jackknife(estimate, sessions)))]
    if len(kinds) > 1:
        points.append(dict(_by_run(kinds, fits_without(estimate, kinds, workers=1))))
    judged = [r for r, record in enumerate(records) if split_windows(record, protocol)] or range(len(records))
    for r in judged:
        errors = []
        for point in (one[r] for one in points):
            by = holdout_model(template, point, of_run[r], records[r])
            errors += window_errors(template, by.model, [records[r]], [by.nuisances], ["run"], protocol)
        if not errors:
            raise InputError(f"run '{records[r].name}' has no window in which both position and heading are measured")
        scores.append((np.mean([e.heading_deg for e in errors]), np.mean([e.position_m for e in errors])))
    return np.array(scores)


def groups_of(names: Sequence[str]) -> list[list[int]]:
    """Return the positions of each name, in the order in which the names occur."""
    return [[i for i, name in enumerate(names) if name == one] for one in dict.fromkeys(names)]


def _by_run(groups: Sequence[Sequence[int]], points: Array) -> Iterator[tuple[int, Array]]:
    """Yield each run of the groups with the estimate without its group."""
    for group, point in zip(groups, points, strict=True):
        yield from ((run, point) for run in group)


def _kind(record: Record) -> str:
    """Manoeuvre that a record shows; one word for all in which none can be recognised."""
    try:
        return str(recognise_manoeuvre(record))
    except InputError:
        return "other"
