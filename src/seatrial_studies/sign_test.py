"""Which of two paired samples is the smaller one: the sign test."""

import numpy as np
from scipy.stats import binomtest

from seatrial.core.values import Array

SIGNIFICANCE = 0.05
"""Probability with which chance alone gives a verdict; our choice."""


def is_smaller(one: Array, other: Array) -> bool:
    """Return whether `one` is smaller in more pairs than chance explains (one-sided sign test); ties do not count."""
    wins, losses = int(np.sum(one < other)), int(np.sum(one > other))
    return wins + losses > 0 and float(binomtest(wins, wins + losses, alternative="greater").pvalue) < SIGNIFICANCE
