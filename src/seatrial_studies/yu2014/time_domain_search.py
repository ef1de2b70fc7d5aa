"""The search as the paper ran it, each individual simulated for 1000 s in steps of 0.1 s; once, in the full study."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.control import genetic_run
from seatrial.core.values import Array
from seatrial.numerics.optimise import GeneticSettings
from seatrial.physics.loops import Preamplifier, state_space
from seatrial.physics.sea import Spacing, ittc, realise
from seatrial.physics.simulate import loop_record
from seatrial_studies.yu2014.histories import LINES, response_to_slope
from seatrial_studies.yu2014.published import HEIGHT, RECORD_SECONDS, STEP
from seatrial_studies.yu2014.published_loop import (
    DESIGN_SEA,
    KNOT,
    FinObjective,
    RollResponse,
    objective_values,
    performance,
    roll_response,
)
from seatrial_studies.yu2014.searches import BITS, BOX

_DIVERGED = 1e3  # rad^2, variance from which on a record has run away: far beyond a full turn


@dataclass(frozen=True, eq=False)
class TimeDomainSearch:
    """One search by records of one sea, and the same search by the sea's spectrum.

    Attributes:
        gains: answers by records and by the spectrum, same random numbers, each (3,).
        responses: of both in the spectrum.
        cpu_s: CPU time of both searches, s.
        evaluations: records simulated.
    """

    preamplifier: Preamplifier
    gains: tuple[Array, Array]
    responses: tuple[RollResponse, RollResponse]
    cpu_s: tuple[float, float]
    evaluations: int


def time_domain_search(preamplifier: Preamplifier, seed: int) -> TimeDomainSearch:
    """Search once by 10,000 records of 1000 s in one realised sea, the seed's, and once by its spectrum."""
    of = performance(preamplifier)
    states, slope = state_space(of.loop), wave_slope_record(np.random.default_rng([seed, 10]))

    def by_records(points: Array) -> Array:
        records = (loop_record(states, gains, slope, STEP) for gains in points)
        with np.errstate(over="ignore", invalid="ignore"):
            variances = np.array([record.var(axis=0) for record in records])
        bounded = np.where(np.isfinite(variances) & (variances < _DIVERGED), variances, np.inf)
        return objective_values(bounded, FinObjective.PRINTED)

    def by_spectrum(points: Array) -> Array:
        return objective_values(of.evaluate(points, with_Ms=False).variances, FinObjective.PRINTED)

    runs = [
        genetic_run(objectives, BOX, GeneticSettings(bits=BITS), np.random.default_rng([seed, 0]))
        for objectives in (by_records, by_spectrum)
    ]
    first, second = runs
    return TimeDomainSearch(
        preamplifier,
        (first.gains, second.gains),
        (roll_response(of, first.gains), roll_response(of, second.gains)),
        (first.cpu_s, second.cpu_s),
        first.evaluations,
    )


def wave_slope_record(generator: np.random.Generator) -> Array:
    """Return the effective wave slope [rad] of 1000 s at 0.1 s, 18 kn, 90 deg, long-crested ITTC 3.3 m."""
    beta = math.radians(DESIGN_SEA.heading)
    lines = realise(ittc(HEIGHT), DESIGN_SEA.speed * KNOT, beta, generator, count=LINES, spacing=Spacing.JITTERED)
    time = np.arange(round(RECORD_SECONDS / STEP) + 1, dtype=np.float64) * STEP
    return response_to_slope(lines, np.ones(len(lines.omega), dtype=np.complex128), np.asarray(time))
