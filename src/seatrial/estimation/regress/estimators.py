"""Estimators by regression: an operator and an arithmetic, through one door."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.prediction import RowScore
from seatrial.core.values import Array, Finding, Record
from seatrial.estimation.regress.features import RegressionMotion
from seatrial.estimation.regress.operators import DerivativeOperator
from seatrial.estimation.regress.solvers import (
    LinearSolver,
    OrdinaryLeastSquares,
    RegressionSolution,
    solve_with_instruments,
)
from seatrial.estimation.regress.system import RegressionSystem, build_systems
from seatrial.physics.models.candidate_structures import with_candidate_terms
from seatrial.physics.simulate.replay import replay


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
