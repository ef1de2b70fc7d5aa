"""What Qi et al. 2025 print, and what their own numbers say when they are worked through again."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.hydro import G, encounter_frequency
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.sea import ittc, realise
from seatrial.physics.simulate import trajectories
from seatrial_studies.heave_pitch_search import SearchData, candidate_matrices, simulate_search_data
from seatrial_studies.seaway import HEADINGS, SIGNIFICANT_HEIGHT, SPEED, theoretical_coefficients
from seatrial_studies.study_file import Declared, read_study

# What Qi et al. 2025 print: tables 2 to 5, statements, and what figures show.

SOURCE = read_study("qi2025").source


class SearchAlgorithm(StrEnum):
    """The optimisers that the paper compares."""

    PSO = "PSO"
    WHO = "WHO"
    IWHO = "IWHO"


class PrintedEstimate(Declared):
    """A column of tables 2 to 4: estimates, magnitudes in the order of COEFFICIENTS, errors [%], seconds of table 5."""

    heading: int
    algorithm: SearchAlgorithm
    estimates: tuple[float, ...]
    errors: tuple[float, ...]
    seconds: float


PRINTED = {
    (printed.heading, printed.algorithm): printed
    for printed in map(PrintedEstimate.model_validate, read_study("qi2025").published["estimates"])
}


def printed_estimate(heading: int, algorithm: SearchAlgorithm) -> Array:
    """Printed estimates, magnitudes, (8,) in the order of COEFFICIENTS."""
    return np.array(PRINTED[heading, algorithm].estimates)


def printed_error(heading: int, algorithm: SearchAlgorithm) -> Array:
    """Printed relative errors, per cent, (8,): of the mean of ten runs."""
    return np.array(PRINTED[heading, algorithm].errors)


def true_values(heading: int) -> Array:
    """Printed theoretical values, magnitudes, (8,)."""
    values = theoretical_coefficients(heading, printed_sign=True).values
    return np.array([values[name] for name in COEFFICIENTS])


def recomputed_error(heading: int, algorithm: SearchAlgorithm) -> Array:
    """Return the relative errors of the printed estimates, per cent, (8,), with their sign."""
    return 100.0 * (printed_estimate(heading, algorithm) / true_values(heading) - 1.0)


def mean_recomputed_error(heading: int, algorithm: SearchAlgorithm) -> float:
    """Return the mean absolute error of the printed estimates, per cent."""
    return float(np.mean(np.abs(recomputed_error(heading, algorithm))))


def printed_mean_errors() -> list[float]:
    """Return the mean printed error of IWHO at each heading, per cent."""
    return [float(np.mean(printed_error(heading, SearchAlgorithm.IWHO))) for heading in HEADINGS]


def misprinted_errors() -> list[tuple[int, SearchAlgorithm, str, float, float]]:
    """Printed errors that do not follow from the printed values: heading, algorithm, coefficient, printed, recomputed.

    Four printed digits of estimate and truth leave some 0.02 points of doubt.
    """
    found = []
    for heading in HEADINGS:
        for algorithm in SearchAlgorithm:
            again = np.abs(recomputed_error(heading, algorithm))
            for name, said, is_so in zip(COEFFICIENTS, printed_error(heading, algorithm), again, strict=True):
                if abs(said - is_so) > 0.05:
                    found.append((heading, algorithm, name, float(said), float(is_so)))
    return found


# What the paper's own numbers say when they are worked through again.

# per cent, errors that stand at the end of the search box
SATURATED_RANGE = (-10.05, -9.3)


@dataclass(frozen=True, eq=False)
class WildHorseAudit:
    """Numbers behind the verdicts.

    Attributes:
        implied_speeds: heading -> (b35 + |b53|) / (2 a33) and (b35 - |b53|) / (2 a33), m/s.
        implied_frequencies: heading -> frequency of encounter [rad/s] that the tables' coefficients have been computed
            for, sqrt(2 U b33 / (a53 - a35)) with |b53|'s sign: strip theory adds +- U b33 / w^2 to a35 and a53.
        encounter_ranges: heading -> least and largest frequency of encounter [rad/s] of the 30 harmonics.
        repetition: s after which the sea at 90 degrees repeats itself: 2 pi over the interval of the harmonics.
        sign_effect: heading -> rms change of heave and pitch by the printed sign of b53, over their rms.
        saturated_values: values of WHO at 90 and 135 degrees between -10 and -9.3 %, and their number.
        median_extremes: largest heave [m] and pitch [deg] within 200 s at 45 degrees, median over seas.
        kinematic_pitch: smallest pitch in degrees that goes with the heave of figures 1 and 2 in waves long
            enough to be followed.
        spectrum_heights: significant height [m] of the spectrum with B = 3.11 / h^3 as printed, and with h^2.
        step_rank: directions of the eight unknowns that one step of two motions identifies.
        beyond_box: PSO's printed values farther from the truth than 10.05 %, their number, the largest error [%].
    """

    implied_speeds: dict[int, tuple[float, float]]
    implied_frequencies: dict[int, float]
    encounter_ranges: dict[int, tuple[float, float]]
    repetition: float
    sign_effect: dict[int, tuple[float, float]]
    saturated_values: tuple[int, int]
    median_extremes: tuple[float, float]
    kinematic_pitch: float
    spectrum_heights: tuple[float, float]
    step_rank: int
    beyond_box: tuple[int, int, float]


def audit(seas: list[SearchData], seed: int) -> WildHorseAudit:
    """Everything that needs no search; `seas` at 45 degrees."""
    tops = np.array([np.abs(s.states[:, [0, 2]]).max(axis=0) for s in seas])
    return WildHorseAudit(
        {h: _implied_speeds(h) for h in HEADINGS},
        {h: _implied_frequency(h) for h in HEADINGS},
        {h: _encounter_range(h) for h in HEADINGS},
        _repetition(),
        {h: _sign_effect(h, seed) for h in HEADINGS},
        _saturation(),
        (float(np.median(tops[:, 0])), math.degrees(float(np.median(tops[:, 1])))),
        _kinematic_pitch(),
        _spectrum_heights(),
        _step_rank(seas[0]),
        _beyond_box(),
    )


def _implied_speeds(heading: int) -> tuple[float, float]:
    a33, b35, b53 = (true_values(heading)[COEFFICIENTS.index(n)] for n in ("a33", "b35", "b53"))
    return float((b35 + b53) / (2.0 * a33)), float((b35 - b53) / (2.0 * a33))


def _implied_frequency(heading: int) -> float:
    """Return w from a53 - a35 = 2 U b33 / w^2 (strip theory, Salvesen, Tuck & Faltinsen 1970, without end terms)."""
    a35, a53, b33 = (true_values(heading)[COEFFICIENTS.index(n)] for n in ("a35", "a53", "b33"))
    return float(np.sqrt(2.0 * SPEED * b33 / (a53 - a35)))


def _harmonics() -> Array:
    """Frequencies [rad/s] of the 30 harmonics, equal intervals over the band."""
    return realise(ittc(SIGNIFICANT_HEIGHT), SPEED, 0.0, np.random.default_rng(0)).omega


def _encounter_range(heading: int) -> tuple[float, float]:
    omega_e = np.abs(encounter_frequency(_harmonics(), SPEED, math.radians(heading)))
    return float(omega_e.min()), float(omega_e.max())


def _repetition() -> float:
    return float(2.0 * np.pi / np.diff(_harmonics())[0])


def _sign_effect(heading: int, seed: int) -> tuple[float, float]:
    data = simulate_search_data(heading, np.random.default_rng([seed, 3, heading]))
    turned = data.truth.copy()
    turned[COEFFICIENTS.index("b53")] *= -1.0
    A, B = candidate_matrices(np.stack([data.truth, turned]))
    y = trajectories(A, B, data.forcing, np.zeros(4))
    change: Array = np.sqrt(np.mean((y[1] - y[0]) ** 2, axis=0)) / np.sqrt(np.mean(y[0] ** 2, axis=0))
    return float(change[0]), float(change[1])


def _saturation() -> tuple[int, int]:
    errors = np.concatenate([recomputed_error(h, SearchAlgorithm.WHO) for h in (90, 135)])
    low, high = SATURATED_RANGE
    return int(np.sum((errors >= low) & (errors <= high))), len(errors)


def _kinematic_pitch() -> float:
    """Pitch [deg] of a ship that follows waves of 0.3 m amplitude and the sea's modal frequency at 45 degrees."""
    slope = 0.3 * ittc(SIGNIFICANT_HEIGHT).modal_frequency ** 2 / G
    return math.degrees(slope * math.cos(math.radians(45.0)))


def _spectrum_heights() -> tuple[float, float]:
    """4 sqrt(m0) with m0 = A / (4 B), A = 8.1e-3 g^2: the integral of eq. (13)."""
    heights = (4.0 * math.sqrt(8.1e-3 * G**2 * SIGNIFICANT_HEIGHT**power / (4.0 * 3.11)) for power in (3, 2))
    printed, corrected = heights
    return printed, corrected


def _step_rank(data: SearchData, sample: int = 100, change: float = 1e-4) -> int:
    """Rank of the slopes of both motions after one step, by all coefficients in relative terms."""
    count = len(data.truth)
    points = data.truth * (1.0 + change * np.vstack([np.eye(count), -np.eye(count)]))
    A, B = candidate_matrices(points)
    y = trajectories(A, B, data.forcing.one_step(sample), data.states[sample])[:, 1]
    slopes = (y[:count] - y[count:]) / (2.0 * change)
    return int(np.linalg.matrix_rank(slopes / np.abs(slopes).max(axis=0)))


def _beyond_box() -> tuple[int, int, float]:
    errors = np.abs(np.concatenate([recomputed_error(h, SearchAlgorithm.PSO) for h in HEADINGS]))
    return int(np.sum(errors > -SATURATED_RANGE[0])), len(errors), float(errors.max())
