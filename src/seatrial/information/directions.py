"""Fisher information read direction by direction: what the records tell well, vaguely, or not at all.

Everything is in relative changes, parameter over its characteristic size, so that directions of different parameters
compare (eigen-directions of the scaled information: Belsley, Kuh & Welsch 1980, Regression Diagnostics, section 3.2).
"""

from collections.abc import Sequence

import numpy as np

from seatrial.results import Direction
from seatrial.values import Array

_NAMED, _SHARE = 5, 0.25
_KNOWN, _VAGUE, _ANYTHING = 0.1, 1.0, 10.0
_LEAST = 1e-24


def relative(information: Array, sizes: Array) -> Array:
    """Information of relative changes, shape (n, n); sizes (n,) are the parameters' characteristic sizes."""
    return information * sizes[:, None] * sizes[None, :]


def directions(information: Array, names: Sequence[str], sizes: Array) -> tuple[Direction, ...]:
    """All eigen-directions, the least determined first, each with the standard deviation along it and its words.

    information: of the data alone, shape (n, n), other unknowns eliminated.
    """
    values, vectors = np.linalg.eigh(relative(information, sizes))
    least = _LEAST * max(float(values[-1]), 1e-300)
    return tuple(
        _direction(vectors[:, k], float(1.0 / np.sqrt(value)) if value > least else np.inf, names)
        for k, value in enumerate(values)
    )


def _direction(vector: Array, deviation: float, names: Sequence[str]) -> Direction:
    order = np.argsort(-np.abs(vector), kind="stable")
    signed = vector * np.sign(vector[order[0]])
    combination = {names[int(i)]: float(signed[i]) for i in order}
    return Direction(combination, deviation, words(combination, deviation))


def words(combination: dict[str, float], deviation: float) -> str:
    """A direction in words: who moves with whom, and how well that is known."""
    large = [n for n, c in combination.items() if abs(c) >= _SHARE * max(map(abs, combination.values()))][:_NAMED]
    known = f"{float(f'{100 * deviation:.2g}'):g} %" if deviation < _ANYTHING else "any amount"
    if len(large) == 1:
        (name,) = large
        if deviation <= _KNOWN:
            return f"{name} is determined to {known}"
        if deviation <= _VAGUE:
            return f"{name} is determined vaguely, to {known}"
        return f"{name} is not determined: it may be wrong by {known}"
    terms = " ".join(f"{combination[n]:+.2f} {n}" for n in large)
    if deviation <= _KNOWN:
        return f"the combination {terms} (relative changes) is determined to {known}"
    if deviation <= _VAGUE:
        return f"along {terms} (relative changes) the records leave {known} open: these trade against each other"
    return f"along {terms} (relative changes) the records tell nothing: these may be wrong together by {known}"


def effective_parameters(information: Array, precision: Array) -> float:
    """Number of parameters that the data determine, trace of I (I + P)^-1 (MacKay 1992, Neural Comp. 4, 415).

    precision: of the priors in the same units; where there are none at all, every direction that is known better than
    to 100 % counts one (both matrices then in relative changes).
    """
    if not np.any(precision):
        return float(np.sum(np.linalg.eigvalsh(information) > _VAGUE**-2))
    return float(np.trace(np.linalg.solve(information + precision, information)))
