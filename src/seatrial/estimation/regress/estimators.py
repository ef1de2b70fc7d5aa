"""Estimators by regression: how linear systems are solved, and the ready combinations, support vectors among them."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, Self

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.prediction import RowScore
from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.estimation.regress.operators import DerivativeOperator, RegressionMotion, RegressionRows, demand_positive
from seatrial.estimation.regress.samples import folds
from seatrial.physics.models.candidate_structures import with_candidate_terms
from seatrial.physics.simulate.replay import replay

# How the coefficients of the linear systems of a regression are found: least squares, shrinkage, selection.

# The linear systems of a regression: equations that share no coefficient stand apart.

_COLLINEAR = 1e-12  # ratio of singular values: rounding
_NAMED = 0.05  # share of the largest component worth naming; chosen


@dataclass(frozen=True, eq=False)
class RegressionSystem:
    """target = matrix @ coefficients + noise.

    Attributes:
        equations: states whose rates stand in it; names: its coefficients, k.
        matrix: (n, k); target: (n,); rows of several equations one after another, each in units of its own spread.
    """

    equations: tuple[str, ...]
    names: tuple[str, ...]
    matrix: Array
    target: Array

    @property
    def title(self) -> str:
        """What reports call it."""
        return ", ".join(self.equations)

    def restricted_to(self, names: Sequence[str]) -> Self:
        """Only these of its coefficients; the others are zero."""
        kept = [self.names.index(n) for n in names]
        return replace(self, names=tuple(names), matrix=self.matrix[:, kept])


def build_systems(
    model: Model, motions: Sequence[RegressionMotion], operator: DerivativeOperator
) -> tuple[RegressionSystem, ...]:
    """The systems of all runs together, one for each set of equations that shares coefficients.

    Raises:
        InputError: no run is long enough for the operator, or the features of a system are constant or collinear.
    """
    made = assemble_systems(model, motions, operator)
    if not made:
        raise InputError("no run is long enough for the regression's windows; give longer runs or shorter windows")
    for system in made:
        refuse_degenerate(system)
    return made


def assemble_systems(
    model: Model, motions: Sequence[RegressionMotion], operator: DerivativeOperator
) -> tuple[RegressionSystem, ...]:
    """The systems of all runs together as they are, to be predicted; none where no run is long enough."""
    of_runs = [rows for motion in motions if len((rows := operator.rows(model, motion)).time)]
    if not of_runs:
        return ()
    rows = RegressionRows(
        np.concatenate([r.time for r in of_runs]),
        np.concatenate([r.target for r in of_runs]),
        np.concatenate([r.slope for r in of_runs]),
        of_runs[0].step,
    )
    names = model.parameters.free_names
    return tuple(_system(model, rows, equations, columns, names) for equations, columns in _coupled_equations(model))


def refuse_degenerate(system: RegressionSystem) -> None:
    """Refuse features that do not act, that are combinations of one another, or too few rows.

    Raises:
        InputError: naming them.
    """
    rows, count = system.matrix.shape
    if rows < count:
        raise InputError(
            f"the runs give {rows} row{'s' * (rows != 1)} for the {count} coefficients {', '.join(system.names)}: "
            "give longer runs or shorter windows"
        )
    size = np.sqrt(np.mean(system.matrix**2, axis=0))
    absent = [n for n, s in zip(system.names, size, strict=True) if not s > 0.0]
    if absent:
        raise InputError(
            f"the feature of {', '.join(absent)} is zero in these rows, so that regression cannot see it: "
            "record a manoeuvre in which it acts, or fix it under [model]"
        )
    _, values, directions = np.linalg.svd(system.matrix / size, full_matrices=False)
    if values[-1] <= _COLLINEAR * values[0]:
        share = np.abs(directions[-1])
        alike = [n for n, s in zip(system.names, share, strict=True) if s > _NAMED * share.max()]
        raise InputError(
            f"the features of {', '.join(alike)} are collinear in these rows: record a manoeuvre that separates "
            "them, or fix one of them under [model]"
        )


def _coupled_equations(model: Model) -> list[tuple[list[int], list[int]]]:
    """States and places among the free coefficients of each set of equations that shares some (structural)."""
    nx, nu = len(model.states), len(model.inputs)
    place = {nx + nu + model.parameters.index(n): c for c, n in enumerate(model.parameters.free_names)}
    holds: dict[int, set[int]] = {}
    for state, column in model.compiled.rates_pattern:
        if int(column) in place:
            holds.setdefault(int(state), set()).add(place[int(column)])
    sets: list[tuple[set[int], set[int]]] = []
    for state, columns in sorted(holds.items()):
        joined = ({state}, set(columns))
        for other in [s for s in sets if s[1] & columns]:
            sets.remove(other)
            joined = (joined[0] | other[0], joined[1] | other[1])
        sets.append(joined)
    return [(sorted(states), sorted(columns)) for states, columns in sets]


def _system(
    model: Model, rows: RegressionRows, equations: list[int], columns: list[int], names: tuple[str, ...]
) -> RegressionSystem:
    spread = [float(np.std(rows.target[:, i])) or 1.0 for i in equations] if len(equations) > 1 else [1.0]
    return RegressionSystem(
        tuple(model.states[i] for i in equations),
        tuple(names[c] for c in columns),
        np.concatenate([rows.slope[:, i][:, columns] / s for i, s in zip(equations, spread, strict=True)]),
        np.concatenate([rows.target[:, i] / s for i, s in zip(equations, spread, strict=True)]),
    )


# How the coefficients of a linear system are found: least squares, shrinkage, selection, instruments.

FOLDS = 10
PENALTIES = np.logspace(-6.0, 6.0, 49)  # four a decade over twelve decades; chosen


@dataclass(frozen=True, eq=False)
class RegressionSolution:
    """Coefficients (k,) of a system, the constant the method allowed itself besides, and what to say of it."""

    coefficients: Array
    bias: float = 0.0
    findings: tuple[Finding, ...] = ()
    settings: dict[str, float] = field(default_factory=dict)


class LinearSolver(Protocol):
    """From a system to its coefficients."""

    def solve(self, system: RegressionSystem) -> RegressionSolution:
        """The coefficients in the system's order."""
        ...


@dataclass(frozen=True, eq=False)
class ScaledSystem:
    """Root mean squares of columns (k,) and of the target, and the system, `matrix` and `target`, in these units."""

    column_scales: Array
    target_scale: float
    matrix: Array
    target: Array

    def unscaled(self, coefficients: Array) -> Array:
        """Coefficients in the system's own units."""
        return self.target_scale * coefficients / self.column_scales


def scale_system(system: RegressionSystem) -> ScaledSystem:
    """The system in units of the root mean squares of its columns and target."""
    columns = np.sqrt(np.mean(system.matrix**2, axis=0))
    columns = np.where(columns > 0.0, columns, 1.0)
    target = float(np.sqrt(np.mean(system.target**2))) or 1.0
    return ScaledSystem(columns, target, system.matrix / columns, system.target / target)


@dataclass(frozen=True)
class OrdinaryLeastSquares:
    """Ordinary least squares (Gauss 1809)."""

    def solve(self, system: RegressionSystem) -> RegressionSolution:
        """By orthogonal decomposition."""
        scaled = scale_system(system)
        return RegressionSolution(scaled.unscaled(_least_squares(scaled.matrix, scaled.target)))


@dataclass(frozen=True)
class Ridge:
    """Least squares with a penalty on the coefficients' squares (Hoerl & Kennard 1970).

    penalty: lambda of |residual|^2 + lambda |coefficients|^2; None takes the best over contiguous folds.
    """

    penalty: float | None = None

    def __post_init__(self) -> None:
        if self.penalty is not None and not 0.0 <= self.penalty < np.inf:
            raise InputError(f"a ridge penalty of {self.penalty:g} is none; give 0 or more, or None")

    def solve(self, system: RegressionSystem) -> RegressionSolution:
        """By the normal equations."""
        scaled = scale_system(system)
        penalty = _best_penalty(scaled, _ridge_path) if self.penalty is None else self.penalty
        found = _ridge_path(scaled.matrix, scaled.target, np.array([penalty]))[0]
        return RegressionSolution(scaled.unscaled(found), settings={"penalty": penalty})


@dataclass(frozen=True)
class TruncatedSvd:
    """Least squares in the directions whose singular value exceeds `share` of the largest (Hansen 1987)."""

    share: float = 0.03  # of the largest singular value; chosen

    def __post_init__(self) -> None:
        if not 0.0 <= self.share < 1.0:
            raise InputError(f"a share of {self.share:g} of the largest singular value is none; give one from 0 to 1")

    def solve(self, system: RegressionSystem) -> RegressionSolution:
        """By the singular values of the scaled matrix."""
        scaled = scale_system(system)
        left, values, right = np.linalg.svd(scaled.matrix, full_matrices=False)
        kept = values > self.share * values[0]
        inverse = np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0)
        found = right.T @ (inverse * (left.T @ scaled.target))
        return RegressionSolution(scaled.unscaled(found), settings={"directions": float(kept.sum())})


@dataclass(frozen=True)
class LeastSquaresSvm:
    """Least-squares support vector machine with linear kernel (Suykens & Vandewalle 1999).

    That is ridge regression with penalty 1/gamma and a constant that is not penalised. gamma: None takes the best over
    contiguous folds.
    """

    gamma: float | None = None

    def __post_init__(self) -> None:
        if self.gamma is not None:
            demand_positive("gamma of the least-squares support vectors", self.gamma)

    def solve(self, system: RegressionSystem) -> RegressionSolution:
        """By the normal equations about the means."""
        scaled = scale_system(system)
        penalty = _best_penalty(scaled, _centred_ridge_path) if self.gamma is None else 1.0 / self.gamma
        found = _centred_ridge_path(scaled.matrix, scaled.target, np.array([penalty]))[0]
        bias = float(np.mean(scaled.target - scaled.matrix @ found))
        return RegressionSolution(scaled.unscaled(found), scaled.target_scale * bias, settings={"gamma": 1.0 / penalty})


@dataclass(frozen=True)
class Lasso:
    """Least squares with a penalty on the coefficients' magnitudes (Tibshirani 1996; Song et al. 2025, eq. (11)).

    Attributes:
        penalties: lambda of eq. (11), of which the best over contiguous folds is taken (eq. (12): 1e-6 to 1e6).
        refit: whether the chosen coefficients are then found by least squares, without the penalty's pull to zero.
        folds: contiguous folds of the cross-validation.
        is_scaled: whether columns and target are brought to unit root mean square; else a penalty acts on the numbers
            as they come, so that a column of small numbers is dropped first.
    """

    penalties: tuple[float, ...] = tuple(PENALTIES)
    refit: bool = False
    folds: int = FOLDS
    is_scaled: bool = True

    def __post_init__(self) -> None:
        if not self.penalties or not all(0.0 <= p < np.inf for p in self.penalties):
            raise InputError(f"Lasso penalties {self.penalties} are none to choose from; give numbers from 0")

    def solve(self, system: RegressionSystem) -> RegressionSolution:
        """Coefficients that the best penalty leaves; 0 for those it drops."""
        scaled = scale_system(system) if self.is_scaled else _as_it_comes(system)
        penalties = np.sort(self.penalties)
        missed = _holdout_errors(scaled, lambda matrix, target: lasso_path(matrix, target, penalties), self.folds)
        best = int(np.argmin(missed))
        found = lasso_path(scaled.matrix, scaled.target, penalties[best : best + 1])[0]
        kept = found != 0.0
        if self.refit and kept.any():
            found[kept] = _least_squares(scaled.matrix[:, kept], scaled.target)
        settings = {"penalty": float(penalties[best]), "coefficients kept": float(kept.sum())}
        return RegressionSolution(scaled.unscaled(found), findings=_dropped_findings(system, kept), settings=settings)


def _as_it_comes(system: RegressionSystem) -> ScaledSystem:
    """The system in its own units."""
    return ScaledSystem(np.ones(len(system.names)), 1.0, system.matrix, system.target)


def solve_with_instruments(system: RegressionSystem, instruments: RegressionSystem) -> RegressionSolution:
    """(Z' Phi)^-1 Z' y with the features Z of a motion free of the measurement's noise (Soderstrom & Stoica 1983).

    Noise in the features pulls least squares towards zero; instruments that share the motion but not its noise do not.
    """
    scaled = scale_system(system)
    z = instruments.matrix / scaled.column_scales
    return RegressionSolution(scaled.unscaled(_solve(z.T @ scaled.matrix, z.T @ scaled.target)))


def _dropped_findings(system: RegressionSystem, is_kept: Array) -> tuple[Finding, ...]:
    names = [n for n, k in zip(system.names, is_kept, strict=True) if not k]
    if not names:
        return ()
    return (
        Finding(Severity.INFO, "lasso-dropped", f"Lasso drops {', '.join(names)} from the {system.title} equation"),
    )  # fmt: skip


def lasso_path(matrix: Array, target: Array, penalties: Array) -> Array:
    """Return coefficients for each penalty, ascending, (penalties, k): exact, along the path (Efron et al. 2004)."""
    from sklearn.linear_model import lars_path_gram

    count = len(target)
    # the path's alpha is that of |residual|^2 / 2n + alpha |coefficients|_1: lambda / 2n
    alphas, _, path = lars_path_gram(matrix.T @ target, matrix.T @ matrix, n_samples=count, method="lasso")[:3]
    wanted = penalties / (2.0 * count)
    return np.stack([np.interp(wanted, alphas[::-1], one[::-1]) for one in path], axis=1)


def _solve(matrix: Array, target: Array) -> Array:
    return np.asarray(np.linalg.solve(matrix, target), dtype=np.float64)


def _least_squares(matrix: Array, target: Array) -> Array:
    return np.asarray(np.linalg.lstsq(matrix, target)[0], dtype=np.float64)


def _ridge_path(matrix: Array, target: Array, penalties: Array) -> Array:
    """Coefficients for each penalty, shape (penalties, k)."""
    gram, moment = matrix.T @ matrix, matrix.T @ target
    return np.array([_solve(gram + penalty * np.eye(len(gram)), moment) for penalty in penalties])


def _centred_ridge_path(matrix: Array, target: Array, penalties: Array) -> Array:
    return _ridge_path(matrix - matrix.mean(axis=0), target - target.mean(), penalties)


def _best_penalty(scaled: ScaledSystem, path: Callable[[Array, Array, Array], Array]) -> float:
    """The penalty that predicts contiguous blocks left out best."""
    missed = _holdout_errors(scaled, lambda matrix, target: path(matrix, target, PENALTIES))
    return float(PENALTIES[int(np.argmin(missed))])


def _holdout_errors(scaled: ScaledSystem, path: Callable[[Array, Array], Array], count: int = FOLDS) -> Array:
    """Sum of squares over contiguous blocks left out, for each of the coefficients (n, k) that `path` gives."""
    missed = []
    for fold in folds(len(scaled.target), min(count, len(scaled.target))):
        found = path(np.delete(scaled.matrix, fold, axis=0), np.delete(scaled.target, fold))
        missed.append(np.sum((scaled.target[fold] - found @ scaled.matrix[fold].T) ** 2, axis=1))
    return np.sum(missed, axis=0)


# Estimators by regression: an operator and an arithmetic, linear support vectors among them.

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
