"""Open-loop prediction of a run: initial state from its first seconds, nothing else taken from it."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Divergence, Measure, Prediction
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.predict.divergence import divergence_of, without_diverged_rows
from seatrial.estimation.predict.draws import StartStates
from seatrial.estimation.predict.start_states import start_states
from seatrial.estimation.predict.windows import Windows, simulate_windows
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.manoeuvres import ObservedManoeuvre, measures
from seatrial.physics.manoeuvres.measures import ORDERED_MEASURE
from seatrial.physics.simulate.replay import inputs_of, record_of, require_bounded

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
    return {"psi", "delta"} <= set(record.channels) and "psi" in model.states


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
