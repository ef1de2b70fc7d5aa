"""A sampled loop as one matrix of a sample, by a way of its own: blocks stepped one by one on unit vectors."""

import math

import numpy as np
from scipy.signal import cont2discrete

from seatrial.core.values import Array
from seatrial.physics.loops import Block, Sampling, TransferLoop, in_series
from seatrial.physics.loops.autopilot import heading_loop
from seatrial.physics.loops.discrete import difference_equation

TANKER = Block("tanker", (0.0285, 0.00497), (1.0, 0.384, -0.0045, 0.0))
RIB = Block("RIB", (1.0,), (0.6, 1.0, 0.0))


def sampled_loop(plant: Block, sampling: Sampling, gear: float = 0.3) -> TransferLoop:
    """PID on the heading with a steering gear, sampled."""
    from dataclasses import replace

    loop = heading_loop(plant, plant, (Block("gear", (1.0,), (gear, 1.0)),), shortest_filter=0.5 * sampling.sample_s)
    return replace(loop, sampling=sampling)


class SampledMatrices:
    """x[k+1] = M x[k] + N n[k], psi[k] = c x[k], order[k] = k x[k] + d n[k]; n: noise of a sample."""

    def __init__(self, loop: TransferLoop) -> None:
        assert loop.sampling is not None
        T, dead = loop.sampling.sample_s, loop.sampling.dead_time
        chain = in_series("chain", (*loop.servo, loop.plant, *loop.sensor))
        whole = math.floor(dead / T + 1e-9)
        late = dead - whole * T
        num, den = np.array(chain.num), np.array(chain.den)
        A = np.diag(np.ones(len(den) - 2), -1)
        A[0] = -den[1:] / den[0]
        B = np.eye(len(A))[:, :1]
        C = np.zeros((1, len(A)))
        C[0, len(A) - len(num) :] = num / den[0]

        def step(t: float) -> tuple[Array, Array]:
            if t <= 0.0:
                return np.eye(len(A)), np.zeros(len(A))
            made = cont2discrete((A, B, C, np.zeros((1, 1))), t)
            return np.asarray(made[0]), np.asarray(made[1])[:, 0]

        (first, began), (second, self._now) = step(late), step(T - late)
        self._F, self._late, self.c0 = second @ first, second @ began, C[0]
        self._whole = whole
        self._blocks = [difference_equation(term.block, T) for term in loop.terms]
        self._filters = [difference_equation(block, T) for block in loop.filters]
        self._gains = loop.gain_values
        self.size = len(A) + sum(len(a) - 1 for _, a in (*self._blocks, *self._filters)) + whole + 1
        self._n = len(A)
        self.M = np.stack([self._stepped(row, 0.0)[0] for row in np.eye(self.size)], axis=1)
        self.N = self._stepped(np.zeros(self.size), 1.0)[0]
        self.k = np.array([self._stepped(row, 0.0)[1] for row in np.eye(self.size)])
        self.d = self._stepped(np.zeros(self.size), 1.0)[1]
        self.c = np.concatenate([self.c0, np.zeros(self.size - self._n)])

    def _stepped(self, x: Array, noise: float) -> tuple[Array, float]:
        plant, rest = x[: self._n], list(x[self._n : self.size - self._whole - 1])
        orders, following = x[self.size - self._whole - 1 :], []

        def through(block: tuple[tuple[float, ...], tuple[float, ...]], value: float) -> float:
            b, a = block
            own = [rest.pop(0) for _ in range(len(a) - 1)]
            y = b[0] * value + (own[0] if own else 0.0)
            for i in range(len(own)):
                after = own[i + 1] if i + 1 < len(own) else 0.0
                following.append(after + b[i + 1] * value - a[i + 1] * y)
            return y

        error = -float(self.c0 @ plant) - noise
        order = sum(gain * through(block, error) for gain, block in zip(self._gains, self._blocks, strict=True))
        for block in self._filters:
            order = through(block, order)
        waiting = np.concatenate([[order], orders])
        moved = self._F @ plant + self._now * waiting[self._whole] + self._late * waiting[self._whole + 1]
        return np.concatenate([moved, following, waiting[: self._whole + 1]]), order
