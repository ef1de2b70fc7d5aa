"""Velocities, heading and position side by side, as declared: what the comparisons work on."""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.data.check.signal import cumulative_integral, smoothed, smoothed_derivative, trimmed_rms, window_length

DEGREES_PER_RADIAN = 180.0 / math.pi
# samples of a record from which on it is compared with itself; chosen: some windows of smoothing
MIN_SAMPLES = 30


@dataclass(frozen=True)
class VelocityConvention:
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
class RecordedMotion:
    """A clean, evenly sampled record with x0, y0, psi, u and v, standard signs and unwrapped angles."""

    record: Record

    @property
    def frame(self) -> str:
        """Declared frame of u and v."""
        return self.record.channel("u").frame

    @property
    def reference_offset(self) -> float:
        """Distance by which the position's reference point lies ahead of the velocities' [m]."""
        return self.record.channel("x0").reference_point - self.record.channel("v").reference_point

    @property
    def window_samples(self) -> int:
        """Smoothing window in samples."""
        return window_length(len(self.record))

    @cached_property
    def position_derivative(self) -> tuple[Array, Array]:
        """Smoothed derivative of position, north and east [m/s]."""
        north, east = (smoothed_derivative(self.record[s], self.record.dt, self.window_samples) for s in ("x0", "y0"))
        return north, east

    @property
    def conventions(self) -> list[VelocityConvention]:
        """The declared reading first, then all others."""
        frames = (self.frame, "earth" if self.frame == "body" else "body")
        factors = (1.0, -1.0, DEGREES_PER_RADIAN, 1.0 / DEGREES_PER_RADIAN)
        return [VelocityConvention(frame, v_sign, factor, (frame != self.frame) + (v_sign < 0) + (factor != 1.0))
                for frame, v_sign, factor in product(frames, (1.0, -1.0), factors)]  # fmt: skip

    def velocity(self, convention: VelocityConvention) -> tuple[Array, Array]:
        """Return the velocity of the position's reference point, north and east [m/s], as the reading has it."""
        u, v, psi = self.record["u"], convention.v_sign * self.record["v"], convention.psi_factor * self.record["psi"]
        c, s = np.cos(psi), np.sin(psi)
        north, east = (u * c - v * s, u * s + v * c) if convention.frame == "body" else (u, v)
        if self.reference_offset == 0.0:
            return north, east
        lever = self.reference_offset * np.gradient(psi, self.record.dt)
        return north - lever * s, east + lever * c

    def smoothed_velocity(self, convention: VelocityConvention) -> tuple[Array, Array]:
        """Return `velocity` smoothed, on the samples of `position_derivative`."""
        parts = self._smoothed_parts(abs(convention.psi_factor))
        turn = 1.0 if convention.psi_factor > 0 else -1.0
        if convention.frame == "body":
            north = parts["u cos"] - convention.v_sign * turn * parts["v sin"]
            east = turn * parts["u sin"] + convention.v_sign * parts["v cos"]
        else:
            north, east = parts["u"], convention.v_sign * parts["v"]
        return north - turn * parts["lever sin"], east + parts["lever cos"]

    def _smoothed_parts(self, psi_factor: float) -> dict[str, Array]:
        """What every reading of one size of psi is a sum of, smoothed once."""
        if psi_factor not in self._parts:
            u, v, psi = self.record["u"], self.record["v"], psi_factor * self.record["psi"]
            c, s = np.cos(psi), np.sin(psi)
            lever = self.reference_offset * np.gradient(self.record["psi"], self.record.dt)
            products = {"u cos": u * c, "u sin": u * s, "v cos": v * c, "v sin": v * s, "u": u, "v": v,
                        "lever cos": lever * c, "lever sin": lever * s}  # fmt: skip
            self._parts[psi_factor] = {name: smoothed(part, self.window_samples) for name, part in products.items()}
        return self._parts[psi_factor]

    @cached_property
    def _parts(self) -> dict[float, dict[str, Array]]:
        return {}

    def speed_scale(self, convention: VelocityConvention) -> float:
        """Return the least-squares factor from the reading's velocity to the position's."""
        north, east = self.smoothed_velocity(convention)
        gx, gy = self.position_derivative
        power = float(np.sum(north * north + east * east))
        return float(np.sum(gx * north + gy * east)) / power if power > 0 else 0.0

    def misfit(self, convention: VelocityConvention) -> float:
        """Return the size of (derivative of position - scaled velocity) over the size of the derivative."""
        north, east = self.smoothed_velocity(convention)
        gx, gy = self.position_derivative
        k = max(self.speed_scale(convention), 0.0)
        size = max(trimmed_rms(gx, gy), 1e-12)  # above zero, for the division
        return trimmed_rms(gx - k * north, gy - k * east) / size

    @property
    def path_length(self) -> float:
        """Length of the smoothed track [m]."""
        return float(cumulative_integral(np.hypot(*self.position_derivative), self.record.dt)[-1])


def recorded_motion(record: Record) -> RecordedMotion | None:
    """Return the motion of a clean, evenly sampled, signed record; None where channels are missing or it is short."""
    if any(s not in record for s in ("x0", "y0", "psi", "u", "v")) or len(record) < MIN_SAMPLES:
        return None
    return RecordedMotion(record) if record.channel("u").frame == record.channel("v").frame else None
