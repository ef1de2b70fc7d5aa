"""Station keeping of a craft with thrusters: position and heading kept by a PID shared out over the thrusters."""
