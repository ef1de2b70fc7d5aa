"""Instruments between a craft's motion and its records: any model with the outputs that its sensors show."""

from seatrial.physics.sensors.measured_outputs import with_sensors
from seatrial.physics.sensors.settings import Compass, Sensors, VelocityReference
from seatrial.physics.sensors.wave_motion import WaveMotion

__all__ = ["Compass", "Sensors", "VelocityReference", "WaveMotion", "with_sensors"]
