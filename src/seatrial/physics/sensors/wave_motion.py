"""First-order wave motion as sensors show it: displacements in a narrow band on top of the craft's own motion.

Waves move a craft to and fro and leave no mean (Balchen et al. 1976; Saelid, Jenssen & Balchen 1983): an instrument
shows the slow motion, which rudder, thrusters and wind cause, and a displacement xi with

    xi'' + 2 zeta omega xi' + omega^2 xi = noise     (Fossen 2011, section 8.2.6, as an output).

A heading and a yaw rate show the same motion, xi and xi'; so do roll and pitch and their rates. Frequency and damping
are common to all motions of a peak: wind sea is one, swell may be another.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Index

PAIR_COLUMNS = 22
"""Numbers that describe a pair: see `_pair`."""

RATES = {"psi": "r", "phi": "p", "theta": "q"}
"""Angle -> its rate: channels that show the same motion."""

_ANGLES = {rate: angle for angle, rate in RATES.items()}
_COMPLEX_STEP = 1e-30  # of a derivative without cancellation (Squire & Trapp 1998); any small number; chosen


def motion_of(channel: str) -> str:
    """Return the displacement that a channel shows: a rate's angle, else itself."""
    return _ANGLES.get(channel, channel)


@dataclass(frozen=True)
class WaveMotion:
    """Motions that channels show at one or more peaks of the sea's spectrum.

    Unknowns: frequency [rad/s] and relative damping of each peak, then, peak after peak, the variance of each motion
    [SI squared].

    Attributes:
        motions: displacements, as `motion_of` names them; peaks: number of peaks.
    """

    motions: tuple[str, ...] = ()
    peaks: int = 0

    @property
    def pair_count(self) -> int:
        """Number of pairs of states, a displacement and its rate."""
        return self.peaks * len(self.motions)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 2 * self.peaks + self.pair_count

    def shown_states(self, channels: Sequence[str], states: int) -> Index:
        """Return the state that a channel shows of each peak, counted behind `states`, -1: none, (channels, peaks)."""
        table = np.full((len(channels), self.peaks), -1, dtype=np.int64)
        for row, channel in enumerate(channels):
            motion = motion_of(channel)
            if motion in self.motions:
                first = np.arange(self.peaks) * len(self.motions) + self.motions.index(motion)
                table[row] = states + 2 * first + (motion != channel)
        return table

    def pairs(self, unknowns: Array, dt: float) -> tuple[Array, Array]:
        """Return the pairs as `kernels.innovations` wants them, (pairs, columns), and each motion's variance, (pairs,).

        unknowns: (size,); dt: time step [s].
        """
        shape = unknowns[: 2 * self.peaks].reshape(self.peaks, 2)
        pairs = [_pair(float(omega), float(zeta), dt) for omega, zeta in shape for _ in self.motions]
        return np.array(pairs).reshape(len(pairs), PAIR_COLUMNS), np.ascontiguousarray(unknowns[2 * self.peaks :])

    def named(self, unknowns: Array) -> dict[str, float]:
        """Return frequency [rad/s], relative damping and standard deviation of each motion [SI], of each peak."""
        omega, zeta = unknowns[: 2 * self.peaks].reshape(self.peaks, 2).T
        deviation = np.sqrt(unknowns[2 * self.peaks :]).reshape(self.peaks, len(self.motions))
        names = {}
        for peak in range(self.peaks):
            behind = f"_{peak + 1}" if peak else ""
            names |= {f"wave_frequency{behind}": omega[peak], f"wave_damping{behind}": zeta[peak]}
            names |= {f"wave_{m}{behind}": deviation[peak, k] for k, m in enumerate(self.motions)}
        return {name: float(value) for name, value in names.items()}

    def variances(self, unknowns: Array, channels: Sequence[str]) -> Array:
        """Return the variance that waves of each peak add to each channel, (peaks, channels), SI."""
        omega = unknowns[: 2 * self.peaks : 2]
        size = unknowns[2 * self.peaks :].reshape(self.peaks, len(self.motions))
        added = np.zeros((self.peaks, len(channels)))
        for column, channel in enumerate(channels):
            motion = motion_of(channel)
            if motion in self.motions:
                # variance of the rate of a stationary process of this kind: that of the displacement times omega^2
                square = omega**2 if motion != channel else 1.0
                added[:, column] = size[:, self.motions.index(motion)] * square
        return added


STILL = WaveMotion()
"""No waves."""


def _pair(omega: float, zeta: float, dt: float) -> Array:
    """Return one pair: exact transition over dt, the variance gained in it at unit variance, and derivatives."""
    step = _COMPLEX_STEP * 1j
    values = [_exact(omega, zeta, dt), _exact(omega + step, zeta, dt), _exact(omega, zeta + step, dt)]
    phi, noise = (
        [np.real(v[i]) if k == 0 else np.imag(v[i]) / _COMPLEX_STEP for k, v in enumerate(values)] for i in range(2)
    )
    return np.concatenate([*phi, *noise, [omega**2]])


def _exact(omega: complex, zeta: complex, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Return exp(A dt) row by row, (4,), and D - exp(A dt) D exp(A dt)', D = diag(1, omega^2), as 11, 12, 22, (3,).

    D is the stationary covariance at unit variance: A D + D A' is minus the noise's (Gelb 1974, section 3.7).
    """
    root = np.sqrt(1.0 - zeta**2 + 0j)
    decay, angle = np.exp(-zeta * omega * dt), omega * root * dt
    c, s = decay * np.cos(angle), decay * np.sin(angle) / root
    phi = np.array([c + zeta * s, s / omega, -omega * s, c - zeta * s])
    square = omega**2
    noise = np.array([
        1.0 - phi[0] ** 2 - square * phi[1] ** 2,
        -phi[0] * phi[2] - square * phi[1] * phi[3],
        square - phi[2] ** 2 - square * phi[3] ** 2,
    ])  # fmt: skip
    return phi, noise


def realised(
    rms: Mapping[str, float], frequency: float, damping: float, time: Array, rng: np.random.Generator
) -> dict[str, Array]:
    """Return a realisation of one peak's motion in each channel, channel -> (n,), an angle and its rate of the same.

    Args:
        rms: channel -> standard deviation, SI; frequency [rad/s] and relative damping of the peak.
        time: evenly spaced [s], (n,).
    """
    phi, noise = (np.real(part) for part in _exact(frequency, damping, float(time[1] - time[0])))
    kick = np.linalg.cholesky(noise[np.array([[0, 1], [1, 2]])])
    pairs = dict[str, Array]()
    for motion in dict.fromkeys(map(motion_of, rms)):
        states = np.empty((len(time), 2))
        states[0] = rng.standard_normal(2) * [1.0, frequency]
        for row, drawn in enumerate(rng.standard_normal((len(time) - 1, 2))):
            states[row + 1] = phi.reshape(2, 2) @ states[row] + kick @ drawn
        pairs[motion] = states
    scale = {motion_of(c): size / (1.0 if motion_of(c) == c else frequency) for c, size in rms.items()}
    return {c: scale[motion_of(c)] * pairs[motion_of(c)][:, int(motion_of(c) != c)] for c in rms}
