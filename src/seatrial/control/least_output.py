"""The gains that leave least of the output within the restrictions: spread points, the best pressed by gradients."""

import numpy as np

from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.control.gradient_refinement import all_gains, free_gain_bounds, refine_gains
from seatrial.core.values import Array

_SAMPLES, _STARTS = 4096, 3  # Sobol points, and those that are refined; chosen
_RESTARTS = 5  # searches from the best, until one finds nothing better; chosen


def spread_gains(evaluator: GainEvaluator, seed: int) -> Array:
    """Return gains spread over their box, (n, g): Sobol points, half of them towards small gains."""
    from scipy.stats import qmc

    _, (low, high) = free_gain_bounds(evaluator)
    unit = qmc.Sobol(len(low), seed=seed).random(_SAMPLES)
    unit[::2] **= 3.0
    return all_gains(evaluator, low + unit * (high - low))


def least_output_gains(evaluator: GainEvaluator, samples: Array) -> Array:
    """Return the best samples pressed against the restrictions; the least first objective wins, (g,).

    Where no sample keeps them, the one that breaks them least.
    """
    judged = evaluator.evaluate(samples)
    values = np.where(judged.is_feasible, judged.objectives[:, 0], np.inf)
    places = free_gain_bounds(evaluator)[0]
    order = np.argsort(values if np.isfinite(values).any() else judged.excess.max(axis=1))
    tried = [samples[i] for i in order[:_STARTS]]
    tried += [all_gains(evaluator, refine_gains(evaluator, start[places])[None])[0] for start in tried]
    best = _best_of(evaluator, tried)
    for _ in range(_RESTARTS):  # the search's picture of the curvature begins anew
        again = _best_of(evaluator, [best, all_gains(evaluator, refine_gains(evaluator, best[places])[None])[0]])
        if np.array_equal(again, best):
            break
        best = again
    return best


def _best_of(evaluator: GainEvaluator, tried: list[Array]) -> Array:
    """Return the feasible gains of the least first objective; without any those that break the restrictions least."""
    judged = evaluator.evaluate(np.array(tried))
    if not judged.is_feasible.any():
        return tried[int(np.argmin(judged.excess.max(axis=1)))]
    return tried[int(np.argmin(np.where(judged.is_feasible, judged.objectives[:, 0], np.inf)))]
