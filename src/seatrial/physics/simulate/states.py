"""States of a model where a run begins: as measured, from its inputs alone, on the straight run of the approach."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.equations.model import RUDDER, ZERO_BY_DEFAULT
from seatrial.core.values import NOTATION, Array, Index, InputError, Record, spelling_hint
from seatrial.physics.sensors.measured_outputs import is_late
from seatrial.physics.simulate.replay import inputs_of

if TYPE_CHECKING:
    from seatrial.physics.simulate.batch import InputCorrection, SegmentBatch

# States that follow the inputs alone (thrusters behind their lags): known from the commands of a run.

_SETTLING_STEP_S = 0.05  # of a simulation until actuators have settled; chosen: the least lag there is
_SETTLING_S = 60.0
"""Time for which the first command of a run counts as given before it [s]: many times any lag; chosen."""


def actuator_states(model: Model) -> tuple[str, ...]:
    """Return the states without a measured channel whose rates hold inputs, parameters and states of this kind only."""
    nx, nu = len(model.states), len(model.inputs)
    unmeasured = {i for i, s in enumerate(model.states) if s not in NOTATION}
    if not unmeasured:
        return ()
    pattern = model.compiled.rates_pattern
    by_state = [{int(k) for i, k in pattern if i == row} for row in range(nx)]
    kept = {i for i in unmeasured if any(nx <= k < nx + nu for k in by_state[i])}
    while True:
        closed = {i for i in kept if all(k in kept for k in by_state[i] if k < nx)}
        if closed == kept:
            return tuple(s for i, s in enumerate(model.states) if i in kept)
        kept = closed


def settled_actuators(model: Model, inputs: Array) -> Array:
    """Return the state (nx,) in which what follows the inputs alone has settled at constant `inputs` (nu,), else 0."""
    from seatrial.physics.simulate.replay import trajectory

    state = np.zeros(len(model.states))
    names = actuator_states(model)
    if names:
        steps, alone = round(_SETTLING_S / _SETTLING_STEP_S), _actuators_only(model, names)
        states, _ = trajectory(alone, np.tile(inputs, (steps + 1, 1)), _SETTLING_STEP_S, np.zeros(len(names)))
        state[[model.states.index(name) for name in alone.states]] = states[-1]
    return state


@dataclass(frozen=True, eq=False)
class ActuatorHistory:
    """The commands of whole runs, from which actuator states follow at the start of each segment.

    Attributes:
        inputs: of all runs, end to end, (rows, nu), each run's first sample repeated before it until things settle.
        offsets: (runs + 1,), where each run's rows begin.
        run, row: of each segment, its run and the row of its first sample, both (segments,).
        session: of each run, (runs,).
        substeps: Runge-Kutta steps in a sample.
        last: what was worked out last, along all runs, and where, by the names of what it is differentiated by;
            None: states.
    """

    model: Model
    inputs: Array
    offsets: Index
    dt: float
    run: Index
    row: Index
    session: Index
    substeps: int = 1
    last: dict[tuple[str, ...] | None, tuple[tuple[Hashable, ...], Array]] = field(default_factory=dict, repr=False)

    @classmethod
    def from_runs(
        cls, model: Model, inputs: Sequence[Array], dt: float, run: Index, first: Index, session: Index
    ) -> "ActuatorHistory | None":
        """Return the history of runs with inputs (rows, nu) each; None where the model has no actuator state.

        first: of each segment, the sample of its run with which it begins; session: of each segment.
        """
        names = actuator_states(model)
        if not names:
            return None
        lead = max(1, round(_SETTLING_S / dt))
        rows = [np.concatenate([np.repeat(u[:1], lead, axis=0), u]) for u in inputs]
        offsets = np.concatenate([[0], np.cumsum([len(r) for r in rows])]).astype(np.int64)
        segments = [np.flatnonzero(run == k) for k in range(len(inputs))]
        of_run = np.array([session[s[0]] if len(s) else 0 for s in segments], dtype=np.int64)
        row = offsets[run] + lead + first
        return cls(_actuators_only(model, names), np.concatenate(rows), offsets, dt, run, row, of_run)

    def selected(self, indices: Index) -> "ActuatorHistory":
        """Return the history for the chosen segments only."""
        return replace(self, run=self.run[indices], row=self.row[indices])

    @cached_property
    def states(self) -> tuple[str, ...]:
        """The actuator states."""
        return self.model.states

    def starts(self, parameters: Array, corrections: Array, kinds: "tuple[InputCorrection, ...]") -> Array:
        """Return the states at the start of each segment, (segments, states).

        parameters: of each session, all of the model's, (sessions, np); corrections: of each session, (sessions, n).
        """
        return self._along_runs(None, parameters, corrections, kinds)[self.row]

    def slopes(
        self, names: tuple[str, ...], parameters: Array, corrections: Array, kinds: "tuple[InputCorrection, ...]"
    ) -> Array:
        """Return the derivatives of `starts` by the named parameters, then by corrections, (segments, states, n)."""
        return self._along_runs(names, parameters, corrections, kinds)[self.row]

    def _along_runs(
        self, names: tuple[str, ...] | None, parameters: Array, corrections: Array, kinds: "tuple[InputCorrection, ...]"
    ) -> Array:
        """States along all runs, or where names are given their derivatives; at one point worked out once."""
        values, of_runs = np.ascontiguousarray(parameters[self.session]), corrections[self.session]
        point = (self.substeps, kinds, values.tobytes(), of_runs.tobytes())
        latest = self.last.get(names)
        if latest is None or latest[0] != point:
            batch = self._batch(names or (), kinds)
            way = 0, batch.segment_count, self._rest, values, of_runs
            latest = point, batch.simulate(*way)[0] if names is None else batch.differentiate(*way)[1]
            self.last[names] = latest
        return latest[1]

    @property
    def _rest(self) -> Array:
        return np.zeros((len(self.offsets) - 1, len(self.model.states)))

    def _batch(self, names: tuple[str, ...], kinds: "tuple[InputCorrection, ...]") -> "SegmentBatch":
        from seatrial.physics.simulate.batch import SegmentBatch

        return SegmentBatch(
            self.model, self.inputs, self.offsets, self.dt, self.model.states, names, kinds, (), self.substeps
        )


def actuator_motion(model: Model, inputs: Array, dt: float) -> dict[str, Array]:
    """Return the actuator states along inputs (n, nu), (n,) each, at the model's values; what is NaN diverged."""
    from seatrial.physics.simulate.batch import error_over_range, sufficient_substeps

    run = np.zeros(1, dtype=np.int64)
    history = ActuatorHistory.from_runs(model, (inputs,), dt, run, run, run)
    if history is None:
        return {}
    every = replace(history, run=np.zeros(len(inputs), dtype=np.int64), row=history.row[0] + np.arange(len(inputs)))

    def motion(substeps: int) -> Array:
        return replace(every, substeps=substeps).starts(model.parameters.values[None], np.zeros((1, 0)), ())

    columns = motion(sufficient_substeps(motion, error_over_range))
    return dict(zip(every.states, columns.T, strict=True))


def _actuators_only(model: Model, names: tuple[str, ...]) -> Model:
    """The equations of these states alone, with all parameters."""
    equations = model.equations
    rates = tuple(rate for rate in equations.rates if rate.name in names)
    return replace(model, equations=replace(equations, name=f"{equations.name}, actuators", rates=rates, outputs=()))


# The straight run before a manoeuvre: inputs that are held, the steady speed, the time to travel one's own length.

_SPEEDS = np.geomspace(1e-3, 1e2, 60)  # m/s; grid that brackets a speed, up to what guards against a wrong unit; chosen
_SEARCHED = np.geomspace(1e-3, 1e3, 121)  # propulsion over speed, m/s or rps: twenty a decade; chosen


def held_inputs(model: Model, values_by_name: Mapping[str, float], rudder: str) -> Array:
    """Return constant inputs in the model's signs, shape (nu,), rudder amidships; absent wind channels mean still air.

    Raises:
        InputError: an input is missing, unknown, or the rudder is among those given.
    """
    known = [name for name in model.input_names if name != rudder]
    for name in values_by_name:
        if name not in known:
            raise InputError(f"'{name}' is no held input of model '{model.name}'{spelling_hint(name, known)}")
    values = np.zeros(len(model.inputs))
    for j, item in enumerate(model.inputs):
        if item.name in values_by_name:
            values[j] = -values_by_name[item.name] if item.is_reversed else values_by_name[item.name]
        elif item.name != rudder and item.name not in ZERO_BY_DEFAULT:
            raise InputError(f"model '{model.name}' needs the input '{item.name}'; give the value it is held at")
    return values


def approach_speed(model: Model, held: Array) -> float:
    """Return the speed u [m/s] at which surge is in balance on a straight course without drift."""
    from scipy.optimize import brentq

    from seatrial.numerics.kernels.integrate import evaluate

    place, parameters = model.states.index("u"), model.parameters.values
    state, rates = settled_actuators(model, held), np.empty(len(model.states))

    def surge(u: float) -> float:
        state[place] = u
        model.compiled.rates(0.0, state, held, parameters, rates)
        return float(rates[place])

    states, inputs = np.tile(state, (len(_SPEEDS), 1)), np.tile(held, (len(_SPEEDS), 1))
    states[:, place] = _SPEEDS
    table = np.empty_like(states)
    evaluate(model.compiled.rates, states, inputs, parameters, 0.0, table)
    gains = table[:, place] > 0.0
    balanced = np.flatnonzero(gains[:-1] & (table[1:, place] <= 0.0))
    if not balanced.size:
        raise InputError(
            f"model '{model.name}' has no steady speed ahead with these inputs; state the approach speed in m/s: "
            "--speed on the command line, speed= in Python"
        )
    return float(brentq(surge, *_SPEEDS[balanced[0] : balanced[0] + 2], xtol=1e-12))  # m/s of rounding; chosen


def balancing_input(model: Model, held: Array, name: str, speed: float) -> float:
    """Return the input at which surge is in balance on a straight course at u = `speed` [m/s], the others as held.

    Raises:
        InputError: there is none.
    """
    from scipy.optimize import brentq

    place, k = model.input_names.index(name), model.states.index("u")
    inputs, rates = held.copy(), np.empty(len(model.states))

    def surge(value: float) -> float:
        inputs[place] = value
        state = settled_actuators(model, inputs)
        state[k] = speed
        model.compiled.rates(0.0, state, inputs, model.parameters.values, rates)
        return float(rates[k])

    tried = _SEARCHED * speed
    least = next((i for i, value in enumerate(tried) if surge(value) > 0.0), 0)
    if least == 0:
        raise InputError(
            f"model '{model.name}' has no '{name}' that drives the ship at {speed:.4g} m/s; take another speed"
        )
    return float(brentq(surge, tried[least - 1], tried[least], xtol=1e-12))  # of the propulsion: rounding


def straight_run(model: Model, plan: Record, speed: float | None = None) -> dict[str, float]:
    """Return where a planned record starts: on a straight course at u = `speed`, thrusters at rest, all else zero.

    Without a speed it is the one at which surge balances with the plan's first inputs, rudder amidships; a craft with
    thrusters starts at rest.
    """
    start = dict.fromkeys(model.states, 0.0)
    if "u" in start and speed is not None:
        start["u"] = speed
    elif "u" in start and not model.has_thrusters:
        first = inputs_of(model, plan)[0].copy()
        first[[name == RUDDER for name in model.input_names]] = 0.0
        start["u"] = approach_speed(model, first)
    return start


def characteristic_time(model: Model, start: Array, given_speed: float | None, length: float = 0.0) -> float:
    """L/U [s] from the start's u, the speed given, or the model's parameter U; else a Nomoto model's time constant.

    length: L [m] where it is no parameter of the model.
    """
    parameters = model.parameters
    length = parameters.value_of("L", length)
    speed = float(start[model.states.index("u")]) if model.has_speed else given_speed or parameters.value_of("U", 0.0)
    if length > 0.0 and speed > 0.0:
        return length / speed
    for constant in ("T", "T_1"):
        if constant in parameters:
            return parameters[constant].value
    raise InputError(f"model '{model.name}': the approach speed must be positive, and its parameters must give L")


# States of a model along a record, as measured: for regression and for starting values.

_WITH_HEADING = ", or positions and heading"  # from which u and v are derived
_SMOOTHING_SAMPLES = 15  # window of the local polynomials, samples; chosen
_LEAST_SAMPLES = 5  # of a window whose cubic is not fixed by its samples
_PERIOD_SHARE = 0.5  # of the period of most power: the longest window along which a cubic follows it; chosen


def _slope(record: Record, symbol: str) -> Array:
    """Derivative by local cubic polynomials (Savitzky & Golay 1964) over 15 samples, fewer where the motion is fast."""
    from seatrial.numerics.local_polynomials import smoothed_locally

    values = record[symbol]
    width = min(_smoothing_width(values), len(values) - 1 + len(values) % 2)
    if width == 1:
        raise InputError(f"record '{record.name}': {len(values)} samples show no rate of '{symbol}'; give a longer one")
    return smoothed_locally(values, width, min(3, width - 1), 1, record.dt)


def _smoothing_width(values: Array) -> int:
    """Return the samples of a window, odd: no more of them than a share of the period at which values vary most."""
    known = values[np.isfinite(values)]
    power = np.abs(np.fft.rfft(known - known.mean())) if len(known) else np.zeros(1)
    cycles = int(np.argmax(power))
    longest = int(_PERIOD_SHARE * len(known) / cycles) if cycles else _SMOOTHING_SAMPLES
    return min(max(longest - 1 + longest % 2, _LEAST_SAMPLES), _SMOOTHING_SAMPLES)


def hidden_states(model: Model, records: Sequence[Record]) -> tuple[str, ...]:
    """States that no instrument shows, no record holds and that do not follow the inputs alone."""
    hidden = tuple(s for s in model.states if s not in NOTATION and not is_late(s) and not all(s in r for r in records))
    following = actuator_states(model) if hidden else ()
    return tuple(s for s in hidden if s not in following)


def unobserved_states(model: Model, record: Record) -> tuple[str, ...]:
    """States of the model that the record neither holds nor implies."""
    found = _available_states(model, record)
    return tuple(s for s in model.states if s not in found)


def measured_states(model: Model, record: Record) -> Array:
    """States as columns, shape (n, nx); u, v, r are derived from positions and heading where they were not measured.

    Raises:
        InputError: a state is neither measured nor derivable.
    """
    found = _available_states(model, record)
    missing = [s for s in model.states if s not in found]
    if missing:
        raise InputError(
            f"record '{record.name}' neither holds nor implies '{missing[0]}', "
            f"which model '{model.name}' needs; add the channel{_WITH_HEADING if missing[0] in 'uv' else ''}"
        )
    columns = np.stack([found[s] for s in model.states], axis=1)
    return np.ascontiguousarray(np.where(np.isfinite(columns), columns, 0.0))


def _available_states(model: Model, record: Record) -> dict[str, Array]:
    """What the record holds or implies of the model's states, (n,) each."""
    found: dict[str, Array] = {s: record[s] for s in model.states if s in record}
    if "r" not in found and "psi" in record:
        found["r"] = _slope(record, "psi")
    if "p" not in found and "phi" in record:
        found["p"] = _slope(record, "phi")
    if "psi" not in found and "r" in found:
        found["psi"] = np.concatenate([[0.0], np.cumsum(0.5 * record.dt * (found["r"][1:] + found["r"][:-1]))])
    if not {"u", "v"} <= set(found) and {"x0", "y0", "psi"} <= set(record.channels):
        north, east, psi = _slope(record, "x0"), _slope(record, "y0"), record["psi"]
        found.setdefault("u", north * np.cos(psi) + east * np.sin(psi))
        found.setdefault("v", -north * np.sin(psi) + east * np.cos(psi))
    for rate in model.states:
        if rate.endswith("_dot") and rate not in found and rate.removesuffix("_dot") in record:
            found[rate] = _slope(record, rate.removesuffix("_dot"))
    if any(s not in NOTATION and s not in found for s in model.states):
        found = actuator_motion(model, inputs_of(model, record), record.dt) | found
    for state in model.states:
        if is_late(state) and state.split("_")[0] in found:
            found.setdefault(state, found[state.split("_")[0]])
    for unused in ("x0", "y0"):
        found.setdefault(unused, np.zeros(len(record)))
    return found
