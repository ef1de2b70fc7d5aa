"""Open-loop prediction of a run: initial state from its first seconds, nothing else taken from it."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Measure, Prediction
from seatrial.core.values import Array, Record
from seatrial.estimation.predict.draws import simulate_points
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.manoeuvres import measures
from seatrial.physics.simulate.channels import inputs_of, record_of
from seatrial.physics.simulate.divergence import require_bounded


def estimate_initial_state(
    template: OutputError, model: Model, record: Record, nuisances: Array, seconds: float
) -> Array:
    """Output-error estimate of the initial state from the first `seconds` of a record, model held, shape (nx,)."""
    beginning = record.between(record.time[0], record.time[0] + max(seconds, 4 * record.dt))
    held = model.with_parameters(model.parameters.fixed(*model.parameters.names))
    data = cut_segments(held, [beginning], template.data.outputs, None)
    problem = replace(template, model=held, data=data, pinned=nuisances, inflation=None)
    found = levenberg_marquardt(problem, nuisances, problem.measured_initial_states(), evaluations=40)
    return problem.unpack(nuisances, found.local)[0][0]


@dataclass(frozen=True, eq=False)
class OpenLoopRun:
    """One run simulated: all observables of the model as channels, and the initial state it began with, (nx,)."""

    record: Record
    initial_state: Array


def simulate_open_loop(
    template: OutputError, model: Model, record: Record, nuisances: Array, seconds: float
) -> OpenLoopRun:
    """Return the record simulated over its whole length from its inputs.

    Raises:
        InputError: the simulation diverges (which run, which channel, when).
    """
    start = estimate_initial_state(template, model, record, nuisances, seconds)
    point = np.array([[model.parameters[n].value for n in template.free]])
    simulated = observables_record(
        model, record, simulate_points(template, model, record, start[None], point, nuisances[None])[0]
    )
    require_bounded(model, record.time, np.stack([simulated[s] for s in model.states], axis=1), f"run '{record.name}'")
    return OpenLoopRun(simulated, start)


def observables_record(model: Model, record: Record, y: Array) -> Record:
    """Return observables along a record's inputs, shape (rows, observables), as a record."""
    nx = len(model.states)
    return record_of(model, record.name, record.time, y[:, :nx], y[:, nx:], inputs_of(model, record))


def rms_errors(measured: Record, simulated: Record) -> dict[str, float]:
    """Return root-mean-square differences: angles in degrees, position and heave in m, u, v in m/s, r in rad/s."""

    def difference(symbol: str) -> Array:
        return simulated[symbol] - measured[symbol]

    errors = {}
    if "psi" in measured and "psi" in simulated:
        errors["psi_deg"] = float(np.degrees(np.sqrt(np.nanmean(difference("psi") ** 2))))
    if {"x0", "y0"} <= set(measured.channels) & set(simulated.channels):
        errors["position_m"] = float(np.sqrt(np.nanmean(difference("x0") ** 2 + difference("y0") ** 2)))
    for symbol, name in (("theta", "theta_deg"), ("phi", "phi_deg")):
        if symbol in measured and symbol in simulated:
            errors[name] = float(np.degrees(np.sqrt(np.nanmean(difference(symbol) ** 2))))
    for symbol in ("z", "u", "v", "r"):
        if symbol in measured and symbol in simulated:
            errors[symbol] = float(np.sqrt(np.nanmean(difference(symbol) ** 2)))
    return errors


def is_steered(record: Record, model: Model) -> bool:
    """Return whether manoeuvring measures can be read from the record and from a simulation of it."""
    return {"psi", "delta"} <= set(record.channels) and "psi" in model.states


def compare_measures(record: Record, simulated: Record, length: float) -> dict[str, Measure]:
    """Return measures of a run and of its simulation, both at the measured executes."""
    of_measured, of_simulated = measures(record, length), measures(simulated, length, reference=record)
    return {k: Measure(of_measured.get(k), of_simulated.get(k)) for k in dict.fromkeys([*of_measured, *of_simulated])}


def predict_run(
    model: Model, record: Record, role: str, simulation: OpenLoopRun, seconds: float, length: float
) -> Prediction:
    """Return one run open loop beside its measurement, with rms and manoeuvring measures."""
    pairs = compare_measures(record, simulation.record, length) if is_steered(record, model) else {}
    return Prediction(
        record.name, role, record, simulation.record, rms_errors(record, simulation.record), pairs, seconds
    )


def mean_nuisances(template: OutputError, shared: Array) -> Array:
    """Return the mean of each nuisance over the training sessions: what an unseen session is given."""
    return nuisance_table(template, shared).mean(axis=0)


def nuisance_table(template: OutputError, shared: Array) -> Array:
    """Return what each training session has of its own, shape (sessions, k)."""
    return shared[len(template.free) :].reshape(len(template.data.sessions), template.unknowns_per_session)
