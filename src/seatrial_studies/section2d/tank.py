"""What is documented of the flume, the section and its holding; how the files are laid out."""

import math

from seatrial.data.read import ColumnSpec, Layout
from seatrial_studies.section2d.lewis import LewisForm

SOURCE = (
    "Regular beam waves on a 2-D ship section, NTNU (open data, CC0): sway-heave-roll (3PPH), sway-heave (4PPH) and "
    "heave-roll (6PPH) in a flume 0.6 m wide; no paper's claims are judged, the documented values are"
)
RHO, G = 1000.0, 9.81
BEAM, DRAUGHT, LENGTH = 0.40, 0.20, 0.586
MASS, KG, GM, ROLL_RADIUS = 46.8, 0.108, 0.0629, 0.36 * BEAM
DEPTH, WIDTH, TO_MODEL, ROUND_TRIP = 1.0, 0.6, 7.0, 12.0
AREA_COEFFICIENT = MASS / (RHO * BEAM * DRAUGHT * LENGTH)
FORM = LewisForm.from_dimensions(BEAM, DRAUGHT, AREA_COEFFICIENT)

HEAVE_STIFFNESS = RHO * G * BEAM * LENGTH
ROLL_STIFFNESS = MASS * G * GM
ROLL_INERTIA = MASS * ROLL_RADIUS**2
ROLL_AXIS = DRAUGHT - KG

# documented truth
HEAVE_PERIOD, ROLL_PERIOD = 1.17, 1.26
SWAY_STIFFNESS = (59.2, 60.9)
RIG_DAMPING = 8.7
HEIGHTS = {1: 0.024, 2: 0.040}

# not documented: a search over all spacings leaves this one arrangement of the probes (the mirrored one apart)
PROBES = ("zeta_1", "zeta_2", "zeta_3", "zeta_4")
PROBE_PLACES = (1.95, 2.20, 2.50)
FIRST_PROBE_TO_MODEL = 4.06

CAMERA = ("y0", "z", "phi")
LAYOUT = Layout(
    "text",
    ColumnSpec("time", "Time [s]", "s"),
    (
        ColumnSpec("x_wm", "WM_Position", "m"),
        *(ColumnSpec(f"zeta_{k}", f"WP_{k} [m]", "m") for k in (1, 2, 3, 4, 6)),
        ColumnSpec("y0", "Sway [m]", "m"),
        ColumnSpec("z", "Heave [m]", "m", positive="up"),
        ColumnSpec("phi", "Roll [rad]", "rad"),
        ColumnSpec("S_1", "Tension_SB [N]", "N"),
        ColumnSpec("S_2", "Tension_PS [N]", "N"),
        ColumnSpec("F_y", "Force_Sway [N]", "N"),
        ColumnSpec("z_ddot_1", "ACC_Heave_SB [m/s2]", "m/s^2", positive="up"),
        ColumnSpec("z_ddot_2", "ACC_HEAVE_PS [m/s2]", "m/s^2", positive="up"),
        ColumnSpec("v_dot", "ACC_SWAY [m/s2]", "m/s^2"),
    ),
)


def natural_period(inertia: float, stiffness: float) -> float:
    """Return the natural period [s]."""
    return 2.0 * math.pi * math.sqrt(inertia / stiffness)
