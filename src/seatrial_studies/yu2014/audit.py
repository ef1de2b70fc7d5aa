"""The print worked through again from its own numbers: misprints and what they would do."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, decode, encode, selection_probabilities
from seatrial.physics.loops import Preamplifier
from seatrial_studies.yu2014.published import (
    DESIGN_SEA,
    LOWER,
    PUBLISHED,
    PUBLISHED_LOOP,
    PUBLISHED_VALUES,
    TABLE_1,
    UPPER,
    RollResponse,
    effective_slope,
    performance,
    roll_response,
)

# bits, longest code that is tried
LONGEST_CODE = 24
PRINTED_DIGITS = 3


@dataclass(frozen=True)
class FinInertia:
    """Section 2.3: mass [kg] and moment of inertia [kg m^2] about the stock, and the latter with one chord throughout.

    Attributes:
        chord: span over aspect ratio, m.
    """

    chord: float
    mass: float
    inertia: float
    consistent_inertia: float


@dataclass(frozen=True, eq=False)
class FinGainAudit:
    """Numbers behind the verdicts on the print; no random number is drawn but for `roulette_sum`.

    Attributes:
        target: fin variance [deg^2] at which 20 % of amplitudes exceed 22 deg; target_rounded: with ln 5 as 1.61.
        fin_rate_readings: rms [deg s] of the fin rate's print with 1/s, and the rate itself [deg/s]; by reading.
        roulette_sum: what selection probabilities of 50 individuals add up to with the sum over 3, drawn at random.
        lower_reductions, larger_rates: rows of table 1 in which the statements hold.
        contradictory_rows: rows whose two columns imply different rolls without fins, whatever was rounded.
        shortest_code_bits: shortest code that holds every printed gain.
        runge_kutta_growth: of one Runge-Kutta step of 0.1 s along the gyro's poles.
        roll_responses: of the paper's gains where they were set, by reading.
        servo_gain: fin angle ordered for each degree, servo.
    """

    target: float
    target_rounded: float
    fin_inertia: FinInertia
    fin_rate_readings: dict[Preamplifier, tuple[float, float]]
    roulette_sum: float
    lower_reductions: int
    larger_rates: int
    contradictory_rows: tuple[str, ...]
    shortest_code_bits: int
    runge_kutta_growth: float
    roll_responses: dict[Preamplifier, RollResponse]
    servo_gain: float


def audit(seed: int) -> FinGainAudit:
    """Return all numbers of the audit (some hundredths of a second)."""
    return FinGainAudit(
        PUBLISHED.fin_limit**2 / (2.0 * math.log(1.0 / PUBLISHED.saturation)),
        PUBLISHED.fin_limit**2 / (2.0 * 1.61),
        fin_inertia(),
        {reading: fin_rate_readings(reading) for reading in Preamplifier},
        roulette_sum(np.random.default_rng([seed, 3])),
        sum(row.genetic.reduction < row.traditional.reduction for row in TABLE_1),
        sum(row.traditional.rate > row.genetic.rate for row in TABLE_1),
        contradictory_rows(),
        shortest_code_bits(),
        runge_kutta_growth(PUBLISHED.step, complex(PUBLISHED_LOOP.sensor[0].poles[0])),
        {reading: roll_response(performance(reading)) for reading in Preamplifier},
        PUBLISHED_LOOP.servo[0].gain,
    )


def fin_inertia() -> FinInertia:
    """Mass of a plate, a third of it for the water, on a lever of a fifth of the chord."""
    mass = PUBLISHED.density * PUBLISHED.span * PUBLISHED.chord * PUBLISHED.thickness
    return FinInertia(
        PUBLISHED.span / PUBLISHED.aspect,
        mass,
        _stock_inertia(mass, PUBLISHED.chord_of_lever),
        _stock_inertia(mass, PUBLISHED.chord),
    )


def _stock_inertia(mass: float, chord: float) -> float:
    return 4.0 / 3.0 * mass * (0.2 * chord) ** 2


def fin_rate_readings(preamplifier: Preamplifier) -> tuple[float, float]:
    """rms of alpha / s [deg s] and of s alpha [deg/s] where the gains were set."""
    of = performance(preamplifier)
    w = effective_slope(DESIGN_SEA).omega_e
    S = 1.0 / (1.0 + of.loop.open_loop(w))
    fins = of.loop.gain_values @ of.loop.controller_terms(w) * of.loop.disturbance.frequency_response(w) * S
    energy = np.abs(fins) ** 2 * effective_slope(DESIGN_SEA).energy
    return tuple(math.degrees(math.sqrt(float(np.sum(energy * w**power)))) for power in (-2, 2))  # type: ignore[return-value]


def roulette_sum(generator: np.random.Generator) -> float:
    """What the probabilities of a population of 50 add up to when they are divided by a sum over its first 3."""
    share = selection_probabilities(generator.random(50))
    return float(1.0 / share[:3].sum())


def contradictory_rows() -> tuple[str, ...]:
    """Return rows whose columns cannot come from one sea."""
    made = []
    for row in TABLE_1:
        (low, high), (other_low, other_high) = row.traditional.uncontrolled_bounds, row.genetic.uncontrolled_bounds
        if high < other_low or other_high < low:
            made.append(row.name)
    return tuple(made)


def shortest_code_bits() -> int:
    """Return bits of the shortest code whose values round to all gains as they are printed."""
    return next(bits for bits in range(2, LONGEST_CODE) if _represents_gains(bits))


def _represents_gains(bits: int) -> bool:
    values, box = PUBLISHED_VALUES, Box(LOWER, UPPER)
    nearest: Array = decode(encode(values, box, bits), box)
    return bool(np.all(np.round(nearest, PRINTED_DIGITS) == values))


def runge_kutta_growth(step: float, pole: complex) -> float:
    """|1 + z + z^2 / 2 + z^3 / 6 + z^4 / 24|, z = h lambda: above 1 the classical method diverges."""
    z = step * pole
    return abs(1.0 + z + z**2 / 2.0 + z**3 / 6.0 + z**4 / 24.0)
