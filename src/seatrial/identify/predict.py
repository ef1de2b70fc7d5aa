"""Open-loop prediction of a run: initial state from its first seconds, nothing else taken from it."""

from dataclasses import replace

import numpy as np

from seatrial.equations import Model
from seatrial.manoeuvres import measures
from seatrial.optimise import levenberg_marquardt
from seatrial.problem.output_error import OutputError
from seatrial.problem.segments import cut
from seatrial.results import Measure, Prediction
from seatrial.simulate.batch import Batch
from seatrial.simulate.bounds import demand_bounded
from seatrial.simulate.channels import record_of
from seatrial.values import Array, Record


def _problem(template: OutputError, model: Model, record: Record, own: Array, outputs: tuple[str, ...]) -> OutputError:
    """The record as one segment with every shared unknown pinned: `own` holds the session's nuisances."""
    held = model.with_parameters(model.parameters.fixed(*model.parameters.names))
    noise = dict(zip(template.data.outputs, template.noise, strict=True))
    data = cut(held, [record], outputs, None)
    return replace(
        template,
        model=held,
        data=data,
        noise=np.array([noise.get(o, 1.0) for o in outputs]),
        pinned=own,
        inflation=None,
    )


def initial_state(template: OutputError, model: Model, record: Record, own: Array, seconds: float) -> dict[str, float]:
    """Output-error estimate of the initial state from the first `seconds` of a record, model held."""
    beginning = record.between(record.time[0], record.time[0] + max(seconds, 4 * record.dt))
    problem = _problem(template, model, beginning, own, template.data.outputs)
    found = levenberg_marquardt(problem, own, problem.measured_starts(), evaluations=40)
    return dict(zip(problem.starts, found.local[0], strict=True))


def open_loop(template: OutputError, model: Model, record: Record, own: Array, seconds: float) -> Record:
    """The record simulated over its whole length from its inputs; all observables of the model as channels.

    Raises:
        InputError: the simulation diverges (which run, which channel, when).
    """
    start = initial_state(template, model, record, own, seconds)
    problem = _problem(template, model, record, own, model.observables)
    local = np.array([[start.get(s, 0.0) for s in problem.starts]])
    x0, values, corrections = problem.unpacked(own, local)
    batch = Batch(problem.model, problem.data.inputs, problem.data.offsets, problem.data.dt, model.observables,
                  corrections=tuple(n.correction for n in template.nuisances), substeps=template.substeps)  # fmt: skip
    y, _ = batch.simulate(0, 1, x0, values, corrections)
    nx = len(model.states)
    demand_bounded(model, record.time, y[:, :nx], f"run '{record.name}'")
    return record_of(model, record.name, record.time, y[:, :nx], y[:, nx:], problem.data.inputs)


def rms(measured: Record, simulated: Record) -> dict[str, float]:
    """Root-mean-square differences: heading in degrees, position in m, u, v in m/s, r in rad/s, as far as measured."""

    def difference(symbol: str) -> Array:
        return simulated[symbol] - measured[symbol]

    made = {}
    if "psi" in measured and "psi" in simulated:
        made["psi_deg"] = float(np.degrees(np.sqrt(np.nanmean(difference("psi") ** 2))))
    if {"x0", "y0"} <= set(measured.channels) & set(simulated.channels):
        made["position_m"] = float(np.sqrt(np.nanmean(difference("x0") ** 2 + difference("y0") ** 2)))
    for symbol in ("u", "v", "r"):
        if symbol in measured and symbol in simulated:
            made[symbol] = float(np.sqrt(np.nanmean(difference(symbol) ** 2)))
    return made


def prediction(
    template: OutputError, model: Model, record: Record, role: str, own: Array, seconds: float, length: float
) -> Prediction:
    """One run open loop beside its measurement, with rms and manoeuvring measures, both at the measured executes."""
    simulated = open_loop(template, model, record, own, seconds)
    steered = {"psi", "delta"} <= set(record.channels) and "psi" in simulated
    of_measured = measures(record, length) if steered else {}
    of_simulated = measures(simulated, length, like=record) if steered else {}
    pairs = {k: Measure(of_measured.get(k), of_simulated.get(k)) for k in dict.fromkeys([*of_measured, *of_simulated])}
    return Prediction(record.name, role, record, simulated, rms(record, simulated), pairs, seconds)


def session_means(template: OutputError, shared: Array) -> Array:
    """Mean of each nuisance over the training sessions: what an unseen session is given."""
    own = shared[len(template.free) :].reshape(len(template.data.sessions), template.kinds)
    return own.mean(axis=0)
