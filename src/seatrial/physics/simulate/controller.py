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
from seatrial.physics.loops.state_space import canonical


@dataclass(frozen=True, eq=False)
class Controller:
    """x' = A x + b e, order = c x + d e, from the error e = reference - output to the actuator without limits.

    Attributes:
        A: (n, n); b, c: (n,).
        slow: which states belong to terms with a pole nearer the origin than every pole of the plant but its
            integrators, (n,): those that wind up.
        drift: row (n + 1,) over [x, e] that gives the rate of change of the slow terms' share of the order.
    """

    A: Array
    b: Array
    c: Array
    d: float
    slow: Array
    drift: Array

    def law(self, dt: float, *, is_holding: bool) -> Array:
        """E, g0, g1 and the row that gives the order a step ahead, flat; slow states stand still if `is_holding`."""
        moving = np.where(self.slow, 0.0, 1.0) if is_holding else np.ones(len(self.b))
        n = len(self.b)
        whole = np.zeros((n + 2, n + 2))
        whole[:n, :n], whole[:n, n] = moving[:, None] * self.A * dt, moving * self.b * dt
        whole[n, n + 1] = 1.0
        made = expm(whole)
        E, held, ramp = made[:n, :n], made[:n, n], made[:n, n + 1]
        ahead = (self.c @ E, [self.c @ (held - ramp)], [self.c @ ramp + self.d])
        return np.concatenate([E.ravel(), held - ramp, ramp, *ahead])


_THROUGH = Controller(np.zeros((0, 0)), np.zeros(0), np.zeros(0), 1.0, np.zeros(0, dtype=bool), np.zeros(1))


def controller_of(loop: TransferLoop, gains: Array) -> Controller:
    """Sensor, terms with those gains (g,), filters and servo in a row."""
    seen = reduce(_then, loop.sensor, _THROUGH)
    made = replace(seen, c=np.zeros(len(seen.c)), d=0.0)
    slowest = _slowest(loop.plant)
    for gain, term in zip(gains, loop.terms, strict=True):
        made = _beside(made, seen, float(gain), term.block, slowest)
    share = float(np.prod([np.sign(block.gain) for block in (*loop.filters, *loop.servo)]))
    before = len(made.b)
    made = reduce(_then, (*loop.filters, *loop.servo), made)
    drift = np.zeros(len(made.b) + 1)
    drift[:before], drift[-1] = share * made.drift[:before], share * made.drift[-1]
    return replace(made, drift=drift)


def _slowest(plant: Block) -> float:
    """The plant's pole nearest the origin but not at it, rad/s; zero where it has none."""
    sizes = np.abs(plant.poles)
    return float(sizes[sizes > 1e-9].min(initial=np.inf)) if np.any(sizes > 1e-9) else 0.0


def _then(first: Controller, block: Block) -> Controller:
    """A block behind."""
    A, b, c, d = canonical(block)
    n, m = len(first.b), len(b)
    whole = np.zeros((n + m, n + m))
    whole[:n, :n], whole[n:, :n], whole[n:, n:] = first.A, np.outer(b, first.c), A
    return Controller(
        whole, np.concatenate([first.b, b * first.d]), np.concatenate([d * first.c, c]), d * first.d,
        np.concatenate([first.slow, np.zeros(m, dtype=bool)]),
        np.concatenate([first.drift[:-1], np.zeros(m), first.drift[-1:]]),
    )  # fmt: skip


def _beside(made: Controller, seen: Controller, gain: float, block: Block, slowest: float) -> Controller:
    """One more term on what the sensor shows; `made` has the sensor's states first."""
    A, b, c, d = canonical(block)
    n, m, s = len(made.b), len(b), len(seen.b)
    whole = np.zeros((n + m, n + m))
    whole[:n, :n], whole[n:, :s], whole[n:, n:] = made.A, np.outer(b, seen.c), A
    is_slow = bool(m) and float(np.abs(block.poles).min()) < max(slowest, 1e-9)
    drift = np.concatenate([made.drift[:-1], np.zeros(m), made.drift[-1:]])
    if is_slow:
        drift[n : n + m] += gain * (c @ A)
        drift[:s] += gain * (c @ b) * seen.c
        drift[-1] += gain * (c @ b) * seen.d
    direct = np.zeros(n)
    direct[:s] = gain * d * seen.c
    return Controller(
        whole, np.concatenate([made.b, b * seen.d]), np.concatenate([made.c + direct, gain * c]),
        made.d + gain * d * seen.d, np.concatenate([made.slow, np.full(m, is_slow)]), drift,
    )  # fmt: skip
