"""Time histories of one sea, as in figures 3 to 7, and how much one record of 1000 s can show."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.hydro import Complex, G
from seatrial.physics.loops import Preamplifier, TransferLoop
from seatrial.physics.sea import Spacing, WaveComponents, harmonic_sum, ittc, realise, short_crested
from seatrial_studies.yu2014.published import DESIGN_ROW, HEIGHT, PUBLISHED_VALUES, RECORD_SECONDS
from seatrial_studies.yu2014.published_loop import (
    DESIGN_SEA,
    HULL_FACTOR,
    KNOT,
    effective_slope,
    performance,
    stabiliser_loop,
)
from seatrial_studies.yu2014.table_1_fit import Table1Fit

# s, s and lines of the sea; our choice
DURATION, SAMPLE, LINES = 200.0, 0.25, 300


@dataclass(frozen=True, eq=False)
class RollHistories:
    """At 18 kn and 90 deg, all (n,); roll [deg] and fin rate [deg/s] at the fitted level.

    Attributes:
        uncontrolled: roll without fins.
        pid, genetic: (roll, fin rate) under the baseline and the paper's gains.
    """

    time: Array
    uncontrolled: Array
    pid: tuple[Array, Array]
    genetic: tuple[Array, Array]


def simulate_histories(fit: Table1Fit, seed: int) -> RollHistories:
    """The same waves for all three, in the sea fitted to table 1; steady motion, so that nothing is integrated."""
    rng = np.random.default_rng([seed, 6])
    sea = fit.sea(DESIGN_ROW.heading, DESIGN_ROW.speed)
    long = realise(
        ittc(HEIGHT), sea.speed * KNOT, math.radians(sea.heading), rng, count=LINES, spacing=Spacing.JITTERED
    )
    lines = long if sea.spreading is None else short_crested(long, rng, sea.spreading)
    time = np.arange(0.0, DURATION, SAMPLE)
    made = stabiliser_loop(fit.preamplifier, sea.speed, fit.K_q)
    scale = math.degrees(fit.level)
    free = scale * response_to_slope(lines, made.disturbance.frequency_response(np.abs(lines.omega_e)), time)
    return RollHistories(
        time,
        free,
        _controlled_motion(made, fit.baseline, lines, time, scale),
        _controlled_motion(made, PUBLISHED_VALUES, lines, time, scale),
    )


def _controlled_motion(
    transfer_loop: TransferLoop, gains: Array, lines: WaveComponents, time: Array, scale: float
) -> tuple[Array, Array]:
    """Roll and fin rate."""
    made, w = transfer_loop.with_gains(gains), np.abs(lines.omega_e)
    roll = made.disturbance.frequency_response(w) / (1.0 + made.open_loop(w))
    rate = -1j * w * (made.gain_values @ made.controller_terms(w)) * roll
    return scale * response_to_slope(lines, roll, time), scale * response_to_slope(lines, rate, time)


def response_to_slope(lines: WaveComponents, operator: Complex, time: Array) -> Array:
    """Return the response (n,) to the effective wave slope; operators at |omega_e|, overtaken lines conjugated."""
    k = lines.omega**2 / G
    hull = np.array(
        [
            HULL_FACTOR.slope_factor(np.array([w]), float(b))[0]
            for w, b in zip(lines.omega, lines.direction, strict=True)
        ]
    )
    slope = 1j * k * np.sin(lines.direction) * hull * lines.amplitude
    ahead = np.where(lines.omega_e < 0.0, np.conj(slope), slope)
    return harmonic_sum(np.abs(lines.omega_e), operator * ahead, time)


def rms_variation(preamplifier: Preamplifier) -> float:
    """Coefficient of variation of the rms roll of one record of 1000 s under the paper's gains where they were set.

    Of a Gaussian process with one-sided spectrum S: var(s^2) = 2 pi / T int S^2 d omega, half of it relatively for s.
    """
    made, seen = performance(preamplifier).loop, effective_slope(DESIGN_SEA)
    w = seen.omega_e
    energy = np.abs(made.disturbance.frequency_response(w) / (1.0 + made.open_loop(w))) ** 2 * seen.energy
    squared = float(np.sum(energy**2 / np.gradient(w)))
    return 0.5 * math.sqrt(2.0 * math.pi / RECORD_SECONDS * squared) / float(energy.sum())
