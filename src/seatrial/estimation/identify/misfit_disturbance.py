"""A warning where the estimated disturbance moves a state by more than the state moves at all: no sea does that."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.text.numbers import significant
from seatrial.core.values import NOTATION, Finding, Record, Severity


def misfit_disturbance(
    intensities: Mapping[str, float], simulated: Sequence[Record], seconds: float
) -> tuple[Finding, ...]:
    """Return a warning `disturbance-exceeds-motion` of the states whose noise exceeds their own spread.

    Args:
        intensities: state -> intensity of its process noise, SI over the root of a second.
        simulated: the training runs as the model has them.
        seconds: in which the craft changes its motion; noise that is not damped grows to q sqrt(T) in it.
    """
    parts = []
    for state, intensity in intensities.items():
        samples = [r[state][np.isfinite(r[state])] for r in simulated if state in r]
        spread = float(np.std(np.concatenate(samples))) if samples else math.nan
        disturbed = intensity * math.sqrt(seconds)
        if disturbed > spread > 0.0:
            unit = NOTATION[state].unit
            parts.append(f"{state}: {significant(disturbed, 2)} {unit} within {significant(seconds, 2)} s, while the "
                         f"runs spread by {significant(spread, 2)} {unit}")  # fmt: skip
    if not parts:
        return ()
    text = "the estimated disturbance moves the craft by more than it moves in the runs: the model's misfit, not the "
    return (Finding(Severity.WARNING, "disturbance-exceeds-motion", f"{text}sea, is likely", "; ".join(parts),
                    "free more coefficients, correct a channel, or take a richer model"),)  # fmt: skip
