"""What the mean of ten runs is worth: the paper's ten against tens drawn from many runs of the same search."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.values import Array

# runs whose mean the paper prints
RUNS = 10
# probability that one of three checks fails though the printed ten are runs of the search repeated here; our choice
FAMILY_PROBABILITY = 0.05
# tens drawn with replacement for a quantile (Efron 1979); our choice
BOOTSTRAP_TENS = 10_000


@dataclass(frozen=True, eq=False)
class TenRuns:
    """Relative errors of many runs at one heading, (runs, 8), the first ten those of the tables; a seed for draws."""

    errors: Array
    seed: int

    @property
    def tens(self) -> Array:
        """Return the mean absolute error of the mean of each ten runs, one ten after another, (runs / 10,)."""
        means = self.errors.reshape(-1, RUNS, self.errors.shape[1]).mean(axis=1)
        return np.mean(np.abs(means), axis=1)

    @cached_property
    def drawn_tens(self) -> Array:
        """Return the same of tens drawn with replacement from all runs, (BOOTSTRAP_TENS,)."""
        picks = np.random.default_rng([self.seed, 29]).integers(len(self.errors), size=(BOOTSTRAP_TENS, RUNS))
        return np.mean(np.abs(self.errors[picks].mean(axis=1)), axis=1)

    def probability_below(self, error: float) -> float:
        """Return the share of drawn tens whose error is at most this one."""
        return float(np.mean(self.drawn_tens <= error))

    def limit_on_median(self, printed: float, headings: int) -> float:
        """Return the largest median of tens with which a printed ten is still likely.

        A ten lies below the quantile q of its own distribution with probability FAMILY_PROBABILITY / headings
        (Bonferroni); the printed error is no such rarity as long as median / printed <= median / quantile.
        """
        drawn = self.drawn_tens
        return float(printed * np.median(drawn) / np.quantile(drawn, FAMILY_PROBABILITY / headings))
