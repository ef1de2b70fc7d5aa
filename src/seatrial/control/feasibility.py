"""Whether any gains keep all restrictions; if none, which restriction is missed by how much."""

import math

import numpy as np

from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.control.gradient_refinement import all_gains, free_gain_bounds
from seatrial.core.results.tuning import Controller
from seatrial.core.values import InputError

_SAMPLES, _ROUNDS = 20_000, 8  # random gains in all, in rounds of shrinking size; chosen
_IDLE = (
    "the best that was found is no control at all, with every gain at zero: raise limits.Ms, limits.saturation or "
    "the actuator's own limits where they leave nothing else, and name the motion first under minimise"
)


def refuse_idle(chosen: Controller) -> None:
    """Refuse an answer that does nothing.

    Raises:
        InputError: the chosen gains leave the actuator where it is.
    """
    if not chosen.rms["actuator"] > 0.0:
        raise InputError(_IDLE)


def refuse_infeasible(evaluator: GainEvaluator, seed: int) -> None:
    """Say why a front is empty: restrictions that no gains within the bounds keep, or hardly any.

    Raises:
        InputError: always; which restriction is missed by how much by the gains that come nearest, or where those lie
            that the search has missed.
    """
    rng = np.random.default_rng(seed)
    _, (low, high) = free_gain_bounds(evaluator)
    best, least = low, math.inf
    for size in np.geomspace(1.0, 0.003, _ROUNDS):  # steps from the whole range down to 0.3 % of it; chosen
        steps = rng.uniform(-size, size, (_SAMPLES // _ROUNDS, len(low))) * (high - low)
        tried = np.clip((0.5 * (low + high) if size == 1.0 else best) + steps, low, high)
        excess = evaluator.evaluate(all_gains(evaluator, tried)).excess.max(axis=1)
        place = int(np.argmin(excess))
        if excess[place] < least:
            best, least = tried[place], float(excess[place])
    made = evaluator.evaluate(all_gains(evaluator, best[None]))
    where = ", ".join(
        f"{n} = {v:.4g}" for n, v in zip(evaluator.loop.gains.names, all_gains(evaluator, best[None])[0], strict=True)
    )
    if least <= 0.0 and not made.variances[0, :, 1].any():
        raise InputError(_IDLE)
    if least <= 0.0:
        raise InputError(
            f"the search met no gains that keep all limits, though {where} do: narrow the bounds of the gains about "
            "them"
        )
    if not math.isfinite(made.Ms[0]):
        raise InputError("no gains within their bounds make the loop stable; check signs, or widen the bounds")
    limits = evaluator.task.constraints
    names = (f"Ms of {limits.Ms:g}", "actuator saturation", "actuator rate saturation")
    roots = np.array([made.excess[0, 0], *(np.sqrt(1.0 + made.excess[0, 1:]) - 1.0)])
    said = [f"{name} by {100.0 * over:.3g} %" for name, over in zip(names, roots, strict=True) if over > 0.0]
    raise InputError(
        f"no gains within their bounds keep all limits: the nearest ({where}) exceed {' and '.join(said)}; "
        "raise that limit, or widen the bounds of the gains"
    )
