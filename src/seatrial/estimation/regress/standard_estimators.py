"""The regressions that a comparison shows, by name."""

from seatrial.data.trial.settings import SupportVectorSettings
from seatrial.estimation.regress.estimators import InstrumentalVariables, LinearRegression, RegressionEstimator
from seatrial.estimation.regress.operators import Central, Centred, Differenced, Euler, Smoothed, Weak
from seatrial.estimation.regress.pipeline import pipelines
from seatrial.estimation.regress.solvers import Lasso, LeastSquaresSvm, OrdinaryLeastSquares, Ridge, TruncatedSvd
from seatrial.estimation.regress.support_vectors import SupportVectors


def standard_estimators(half_width: float, svr: SupportVectorSettings | None = None) -> tuple[RegressionEstimator, ...]:
    """The estimators of a comparison; windows of that half width [s], the published pipeline with its settings."""
    settings = svr or SupportVectorSettings()
    support_vectors = SupportVectors(
        settings.C, settings.epsilon, settings.scaled, max_iterations=settings.max_iterations
    )
    least_squares = OrdinaryLeastSquares()
    return (
        LinearRegression("Euler differences, least squares", Euler(), least_squares),
        LinearRegression("Euler, differenced", Differenced(Euler()), least_squares),
        LinearRegression("Euler, differenced and centred", Centred(Differenced(Euler())), least_squares),
        LinearRegression("central differences, least squares", Central(), least_squares),
        LinearRegression("central differences, ridge", Central(), Ridge()),
        LinearRegression("central differences, truncated SVD", Central(), TruncatedSvd()),
        LinearRegression("central differences, Lasso", Central(), Lasso()),
        LinearRegression("central differences, least-squares SVM", Central(), LeastSquaresSvm()),
        LinearRegression("central differences, support vectors", Central(), support_vectors),
        LinearRegression("smoothed derivative, least squares", Smoothed(0.5 * half_width), least_squares),
        LinearRegression("weak form, least squares", Weak(half_width), least_squares),
        LinearRegression("weak form, ridge", Weak(half_width), Ridge()),
        *pipelines(settings),
        InstrumentalVariables("weak form, instrumental variables", Weak(half_width)),
    )
