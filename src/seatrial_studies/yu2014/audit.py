"""The print worked through again from its own numbers: misprints and what they would do."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.results import Table
from seatrial.core.values import Array
from seatrial.numerics.optimise import Box, decode, encode, selection_probabilities
from seatrial.physics.loops import Preamplifier
from seatrial_studies.yu2014.published import (
    ASPECT,
    CHORD,
    CHORD_OF_LEVER,
    DENSITY,
    DESIGN_SEA,
    FIN_LIMIT,
    INERTIA,
    LOWER,
    PREAMPLIFIER_LABELS,
    PUBLISHED_LOOP,
    PUBLISHED_VALUES,
    SATURATION,
    SPAN,
    STEP,
    TABLE_1,
    TARGET_DEG2,
    THICKNESS,
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
        FIN_LIMIT**2 / (2.0 * math.log(1.0 / SATURATION)),
        FIN_LIMIT**2 / (2.0 * 1.61),
        fin_inertia(),
        {reading: fin_rate_readings(reading) for reading in Preamplifier},
        roulette_sum(np.random.default_rng([seed, 3])),
        sum(row.genetic.reduction < row.traditional.reduction for row in TABLE_1),
        sum(row.traditional.rate > row.genetic.rate for row in TABLE_1),
        contradictory_rows(),
        shortest_code_bits(),
        runge_kutta_growth(STEP, complex(PUBLISHED_LOOP.sensor[0].poles[0])),
        {reading: roll_response(performance(reading)) for reading in Preamplifier},
        PUBLISHED_LOOP.servo[0].gain,
    )


def fin_inertia() -> FinInertia:
    """Mass of a plate, a third of it for the water, on a lever of a fifth of the chord."""
    mass = DENSITY * SPAN * CHORD * THICKNESS
    return FinInertia(SPAN / ASPECT, mass, _stock_inertia(mass, CHORD_OF_LEVER), _stock_inertia(mass, CHORD))


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


# The misprints of the paper, each with what the print does and what stands in its place.


def misprint_table(audit: FinGainAudit) -> Table:
    """Return the misprints, one row each."""
    both = [(PREAMPLIFIER_LABELS[r], audit.roll_responses[r], audit.fin_rate_readings[r]) for r in Preamplifier]
    rows = [
        (
            "section 2.2, target variance 150.31 deg²",
            f"22² / (2 ln 5) is {audit.target:.2f}; with ln 5 as 1.61, {audit.target_rounded:.2f}",
            f"{TARGET_DEG2}, as printed",
        ),
        (
            "section 2.3, chord 2.22 m, then 2.2 m",
            f"1.18 / 0.53 = {audit.fin_inertia.chord:.3f} m; I = "
            f"{audit.fin_inertia.inertia:.1f} kg m² with {CHORD_OF_LEVER} in the lever, "
            f"{audit.fin_inertia.consistent_inertia:.1f} with {CHORD} throughout",
            f"{INERTIA} kg m²; with eta it cancels in eq. (7)",
        ),
        (
            "section 2.2, fin rate = fin angle times 1/s",
            "; ".join(f"{words}: {integral:.1f}° s rms, an angle summed up" for words, _, (integral, _) in both),
            "times s: " + "; ".join(f"{rate:.1f}°/s" for _, _, (_, rate) in both),
        ),
        (
            "section 3, selection probabilities over a sum of 3",
            f"those of 50 add up to {audit.roulette_sum:.1f}",
            "the sum over the whole population",
        ),
        (
            "section 2.1, Phi is the open-loop transfer function",
            "without feedback it is G_phi: no gain would matter",
            "G_phi / (1 + L), as the block diagram has it",
        ),
        (
            "eq. (2), J2 = (var - 150.31)²",
            "; ".join(f"{words}: {m.fin**2:.0f} deg², {m.saturation_percent:.0f} % saturated" for words, m, _ in both)
            + "; below the target J2 rewards fin motion",
            "as printed, and one-sided beside",
        ),
        (
            "section 2.2, p substituted in “eq. (2)”",
            "eq. (2) is J2, which has no p",
            "in the share of amplitudes beyond 22°, Rayleigh",
        ),
        ("eq. (3), W without the 1 / (2 pi) of J1", "a factor that eq. (7) divides out", "neither has it"),
        ("eq. (7), sigma with 'max', in words 'the fittest'", "two searches, different answers", "max; best beside"),
        (
            "section 3, step of 0.1 s",
            f"a Runge-Kutta step grows by {audit.runge_kutta_growth:.0f} along the gyro's poles -40 ± 49i",
            "no step: variances in the frequency domain",
        ),
        (
            "section 3, codes",
            f"gains with three decimals need {audit.shortest_code_bits} bits",
            f"{audit.shortest_code_bits}",
        ),
        (
            "section 1, servo 550 / (s² + 15 s + 225)",
            f"{audit.servo_gain:.3f}° of fin for a degree ordered",
            "as printed",
        ),
        (
            "section 1, preamplifier with a lag of 30 s",
            f"P acts on the roll angle: Ms {audit.roll_responses[Preamplifier.PRINTED].Ms:.2f}",
            f"as printed, and as a washout beside: Ms {audit.roll_responses[Preamplifier.WASHOUT].Ms:.2f}",
        ),
    ]
    return Table("Misprints and loose ends, with evidence", ("print", "what it does", "here"), tuple(rows))
