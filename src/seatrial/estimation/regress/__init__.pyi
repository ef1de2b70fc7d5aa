"""Names of this package, imported when first used."""

from seatrial.estimation.information.covariance import (
    collinearity as collinearity,
    condition_number as condition_number,
)
from seatrial.estimation.regress.samples import (
    without_duplicates as without_duplicates,
    without_missing as without_missing,
    without_outliers as without_outliers,
    without_small as without_small,
)
from seatrial.estimation.regress.estimators import (
    InstrumentalVariables as InstrumentalVariables,
    LinearRegression as LinearRegression,
    RegressionEstimate as RegressionEstimate,
    RegressionEstimator as RegressionEstimator,
)
from seatrial.estimation.regress.operators import RegressionMotion as RegressionMotion, features as features
from seatrial.estimation.regress.pipeline import (
    available_estimators as available_estimators,
    estimator_named as estimator_named,
    estimator_of_method as estimator_of_method,
)
from seatrial.estimation.regress.operators import (
    Central as Central,
    Centred as Centred,
    DerivativeOperator as DerivativeOperator,
    Differenced as Differenced,
    Euler as Euler,
    Smoothed as Smoothed,
    Weak as Weak,
)
from seatrial.estimation.regress.pipeline import (
    Cleaning as Cleaning,
    DIFFERENCED_AND_CENTRED as DIFFERENCED_AND_CENTRED,
    Pipeline as Pipeline,
    ablations as ablations,
    pipelines as pipelines,
    row_score as row_score,
)
from seatrial.estimation.regress.estimators import (
    Lasso as Lasso,
    LeastSquaresSvm as LeastSquaresSvm,
    LinearSolver as LinearSolver,
    OrdinaryLeastSquares as OrdinaryLeastSquares,
    Ridge as Ridge,
    TruncatedSvd as TruncatedSvd,
)
from seatrial.estimation.regress.samples import (
    blocks as blocks,
    folds as folds,
    record_folds as record_folds,
    shuffled_split as shuffled_split,
)
from seatrial.estimation.regress.pipeline import standard_estimators as standard_estimators
from seatrial.estimation.regress.estimators import SupportVectors as SupportVectors
from seatrial.estimation.regress.term_selection import select_terms as select_terms
from seatrial.estimation.regress.estimators import (
    RegressionSystem as RegressionSystem,
    assemble_systems as assemble_systems,
    build_systems as build_systems,
)
