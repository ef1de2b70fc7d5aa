"""A ship model to copy: first-order steering with a quadratic loss of speed in the turn."""

from seatrial.core.equations import Model, Sheet

NOMOTO = "Nomoto et al. 1957, Int. Shipbuilding Progress 4(35), eq. (6)"


def model() -> Model:
    """Return the model; states r, psi, u in SI units, rudder positive to port turn as in the notation table."""
    sheet = Sheet("yaw_and_speed", source=NOMOTO, meaning="first-order steering with a loss of speed in the turn")
    r, psi, u = sheet.states("r psi u")
    delta = sheet.input("delta")
    T = sheet.parameter("T", 10.0, "s", "time constant", free=True, lower=0.1)
    K = sheet.parameter("K", 0.1, "1/s", "gain", free=True)
    u_0 = sheet.parameter("u_0", 1.2, "m/s", "approach speed")
    c_r = sheet.parameter("c_r", 3.0, "1/s", "loss of speed in a turn", free=True)

    sheet.rate(r, (K * delta - r) / T, NOMOTO)
    sheet.rate(psi, r)
    sheet.rate(u, (u_0 - u) / T - c_r * u * r**2, "fitted form")
    return sheet.model()
