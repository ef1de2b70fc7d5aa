"""The regressions that a comparison shows, by name."""

from seatrial.estimation.regress.arithmetic import Lasso, LeastSquares, LeastSquaresSvm, Ridge, TruncatedSvd
from seatrial.estimation.regress.estimators import Estimator, InstrumentalVariables, Regression
from seatrial.estimation.regress.operators import Central, Centred, Differenced, Euler, Smoothed, Weak
from seatrial.estimation.regress.pipeline import Pipeline
from seatrial.estimation.regress.support_vectors import SupportVectors


def regressions(seconds: float) -> tuple[Estimator, ...]:
    """The estimators of a comparison; windows of half width `seconds`."""
    least_squares = LeastSquares()
    return (
        Regression("Euler differences, least squares", Euler(), least_squares),
        Regression("Euler, differenced", Differenced(Euler()), least_squares),
        Regression("Euler, differenced and centred", Centred(Differenced(Euler())), least_squares),
        Regression("central differences, least squares", Central(), least_squares),
        Regression("central differences, ridge", Central(), Ridge()),
        Regression("central differences, truncated SVD", Central(), TruncatedSvd()),
        Regression("central differences, Lasso", Central(), Lasso()),
        Regression("central differences, least-squares SVM", Central(), LeastSquaresSvm()),
        Regression("central differences, support vectors", Central(), SupportVectors()),
        Regression("smoothed derivative, least squares", Smoothed(0.5 * seconds), least_squares),
        Regression("weak form, least squares", Weak(seconds), least_squares),
        Regression("weak form, ridge", Weak(seconds), Ridge()),
        Pipeline(name="published pipeline (Song et al. 2025)", operator=Euler()),
        Pipeline(),
        InstrumentalVariables("weak form, instrumental variables", Weak(seconds)),
    )
