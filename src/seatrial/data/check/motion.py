"""Velocities, heading and position side by side, as declared: what the comparisons work on."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.data.check.signal import integral, size, slope, smoothed, window

DEGREES = 180.0 / math.pi


@dataclass(frozen=True)
class Reading:
    """One way to read the columns u, v and psi; `changes` counts departures from the declared way.

    Attributes:
        frame: ``body`` or ``earth``.
        v_sign: factor on v.
        psi_factor: factor on psi (-1: the heading turns the other way; 57.3 or its inverse: wrong unit).
        changes: number of differences from the declaration.
    """

    frame: str
    v_sign: float
    psi_factor: float
    changes: int


@dataclass(frozen=True)
class Motion:
    """Channels in SI, signs already turned to the notation table's, angles unwrapped; shape (n,) each.

    `ahead` is how far the position's reference point lies ahead of the velocities' [m].
    """

    name: str
    time: Array
    dt: float
    x: Array
    y: Array
    psi: Array
    u: Array
    v: Array
    frame: str
    ahead: float

    @property
    def length(self) -> int:
        """Smoothing window in samples."""
        return window(len(self.time))

    @property
    def measured(self) -> tuple[Array, Array]:
        """Smoothed derivative of position, north and east [m/s]."""
        return slope(self.x, self.dt, self.length), slope(self.y, self.dt, self.length)

    @property
    def readings(self) -> list[Reading]:
        """The declared reading first, then all others."""
        frames = (self.frame, "earth" if self.frame == "body" else "body")
        factors = (1.0, -1.0, DEGREES, 1.0 / DEGREES)
        return [
            Reading(f, sv, fp, (f != self.frame) + (sv < 0) + (fp != 1.0))
            for f in frames
            for sv in (1.0, -1.0)
            for fp in factors
        ]

    def velocity(self, reading: Reading) -> tuple[Array, Array]:
        """Velocity of the position's reference point, north and east [m/s], as the reading has it."""
        psi, v = reading.psi_factor * self.psi, reading.v_sign * self.v
        c, s = np.cos(psi), np.sin(psi)
        north, east = (self.u * c - v * s, self.u * s + v * c) if reading.frame == "body" else (self.u, v)
        if self.ahead == 0.0:
            return north, east
        lever = self.ahead * np.gradient(psi, self.dt)
        return north - lever * s, east + lever * c

    def scale(self, reading: Reading) -> float:
        """Least-squares factor from the reading's velocity to the position's."""
        north, east = (smoothed(w, self.length) for w in self.velocity(reading))
        gx, gy = self.measured
        power = float(north @ north + east @ east)
        return float(gx @ north + gy @ east) / power if power > 0 else 0.0

    def misfit(self, reading: Reading) -> float:
        """Size of (derivative of position - scaled velocity) over size of the derivative."""
        north, east = (smoothed(w, self.length) for w in self.velocity(reading))
        gx, gy = self.measured
        power = float(north @ north + east @ east)
        k = max(float(gx @ north + gy @ east) / power, 0.0) if power > 0 else 0.0
        return size(gx - k * north, gy - k * east) / max(size(gx, gy), 1e-12)

    @property
    def path(self) -> float:
        """Distance sailed by the smoothed track [m]."""
        return float(integral(np.hypot(*self.measured), self.dt)[-1])


def motion_of(record: Record) -> Motion | None:
    """The motion of a clean, evenly sampled, signed record, or None where channels are missing."""
    if any(s not in record for s in ("x0", "y0", "psi", "u", "v")) or len(record) < 30:
        return None
    if record.channel("u").frame != record.channel("v").frame:
        return None
    return Motion(
        record.name,
        record.time,
        record.dt,
        record["x0"],
        record["y0"],
        record["psi"],
        record["u"],
        record["v"],
        record.channel("u").frame,
        record.channel("x0").reference_point - record.channel("v").reference_point,
    )
