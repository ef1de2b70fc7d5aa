"""A craft that follows a step of heading under proportional-derivative control."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.numerics.kernels.feedback import clamp, steer
from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import COMMAND_SIGNATURE, OPTIONS

# places in the memory of the command
_KP, _KD, _CHANGE, _LIMIT, _HEADING, _RATE, _ACTUATOR, _SIGN = range(8)


@dataclass(frozen=True)
class HeadingStep:
    """An order to change the heading and how it is followed: delta = KP error - KD r, held over each step.

    Attributes:
        change: of heading [rad]; limit: largest angle of the actuator [rad].
        actuator: input of the model, positive as the notation table has it.
        duration, dt: s.
    """

    change: float
    limit: float
    actuator: str
    duration: float
    dt: float

    def simulate(self, model: Model, gains: Array, start: Array, inputs: Array) -> tuple[Array, Array] | None:
        """Return states (n, nx) and inputs (n, nu) at each step; None where the craft runs away.

        gains: KP [rad/rad], KD [s]; start: (nx,); inputs: (nu,), held but for the actuator; SI units, the
        model's signs.
        """
        place = model.input_names.index(self.actuator)
        memory = np.empty(_SIGN + 1)
        memory[[_KP, _KD]] = gains
        memory[[_CHANGE, _LIMIT]] = start[model.states.index("psi")] + self.change, self.limit
        memory[[_HEADING, _RATE, _ACTUATOR]] = model.states.index("psi"), model.states.index("r"), place
        memory[_SIGN] = -1.0 if model.inputs[place].is_reversed else 1.0
        count = round(self.duration / self.dt)
        states, given = np.empty((count, len(start))), np.empty((count, len(inputs)))
        diverged = steer(
            model.compiled.rates, _follow, start.copy(), inputs.copy(), model.parameters.values, memory, self.dt,
            states, given,
        )  # fmt: skip
        return None if diverged >= 0 else (states, given)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def _follow(t, x, memory, u):  # noqa: ARG001
    """Order the actuator within its limit."""
    error = memory[_CHANGE] - x[int(memory[_HEADING])]
    order = clamp(memory[_KP] * error - memory[_KD] * x[int(memory[_RATE])], memory[_LIMIT])
    u[int(memory[_ACTUATOR])] = memory[_SIGN] * order
