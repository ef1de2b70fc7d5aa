"""What an actuator's drive does in a sea: reversals, their energy, the power."""

import math
from dataclasses import dataclass

SECONDS_PER_HOUR = 3600.0  # s, by definition


@dataclass(frozen=True)
class ActuatorDrive:
    """What turns the actuator: inertia about its stock [kg m^2], efficiency of the drive, 0 to 1."""

    inertia: float
    efficiency: float = 1.0

    def energy(self, rate_variance: float) -> float:
        """Return the energy [J] of a reversal, of a rate of that variance [rad^2/s^2].

        W = I var(rate) / eta (Yu et al. 2014, eq. (3)): between two reversals the drive brings the actuator to a peak
        rate, I peak^2 / 2, and the mean square of the peaks of a narrow band is twice its variance (Rayleigh).
        """
        return self.inertia * rate_variance / self.efficiency


def reversals_per_hour(rate_rms: float, acceleration_rms: float) -> float:
    """Return how often a Gaussian angle turns back in an hour: two a zero up-crossing of its rate (Rice 1945, Bell
    System Technical Journal 24, part III).
    """
    return 2.0 * SECONDS_PER_HOUR / (2.0 * math.pi) * acceleration_rms / rate_rms
