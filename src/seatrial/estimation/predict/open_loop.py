"""Open-loop prediction of a run: initial state from its first seconds, nothing else taken from it."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Measure, Prediction
from seatrial.core.values import Array, Record
from seatrial.estimation.predict.draws import simulated
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.manoeuvres import measures
from seatrial.physics.simulate.bounds import demand_bounded
from seatrial.physics.simulate.channels import inputs_of, record_of


def initial_state(template: OutputError, model: Model, record: Record, own: Array, seconds: float) -> Array:
    """Output-error estimate of the initial state from the first `seconds` of a record, model held, shape (nx,)."""
    beginning = record.between(record.time[0], record.time[0] + max(seconds, 4 * record.dt))
    held = model.with_parameters(model.parameters.fixed(*model.parameters.names))
    data = cut(held, [beginning], template.data.outputs, None)
    problem = replace(template, model=held, data=data, pinned=own, inflation=None)
    found = levenberg_marquardt(problem, own, problem.measured_starts(), evaluations=40)
    known = dict(zip(problem.starts, found.local[0], strict=True))
    return np.array([known.get(s, 0.0) for s in model.states])


@dataclass(frozen=True, eq=False)
class OpenLoop:
    """One run simulated: all observables of the model as channels, and the initial state it began with, (nx,)."""

    record: Record
    start: Array


def open_loop(template: OutputError, model: Model, record: Record, own: Array, seconds: float) -> OpenLoop:
    """The record simulated over its whole length from its inputs.

    Raises:
        InputError: the simulation diverges (which run, which channel, when).
    """
    start = initial_state(template, model, record, own, seconds)
    point = np.array([[model.parameters[n].value for n in template.free]])
    made = as_record(model, record, simulated(template, model, record, start[None], point, own[None])[0])
    demand_bounded(model, record.time, np.stack([made[s] for s in model.states], axis=1), f"run '{record.name}'")
    return OpenLoop(made, start)


def as_record(model: Model, record: Record, y: Array) -> Record:
    """Observables along a record's inputs, shape (rows, observables), as a record."""
    nx = len(model.states)
    return record_of(model, record.name, record.time, y[:, :nx], y[:, nx:], inputs_of(model, record))


def rms(measured: Record, simulated: Record) -> dict[str, float]:
    """Root-mean-square differences: angles in degrees, position and heave in m, u, v in m/s, r in rad/s."""

    def difference(symbol: str) -> Array:
        return simulated[symbol] - measured[symbol]

    made = {}
    if "psi" in measured and "psi" in simulated:
        made["psi_deg"] = float(np.degrees(np.sqrt(np.nanmean(difference("psi") ** 2))))
    if {"x0", "y0"} <= set(measured.channels) & set(simulated.channels):
        made["position_m"] = float(np.sqrt(np.nanmean(difference("x0") ** 2 + difference("y0") ** 2)))
    for symbol, name in (("theta", "theta_deg"), ("phi", "phi_deg")):
        if symbol in measured and symbol in simulated:
            made[name] = float(np.degrees(np.sqrt(np.nanmean(difference(symbol) ** 2))))
    for symbol in ("z", "u", "v", "r"):
        if symbol in measured and symbol in simulated:
            made[symbol] = float(np.sqrt(np.nanmean(difference(symbol) ** 2)))
    return made


def is_steered(record: Record, model: Model) -> bool:
    """Whether manoeuvring measures can be read from the record and from a simulation of it."""
    return {"psi", "delta"} <= set(record.channels) and "psi" in model.states


def compared(record: Record, simulated: Record, length: float) -> dict[str, Measure]:
    """Measures of a run and of its simulation, both at the measured executes."""
    of_measured, of_simulated = measures(record, length), measures(simulated, length, like=record)
    return {k: Measure(of_measured.get(k), of_simulated.get(k)) for k in dict.fromkeys([*of_measured, *of_simulated])}


def prediction(model: Model, record: Record, role: str, made: OpenLoop, seconds: float, length: float) -> Prediction:
    """One run open loop beside its measurement, with rms and manoeuvring measures."""
    pairs = compared(record, made.record, length) if is_steered(record, model) else {}
    return Prediction(record.name, role, record, made.record, rms(record, made.record), pairs, seconds)


def session_means(template: OutputError, shared: Array) -> Array:
    """Mean of each nuisance over the training sessions: what an unseen session is given."""
    return offsets_of(template, shared).mean(axis=0)


def offsets_of(template: OutputError, shared: Array) -> Array:
    """What each training session has of its own, shape (sessions, k)."""
    return shared[len(template.free) :].reshape(len(template.data.sessions), template.kinds)
