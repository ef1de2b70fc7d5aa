"""A simulated trial series of a craft with known coefficients."""
