"""Figures 6 and 7: models that are carried on while their coefficients are identified, and one left at a guess."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.problems import centred_box
from seatrial_studies.published_ship import HEADINGS
from seatrial_studies.qi2025.published import SearchAlgorithm
from seatrial_studies.qi2025.reproduction import FIGURE_HEADING, NARROW_HALF_WIDTH, SearchSetting, WildHorseReproduction
from seatrial_studies.sign_test import is_smaller
from seatrial_studies.swarm_search import SearchData, candidates_for

# guesses drawn from the box of the search; our choice
GUESSES = 20
_MOTIONS = [0, 2]


@dataclass(frozen=True, eq=False)
class Tracking:
    """Motions of the identified models, and their errors.

    Attributes:
        states: of IWHO's first run at 45 degrees, carried by the best point of each iteration, then by the last,
            (samples, 4).
        errors: rms error of heave and pitch of each run over the rms of the motion, (runs, 2), by heading and
            algorithm.
        guess_errors: at 45 degrees, of coefficients drawn once from the box and kept, mean over the guesses, (2,).
        lag_gain: rms error of heave and pitch over that against the motion one sample earlier, (2,): above 1 where
            the model lags a sample, as the paper says of its own.
    """

    states: Array
    errors: dict[tuple[int, SearchAlgorithm], Array]
    guess_errors: Array
    lag_gain: Array

    def median_error(self, heading: int, algorithm: SearchAlgorithm) -> Array:
        """Return the median over the runs, heave and pitch, (2,)."""
        return np.median(self.errors[heading, algorithm], axis=0)

    def is_most_accurate(self, headings: tuple[int, ...]) -> bool:
        """Return whether IWHO tracks heave and pitch more accurately than both others, by a sign test over the runs."""
        best, *others = (
            np.concatenate([self.errors[h, a] for h in headings])
            for a in (SearchAlgorithm.IWHO, SearchAlgorithm.WHO, SearchAlgorithm.PSO)
        )
        return all(is_smaller(best[:, j], other[:, j]) for other in others for j in range(len(_MOTIONS)))


def track(reproduction: WildHorseReproduction, seed: int) -> Tracking:
    """Return all runs in the paper's setting, and guesses that are never corrected."""
    errors = {}
    for heading in (FIGURE_HEADING, *HEADINGS):
        for a in SearchAlgorithm:
            traces = reproduction.searches[SearchSetting.PAPER, heading, a].traces
            pairs = zip(reproduction.seas[heading], traces, strict=True)
            errors[heading, a] = np.array([relative_error(d, tracked_states(d, trace)) for d, trace in pairs])
    data = reproduction.seas[FIGURE_HEADING][0]
    states = tracked_states(
        data, reproduction.searches[SearchSetting.PAPER, FIGURE_HEADING, SearchAlgorithm.IWHO].trace
    )
    guesses = centred_box(data.truth, NARROW_HALF_WIDTH).random_points(np.random.default_rng([seed, 31]), GUESSES)
    guessed = [relative_error(data, tracked_states(data, guess[None])) for guess in guesses]
    iwho, ship = states[:, _MOTIONS], data.states[:, _MOTIONS]
    lag_gain = _rms(iwho[1:] - ship[1:]) / _rms(iwho[1:] - ship[:-1])
    return Tracking(states, errors, np.mean(guessed, axis=0), lag_gain)


def tracked_states(data: SearchData, trace: Array) -> Array:
    """Return the states (samples, 4) from rest, step k with the point (8,) of iteration k, later with the last."""
    candidates = candidates_for(data)
    states = [data.states[0]]
    for step in range(len(data.states) - 1):
        point = trace[min(step, len(trace) - 1)]
        states.append(candidates.advanced_state(point, step, states[-1]))
    return np.array(states)


def relative_error(data: SearchData, states: Array) -> Array:
    """Return the rms error of heave and pitch over the rms of the ship's motion, (2,)."""
    ship = data.states[:, _MOTIONS]
    return _rms(states[:, _MOTIONS] - ship) / _rms(ship)


def _rms(values: Array) -> Array:
    return np.sqrt(np.mean(values**2, axis=0))
