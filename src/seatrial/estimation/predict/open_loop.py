"""Open-loop prediction of a run: initial state from its first seconds, nothing else taken from it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Divergence, Measure, Prediction
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.data.trial.model_table import COMMON_PARTICULARS
from seatrial.estimation.predict.draws import StartStates
from seatrial.estimation.predict.windows import Windows, simulate_windows, start_states
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.kernels.integrate import evaluate_tangent
from seatrial.physics.manoeuvres import ObservedManoeuvre, measures
from seatrial.physics.manoeuvres.measures import ORDERED_MEASURE
from seatrial.physics.simulate.replay import first_row_outside, inputs_of, record_of, require_bounded, state_limits

# Runs whose simulation leaves all bounds: how long each lasts, and which terms of the equations drive it away.

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
    )


# Open-loop prediction of a run: initial state from its first seconds, nothing else taken from it.

_ERROR_ORDER = ("psi_deg", "position_m", "theta_deg", "phi_deg", "z", "u", "v", "r")


_OF_SPEED = ("approach_speed", "speed_loss", "steady_diameter_L")  # measures that speeds are in


@dataclass(frozen=True, eq=False)
class OpenLoopRun:
    """One run simulated: all observables of the model as channels, and the state it began with.

    Where it diverges (`divergence`), its channels are NaN from there on.
    """

    record: Record
    start: StartStates
    divergence: Divergence | None = None


def simulate_open_loop(
    template: OutputError, model: Model, record: Record, nuisances: Array, seconds: float
) -> OpenLoopRun:
    """Return the record simulated over its whole length from its inputs.

    Raises:
        InputError: the simulation diverges (which run, which channel, when).
    """
    windows = Windows.of_record(record)
    start = start_states(template, model, windows, nuisances[None], seconds)
    y = simulate_windows(template, model, windows, nuisances[None], start.values)[0]
    require_bounded(model, record.time, y[:, : len(model.states)], f"run '{record.name}'")
    return OpenLoopRun(observables_record(model, record, y), start)


def simulate_while_bounded(
    template: OutputError, model: Model, record: Record, nuisances: Array, seconds: float
) -> OpenLoopRun:
    """Return the record simulated from its inputs for as long as it stays within its bounds.

    Raises:
        InputError: it cannot be simulated at all: an input is missing, or fewer than three samples.
    """
    return open_loop_runs(template, model, Windows.of_record(record), nuisances[None], seconds)[0]


def open_loop_runs(
    template: OutputError, model: Model, windows: Windows, nuisances: Array, seconds: float
) -> list[OpenLoopRun]:
    """Return each window simulated from its inputs for as long as it stays within its bounds.

    nuisances: of each run, (runs, k); seconds: of a window's beginning, for its initial state; 0: as measured.

    Raises:
        InputError: as `simulate_while_bounded`.
    """
    starts = start_states(template, model, windows, nuisances, seconds)
    simulated = simulate_windows(template, model, windows, nuisances, starts.values)
    pairs = zip(windows.pieces, simulated, strict=True)
    return [_while_bounded(model, *pair, starts[i : i + 1]) for i, pair in enumerate(pairs)]


def _while_bounded(model: Model, measured: Record, y: Array, start: StartStates) -> OpenLoopRun:
    divergence = divergence_of(model, measured, y[:, : len(model.states)])
    record = without_diverged_rows(observables_record(model, measured, y), model.input_names, divergence)
    return OpenLoopRun(record, start, divergence)


def observables_record(model: Model, record: Record, y: Array) -> Record:
    """Return observables along a record's inputs, shape (rows, observables), as a record."""
    nx = len(model.states)
    return record_of(model, record.name, record.time, y[:, :nx], y[:, nx:], inputs_of(model, record))


def rms_errors(measured: Record, simulated: Record) -> dict[str, float]:
    """Return root-mean-square differences over the samples that were measured and are simulated.

    What is never compared is absent.
    """
    both = set(measured.channels) & set(simulated.channels)
    squares = {s: _mean_square(simulated[s] - measured.measured(s)) for s in both}
    factors = {"psi_deg": ("psi", np.degrees(1.0)), "theta_deg": ("theta", np.degrees(1.0)),
               "phi_deg": ("phi", np.degrees(1.0)), **{s: (s, 1.0) for s in ("z", "u", "v", "r")}}  # fmt: skip
    errors = {name: factor * math.sqrt(squares[s]) for name, (s, factor) in factors.items() if s in both}
    if {"x0", "y0"} <= both and has_moving_track(simulated):
        errors["position_m"] = math.sqrt(squares["x0"] + squares["y0"])
    return {name: errors[name] for name in _ERROR_ORDER if name in errors and np.isfinite(errors[name])}


def has_moving_track(simulated: Record) -> bool:
    """Return whether the simulated position moves at all; that of a model of steering alone does not."""
    spans = [np.ptp(values[np.isfinite(values)]) for s in ("x0", "y0") if np.isfinite(values := simulated[s]).any()]
    return any(span > 0.0 for span in spans)


def _mean_square(errors: Array) -> float:
    """Of the errors where something was measured; NaN without any."""
    finite = errors[np.isfinite(errors)]
    return float(np.mean(finite**2)) if len(finite) else math.nan


def is_steered(record: Record, model: Model) -> bool:
    """Return whether manoeuvring measures can be read from the record and from a simulation of it."""
    return {"psi", "delta"} <= set(record.channels) and model.has_heading


def compare_measures(
    record: Record, simulated: Record, length: float, divergence: Divergence | None = None
) -> dict[str, Measure]:
    """Return measures of a run and of its simulation, both at the measured executes, but for the rudder's order.

    Of a simulation that diverges those are read that lie within the time it lasted. Where speeds were measured by
    positions alone, those of the simulation are over ground as well.
    """
    recognised = ObservedManoeuvre.from_record(record)
    of_measured = measures(record, length, reference=recognised)
    if divergence is None:
        of_simulated = measures(simulated, length, reference=recognised)
        if "u" not in record and {"u", "x0", "y0"} <= set(simulated.channels):
            over_ground = measures(_with_speed_over_ground(simulated), length, reference=recognised)
            of_simulated |= {name: over_ground[name] for name in _OF_SPEED if name in over_ground}
        names = dict.fromkeys([*of_measured, *of_simulated])
    else:
        of_simulated, names = _measures_until(record, simulated, length, divergence), dict.fromkeys(of_measured)
    return {k: Measure(of_measured.get(k), of_simulated.get(k)) for k in names if k != ORDERED_MEASURE}


def _with_speed_over_ground(simulated: Record) -> Record:
    """The simulated record, its velocities those of its track: a current is in them."""
    along, across = (np.gradient(simulated[symbol], simulated.dt) for symbol in ("x0", "y0"))
    surge = simulated.channel("u").with_values(np.hypot(along, across))
    return simulated.without("v").with_channel("u", surge)


def _measures_until(record: Record, simulated: Record, length: float, divergence: Divergence) -> dict[str, float]:
    rows = slice(0, int(np.searchsorted(record.time, divergence.time)))
    if len(record.time[rows]) < 2:
        return {}
    try:
        return measures(simulated.rows(rows), length, reference=record.rows(rows))
    except InputError:  # too little is left of the run
        return {}


def predict_run(
    model: Model, record: Record, role: str, simulation: OpenLoopRun, seconds: float, length: float
) -> Prediction:
    """Return one run open loop beside its measurement, with rms and manoeuvring measures."""
    found = simulation.divergence
    pairs = compare_measures(record, simulation.record, length, found) if is_steered(record, model) else {}
    return Prediction(
        record.name, role, record, simulation.record, rms_errors(record, simulation.record), pairs, seconds,
        divergence=found,
    )  # fmt: skip
