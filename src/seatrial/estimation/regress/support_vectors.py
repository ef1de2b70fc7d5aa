"""Linear support vector regression as Song et al. 2025 have it, with the scaling and the tube said openly."""

import warnings
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Finding, InputError, Severity
from seatrial.estimation.regress.features import demand_positive
from seatrial.estimation.regress.solvers import RegressionSolution, scale_system
from seatrial.estimation.regress.system import RegressionSystem

_MANY_ROWS = 3000  # default of the largest number of rows; chosen
_MAX_ITERATIONS = 100_000  # default of the solver's iterations at most; chosen, some seconds for 3000 rows


@dataclass(frozen=True)
class SupportVectors:
    """Support vector regression with linear kernel (Vapnik 1995; Song et al. 2025, eqs. (19)-(25)), by scikit-learn.

    Attributes:
        penalty: C; tube: half width epsilon within which a residual costs nothing.
        is_standardised: whether columns and target are brought to unit root mean square; else penalty and tube act
            on the numbers as they come, and a tube of 0.1 swallows a target of 0.03 whole.
        max_rows: samples at most, evenly taken; the paper thins its record, too (section 1.2).
        max_iterations: iterations of the solver, after which it ends with a finding.
    """

    penalty: float = 1.0
    tube: float = 0.1
    is_standardised: bool = True
    max_rows: int = _MANY_ROWS
    max_iterations: int = _MAX_ITERATIONS

    def __post_init__(self) -> None:
        demand_positive("penalty C of the support vectors", self.penalty)
        if not 0.0 <= self.tube < np.inf:
            raise InputError(f"a tube of {self.tube:g} is none; give 0 or more")

    def solve(self, system: RegressionSystem) -> RegressionSolution:
        """The weights and the bias b of eq. (26), which should be near zero for the weights to count."""
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.svm import SVR

        scaled = scale_system(system)
        thin = slice(None, None, max(1, len(system.target) // self.max_rows))
        matrix, target = (scaled.matrix, scaled.target) if self.is_standardised else (system.matrix, system.target)
        # MB of its cache; chosen
        machine = SVR(kernel="linear", C=self.penalty, epsilon=self.tube, cache_size=500, max_iter=self.max_iterations)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)
            machine.fit(matrix[thin], target[thin])
        weights = (
            np.asarray(machine.coef_, dtype=np.float64).ravel()
            if len(machine.support_)
            else np.zeros(len(system.names))
        )
        bias = float(np.ravel(machine.intercept_)[0])
        back = scaled.unscaled(weights) if self.is_standardised else weights
        unit = scaled.target_scale if self.is_standardised else 1.0
        share = float(len(machine.support_)) / len(target[thin])
        reach = float(np.abs(target[thin]).max())
        findings = () if weights.any() else (_zero_weights_finding(system, self.tube, reach),)
        if int(np.max(machine.n_iter_)) >= self.max_iterations:
            findings += (_not_converged_finding(system, self.max_iterations),)
        return RegressionSolution(back, unit * bias, findings, {"support vectors (share)": share})


def _zero_weights_finding(system: RegressionSystem, tube: float, reach: float) -> Finding:
    return Finding(
        Severity.WARNING,
        "tube-too-wide",
        f"support vector regression of the {system.title} equation returns zeros only: its tube of {tube:g} is wider "
        f"than its target, which reaches {reach:.2g}",
        "",
        "scale the target to unit size, or give a tube of a few per cent of it",
    )


def _not_converged_finding(system: RegressionSystem, iterations: int) -> Finding:
    return Finding(
        Severity.WARNING,
        "not-converged",
        f"support vector regression of the {system.title} equation stopped at its limit of {iterations} iterations "
        "before it converged: its coefficients are those of an unfinished search",
        "",
        "a smaller C or a wider epsilon converges sooner, or raise max_iterations under [compare.svr]",
    )
