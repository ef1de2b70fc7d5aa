"""Terms that Lasso selects among a model's candidates, judged by runs left out (Song et al. 2025, section 1.3)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.results.term_selection import SelectedTerms, TermSelection
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.regress.estimators import RegressionSystem, assemble_systems, lasso_path
from seatrial.estimation.regress.operators import DerivativeOperator, RegressionMotion, feature_interactions
from seatrial.estimation.regress.samples import folds
from seatrial.physics.models.candidate_structures import candidate_terms, with_candidate_terms

_BLOCKS = 10  # contiguous blocks of a single run, each left out once: ten folds (Song et al. 2025, section 1.3.1)
_PENALTIES = 49  # penalties, evenly in decades; chosen
_LOWEST = 1e-4  # smallest penalty over the largest, at which no term is kept; chosen


def select_terms(model: Model, records: Sequence[Record], operator: DerivativeOperator) -> TermSelection:
    """Return the terms that Lasso keeps of all candidates of a model, equation by equation.

    The candidates are the free coefficients of the model and the terms that its family declares. A penalty is judged by
    the rows of each run left out, which least squares on the terms that it keeps in the others predicts. Of the
    penalties within one standard error of the least error the largest is taken (Breiman et al. 1984, section 3.4.3).

    Args:
        model: at its estimate. Coefficients in which its rates are not linear stay there.
        operator: rows of a run, in place of its derivative.

    Raises:
        InputError: the records do not show every state, no candidate is left, or no run is long enough.
    """
    wide = with_candidate_terms(model)
    wide = wide.with_parameters(wide.parameters.freed(*candidate_terms(wide)))
    motions = [RegressionMotion.from_record(wide, record) for record in records]
    held = _held_for_linearity(wide, motions)
    wide = wide.with_parameters(wide.parameters.fixed(*held))
    if not wide.parameters.free_names:
        raise InputError(f"model '{model.name}' is linear in none of its candidates, as Lasso needs")
    by_run = [assemble_systems(wide, [motion], operator) for motion in motions]
    by_run = [systems for systems in by_run if systems]
    if not by_run:
        raise InputError("no run is long enough for the regression's windows; give longer runs")
    is_one_run = len(by_run) == 1
    equations = tuple(
        selected_terms(_parts(systems[0]) if is_one_run else systems) for systems in zip(*by_run, strict=True)
    )
    unit = f"{_BLOCKS} blocks of the only run" if is_one_run else f"{len(by_run)} runs"
    return TermSelection(equations, unit, tuple(n for n in held if n in model.parameters.free_names))


def _held_for_linearity(model: Model, motions: Sequence[RegressionMotion]) -> tuple[str, ...]:
    """Free coefficients without which the rates are linear in the rest: first those that meet most others."""
    names = list(model.parameters.free_names)
    meets = np.any([feature_interactions(model, motion) for motion in motions], axis=0)
    held = list[str]()
    while meets.any():
        worst = int(np.argmax(np.sum(meets, axis=0) + np.sum(meets, axis=1)))
        held.append(names.pop(worst))
        meets = np.delete(np.delete(meets, worst, axis=0), worst, axis=1)
    return tuple(held)


def _parts(system: RegressionSystem) -> list[RegressionSystem]:
    """A run's system in contiguous blocks."""
    rows = folds(len(system.target), min(_BLOCKS, len(system.target)))
    return [replace(system, matrix=system.matrix[block], target=system.target[block]) for block in rows]


def selected_terms(parts: Sequence[RegressionSystem]) -> SelectedTerms:
    """Return the terms of one set of equations, by parts that are left out one after the other."""
    names = parts[0].names
    matrices, targets = [part.matrix for part in parts], [part.target for part in parts]
    matrix, target = np.concatenate(matrices), np.concatenate(targets)
    scale = np.sqrt(np.mean(matrix**2, axis=0))
    acts = scale > 0.0
    matrix = matrix[:, acts] / scale[acts]
    acting = [name for name, is_acting in zip(names, acts, strict=True) if is_acting]
    largest = 2.0 * float(np.max(np.abs(matrix.T @ target), initial=0.0))  # of eq. (11): nothing is kept there
    penalties = largest * np.geomspace(_LOWEST, 1.0, _PENALTIES)
    errors = np.array([
        _errors_on(part.matrix[:, acts] / scale[acts], part.target, *_without(parts, k, acts, scale), penalties)
        for k, part in enumerate(parts)
    ])  # fmt: skip
    mean, spread = np.mean(errors, axis=0), np.std(errors, axis=0, ddof=1) / np.sqrt(len(parts))
    best = int(np.argmin(mean))
    chosen = int(np.flatnonzero(mean <= mean[best] + spread[best])[-1])
    path = lasso_path(matrix, target, penalties)
    kept = path[chosen] != 0.0
    values = np.zeros(len(acting))
    values[kept] = np.linalg.lstsq(matrix[:, kept], target)[0]
    entry = [int(np.flatnonzero(path[:, k] != 0.0)[-1]) if path[:, k].any() else -1 for k in range(len(acting))]
    order = [k for k in sorted(range(len(acting)), key=lambda k: -entry[k]) if entry[k] >= 0]
    zero = float(np.mean([np.mean(part.target**2) for part in parts]))
    return SelectedTerms(
        equations=parts[0].title,
        candidates=tuple(acting),
        kept=tuple(name for name, is_kept in zip(acting, kept, strict=True) if is_kept),
        values={name: float(v) for name, v, is_kept in zip(acting, values / scale[acts], kept, strict=True) if is_kept},
        order=tuple(acting[k] for k in order),
        penalties=tuple(map(float, penalties)),
        counts=tuple(int(np.count_nonzero(row)) for row in path),
        errors=tuple(float(np.sqrt(e / zero)) for e in mean),
        chosen=chosen,
        best=best,
    )


def _without(parts: Sequence[RegressionSystem], k: int, acts: NDArray[np.bool_], scale: Array) -> tuple[Array, Array]:
    """Rows of all parts but one, columns scaled."""
    rest = [part for i, part in enumerate(parts) if i != k]
    matrix = np.concatenate([part.matrix for part in rest])[:, acts] / scale[acts]
    return matrix, np.concatenate([part.target for part in rest])


def _errors_on(matrix: Array, target: Array, rest: Array, targets: Array, penalties: Array) -> Array:
    """Mean square error of a part's rows by the terms that each penalty keeps in the others, (penalties,)."""
    kept = lasso_path(rest, targets, penalties) != 0.0
    errors = dict[bytes, float]()
    for support in kept:
        if support.tobytes() not in errors:
            values = np.linalg.lstsq(rest[:, support], targets)[0] if support.any() else np.zeros(0)
            errors[support.tobytes()] = float(np.mean((target - matrix[:, support] @ values) ** 2))
    return np.array([errors[support.tobytes()] for support in kept])
