"""The controller of a loop in steps: its own states, discretised exactly for an error that runs straight between them.

[E, P, R] = exp of the augmented matrix (Van Loan 1978, IEEE Trans. Autom. Control 23(3), 395-404): x_{k+1} = E x_k +
(P - R) e_k + R e_{k+1} (first-order hold, "ramp-invariant": Franklin, Powell & Workman 1998, section 6.3).
"""

from dataclasses import dataclass, replace
from functools import reduce

import numpy as np
from scipy.linalg import expm

from seatrial.core.values import Array
from seatrial.physics.loops import Block, TransferLoop
from seatrial.physics.loops.block import controllable_form
from seatrial.physics.loops.discrete import holding_terms


@dataclass(frozen=True, eq=False)
class ControllerStateSpace:
    """x' = A x + b e, order = c x + d e, from the error e = reference - output to the actuator without limits.

    Attributes:
        A: (n, n); b, c: (n,).
        is_slow: which states belong to terms that wind up, (n,): see `holding_terms`.
        slow_rate: row (n + 1,) over [x, e] that gives the rate of change of the slow terms' share of the order.
    """

    A: Array
    b: Array
    c: Array
    d: float
    is_slow: Array
    slow_rate: Array

    def discretised(self, dt: float, *, is_holding: bool) -> Array:
        """Return E by columns, g0, g1 and the row that gives the order a step ahead, flat.

        Slow states stand still if `is_holding`.
        """
        moving = np.where(self.is_slow, 0.0, 1.0) if is_holding else np.ones(len(self.b))
        n = len(self.b)
        whole = np.zeros((n + 2, n + 2))
        whole[:n, :n], whole[:n, n] = moving[:, None] * self.A * dt, moving * self.b * dt
        whole[n, n + 1] = 1.0
        made = expm(whole)
        E, held, ramp = made[:n, :n], made[:n, n], made[:n, n + 1]
        ahead = (self.c @ E, [self.c @ (held - ramp)], [self.c @ ramp + self.d])
        return np.concatenate([E.T.ravel(), held - ramp, ramp, *ahead])


_UNIT_GAIN = ControllerStateSpace(np.zeros((0, 0)), np.zeros(0), np.zeros(0), 1.0, np.zeros(0, dtype=bool), np.zeros(1))


def controller_state_space(loop: TransferLoop, gains: Array) -> ControllerStateSpace:
    """Return sensor, terms with those gains (g,), filters and servo in a row."""
    seen = reduce(_append_block, loop.sensor, _UNIT_GAIN)
    made = replace(seen, c=np.zeros(len(seen.c)), d=0.0)
    holds, share = holding_terms(loop)
    for gain, term, is_held in zip(gains, loop.terms, holds, strict=True):
        made = _add_term(made, seen, float(gain), term.block, is_slow=is_held)
    before = len(made.b)
    made = reduce(_append_block, (*loop.filters, *loop.servo), made)
    drift = np.zeros(len(made.b) + 1)
    drift[:before], drift[-1] = share * made.slow_rate[:before], share * made.slow_rate[-1]
    return replace(made, slow_rate=drift)


def _append_block(first: ControllerStateSpace, block: Block) -> ControllerStateSpace:
    """Return a block behind."""
    A, b, c, d = controllable_form(block)
    n, m = len(first.b), len(b)
    whole = np.zeros((n + m, n + m))
    whole[:n, :n], whole[n:, :n], whole[n:, n:] = first.A, np.outer(b, first.c), A
    return ControllerStateSpace(
        whole, np.concatenate([first.b, b * first.d]), np.concatenate([d * first.c, c]), d * first.d,
        np.concatenate([first.is_slow, np.zeros(m, dtype=bool)]),
        np.concatenate([first.slow_rate[:-1], np.zeros(m), first.slow_rate[-1:]]),
    )  # fmt: skip


def _add_term(
    controller: ControllerStateSpace, sensor: ControllerStateSpace, gain: float, block: Block, *, is_slow: bool
) -> ControllerStateSpace:
    """Return one more term on what the sensor shows; `controller` has the sensor's states first."""
    A, b, c, d = controllable_form(block)
    n, m, s = len(controller.b), len(b), len(sensor.b)
    whole = np.zeros((n + m, n + m))
    whole[:n, :n], whole[n:, :s], whole[n:, n:] = controller.A, np.outer(b, sensor.c), A
    drift = np.concatenate([controller.slow_rate[:-1], np.zeros(m), controller.slow_rate[-1:]])
    if is_slow:
        drift[n : n + m] += gain * (c @ A)
        drift[:s] += gain * (c @ b) * sensor.c
        drift[-1] += gain * (c @ b) * sensor.d
    direct = np.zeros(n)
    direct[:s] = gain * d * sensor.c
    return ControllerStateSpace(
        whole, np.concatenate([controller.b, b * sensor.d]), np.concatenate([controller.c + direct, gain * c]),
        controller.d + gain * d * sensor.d, np.concatenate([controller.is_slow, np.full(m, is_slow)]), drift,
    )  # fmt: skip
