"""The linear systems of a regression: equations that share no coefficient stand apart."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.estimation.regress.features import RegressionMotion
from seatrial.estimation.regress.operators import DerivativeOperator, RegressionRows

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
