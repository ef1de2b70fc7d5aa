"""Settings of the regressions that `--compare` sets beside a fit: tables of a trial file, values in Python."""

from typing import Annotated, Self

from pydantic import Field, model_validator
from pydantic.dataclasses import dataclass

from seatrial.data.trial.amounts import STRICT_FIELDS
from seatrial.data.trial.schema_errors import raises_input_error

Positive = Annotated[float, Field(gt=0)]


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class SupportVectorSettings:
    """`[compare.svr]`: the pipeline of Song et al. 2025, clean, split, select by Lasso, regress by support vectors.

    C, epsilon, thresholds and the number of penalties are not printed there; their defaults are ours.

    Attributes:
        C: penalty of what lies outside the tube, eq. (19).
        epsilon: half width of the tube in standard deviations of the target; in its own unit where `scaled` is false.
        scaled: whether columns and target are brought to unit root mean square first.
        max_iterations: steps of the solver, after which a finding says that it did not converge.
        outlier_score: largest standard score that stays, eq. (5); 0 keeps all samples.
        small_share: least absolute value that stays, as a share of each velocity's standard deviation, eq. (8).
        drop_duplicates: whether repeated samples go, eq. (6).
        folds: contiguous folds of Lasso's cross-validation.
        lambda_: smallest and largest penalty of Lasso, eq. (12); lambda_count: how many between, evenly in decades.
        test_share: share of each record, its end, that is kept for testing, eq. (9).
        candidates: whether Lasso chooses among all candidate terms that the model knows, or among its own alone.
        ablation: whether the pipeline is repeated with each of its steps left out.
    """

    C: Positive = 1.0
    epsilon: Annotated[float, Field(ge=0)] = 0.1
    scaled: bool = True
    max_iterations: Annotated[int, Field(ge=1)] = 100_000
    outlier_score: Annotated[float, Field(ge=0)] = 3.0
    small_share: Annotated[float, Field(ge=0)] = 1e-3
    drop_duplicates: bool = True
    folds: Annotated[int, Field(ge=2)] = 10
    lambda_: Annotated[tuple[Positive, Positive], Field(alias="lambda")] = (1e-6, 1e6)
    lambda_count: Annotated[int, Field(ge=1, le=1000)] = 49
    test_share: Annotated[float, Field(gt=0, lt=1)] = 0.2
    candidates: bool = True
    ablation: bool = False

    @model_validator(mode="after")
    def _penalties_in_order(self) -> Self:
        if self.lambda_[0] >= self.lambda_[1]:
            low, high = self.lambda_
            raise ValueError(f"lambda runs from {low:g} to {high:g}; give the smaller first")
        return self


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class CompareSettings:
    """`[compare]`: settings of the regressions that `--compare` sets beside the fit."""

    svr: SupportVectorSettings = Field(default_factory=SupportVectorSettings)
