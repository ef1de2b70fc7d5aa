"""Plain arrays around the integrators: one call with everything that does not matter filled in."""

from dataclasses import dataclass, field

import numpy as np

from seatrial.core.equations import Model
from seatrial.numerics.kernels.integrate import DELAY, GAIN, OFFSET, replay, replay_tangent

Index = np.ndarray


@dataclass(frozen=True)
class KernelCase:
    """Segments of one model; corrections one value an input."""

    model: Model
    inputs: np.ndarray
    offsets: tuple[int, ...]
    dt: float
    start: np.ndarray
    p: np.ndarray
    substeps: int = 1
    gain: tuple[float, ...] = field(default=())
    offset: tuple[float, ...] = field(default=())
    delay: tuple[float, ...] = field(default=())
    held: tuple[int, ...] = field(default=())

    @property
    def run_inputs(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Inputs, where each segment lies among them, and which of them run straight."""
        first, last = self.offsets[:-1], self.offsets[1:]
        place = np.ascontiguousarray(np.column_stack([first, first, last]), dtype=np.int64)
        return self.inputs, place, np.array([0.0 if j in self.held else 1.0 for j in range(len(self.model.inputs))])

    @property
    def segments(self) -> int:
        return len(self.offsets) - 1

    def corrections(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        nu = len(self.model.inputs)
        rows = [np.array(g if g else d * np.ones(nu)) for g, d in ((self.gain, 1), (self.offset, 0), (self.delay, 0))]
        return tuple(np.tile(row, (self.segments, 1)) for row in rows)  # type: ignore[return-value]

    @property
    def select(self) -> Index:
        return np.arange(len(self.model.observables))

    def run(self) -> tuple[np.ndarray, np.ndarray]:
        """All observables (rows, ny) and the failure flags."""
        c = self.model.compiled
        y, failed = np.full((len(self.inputs), len(self.select)), 7.0), np.full(self.segments, -1)
        gain, offset, delay = self.corrections()
        replay(
            *(c.rates, c.outputs, *self.run_inputs, np.array(self.offsets), 0, self.segments, self.dt, self.substeps),
            *(self.start, self.p, gain, offset, delay, self.select, len(self.model.outputs), y, failed),
        )
        return y, failed

    def columns(self) -> list[tuple[str, int]]:
        """Every column there can be: parameters, offset, gain and delay of each input, initial states."""
        inputs = [(kind, j) for kind in ("offset", "gain", "delay") for j in range(len(self.model.inputs))]
        return [
            *(("p", i) for i in range(self.p.shape[1])),
            *inputs,
            *(("start", i) for i in range(self.start.shape[1])),
        ]

    def links(self, pattern: np.ndarray) -> tuple[Index, Index, Index]:
        nx, nu = len(self.model.states), len(self.model.inputs)
        place = {column: k for k, column in enumerate(self.columns())}
        chain = [(i, k) for i, k in pattern if k < nx]
        link_p = [(i, k, place["p", k - nx - nu]) for i, k in pattern if k >= nx + nu]
        slots = {"offset": OFFSET, "gain": GAIN, "delay": DELAY}
        link_u = [
            (i, k, 3 * (k - nx) + slot, place[kind, k - nx])
            for i, k in pattern
            if nx <= k < nx + nu
            for kind, slot in slots.items()
        ]
        tables = ((chain, 2), (link_p, 3), (link_u, 4))
        return tuple(np.array(rows, dtype=np.int64).reshape(-1, w) for rows, w in tables)  # type: ignore[return-value]

    def run_tangent(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """`run` with derivatives (rows, ny, columns)."""
        c, columns = self.model.compiled, self.columns()
        y, failed = np.full((len(self.inputs), len(self.select)), 7.0), np.full(self.segments, -1)
        s = np.full((len(self.inputs), len(self.select), len(columns)), 7.0)
        start_column = np.array([columns.index(("start", i)) for i in range(self.start.shape[1])])
        gain, offset, delay = self.corrections()
        replay_tangent(
            *(c.rates_tangent, c.outputs_tangent, *self.run_inputs, np.array(self.offsets), 0, self.segments, self.dt),
            *(self.substeps, self.start, self.p, gain, offset, delay),
            *self.links(c.rates_pattern),
            *self.links(c.outputs_pattern),
            *(start_column, self.select, len(self.model.outputs), y, s, failed),
        )
        return y, s, failed
