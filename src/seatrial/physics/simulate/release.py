"""A ship that rolls, let go from an angle: the decay that a model foresees."""

import math
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Provenance, Record, frozen
from seatrial.physics.manoeuvres.release import release_angle
from seatrial.physics.simulate.channels import record_of
from seatrial.physics.simulate.divergence import require_bounded
from seatrial.physics.simulate.replay import trajectory

_PERIODS = 15.0  # natural periods that a decay is simulated for where nothing is said; chosen
_SAMPLES_A_PERIOD = 100.0  # chosen; Runge-Kutta of fourth order then errs by 1e-6 of the angle a period


def rolls_only(model: Model) -> bool:
    """Return whether the model can only be released: it rolls, and has no heading to be steered."""
    return {"phi", "p"} <= set(model.states) and "psi" not in model.states


def natural_period(model: Model) -> float:
    """Return the natural period at small angles [s] of a model that rolls, 2 pi / sqrt(c_1).

    Raises:
        InputError: the model has no restoring moment `c_1`, or one that is not positive.
    """
    c_1 = model.parameters["c_1"].value if "c_1" in model.parameters else math.nan
    if not c_1 > 0.0:
        raise InputError(f"model '{model.name}' cannot be released: it needs a positive restoring moment c_1")
    return 2.0 * math.pi / math.sqrt(c_1)


def release(model: Model, text: str, period: float, duration: float | None = None) -> Record:
    """Let the ship go from an angle, at rest, in calm water with fins amidships.

    Args:
        model: states phi and p; all parameters must have values.
        text: ``release:15`` or ``release:15:port`` [deg], counted from the angle of rest `phi_0`.
        period: natural period [s], which sets sample interval and duration.
        duration: s; by default 15 natural periods.

    Returns:
        A simulated record of phi, p and the inputs, all zero.

    Raises:
        InputError: the text names no release, a duration that is not positive, or the simulation diverges.
    """
    angle, longest = release_angle(text), _PERIODS * period if duration is None else duration
    if not (math.isfinite(longest) and longest > 0.0):
        raise InputError(f"the duration {longest:g} s of a release is not positive")
    dt = period / _SAMPLES_A_PERIOD
    time = frozen(dt * np.arange(round(longest / dt) + 1))
    start = np.zeros(len(model.states))
    rest = model.parameters["phi_0"].value if "phi_0" in model.parameters else 0.0
    start[model.states.index("phi")] = rest + angle
    inputs = np.zeros((len(time), len(model.inputs)))
    states, outputs = trajectory(model, inputs, dt, start)
    require_bounded(model, time, states, f"manoeuvre '{text}'")
    simulated = record_of(model, text, time, states, outputs, inputs)
    return replace(simulated, provenance=Provenance(f"manoeuvre '{text}' of model '{model.name}'"))
