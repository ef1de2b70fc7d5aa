"""Time histories of one sea, as in figures 3 to 7, and how much one record of 1000 s can tell."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.hydro.dispersion import G
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import TransferLoop
from seatrial.physics.loops.fin import Preamplifier
from seatrial.physics.sea.realise import Lines, Spacing, harmonic_sum, realise, short_crested
from seatrial.physics.sea.spectrum import ittc
from seatrial_studies.yu2014.fitted import Fitted
from seatrial_studies.yu2014.published import FOUND, HEIGHT, RECORD, SET_AT
from seatrial_studies.yu2014.readings import HULL, KNOT, SETTING, loop, met, performance

DURATION, SAMPLE, LINES = 200.0, 0.25, 300


@dataclass(frozen=True, eq=False)
class Histories:
    """At 18 kn and 90 deg, all (n,); roll [deg] and fin rate [deg/s] at the fitted level.

    Attributes:
        free: roll without fins; pid, genetic: (roll, fin rate) under the baseline and the paper's gains.
    """

    time: Array
    free: Array
    pid: tuple[Array, Array]
    genetic: tuple[Array, Array]


def histories(of: Fitted, seed: int) -> Histories:
    """The same waves for all three, in the sea fitted to table 1; steady motion, so that nothing is integrated."""
    rng = np.random.default_rng([seed, 6])
    sea = of.sea(SET_AT.heading, SET_AT.speed)
    long = realise(
        ittc(HEIGHT), sea.speed * KNOT, math.radians(sea.heading), rng, count=LINES, spacing=Spacing.JITTERED
    )
    lines = long if sea.spreading is None else short_crested(long, rng, sea.spreading)
    time = np.arange(0.0, DURATION, SAMPLE)
    made = loop(of.reading, sea.speed, of.K_q)
    scale = math.degrees(of.level)
    free = scale * _summed(lines, made.disturbance.at(np.abs(lines.encounter)), time)
    return Histories(time, free, _moved(made, of.baseline, lines, time, scale), _moved(made, FOUND, lines, time, scale))


def _moved(plain: TransferLoop, gains: Array, lines: Lines, time: Array, scale: float) -> tuple[Array, Array]:
    """Roll and fin rate."""
    made, w = plain.with_gains(gains), np.abs(lines.encounter)
    roll = made.disturbance.at(w) / (1.0 + made.open(w))
    rate = -1j * w * (made.values @ made.controller_terms(w)) * roll
    return scale * _summed(lines, roll, time), scale * _summed(lines, rate, time)


def _summed(lines: Lines, operator: Complex, time: Array) -> Array:
    """Response to the effective wave slope; operators at |omega_e|, lines the ship overtakes conjugated."""
    k = lines.omega**2 / G
    hull = np.array([HULL.at(np.array([w]), float(b))[0] for w, b in zip(lines.omega, lines.direction, strict=True)])
    slope = 1j * k * np.sin(lines.direction) * hull * lines.amplitude
    ahead = np.where(lines.encounter < 0.0, np.conj(slope), slope)
    return harmonic_sum(np.abs(lines.encounter), operator * ahead, time)


def variation_of_rms(reading: Preamplifier) -> float:
    """Coefficient of variation of the rms roll of one record of 1000 s under the paper's gains where they were set.

    Of a Gaussian process with one-sided spectrum S: var(s^2) = 2 pi / T int S^2 d omega, half of it relatively for s.
    """
    made, seen = performance(reading).loop, met(SETTING)
    w = seen.omega_e
    energy = np.abs(made.disturbance.at(w) / (1.0 + made.open(w))) ** 2 * seen.energy
    squared = float(np.sum(energy**2 / np.gradient(w)))
    return 0.5 * math.sqrt(2.0 * math.pi / RECORD * squared) / float(energy.sum())
