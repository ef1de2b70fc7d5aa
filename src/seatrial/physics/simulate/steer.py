"""A programme steered through a model: zigzags, turning circles and the rest, with the helmsman in the loop."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Provenance, Record, frozen
from seatrial.core.values.record import MAX_SAMPLES
from seatrial.numerics.kernels.feedback import steer
from seatrial.physics.manoeuvres.helmsman import FINISHED, NOT_FINISHED, Steering, rudder_angles
from seatrial.physics.manoeuvres.programme import Programme
from seatrial.physics.simulate.actuators import settled_actuators
from seatrial.physics.simulate.approach import RUDDER, approach_speed, characteristic_time, held_inputs
from seatrial.physics.simulate.channels import record_of
from seatrial.physics.simulate.divergence import require_bounded
from seatrial.physics.simulate.replay import trajectory

# 35 deg to 30 deg on the other side in 28 s: SOLAS, chapter II-1, regulation 29.3.2
SOLAS_SLEW_RATE = math.radians(65.0 / 28.0)


def manoeuvre(
    model: Model,
    programme: Programme,
    *,
    dt: float = 0.1,
    duration: float | None = None,
    speed: float | None = None,
    inputs: Mapping[str, float] | None = None,
    slew_rate: float = SOLAS_SLEW_RATE,
    approach: float = 0.0,
    length: float = 0.0,
) -> Record:
    """Steer `programme` from a straight run.

    The rudder angles the helmsman gave are then replayed linear between samples, so that replaying the returned record
    repeats it to the last bit.

    Args:
        model: needs the input ``delta`` and the state ``psi``; all parameters must have values.
        programme: from `manoeuvres.programme`.
        dt: step and sample interval [s].
        duration: s, at the longest; by default the programme's own in ship lengths, and it ends when finished.
        speed: approach speed u [m/s]; by default the speed at which the surge equation balances, rudder amidships.
        inputs: the other inputs, held constant, by name in SI units and notation signs (``n``, ``v_j``); wind is zero.
        slew_rate: of the rudder [rad/s]; by default SOLAS's for ships at full scale.
        approach: s before the first execute.
        length: of a craft [m] whose model has no parameter ``L``.

    Returns:
        A simulated record of states, outputs and inputs from the start of the approach.

    Raises:
        InputError: an input is missing or unknown, no steady speed exists, or the simulation diverges.
    """
    _require_steerable(model, dt, slew_rate)
    held = held_inputs(model, inputs or {}, RUDDER)
    start = settled_actuators(model, held)
    if "u" in model.states:
        start[model.states.index("u")] = approach_speed(model, held) if speed is None else speed
    unit = characteristic_time(model, start, given_speed=speed, length=length)
    longest = approach + programme.maximum_lengths * unit if duration is None else duration
    rudder = model.input_names.index(RUDDER)
    steering = Steering(
        model.states.index("psi"), model.states.index("r") if "r" in model.states else -1,
        rudder, -1.0 if model.inputs[rudder].is_reversed else 1.0, slew_rate, dt, approach, unit,
    )  # fmt: skip
    used, finished = _steer_programme(model, programme, steering, start, held, longest)
    time = frozen(dt * np.arange(len(used)))
    # Record.dt's own quotient, so that a replay takes the same steps to the last bit
    states, outputs = trajectory(model, used, float(time[-1] - time[0]) / (len(time) - 1), start)
    require_bounded(model, time, states, f"manoeuvre '{programme.text}'")
    made = record_of(model, programme.text, time, states, outputs, used)
    ending = f"finished at {time[-1]:g} s" if finished else f"not finished after {time[-1]:g} s"
    steps = (f"rudder slews at {math.degrees(slew_rate):g} deg/s", ending)
    return replace(made, provenance=Provenance(f"manoeuvre '{programme.text}' of model '{model.name}'", steps=steps))


def _require_steerable(model: Model, dt: float, slew_rate: float) -> None:
    if RUDDER not in model.input_names or "psi" not in model.states:
        raise InputError(f"model '{model.name}' cannot be steered: it needs the input '{RUDDER}' and the state 'psi'")
    if model.parameters.missing:
        raise InputError(f"model '{model.name}' has no value for {', '.join(model.parameters.missing)}")
    if not (dt > 0.0 and slew_rate > 0.0):
        raise InputError(f"step {dt:g} s and slew rate {slew_rate:g} rad/s must be positive")


def _steer_programme(
    model: Model, programme: Programme, steering: Steering, start: Array, held: Array, longest: float
) -> tuple[Array, bool]:
    """Return inputs at the samples (n, nu), in the model's signs, and whether the helmsman has finished."""
    dt = steering.dt
    if not 1.0 <= longest / dt < MAX_SAMPLES:
        raise InputError(f"a manoeuvre of {longest:g} s is not between 1 and {MAX_SAMPLES:.0e} steps of {dt:g} s")
    count = int(longest / dt) + 1
    states, inputs = np.empty((count, len(start))), np.empty((count, len(held)))
    memory = programme.memory(steering)
    diverged = steer(
        model.compiled.rates, programme.helmsman, start, held.copy(), model.parameters.values, memory, dt, states,
        inputs,
    )  # fmt: skip
    if diverged >= 0:
        require_bounded(
            model, frozen(dt * np.arange(diverged + 1)), states[: diverged + 1], f"manoeuvre '{programme.text}'"
        )
    finished = memory[FINISHED] != NOT_FINISHED
    last = min(count, round(memory[FINISHED] / dt) + 1) if finished else count
    used = np.ascontiguousarray(inputs[:last])
    used[:, steering.delta] = rudder_angles(used[:, steering.delta])
    return used, bool(finished)
