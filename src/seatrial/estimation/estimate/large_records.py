"""Records of more samples than a choice needs: decide on a stated part of them, then take one step over all."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from seatrial.core.values import Record
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.criterion_choice import (
    SPREAD,
    CriterionChoice,
    output_error_choice,
    prediction_error_choice,
)
from seatrial.estimation.estimate.newton_refinement import newton_optimum
from seatrial.estimation.estimate.point_estimate import fit_output_error
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.information.whiteness import whiteness_test
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import over_runs
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import Optimum

MOST_SAMPLES = 100_000
"""Samples of all runs up to which everything is done with all of them; chosen."""

CHOICE_SAMPLES, _STRETCHES = 20_000, 3
"""Samples on which start, disturbance and criterion are chosen beyond that, and stretches of a single run; chosen."""

PIECE_SAMPLES = 20_000
"""Samples of the pieces in which all of them are filtered: each forgets its initial state within a few; chosen."""

_MOST_GROWTH = 10.0
"""Samples of a Newton step over those of the one before, at most; chosen: a step then leaves 0.1 standard errors."""

_FAR, _MOST_REPEATS = 4.0, 2
"""Decrement of the last step from which on it is taken again, and how often at most: from 2.8 standard errors a step
leaves a tenth of one; chosen."""

_LATER_EVALUATIONS = 6
"""Most evaluations of output error over all samples, from the optimum over some; chosen."""


def choice_runs(runs: Runs) -> Runs | None:
    """Return stretches of all runs with some twenty thousand samples; None where all runs together are short enough."""
    return _part(runs, CHOICE_SAMPLES) if _sample_count(runs) > MOST_SAMPLES else None


def _sample_count(runs: Runs) -> int:
    return sum(len(r) for r in runs.records)


def _part(runs: Runs, samples: int) -> Runs:
    """Stretches of all runs with about so many samples together."""
    count = max(1, round(_STRETCHES / len(runs)))
    length = max(samples // (count * len(runs)), 2)
    stretches = [(s, session) for r, session in zip(runs.records, runs.sessions, strict=True)
                 for s in _stretches(r, count, length)]  # fmt: skip
    return replace(runs, records=tuple(s for s, _ in stretches), sessions=tuple(n for _, n in stretches))


def _stretches(record: Record, count: int, length: int) -> Iterator[Record]:
    """Yield stretches of a record from its beginning to its end."""
    length = min(length, len(record))
    for number, first in enumerate(np.linspace(0, len(record) - length, count).round().astype(int).tolist()):
        yield record.rows(slice(first, first + length)).renamed(f"{record.name}, stretch {number + 1}")


def choice_over_all(choice: CriterionChoice, runs: Runs) -> CriterionChoice:
    """Return a choice moved to its optimum over all samples.

    Prediction error takes Newton steps: the point comes from so many samples that what a step leaves is far below its
    standard error. Output error searches on from the point.
    """
    few = choice.estimate.problem
    total, part = _sample_count(runs), len(few.data.inputs)
    reason = f"criterion and disturbance were chosen on {part} of {total} samples, the estimate is that of all"
    if choice.disturbances is None or choice.process_noise is None:
        problem = _with_all_samples(few, runs, None)  # whole: without a disturbance nothing is forgotten
        estimate = fit_output_error(problem, choice.estimate.common_parameters, problem.measured_initial_states(),
                                    runs.noise, rounds=1, evaluations=_LATER_EVALUATIONS)  # fmt: skip
        return output_error_choice(estimate, choice.criterion).with_reasons(reason)
    noise = _noise_over_all(choice.process_noise, runs)
    reasons = (f"{choice.disturbances.choice_text}; over all samples {noise.test.innovations_text}", reason)
    more = () if noise.test.is_white else (SPREAD,)
    return prediction_error_choice(noise, choice.disturbances, *reasons, *more)


def _noise_over_all(few: ProcessNoise, runs: Runs) -> ProcessNoise:
    """The optimum over all samples, by way of parts that grow by one factor, ten at most.

    What a Newton step leaves grows with the square of its distance, and this with the root of that factor; where the
    last one still came from far away, it is taken again.
    """
    part = len(few.problem.runs.data.inputs)
    factor = _sample_count(runs) / part
    steps = max(1, math.ceil(math.log(factor) / math.log(_MOST_GROWTH)))
    growth, noise = factor ** (1.0 / steps), few
    for step in range(1, steps):
        noise = _one_step(few, noise.optimum, _part(runs, round(part * growth**step)), growth)
    noise = _one_step(few, noise.optimum, runs, growth)
    for _ in range(_MOST_REPEATS):
        if noise.newton_decrement <= _FAR:
            break
        noise = _one_step(few, noise.optimum, runs, 1.0)
    normalised = noise.problem.innovations(noise.optimum.solution.point).normalised
    pieces = [normalised[a:b] for a, b in pairwise(noise.problem.runs.data.offsets)]
    return replace(noise, newton_decrement=0.0, test=replace(few.test, whiteness=whiteness_test(pieces)))


def _one_step(few: ProcessNoise, before: Optimum, runs: Runs, growth: float) -> ProcessNoise:
    """One Newton step over these runs from an optimum of `growth` times fewer samples; its decrement is kept."""
    output_error = _with_all_samples(few.output_error, runs, PIECE_SAMPLES * few.output_error.data.dt)
    problem = over_runs(few.problem, output_error)
    optimum, decrement = newton_optimum(problem, before, growth)
    return replace(few, problem=problem, optimum=optimum, newton_decrement=decrement, output_error=output_error)


def _with_all_samples(problem: OutputError, runs: Runs, seconds: float | None) -> OutputError:
    """The problem with all samples, in pieces of so many seconds; None: whole runs."""
    return replace(
        problem, data=cut_segments(problem.model, runs.records, problem.data.outputs, seconds, runs.sessions)
    )
