"""Draws from what records and priors leave open: credible intervals, and how far the draws can be trusted."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number, StoredArray
from seatrial.core.text.numbers import exact


@dataclass(frozen=True)
class CredibleInterval:
    """One coefficient as the draws have it, next to the interval that the fit would have without them, both at 95 %."""

    name: str
    unit: Annotated[str, Field(description="SI; 1 for a number, in the prime system of the model's source")]
    mean: Annotated[Number, Field(description="of the draws")]
    standard_deviation: Annotated[Number, Field(description="of the draws")]
    lower: Annotated[Number, Field(description="2.5 % quantile of the draws")]
    upper: Annotated[Number, Field(description="97.5 % quantile of the draws")]
    other_lower: Annotated[Number, Field(description="lower end by `other_intervals`")]
    other_upper: Annotated[Number, Field(description="as `other_lower`")]
    r_hat: Annotated[Number, Field(description="split R-hat (Vehtari et al. 2021): 1 where the chains agree")]
    effective_size: Annotated[Number, Field(description="independent draws that the draws are worth")]


@dataclass(frozen=True, eq=False)
class Posterior:
    """Draws of the free coefficients, those of sessions and disturbances marginalised."""

    coefficients: tuple[CredibleInterval, ...]
    points: Annotated[StoredArray, Field(description="shape (chains, draws, coefficients), SI; also in posterior.npz")]
    log_density: Annotated[StoredArray, Field(description="shape (chains, draws), up to a constant")]
    tempering: Annotated[
        dict[str, Number],
        Field(description="channel -> correlated samples that count as one; empty: all count in full"),
    ]
    other_intervals: Annotated[str, Field(description="method of the intervals that stand next to the credible ones")]
    acceptance: Annotated[Number, Field(description="share of the proposals that were taken")]
    is_converged: Annotated[bool, Field(description="R-hat at most 1.01 and 400 independent draws of each unknown")]
    is_interrupted: Annotated[bool, Field(description="whether a user ended the draws early")] = False

    @property
    def sentences(self) -> tuple[str, ...]:
        """Return how much was drawn, whether the chains agree, and what counted for less, as sentences."""
        chains, draws = self.points.shape[:2]
        fewest, worst = min(c.effective_size for c in self.coefficients), max(c.r_hat for c in self.coefficients)
        agree = "agree" if self.is_converged else "do not agree" if not self.is_interrupted else "were interrupted"
        sampled = (
            f"Sampling: {chains} chains of {draws} draws {agree}: R-hat at most {worst:.3f}, at least {fewest:.0f} "
            f"independent draws of each coefficient; {100.0 * self.acceptance:.0f} % of the proposals were taken."
        )
        if not self.tempering:
            return (sampled,)
        counted = ", ".join(f"{exact(many, 2)} of {name}" for name, many in self.tempering.items())
        return sampled, f"Residuals are correlated; so many samples count as one: {counted}."
