"""Roll about an axis that stays: damping up to the third order, restoring up to the fifth, per unit of inertia.

phi'' + b_1 phi' + b_2 phi'|phi'| + b_3 phi'^3 + c_1 (phi - phi_0) + c_3 (phi - phi_0)^3 + c_5 (phi - phi_0)^5
    = c_1 (r_w alpha_w + K_alpha alpha_f)
(ITTC 7.5-02-07-04.5, numerical estimation of roll damping; Spouge 1988). phi and p positive to starboard; so are the
wave slope alpha_w and the fin angle alpha_f: a positive one rolls the ship to starboard.
"""

from functools import cache

import sympy as sp

from seatrial.core.equations import Model, Sheet

ITTC = "ITTC Recommended Procedure 7.5-02-07-04.5, equation of free roll per unit of inertia"
WAVES = "effective wave slope: Blagoveshchensky 1962, Theory of Ship Motions, roll in beam seas"
FINS = "fins as an equivalent wave slope: Yu et al. 2014"
LIST = "chosen: a list, or a zero of the instrument"


@cache
def roll() -> Model:
    """Return the roll model: states phi [rad], p [rad/s]; inputs alpha_w [rad] of waves, alpha_f [rad] of fins.

    An absent input counts as zero.

    Free: damping b_1 b_2 b_3, restoring c_1 c_3 c_5 and the angle of rest phi_0. Fixed unless freed: r_w = 1, share of
    alpha_w that acts on the hull, and K_alpha = 0, the wave slope to which a radian of fin angle is equivalent.
    c_1 is the square of the natural frequency at small angles, GM g / (k_xx^2 (1 + added inertia)); c_3 > 0 hardens.
    """
    sheet = Sheet("roll", ITTC, "roll")
    phi, p = sheet.states("phi p")
    alpha_w, alpha_f = sheet.input("alpha_w"), sheet.input("alpha_f")
    b_1 = sheet.parameter("b_1", 0.02, "1/s", "linear damping", ITTC, free=True)
    b_2 = sheet.parameter("b_2", 0.0, "1/rad", "quadratic damping", ITTC, free=True, scale=0.1)
    b_3 = sheet.parameter("b_3", 0.0, "s/rad^2", "cubic damping", ITTC, free=True, scale=0.1)
    c_1 = sheet.parameter("c_1", 1.0, "1/s^2", "restoring at small angles", ITTC, free=True)
    c_3 = sheet.parameter("c_3", 0.0, "1/(s^2 rad^2)", "cubic restoring", ITTC, free=True, scale=1.0)
    c_5 = sheet.parameter("c_5", 0.0, "1/(s^2 rad^4)", "restoring of fifth order", ITTC, free=True, scale=10.0)
    phi_0 = sheet.parameter("phi_0", 0.0, "rad", "angle of rest", LIST, free=True, scale=0.01)
    r_w = sheet.parameter("r_w", 1.0, "1", "effective share of the wave slope", WAVES)
    K_alpha = sheet.parameter("K_alpha", 0.0, "1", "wave slope equivalent to a radian of fin angle", FINS, scale=0.1,
                              latex=r"K_\alpha")  # fmt: skip
    heel = sheet.bind("phi_r", phi - phi_0, "from the angle of rest", "rad")
    damping = sheet.bind("b_phi", b_1 * p + b_2 * p * sp.Abs(p) + b_3 * p**3, ITTC, "rad/s^2")
    restoring = sheet.bind("c_phi", c_1 * heel + c_3 * heel**3 + c_5 * heel**5, ITTC, "rad/s^2")
    rolling = sheet.bind("m_phi", c_1 * (r_w * alpha_w + K_alpha * alpha_f), f"{WAVES}; {FINS}", "rad/s^2")
    sheet.rate(phi, p, "roll rate")
    sheet.rate(p, rolling - damping - restoring, ITTC)
    return sheet.model()
