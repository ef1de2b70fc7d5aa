"""Linear support vector regression as Song et al. 2025 have it, with the scaling and the tube said openly."""

import warnings
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Finding, InputError, Severity
from seatrial.estimation.regress.arithmetic import Solved, scales
from seatrial.estimation.regress.features import demand_positive
from seatrial.estimation.regress.system import System

_MANY_ROWS = 3000
_STEPS = 500_000


@dataclass(frozen=True)
class SupportVectors:
    """Support vector regression with linear kernel (Vapnik 1995; Song et al. 2025, eqs. (19)-(25)), by scikit-learn.

    Attributes:
        penalty: C; tube: half width epsilon within which a residual costs nothing.
        standardised: whether columns and target are first brought to unit root mean square; else penalty and tube act
            on the numbers as they come, and a tube of .1 swallows a target of .03 whole.
        rows: samples at most, evenly taken; the paper thins its record, too (section 1.2).
    """

    penalty: float = 1.0
    tube: float = 0.1
    standardised: bool = True
    rows: int = _MANY_ROWS

    def __post_init__(self) -> None:
        demand_positive("penalty C of the support vectors", self.penalty)
        if not 0.0 <= self.tube < np.inf:
            raise InputError(f"a tube of {self.tube:g} is none; give 0 or more")

    def solve(self, system: System) -> Solved:
        """The weights and the bias b of eq. (26), which should be near zero for the weights to count."""
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.svm import SVR

        scaled = scales(system)
        thin = slice(None, None, max(1, len(system.target) // self.rows))
        matrix, target = (scaled.matrix, scaled.values) if self.standardised else (system.matrix, system.target)
        machine = SVR(kernel="linear", C=self.penalty, epsilon=self.tube, cache_size=500, max_iter=_STEPS)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)
            machine.fit(matrix[thin], target[thin])
        weights = (
            np.asarray(machine.coef_, dtype=np.float64).ravel()
            if len(machine.support_)
            else np.zeros(len(system.names))
        )
        bias = float(np.ravel(machine.intercept_)[0])
        back = scaled.back(weights) if self.standardised else weights
        unit = scaled.target if self.standardised else 1.0
        share = float(len(machine.support_)) / len(target[thin])
        reach = float(np.abs(target[thin]).max())
        findings = () if weights.any() else (_swallowed(system, self.tube, reach),)
        findings += () if int(np.max(machine.n_iter_)) < _STEPS else (_unconverged(system),)
        return Solved(back, unit * bias, findings, {"support vectors (share)": share})


def _swallowed(system: System, tube: float, reach: float) -> Finding:
    return Finding(
        Severity.WARNING,
        "tube-too-wide",
        f"support vector regression of the {system.title} equation returns zeros only: its tube of {tube:g} is wider "
        f"than its target, which reaches {reach:.2g}",
        "",
        "scale the target to unit size, or give a tube of a few per cent of it",
    )


def _unconverged(system: System) -> Finding:
    return Finding(
        Severity.WARNING,
        "not-converged",
        f"support vector regression of the {system.title} equation stopped after {_STEPS} steps before it converged",
        "",
        "a smaller penalty or a wider tube converges sooner",
    )
