"""Methods of estimation by the names that trial files and the command line have for them."""

from enum import StrEnum

from seatrial.core.values import InputError, spelling_hint


class FitCriterion(StrEnum):
    """What the package's own estimate minimises; `auto` is the decision table's choice."""

    AUTO = "auto"
    OUTPUT_ERROR = "output-error"
    MULTIPLE_SHOOTING = "multiple-shooting"
    PREDICTION_ERROR = "prediction-error"


class EstimateMethod(StrEnum):
    """The package's own criteria, searches by a population, and regressions."""

    AUTO = "auto"
    OUTPUT_ERROR = "output-error"
    MULTIPLE_SHOOTING = "multiple-shooting"
    PREDICTION_ERROR = "prediction-error"

    PSO = "pso"
    WHO = "who"
    IWHO = "iwho"
    ICPSO = "icpso"
    DE = "de"
    CMA_ES = "cma-es"

    EULER = "euler"
    EULER_DIFFERENCED = "euler-differenced"
    EULER_CENTRED = "euler-centred"
    OLS = "ols"
    RIDGE = "ridge"
    TSVD = "tsvd"
    LASSO = "lasso"
    LS_SVM = "ls-svm"
    SVR = "svr"
    SMOOTHED = "smoothed"
    WEAK_FORM = "weak-form"
    WEAK_FORM_RIDGE = "weak-form-ridge"
    SONG2025 = "song2025"
    SONG2025_IMPROVED = "song2025-improved"
    INSTRUMENTAL_VARIABLES = "iv"

    @property
    def criterion(self) -> FitCriterion:
        """Return what the package's own estimate minimises, which a published method is compared with."""
        return FitCriterion.AUTO if self.is_published else FitCriterion(self.value)

    @property
    def is_search(self) -> bool:
        """Whether a population searches a box of coefficients."""
        return self in SEARCHES

    @property
    def is_published(self) -> bool:
        """Whether the estimate is not the package's own."""
        return self.value not in [criterion.value for criterion in FitCriterion]


SEARCHES = (
    EstimateMethod.PSO, EstimateMethod.WHO, EstimateMethod.IWHO, EstimateMethod.ICPSO, EstimateMethod.DE,
    EstimateMethod.CMA_ES,
)  # fmt: skip
"""Methods in which a population searches a box of coefficients."""


def method_named(name: object) -> object:
    """Return the method of that name, for a validator: what is no text is passed on.

    Raises:
        InputError: there is no such method; the nearest is named.
    """
    if not isinstance(name, str):
        return name
    names = [method.value for method in EstimateMethod]
    if name not in names:
        raise InputError(f"unknown method '{name}'{spelling_hint(name, names)}")
    return EstimateMethod(name)
