"""The conditions under which a change of parameters leaves the compared outputs as they are."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.equations.model import MEASURED
from seatrial.core.values import NOTATION, Array, Index, InputError
from seatrial.numerics.kernels.integrate import evaluate_tangent

# Null spaces of matrices whose columns have unit norm, and sparse bases of them.

SINGULAR = 1e-11
"""Singular values below this, of columns with unit norm, count as zero: rounding gives 1e-15, real ones 1e-6 and up."""

# relative rounding levels: of a member, pivots first and last, independence; orders of columns tried
_PRESENT, _PIVOT, _LAST_PIVOT, _DISTINCT, _ORDERS = 1e-8, 1e-4, 1e-9, 1e-6, 40


def column_span(columns: Array) -> Array:
    """Orthonormal basis of the columns."""
    norms = np.linalg.norm(columns, axis=0)
    vectors, singular, _ = np.linalg.svd(columns[:, norms > 0.0] / norms[norms > 0.0], full_matrices=False)
    return vectors[:, singular > SINGULAR]


def null_space(effects: Array) -> Array:
    """Orthonormal null vectors of columns of unit norm, shape (columns, nullity)."""
    if effects.shape[1] == 0:
        return np.empty((0, 0))
    triangle = np.linalg.qr(effects, mode="r")
    singular, vectors = np.linalg.svd(triangle)[1:]
    return vectors[np.concatenate([singular, np.zeros(len(vectors) - len(singular))]) < SINGULAR].T


def sparse_basis(null: Array, known_vectors: Sequence[Array] = ()) -> list[Array]:
    """Null vectors with few members that complete `known_vectors` to a basis of the null space; rounding in the others.

    Rows of reduced echelon forms for many orders of the columns have minimal support (circuits of the column matroid,
    Oxley 2011, Matroid Theory, section 1.2); the shortest independent ones are taken.
    """
    taken = [null.T @ g for g in known_vectors]
    chosen: list[Array] = []
    rank = np.linalg.matrix_rank(np.array(taken), tol=_DISTINCT) if taken else 0
    for vector in _minimal_null_vectors(null):
        if rank == null.shape[1]:
            break
        trial = [*taken, null.T @ vector]
        if np.linalg.matrix_rank(np.array(trial), tol=_DISTINCT) > rank:
            taken, rank = trial, rank + 1
            chosen.append(vector)
    return chosen


def _minimal_null_vectors(null: Array) -> list[Array]:
    """Distinct null vectors of minimal support and unit norm, shortest first, then in the order of the columns."""
    rng = np.random.default_rng(1)
    found: dict[tuple[int, ...], Array] = {}
    for k in range(_ORDERS if null.shape[1] > 1 else 1):
        for row in _reduced_echelon_form(null.T, np.arange(len(null)) if k == 0 else rng.permutation(len(null))):
            members = np.flatnonzero(np.abs(row) > _PRESENT * np.abs(row).max())
            found.setdefault(tuple(int(i) for i in members), row / np.linalg.norm(row))
    return [found[key] for key in sorted(found, key=lambda members: (len(members), members))]


def _reduced_echelon_form(matrix: Array, order: Index) -> Array:
    """Reduced echelon form with pivots in this order of the columns, as far as they are not small."""
    rows, at = matrix.copy(), 0
    for threshold in (_PIVOT, _LAST_PIVOT):
        for column in order:
            if at == len(rows):
                return rows
            best = at + int(np.argmax(np.abs(rows[at:, column])))
            if abs(rows[best, column]) < threshold * np.abs(rows[at:]).max():
                continue
            rows[[at, best]] = rows[[best, at]]
            rows[at] /= rows[at, column]
            others = np.arange(len(rows)) != at
            rows[others] -= np.outer(rows[others, column], rows[at])
            at += 1
    return rows[:at]


# The conditions under which a change of parameters leaves the compared outputs as they are, as linear equations.

_POINTS, _ATTEMPTS = 300, 6  # random states, and attempts to get as many with finite rates; chosen
# least and largest size of random values by unit: those of ships and models
_RANGES = {"m/s": (0.03, 10.0), "rad/s": (1e-3, 0.3), "rps": (0.1, 30.0)}
_ORDINARY = (0.05, 20.0)  # the same for other units, SI; chosen
_COMPENSATING = 1e-7  # share of a hidden coefficient in a compensation: rounding is less
_CAPTIVE_MOTION, _CALM_INPUTS = ("u", "v", "r"), ("wind_speed", "wind_direction")


@dataclass(frozen=True, eq=False)
class InvarianceConditions:
    """The conditions at random states and inputs, for one model and one set of compared outputs.

    Attributes:
        compared_states, hidden_states: indices of states that reach a compared output, compared themselves or not.
        compared_outputs: indices of those that are no states.
        forces: bindings that captive tests measure at motions that are known.
        entering_parameters: indices of the parameters that stand in an equation which reaches a compared output.
        states, inputs: (points, nx), (points, nu), SI.
    """

    model: Model
    compared_states: tuple[int, ...]
    hidden_states: tuple[int, ...]
    compared_outputs: tuple[int, ...]
    forces: tuple[str, ...]
    entering_parameters: frozenset[int]
    states: Array
    inputs: Array

    @property
    def outputs(self) -> tuple[str, ...]:
        """What is compared."""
        return (
            *(self.model.states[i] for i in self.compared_states),
            *(self.model.outputs[i].removesuffix(MEASURED) for i in self.compared_outputs),
        )

    @property
    def compared_quantities(self) -> tuple[str, ...]:
        """What is compared, forces included."""
        return (*self.outputs, *self.forces)

    @property
    def hidden_names(self) -> tuple[str, ...]:
        """States that matter and are not compared."""
        return tuple(self.model.states[i] for i in self.hidden_states)

    def effects(self, values: Array, sizes: Array) -> Array:
        """The conditions as columns of unit norm, one a parameter, shape (rows, parameters); silent ones stay zero.

        sizes: (parameters,), the unit of each change, SI. What a change of hidden states can make up for is projected
        out, so that the null space holds parameters only.
        """
        return self._columns(values, sizes)[0]

    def null_vector(self, values: Array, sizes: Array, members: Sequence[int]) -> Array | None:
        """The change of the members, SI, that nothing shows; None where there is none, or more than one."""
        vector, count = self.least_visible_change(values, sizes, members)
        return vector if count == 1 else None

    def least_visible_change(self, values: Array, sizes: Array, members: Sequence[int]) -> tuple[Array, int]:
        """The change of the members, SI, that shows least, and how many independent ones do not show at all."""
        effects, norms = self._columns(values, sizes)
        own = list(members)
        _, singular, vectors = np.linalg.svd(effects[:, own], full_matrices=False)
        scale = sizes[own] / np.where(norms[own] > 0.0, norms[own], 1.0)
        return vectors[-1] * scale, int(np.count_nonzero(singular < SINGULAR))

    def residual(self, values: Array, change: Array) -> tuple[float, tuple[str, ...]]:
        """How far a change (parameters,), SI, breaks the conditions, relative, and the hidden states that help it."""
        raw, moved = self._condition_matrices(values)
        parts = raw * change
        usable = np.isfinite(parts).all(axis=1) & np.isfinite(moved).all(axis=1)
        parts, moved = parts[usable], moved[usable]
        size, left = np.linalg.norm(parts), parts.sum(axis=1)
        if size == 0.0:
            return 0.0, ()
        norms = np.maximum(np.linalg.norm(moved, axis=0), 1e-300)  # above zero, for a division
        weights = np.linalg.lstsq(moved / norms, left, rcond=SINGULAR)[0]
        share = (
            np.abs(weights)
            .reshape(len(self.hidden_states), 1 + len(self.compared_states) + len(self.hidden_states))
            .max(axis=1)
            / size
        )
        helping = tuple(n for n, s in zip(self.hidden_names, share, strict=True) if s > _COMPENSATING)
        return float(np.linalg.norm(left - moved / norms @ weights) / size), helping

    def _columns(self, values: Array, sizes: Array) -> tuple[Array, Array]:
        raw, moved = self._condition_matrices(values)
        with np.errstate(over="ignore", invalid="ignore"):
            raw = raw * sizes
            length = np.sqrt(np.sum(raw**2, axis=1) + np.sum(moved**2, axis=1))
        usable = np.isfinite(length) & (length > 0.0)
        raw, moved = raw[usable] / length[usable, None], moved[usable] / length[usable, None]
        norms = np.linalg.norm(raw, axis=0)
        unit = raw / np.where(norms > 0.0, norms, 1.0)
        span = column_span(moved)
        return unit - span @ (span.T @ unit), norms

    def _condition_matrices(self, values: Array) -> tuple[Array, Array]:
        """Conditions by parameters (rows, P) and by coefficients of xi (rows, hidden * (1 + states))."""
        reaching = (*self.compared_states, *self.hidden_states)
        f, f_jac, g_jac = _jacobians(self.model, self.states, self.inputs, values)
        jac = np.concatenate([f_jac[:, reaching], g_jac[:, self.compared_outputs]], axis=1)
        rows, first = jac.shape[0] * jac.shape[1], len(self.model.states) + len(self.model.inputs)
        by_hidden = []
        for h in self.hidden_states:
            for j in (None, *reaching):
                column = jac[:, :, h] * (1.0 if j is None else self.states[:, j, None])
                if j is not None:
                    with np.errstate(invalid="ignore"):
                        column[:, reaching.index(h)] -= f[:, j]
                by_hidden.append(column.ravel())
        captive = _captive_force_jacobian(self.model, self.forces, self.states, self.inputs, values)
        moved = np.array(by_hidden).reshape(-1, rows).T
        still = np.zeros((len(captive), moved.shape[1]))
        return np.concatenate([jac[:, :, first:].reshape(rows, -1), captive]), np.concatenate([moved, still])


def invariance_conditions(
    model: Model, outputs: Sequence[str], values: Array, forces: Sequence[str] = ()
) -> InvarianceConditions:
    """The conditions for these compared outputs (states or outputs of the model).

    forces: bindings that captive tests measure as well.
    values: (parameters,), SI; a factor that is zero there lets nothing through, so a state behind it reaches no output.

    Raises:
        InputError: an output the model does not have, none at all, or a parameter without a value.
    """
    if not outputs:
        names = ", ".join(model.observables)
        raise InputError(f"model '{model.name}': no output is compared; name at least one of {names}")
    for name in outputs:
        if name not in model.observables:
            raise InputError(f"model '{model.name}' has no output '{name}'; it has {', '.join(model.observables)}")
    if model.parameters.missing:
        raise InputError(
            f"model '{model.name}' needs values of {', '.join(model.parameters.missing)}; "
            "give them under [ship] or [model.fixed]"
        )
    shown = {model.observable_of(name) for name in outputs}
    seen = tuple(i for i, n in enumerate(model.states) if n in shown)
    compared = tuple(i for i, n in enumerate(model.outputs) if n in shown)
    states, inputs = _random_points(model, values)
    code, nx = model.compiled, len(model.states)
    f_jac, g_jac = _jacobians(model, states, inputs, values)[1:]
    written = _influencing_states(seen, compared, code.rates_pattern, code.outputs_pattern, nx)
    felt = _influencing_states(seen, compared, np.argwhere(f_jac.any(axis=0)), np.argwhere(g_jac.any(axis=0)), nx)
    first = nx + len(model.inputs)
    rates = code.rates_pattern[np.isin(code.rates_pattern[:, 0], list(written))]
    made = code.outputs_pattern[np.isin(code.outputs_pattern[:, 0], compared)]
    entering = {int(c) - first for _, c in (*rates, *made) if c >= first}
    entering |= {
        int(i) for i in np.flatnonzero(_captive_force_jacobian(model, forces, states, inputs, values).any(axis=0))
    }
    hidden = tuple(sorted(felt - {*seen}))
    return InvarianceConditions(model, seen, hidden, compared, tuple(forces), frozenset(entering), states, inputs)


def _captive_force_jacobian(model: Model, forces: Sequence[str], states: Array, inputs: Array, values: Array) -> Array:
    """Forces by parameters (rows, parameters) of a captive ship: at these u, v, r, heading north, in still air."""
    if not forces:
        return np.empty((0, len(values)))
    x = np.where([n in _CAPTIVE_MOTION for n in model.states], states, 0.0)
    u = np.where([n in _CALM_INPUTS for n in model.input_names], 0.0, inputs)
    n, first = len(x), len(model.states) + len(model.inputs)
    jac = np.zeros((n, len(forces), first + len(values)))
    tangent = model.compiled.tangent_function(tuple(forces))
    evaluate_tangent(tangent, x, u, np.tile(values, (n, 1)), 0.0, np.empty((n, len(forces))), jac)
    return jac[:, :, first:].reshape(-1, len(values))


def _jacobians(model: Model, states: Array, inputs: Array, values: Array) -> tuple[Array, Array, Array]:
    """Rates (points, nx), their Jacobian (points, nx, columns) and that of the outputs, columns [x | u | p]."""
    code, n, ng = model.compiled, len(states), len(model.outputs)
    width = len(model.states) + len(model.inputs) + len(values)
    p, f, f_jac = np.tile(values, (n, 1)), np.empty_like(states), np.zeros((n, states.shape[1], width))
    g_jac = np.zeros((n, ng, width))
    evaluate_tangent(code.rates_tangent, states, inputs, p, 0.0, f, f_jac)
    if ng:
        evaluate_tangent(code.outputs_tangent, states, inputs, p, 0.0, np.empty((n, ng)), g_jac)
    return f, f_jac, g_jac


def _influencing_states(
    compared_states: Sequence[int], compared_outputs: Sequence[int], rates: Index, outputs: Index, nx: int
) -> set[int]:
    """States that reach a compared output by the (row, column) pairs of rates and outputs."""
    found = {*compared_states} | {int(c) for r, c in outputs if r in compared_outputs and c < nx}
    while more := {int(c) for r, c in rates if r in found and c < nx} - found:
        found |= more
    return found


def _random_points(model: Model, values: Array) -> tuple[Array, Array]:
    """Random states and inputs at which everything is finite; positive ones where roots or logarithms demand it.

    Raises:
        InputError: hardly any can be found.
    """
    rng = np.random.default_rng(0)
    kept_x, kept_u, count = [], [], 0
    for attempt in range(_ATTEMPTS):
        x, u = _random_values(model.states, rng), _random_values(model.input_names, rng)
        if attempt >= _ATTEMPTS // 2:
            x = np.abs(x)
        f, f_jac, g_jac = _jacobians(model, x, u, values)
        good = np.isfinite(f).all(axis=1) & np.isfinite(f_jac).all(axis=(1, 2)) & np.isfinite(g_jac).all(axis=(1, 2))
        kept_x.append(x[good])
        kept_u.append(u[good])
        count += int(np.count_nonzero(good))
        if count >= _POINTS:
            break
    if count < _POINTS // 10:
        raise InputError(
            f"model '{model.name}' gives no finite rates at ordinary states and inputs; "
            "guard its roots, logarithms and denominators"
        )
    return np.concatenate(kept_x)[:_POINTS], np.concatenate(kept_u)[:_POINTS]


def _random_values(names: Sequence[str], rng: np.random.Generator) -> Array:
    """Random values over the decades of each channel, both signs; angles all round."""
    columns = [np.empty((_POINTS, 0))]
    for name in names:
        unit = NOTATION[name].unit if name in NOTATION else "1"
        low, high = np.log(_RANGES.get(unit, _ORDINARY))
        turn, size = rng.uniform(-np.pi, np.pi, _POINTS), np.exp(rng.uniform(low, high, _POINTS))
        columns.append((turn if unit == "rad" else np.copysign(size, turn))[:, None])
    return np.ascontiguousarray(np.concatenate(columns, axis=1))
