"""Runs whose simulation leaves all bounds: how long each lasts, and which terms of the equations drive it away."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Divergence, Prediction
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.data.trial.model_table import COMMON_PARTICULARS
from seatrial.numerics.kernels.sensitivity import evaluate_tangent
from seatrial.physics.simulate.replay import first_row_outside, inputs_of, state_limits

MEASURED_FACTOR = 10.0
"""A diverging run is scored until a state exceeds its largest measured magnitude this many times; chosen."""
MAX_TERMS = 4  # terms that are named; chosen: those behind them are small
_LEAST_TERM_SHARE = 0.05  # of the strongest term, below which a term is not named; chosen


def divergence_of(model: Model, record: Record, states: Array) -> Divergence | None:
    """Return where a simulated run leaves its bounds, or None where it lasts.

    Args:
        record: the measured run, whose inputs were used.
        states: simulated, (n, nx), SI; NaN after the simulation has ended.
    """
    if first_row_outside(states, state_limits(model)) is None:
        return None
    limits = _measured_limits(model, record)
    row = first_row_outside(states, limits) or 0
    share = np.where(np.isfinite(states[row]), np.abs(states[row]), np.inf) / limits
    state = model.states[int(np.argmax(share))]
    last = max(row - 1, 0)
    terms = _driving_terms(model, state, states[last], inputs_of(model, record)[last])
    return Divergence(float(record.time[row]), float(record.time[last] - record.time[0]), state, terms)


def _measured_limits(model: Model, record: Record) -> Array:
    """Bounds of the states' magnitudes, (nx,): a multiple of what was measured, where the state was."""
    limits = state_limits(model)
    for i, state in enumerate(model.states):
        largest = float(np.nanmax(np.abs(record[state]), initial=0.0)) if state in record else 0.0
        if largest > 0.0:
            limits[i] = min(limits[i], MEASURED_FACTOR * largest)
    return limits


def _driving_terms(model: Model, state: str, x: Array, u: Array) -> tuple[str, ...]:
    """Coefficients p with p * d(rate)/dp of the state's own sign, the strongest first: what drives it farther away."""
    nx, nu, p = len(model.states), len(model.inputs), model.parameters.values
    rates, jacobian = np.empty((1, nx)), np.zeros((1, nx, nx + nu + len(p)))
    evaluate_tangent(model.compiled.rates_tangent, x[None], u[None], p[None], 0.0, rates, jacobian)
    i = model.states.index(state)
    pull = p * jacobian[0, i, nx + nu :] * np.sign(x[i])
    pull = np.where(np.isfinite(pull), pull, 0.0)
    names = model.parameters.names
    pull[[k for k, name in enumerate(names) if name in COMMON_PARTICULARS]] = 0.0  # they scale every term
    strongest = [int(k) for k in np.argsort(-pull, kind="stable")[:MAX_TERMS]]
    return tuple(names[k] for k in strongest if pull[k] > _LEAST_TERM_SHARE * float(np.max(pull)) and pull[k] > 0.0)


def without_diverged_rows(record: Record, inputs: Sequence[str], divergence: Divergence | None) -> Record:
    """Return the simulated record with NaN from the divergence on; its inputs stay."""
    if divergence is None:
        return record
    is_scored = record.time < divergence.time
    channels = {
        s: c if s in inputs else c.with_values(np.where(is_scored, c.values, np.nan))
        for s, c in record.channels.items()
    }
    return replace(record, channels=channels)


def divergence_finding(model: Model, prediction: Prediction, divergence: Divergence) -> Finding:
    """Return the warning that a run diverges: when, by which terms, and what to do."""
    free = [name for name in divergence.terms if model.parameters[name].free]
    named = enumeration(divergence.terms) if divergence.terms else "no single term"
    index = prediction.extrapolation.index if prediction.extrapolation else 1.0
    is_beyond = index > 1.0 and prediction.role == "validation"
    cures = ["train on a run of this amplitude"] if is_beyond else []
    cures += [f"give priors for {enumeration(free)} or fix them"] if free else []
    cures += (
        [f"correct the fixed value of {enumeration([n for n in divergence.terms if n not in free])}"]
        if (divergence.terms and not free)
        else []
    )
    return Finding(
        Severity.WARNING,
        "diverged",
        f"{prediction.role} run '{prediction.record}' diverges in '{divergence.state}' after {divergence.seconds:g} s, "
        f"driven by the terms of {named}; it is scored up to then",
        f"{divergence.seconds:g} of {prediction.measured.duration:g} s",
        "; or ".join(cures) or "check the model's coefficients and the run's inputs",
    )


def not_predicted_finding(record: Record, error: InputError) -> Finding:
    """Return the warning that a validation run could not be simulated at all, and why; the fit is kept."""
    return Finding(
        Severity.WARNING,
        "not-predicted",
        f"validation run '{record.name}' is not predicted: {error}",
        f"{len(record)} samples",
        "correct the run, or leave it out; the fit does not rest on it",
    )
