"""Terms that Lasso selects among the candidates of a model, beside the package's own choice."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number


@dataclass(frozen=True)
class SelectedTerms:
    """The candidates of equations that share coefficients, and those that Lasso keeps."""

    equations: Annotated[str, Field(description="states whose rates they give")]
    candidates: tuple[str, ...]
    kept: Annotated[tuple[str, ...], Field(description="at the penalty that is chosen")]
    values: Annotated[dict[str, Number], Field(description="kept term -> least squares on all training runs, SI")]
    order: Annotated[tuple[str, ...], Field(description="terms as they enter while the penalty falls")]
    penalties: Annotated[tuple[Number, ...], Field(description="lambda of Song et al. 2025, eq. (11), ascending")]
    counts: Annotated[tuple[int, ...], Field(description="terms that each penalty keeps")]
    errors: Annotated[
        tuple[Number, ...],
        Field(description="rms error of what was left out over the rms of the rate itself, by penalty"),
    ]
    chosen: Annotated[int, Field(description="place of the largest penalty within one standard error of the least")]
    best: Annotated[int, Field(description="place of the penalty of least error")]

    @property
    def dropped(self) -> tuple[str, ...]:
        """Return the candidates that are not kept."""
        return tuple(name for name in self.candidates if name not in self.kept)


@dataclass(frozen=True)
class TermSelection:
    """Lasso's choice of terms, judged by what was left out."""

    equations: tuple[SelectedTerms, ...]
    left_out: Annotated[str, Field(description="what was left out one after the other, and how many")]
    held: Annotated[
        tuple[str, ...], Field(description="coefficients in which the rates are not linear, at the fit's values")
    ]

    @property
    def kept(self) -> tuple[str, ...]:
        """Return the terms kept in any equation."""
        return tuple(name for terms in self.equations for name in terms.kept)
