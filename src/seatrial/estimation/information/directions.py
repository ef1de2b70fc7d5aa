"""Fisher information read direction by direction: what the records determine well, vaguely, or not at all.

Everything is in relative changes, parameter over its characteristic size, so that directions of different parameters
compare (eigen-directions of the scaled information: Belsley, Kuh & Welsch 1980, Regression Diagnostics, section 3.2).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.results import Direction
from seatrial.core.values import Array
from seatrial.estimation.information.covariance import inverse

_MOST_NAMED, _SHARE = 5, 0.25  # parameters named in a text; share of the largest component worth naming; chosen
_NARROWED = 0.9  # ratio of deviations below which prior knowledge counts as narrowing; chosen
# relative standard deviations that bound the classes; chosen
_WELL_DETERMINED, _POORLY_DETERMINED, _UNDETERMINED = 0.1, 1.0, 10.0
_NO_INFORMATION = 1e-24  # of the largest eigenvalue, below which one counts as zero: rounding squared


def relative_information(information: Array, sizes: Array) -> Array:
    """Information of relative changes, shape (n, n); sizes (n,) are the parameters' characteristic sizes."""
    return information * sizes[:, None] * sizes[None, :]


def directions(
    information: Array, names: Sequence[str], sizes: Array, precision: Array | None = None,
    covariance: Array | None = None,
) -> tuple[Direction, ...]:  # fmt: skip
    """Return all eigen-directions, the least determined first, each with the standard deviation along it and its words.

    Args:
        information: of the data alone, shape (n, n), other unknowns eliminated.
        precision: what is known besides (priors, force points), which the words mention where it narrows a direction
            that the data leave open.
        covariance: behind the intervals, (n, n); where it is wider along a direction than the information has it, as
            under model error, that is its standard deviation.
    """
    scaled = relative_information(information, sizes)
    values, vectors = np.linalg.eigh(scaled)
    least = _NO_INFORMATION * max(float(values[-1]), 1e-300)  # above zero, for a division
    deviations = [float(1.0 / np.sqrt(value)) if value > least else np.inf for value in values]
    if covariance is not None:
        relative = covariance / np.outer(sizes, sizes)
        wider = [float(np.sqrt(max(v @ relative @ v, 0.0))) for v in vectors.T]
        deviations = [max(own, wide) for own, wide in zip(deviations, wider, strict=True)]
    held = deviations
    if precision is not None and np.any(precision):
        posterior = inverse(scaled + relative_information(precision, sizes))
        held = [float(np.sqrt(v @ posterior @ v)) for v in vectors.T]
    order = np.argsort(-np.array(deviations), kind="stable")
    return tuple(_direction(vectors[:, k], deviations[k], held[k], names) for k in order)


def _direction(vector: Array, deviation: float, posterior_deviation: float, names: Sequence[str]) -> Direction:
    order = np.argsort(-np.abs(vector), kind="stable")
    signed = vector * np.sign(vector[order[0]])
    combination = {names[int(i)]: float(signed[i]) for i in order}
    text = direction_text(combination, deviation)
    if deviation > _WELL_DETERMINED and posterior_deviation < _NARROWED * deviation:
        text += f"; what is known besides the records holds it to {_percent(posterior_deviation)}"
    return Direction(combination, deviation, text)


def signed_terms(changes: Mapping[str, float], form: str = "+.2f") -> str:
    """Parameters with their relative changes, e.g. ``+0.91 X_rr -0.34 X_vv``."""
    return " ".join(f"{change:{form}} {name}" for name, change in changes.items())


def _percent(deviation: float) -> str:
    return f"{float(f'{100 * deviation:.2g}'):g} %" if deviation < _UNDETERMINED else "any amount"


def direction_text(combination: Mapping[str, float], deviation: float) -> str:
    """A direction in words: who moves with whom, and how well that is known."""
    large = [n for n, c in combination.items() if abs(c) >= _SHARE * max(map(abs, combination.values()))][:_MOST_NAMED]
    known = _percent(deviation)
    if len(large) == 1:
        (name,) = large
        if deviation <= _WELL_DETERMINED:
            return f"{name} is determined to {known}"
        if deviation <= _POORLY_DETERMINED:
            return f"{name} is determined vaguely, to {known}"
        return f"{name} is not determined: it may be wrong by {known}"
    terms = signed_terms({n: combination[n] for n in large})
    if deviation <= _WELL_DETERMINED:
        return f"the combination {terms} (relative changes) is determined to {known}"
    if deviation <= _POORLY_DETERMINED:
        return f"along {terms} (relative changes) the records leave {known} open: these trade against each other"
    return f"along {terms} (relative changes) the records determine nothing: these may be wrong together by {known}"


def effective_parameters(information: Array, precision: Array, along: Sequence[Direction]) -> float:
    """Return the number of parameters that the data determine: trace of I (I + P)^-1.

    MacKay 1992, Neural Comp. 4, 415. Where there are no priors, every direction known better than to 100 % counts one.

    Args:
        information, precision: of the data and of the priors, in relative changes, (n, n).
        along: the directions of the information.
    """
    if not np.any(precision):
        return float(sum(direction.standard_deviation < _POORLY_DETERMINED for direction in along))
    return float(np.trace(np.linalg.solve(information + precision, information)))
