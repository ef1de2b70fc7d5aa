"""Null spaces of matrices whose columns have unit norm, and sparse bases of them."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.values import Array, Index

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
