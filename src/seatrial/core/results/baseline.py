"""Another estimator's answer to the records of a fit."""

from dataclasses import dataclass, field

from seatrial.core.values import Finding

NO_COMPARISON = "no-comparison"
"""Code of the finding that says why other estimators could not be asked."""


@dataclass(frozen=True)
class OpenLoopScores:
    """Runs simulated open loop, together.

    Attributes:
        rms: keys as in `Prediction.rms`, root of the mean of squares over the runs; empty where a run diverges.
        correlation: channel (u, v, r) -> Pearson's coefficient of measured and simulated, mean over the runs; empty
            where a run diverges.
        diverged: names of the runs whose simulation diverges.
    """

    rms: dict[str, float] = field(default_factory=dict)
    correlation: dict[str, float] = field(default_factory=dict)
    diverged: tuple[str, ...] = ()


@dataclass(frozen=True)
class Baseline:
    """An estimator on the records of a fit; the fit itself stands first, then, if it has any, without its offsets.

    Attributes:
        values: coefficient -> SI; empty where the estimator failed.
        gap: coefficient -> difference from the fit's estimate in its standard errors.
        error: coefficient -> relative error where the true value is known and not zero.
        training, validation: runs open loop with these values, from the initial states that the fit gives them.
        bias: equations -> constant the estimator allowed itself besides.
        note: why it failed; empty where it did not.
        is_fit: whether these are the coefficients of the fit.
    """

    name: str
    values: dict[str, float] = field(default_factory=dict)
    normalised_difference: dict[str, float] = field(default_factory=dict)
    error: dict[str, float] = field(default_factory=dict)
    training: OpenLoopScores = field(default_factory=OpenLoopScores)
    validation: OpenLoopScores = field(default_factory=OpenLoopScores)
    bias: dict[str, float] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    note: str = ""
    is_fit: bool = False

    @property
    def diverged(self) -> tuple[str, ...]:
        """All runs whose simulation diverges."""
        return (*self.training.diverged, *self.validation.diverged)

    def relative_deviation(self, fit: "Baseline") -> dict[str, float]:
        """Relative error of each coefficient where the truth is known, else its relative difference from the fit."""
        if fit.error:
            return self.error
        return {n: value / fit.values[n] - 1.0 for n, value in self.values.items() if fit.values.get(n)}
