"""Typical coefficients of the force of the wind, for starts of searches and priors."""

SYMMETRIC = {"C_X1": -0.7, "C_Y1": -0.8, "C_N2": 0.0}
"""Those of a craft symmetrical fore and aft, where a search starts: the middle of typical values (Fossen 2021, section
10.1, c_x 0.5 to 0.9, c_y 0.7 to 0.95); the moment has either sign."""
TYPICAL_SPREAD = {"C_X1": 0.35, "C_Y1": 0.4, "C_N2": 0.1}
"""Standard deviations about them where the areas are estimates, too: half of the forces' (areas of ships of one length
differ by that); the moment's is the middle of its typical size, 0.05 to 0.20 (Fossen 2021, section 10.1)."""
TYPICAL = "Fossen 2021, section 10.1, typical values of craft symmetrical fore and aft"
