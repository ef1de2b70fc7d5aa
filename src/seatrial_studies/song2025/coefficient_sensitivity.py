"""What a coefficient does to a manoeuvre: alone, as sensitivity analyses ask, and once the others may make up for it.

The indirect method changes one coefficient and simulates again. It cannot see that other coefficients do the same: a
large value says that a wrong coefficient changes the motion, not that the record can identify it. The unique part
says that.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record, spelling_hint
from seatrial.physics.simulate import ZERO_STARTS, batch_class, initial_state, inputs_of, replay

RELATIVE_CHANGE = 0.1


@dataclass(frozen=True, eq=False)
class IndirectSensitivity:
    """Relative changes of states for a relative change of one coefficient at a time, divided by it.

    Attributes:
        names: of the k coefficients; states: of the m states; change: the relative change that was made.
        matrix: shape (k, m), one where a state changes by as many per cent as the coefficient; not negative.
        total: over all states, the sum of a row, shape (k,).
    """

    names: tuple[str, ...]
    states: tuple[str, ...]
    change: float
    matrix: Array
    total: Array


@dataclass(frozen=True, eq=False)
class UniqueSensitivity:
    """Rms slopes of states, over their scales, by relative changes of coefficients: alone, and what is left of them.

    Attributes:
        names: of the k coefficients; states: of the m states.
        matrix: of each state by each coefficient alone, shape (k, m).
        total: over all states, the root of the sum of squares of a row, shape (k,).
        unique: of `total` what no change of the other coefficients can undo, shape (k,). total^2 / unique^2 is the
            variance inflation factor; with white noise as scales and n samples, 1 / (sqrt(n) unique) is the
            Cramér-Rao bound of the coefficient's relative standard error (initial state known).
    """

    names: tuple[str, ...]
    states: tuple[str, ...]
    matrix: Array
    total: Array
    unique: Array


def indirect_sensitivity(
    model: Model,
    record: Record,
    names: Sequence[str] | None = None,
    states: Sequence[str] | None = None,
    change: float = RELATIVE_CHANGE,
    initial: Mapping[str, float] | None = None,
) -> IndirectSensitivity:
    """Indirect sensitivities: each coefficient changed, the record's inputs replayed, the states compared over time.

    Song et al. 2025, section 1.3.2, take it from Xu et al. 2013, J. Harbin Eng. Univ. 34, 669, and print neither its
    formula nor the size of the change. Chosen here: 10 %, and for coefficient i and state j

        S_ij = (integral |x_j(a_i + change a_i) - x_j(a_i)| dt / integral |x_j(a_i)| dt) / |change|.

    The inputs stay as recorded: executes do not move as a helmsman's would.

    Args:
        model: all parameters must have values.
        names: coefficients, by default the free ones.
        states: by default all but the pose (x0, y0, psi), whose size depends on where the record begins.
        change: relative, of either sign.
        initial: state -> value where the record's first sample is not to be used.

    Raises:
        InputError: `change` is none, a coefficient is zero, a state does not move, or a simulation diverges; as
            `seatrial.physics.simulate.replay` for the record.
    """
    if not np.isfinite(change) or change == 0.0:
        raise InputError(f"a relative change of {change:g} is none: give one like 0.1 or -0.1")
    wanted, seen = _coefficients(model, names), _states(model, states)
    base = _simulated_states(model, record, initial, seen)
    sizes = _mean_magnitudes(base, seen, record)
    rows = []
    for name in wanted:
        moved = model.with_values({name: model.parameters[name].value * (1.0 + change)})
        try:
            other = _simulated_states(moved, record, initial, seen)
        except InputError as error:
            raise InputError(f"with '{name}' changed by {100.0 * change:+g} %: {error}") from error
        rows.append(_time_mean(np.abs(other - base)) / sizes / abs(change))
    matrix = np.array(rows).reshape(len(wanted), len(seen))
    return IndirectSensitivity(wanted, seen, change, matrix, matrix.sum(axis=1))


def unique_sensitivity(
    model: Model,
    record: Record,
    names: Sequence[str] | None = None,
    scales: Mapping[str, float] | None = None,
    initial: Mapping[str, float] | None = None,
) -> UniqueSensitivity:
    """Return sensitivities from exact slopes of the replayed record, and their parts orthogonal to all others'.

    With c_i the slopes of all states and samples by ln a_i, each state over its scale, unique_i is the rms of
    c_i - C b, b from least squares of c_i on the columns C of the other coefficients: their first-order adjustment. It
    is 1 / sqrt((C'C)^-1_ii) of all columns (partial regression: Belsley, Kuh & Welsch 1980, Regression Diagnostics,
    section 2.1).

    Args:
        names: coefficients, by default the free ones; those left out do not adjust.
        scales: state -> its scale, e.g. its noise, in SI units; by default all states but the pose, each over its mean
            magnitude, as in `indirect_sensitivity`.
        initial: as in `indirect_sensitivity`; it does not adjust.

    Raises:
        InputError: as `indirect_sensitivity`, or a scale is not positive.
    """
    wanted, seen = _coefficients(model, names), _states(model, None if scales is None else list(scales))
    base = _simulated_states(model, record, initial, seen)
    sizes = _mean_magnitudes(base, seen, record) if scales is None else np.array([scales[s] for s in seen])
    if not np.all(np.isfinite(sizes) & (sizes > 0.0)):
        raise InputError(f"the scale of '{seen[int(np.argmin(sizes > 0.0))]}' is not positive")
    slopes = _log_slopes(model, record, initial, wanted, seen) / sizes[:, None]
    matrix = np.sqrt(np.mean(slopes**2, axis=0)).T
    total = np.sqrt(np.sum(matrix**2, axis=1))
    columns = slopes.reshape(-1, len(wanted)) / np.sqrt(len(record))
    return UniqueSensitivity(wanted, seen, matrix, total, orthogonal_parts(columns))


def orthogonal_parts(columns: Array) -> Array:
    """Return the norm of what least squares on all other columns leaves of each, columns (n, k): shape (k,)."""
    lengths = np.linalg.norm(columns, axis=0)
    # the triangle keeps all lengths and angles
    triangle: Array = np.linalg.qr(columns / np.where(lengths > 0.0, lengths, 1.0))[1]
    left = np.empty(len(lengths))
    for i in range(len(lengths)):
        others, own = np.delete(triangle, i, axis=1), triangle[:, i]
        left[i] = np.linalg.norm(own - others @ np.linalg.lstsq(others, own, rcond=None)[0])
    return left * lengths


def _coefficients(model: Model, names: Sequence[str] | None) -> tuple[str, ...]:
    wanted = model.parameters.free_names if names is None else tuple(names)
    for name in wanted:
        if model.parameters[name].value == 0.0:
            raise InputError(f"coefficient '{name}' of model '{model.name}' is zero, which no relative change moves")
    return wanted


def _states(model: Model, states: Sequence[str] | None) -> tuple[str, ...]:
    if states is None:
        return tuple(s for s in model.states if s not in ZERO_STARTS)
    for state in states:
        if state not in model.states:
            raise InputError(f"'{state}' is no state of model '{model.name}'{spelling_hint(state, list(model.states))}")
    return tuple(states)


def _simulated_states(
    model: Model, record: Record, initial: Mapping[str, float] | None, states: tuple[str, ...]
) -> Array:
    return replay(model, record, initial).matrix(states)


def _time_mean(values: Array) -> Array:
    """Mean over the record by the trapezoidal rule, values (n, m): shape (m,)."""
    return 0.5 * np.mean(values[1:] + values[:-1], axis=0)


def _mean_magnitudes(base: Array, states: Sequence[str], record: Record) -> Array:
    """Mean magnitude of each state, shape (m,)."""
    sizes = _time_mean(np.abs(base))
    if not np.all(sizes > 0.0):
        still = states[int(np.argmin(sizes))]
        raise InputError(f"state '{still}' does not move in record '{record.name}': leave it out of `states`")
    return sizes


def _log_slopes(
    model: Model, record: Record, initial: Mapping[str, float] | None, names: tuple[str, ...], states: tuple[str, ...]
) -> Array:
    """Exact slopes of the states by ln of the coefficients, shape (n, m, k)."""
    inputs, start = inputs_of(model, record), initial_state(model, record, initial or {})
    batch = batch_class(model)(model, inputs, np.array([0, len(inputs)]), record.dt, states, names)
    values = model.parameters.values[None]
    _, slopes, _ = batch.differentiate(0, 1, start[None], values, np.empty((1, 0)))
    return slopes * np.array([model.parameters[name].value for name in names])
