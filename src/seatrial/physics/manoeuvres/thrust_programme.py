"""Programmes for craft that are steered by thrusters: straight run, spin, stop, zigzag by yaw command.

Orders are shares of full command, ahead and to starboard; `_give_order` shares them out over the thrusters. Zigzag and
stopping test: ISO 13643-3:2017 and IMO MSC/Circ.1053 (2002), the yaw command in place of the rudder, full astern of the
approach's share in place of the engine order.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit

from seatrial.core.values import Array, InputError
from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE, OPTIONS, kernel
from seatrial.physics.manoeuvres.programme import NOT_FINISHED, SIDES, ZIGZAG_EXECUTES

# positions in a helmsman's memory; the table of thrusters follows
(
    PSI, SURGE, AHEAD, YAW, SWITCHING, COUNT, STAGE, FINISHED, LAST_SURGE, LAST_TIME, THRUSTERS, TABLE,
) = range(12)  # fmt: skip
COLUMNS = 5  # of the table: input, reading at rest, from there to full ahead, shares of ahead and yaw
SPIN_TURN = float(np.radians(720.0))
"""Heading change that ends a spin: the second turn is steady; chosen."""
_SETTLED, _SETTLING_S = 0.005, 5.0
"""A straight run ends when the speed changes by less than this share in so many seconds; chosen."""
LONGEST_S = 600.0
"""Longest programme [s] where no duration is given; chosen."""


@dataclass(frozen=True)
class ThrustProgramme:
    """A programme: orders as shares of full command, the switching heading [rad] of a zigzag, its compiled helmsman.

    Attributes:
        ahead: of the run itself; None: of the approach, which is chosen with the craft. yaw: positive to starboard.
        is_from_rest: whether it begins at rest; else in a steady straight run.
    """

    text: str
    helmsman: Callable[..., None]
    ahead: float | None
    yaw: float
    switching: float
    is_from_rest: bool

    def memory(self, psi: int, surge: int, ahead: float, thrusters: Array) -> Array:
        """Return the helmsman's memory: places of heading and surge, the order ahead, the table of thrusters (n, 5)."""
        head = np.zeros(TABLE)
        head[[PSI, SURGE, AHEAD, YAW, SWITCHING]] = psi, surge, ahead, self.yaw, self.switching
        head[[COUNT, FINISHED, THRUSTERS]] = ZIGZAG_EXECUTES, NOT_FINISHED, len(thrusters)
        return np.concatenate([head, thrusters.ravel()])


@njit(**OPTIONS)
def _give_order(ahead, yaw, memory, u):
    """Share out an order over the thrusters, each within full command."""
    for i in range(int(memory[THRUSTERS])):
        row = TABLE + COLUMNS * i
        share = min(max(memory[row + 3] * ahead + memory[row + 4] * yaw, -1.0), 1.0)
        u[int(memory[row])] = memory[row + 1] + memory[row + 2] * share


@njit(**OPTIONS)
def _finish(t, memory):
    """Note the time at which the programme is through."""
    if memory[FINISHED] < 0.0:
        memory[FINISHED] = t


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def _straight(t, x, memory, u):
    """Hold the order ahead until the speed has settled."""
    if t - memory[LAST_TIME] >= _SETTLING_S:
        surge = x[int(memory[SURGE])]
        if abs(surge - memory[LAST_SURGE]) < _SETTLED * abs(surge):
            _finish(t, memory)
        memory[LAST_TIME], memory[LAST_SURGE] = t, surge
    _give_order(memory[AHEAD], 0.0, memory, u)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def _spin(t, x, memory, u):
    """Hold the yaw command until the heading has changed by two turns."""
    if abs(x[int(memory[PSI])]) >= memory[SWITCHING]:
        _finish(t, memory)
    _give_order(memory[AHEAD], memory[YAW], memory, u)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def _stop(t, x, memory, u):
    """Go astern from the first step on until the craft has lost its way."""
    if x[int(memory[SURGE])] <= 0.0:
        _finish(t, memory)
    _give_order(-memory[AHEAD] if t > 0.0 else memory[AHEAD], 0.0, memory, u)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def _zigzag(t, x, memory, u):
    """Reverse the yaw command when the heading has deviated by the switching heading."""
    side = 1.0 if int(memory[STAGE]) % 2 == 0 else -1.0
    towards = side * np.sign(memory[YAW])
    if towards * x[int(memory[PSI])] >= memory[SWITCHING]:
        memory[STAGE] += 1.0
        side = -side
        if memory[STAGE] >= memory[COUNT]:
            _finish(t, memory)
    _give_order(memory[AHEAD], side * memory[YAW] if t > 0.0 else 0.0, memory, u)


EXAMPLES = {
    "straight": "straight:50", "spin": "spin:50 or spin:50:port", "stop": "stop:50",
    "zigzag": "zigzag:30/20 or zigzag:30/20:port",
}  # fmt: skip


def thrust_programme(text: str) -> ThrustProgramme:
    """Return the programme that a text names: ``straight:50``, ``spin:50:port``, ``stop:50``, ``zigzag:30/20``.

    Numbers are per cent of full command; of a zigzag the yaw command and the switching heading [deg].

    Raises:
        InputError: the text names no programme, or its numbers cannot be read.
    """
    kind, *fields = text.strip().split(":")
    side = SIDES[fields.pop()] if fields and fields[-1] in SIDES else 1
    if kind not in EXAMPLES:
        raise InputError(
            f"unknown manoeuvre '{text}' of a craft with thrusters; known are {', '.join(EXAMPLES.values())}"
        )
    try:
        numbers = [float(part) for part in "/".join(fields).split("/")]
    except ValueError:
        numbers = []
    if len(numbers) != (2 if kind == "zigzag" else 1) or not all(n > 0.0 for n in numbers) or numbers[0] > 100.0:
        raise InputError(f"cannot read the manoeuvre '{text}'; write it like {EXAMPLES[kind]}, at most 100 per cent")
    share = numbers[0] / 100.0
    if kind == "zigzag":
        return ThrustProgramme(text, _zigzag, None, side * share, float(np.radians(numbers[1])), is_from_rest=False)
    if kind == "spin":
        return ThrustProgramme(text, _spin, 0.0, side * share, SPIN_TURN, is_from_rest=True)
    if kind == "stop":
        return ThrustProgramme(text, _stop, share, 0.0, 0.0, is_from_rest=False)
    return ThrustProgramme(text, _straight, share, 0.0, 0.0, is_from_rest=True)
