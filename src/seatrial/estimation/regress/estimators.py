"""Estimators by regression: an operator and an arithmetic, linear support vectors among them."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.prediction import RowScore
from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.estimation.regress.operators import DerivativeOperator, RegressionMotion, demand_positive
from seatrial.estimation.regress.solvers import (
    LinearSolver,
    OrdinaryLeastSquares,
    RegressionSolution,
    RegressionSystem,
    build_systems,
    scale_system,
    solve_with_instruments,
)
from seatrial.physics.models.candidate_structures import with_candidate_terms
from seatrial.physics.simulate.replay import replay

# Estimators by regression: an operator and an arithmetic, through one door.


@dataclass(frozen=True, eq=False)
class RegressionEstimate:
    """Values of the free coefficients (k,) in the model's order; the constant each equation allowed itself besides.

    Attributes:
        candidates: coefficients of terms that were kept and that the model does not have.
        test: equation -> score on the rows kept for testing.
    """

    values: Array
    bias: dict[str, float] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    settings: dict[str, float] = field(default_factory=dict)
    candidates: dict[str, float] = field(default_factory=dict)
    test: dict[str, RowScore] = field(default_factory=dict)

    def in_model(self, model: Model) -> Model:
        """The model with these coefficients, wider where terms were kept that it does not have."""
        values = dict(zip(model.parameters.free_names, self.values.tolist(), strict=True))
        return (with_candidate_terms(model) if self.candidates else model).with_values(values | self.candidates)


class RegressionEstimator(Protocol):
    """From a model and records to coefficients, whatever values the model comes with."""

    @property
    def name(self) -> str:
        """What tables call it."""
        ...

    def estimate(self, model: Model, records: Sequence[Record]) -> RegressionEstimate:
        """The free coefficients from all records together.

        Raises:
            InputError: the records do not show every state, or their features are constant or collinear.
        """
        ...


@dataclass(frozen=True)
class LinearRegression:
    """A linear solver on the rows that an operator makes."""

    name: str
    operator: DerivativeOperator
    solver: LinearSolver

    def estimate(self, model: Model, records: Sequence[Record]) -> RegressionEstimate:
        """The coefficients, system by system."""
        made = build_systems(model, [RegressionMotion.from_record(model, r) for r in records], self.operator)
        return solve_systems(model, made, self.solver.solve)


@dataclass(frozen=True)
class InstrumentalVariables:
    """Instruments simulated by the model that least squares found, then again by their own (Young & Jakeman 1979)."""

    name: str
    operator: DerivativeOperator
    iterations: int = 3

    def estimate(self, model: Model, records: Sequence[Record]) -> RegressionEstimate:
        """The coefficients after `iterations` of simulation; the records' inputs drive it from their first sample.

        Raises:
            InputError: besides those of regression, a simulation that diverges.
        """
        made = build_systems(model, [RegressionMotion.from_record(model, r) for r in records], self.operator)
        found = solve_systems(model, made, OrdinaryLeastSquares().solve)
        for _ in range(self.iterations):
            ship = found.in_model(model)
            free_of_noise = [RegressionMotion.from_record(model, replay(ship, r)) for r in records]
            instruments = {s.equations: s for s in build_systems(model, free_of_noise, self.operator)}
            found = solve_systems(model, made, lambda s, z=instruments: solve_with_instruments(s, z[s.equations]))
        return found


def solve_systems(
    model: Model, linear_systems: Sequence[RegressionSystem], solve: Callable[[RegressionSystem], RegressionSolution]
) -> RegressionEstimate:
    """Every system solved, the coefficients in the model's order."""
    names = model.parameters.free_names
    values = np.zeros(len(names))
    bias, findings, settings = {}, [], {}
    for system in linear_systems:
        solved = solve(system)
        values[[names.index(n) for n in system.names]] = solved.coefficients
        bias[system.title] = solved.bias
        findings += solved.findings
        settings |= {f"{system.title}: {key}": value for key, value in solved.settings.items()}
    return RegressionEstimate(values, bias, tuple(findings), settings)


# Linear support vector regression as Song et al. 2025 have it, with the scaling and the tube said openly.

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
