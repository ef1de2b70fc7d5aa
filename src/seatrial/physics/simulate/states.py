"""States of a model along a record, as measured: for regression and for starting values."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Array, InputError, Record
from seatrial.numerics.local_polynomials import smoothed_locally
from seatrial.physics.sensors.measured_outputs import is_late
from seatrial.physics.simulate.actuators import actuator_motion, actuator_states
from seatrial.physics.simulate.channels import inputs_of

_WITH_HEADING = ", or positions and heading"  # from which u and v are derived
_SMOOTHING_SAMPLES = 15  # window of the local polynomials, samples; chosen
_LEAST_SAMPLES = 5  # of a window whose cubic is not fixed by its samples
_PERIOD_SHARE = 0.5  # of the period of most power: the longest window along which a cubic follows it; chosen


def _slope(record: Record, symbol: str) -> Array:
    """Derivative by local cubic polynomials (Savitzky & Golay 1964) over 15 samples, fewer where the motion is fast."""
    values = record[symbol]
    width = min(_smoothing_width(values), len(values) - 1 + len(values) % 2)
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


def rest_parameter(model: Model, state: str) -> str:
    """Return the parameter for a state's value at rest, ``phi_0`` of ``phi``; empty where the model has none."""
    name = f"{state}_0"
    return name if state in model.states and name in model.parameters else ""


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
