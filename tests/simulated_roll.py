"""A ship that rolls in a realised sea, by an integrator that is none of the house's."""

from collections.abc import Mapping

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from seatrial.core.values import Record
from seatrial.physics.hydro.excitation import G
from seatrial.physics.sea.realise import Spacing, harmonic_sum, realise
from seatrial.physics.sea.spectrum import Spectrum

SHIP = {"b_1": 0.08, "b_2": 0.0, "b_3": 0.0, "c_1": (2.0 * np.pi / 10.0) ** 2, "c_3": 0.0, "c_5": 0.0, "phi_0": 0.005}
BREADTH, DRAUGHT = 10.5, 3.4


def simulate_roll_record(
    spectrum: Spectrum,
    seed: int,
    values: Mapping[str, float] = SHIP,
    *,
    duration: float = 1800.0,
    dt: float = 0.2,
    noise: float = float(np.radians(0.05)),
) -> Record:
    """Channels phi (noise in rad) and alpha_w, beam seas of 600 lines on a box hull."""
    rng = np.random.default_rng(seed)
    band = spectrum.band(1e-4, 0.9999)
    lines = realise(spectrum, 0.0, 0.5 * np.pi, rng, count=600, spacing=Spacing.JITTERED, band=band)
    k = lines.omega**2 / G
    felt = np.exp(-0.5 * k * DRAUGHT) * np.sinc(0.5 * k * BREADTH / np.pi)
    slope = 1j * k * felt * lines.amplitude
    fine = np.arange(0.0, duration + 0.2, 0.1)
    alpha = CubicSpline(fine, harmonic_sum(lines.omega_e, slope, fine))
    v = values

    def rates(t: float, x: np.ndarray) -> list[float]:
        heel, p = x[0] - v["phi_0"], x[1]
        damping = v["b_1"] * p + v["b_2"] * p * abs(p) + v["b_3"] * p**3
        return [p, v["c_1"] * (float(alpha(t)) - heel) - v["c_3"] * heel**3 - v["c_5"] * heel**5 - damping]

    time = np.arange(0.0, duration, dt)
    phi = solve_ivp(rates, (0.0, time[-1]), [0.02, 0.0], t_eval=time, rtol=1e-6, atol=1e-8).y[0]
    measured = phi + noise * rng.standard_normal(len(time))
    return Record.from_arrays("sea", time, {"phi": measured, "alpha_w": np.asarray(alpha(time))})
