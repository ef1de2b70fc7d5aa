"""Figures 6 and 7: a model that is carried on while its coefficients are identified, beside one left at a guess."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial_studies.qi2025.published import SearchAlgorithm
from seatrial_studies.qi2025.reproduction import FIGURE_HEADING, NARROW_HALF_WIDTH, SearchSetting, WildHorseReproduction
from seatrial_studies.swarm_search import SearchData, candidates_for, centred_box

# guesses drawn from the box of the search; our choice
GUESSES = 20
_MOTIONS = [0, 2]


@dataclass(frozen=True, eq=False)
class Tracking:
    """Motions of the identified model at 45 degrees, and their errors.

    Attributes:
        states: of IWHO's first run, carried by the best point of each iteration, then by the last, (samples, 4).
        errors: rms error of heave and pitch over the rms of the motion, (2,), by algorithm.
        guess_errors: the same of coefficients drawn once from the box and kept, mean over the guesses, (2,).
        lag_gain: rms error of heave and pitch over that against the motion one sample earlier, (2,): above 1 where
            the model lags a sample, as the paper says of its own.
    """

    states: Array
    errors: dict[SearchAlgorithm, Array]
    guess_errors: Array
    lag_gain: Array


def track(reproduction: WildHorseReproduction, seed: int) -> Tracking:
    """Return the first runs in the paper's setting, and guesses that are never corrected."""
    data = reproduction.seas[FIGURE_HEADING][0]
    states = {
        a: tracked_states(data, reproduction.searches[SearchSetting.PAPER, FIGURE_HEADING, a].trace)
        for a in SearchAlgorithm
    }
    guesses = centred_box(data.truth, NARROW_HALF_WIDTH).random_points(np.random.default_rng([seed, 31]), GUESSES)
    guessed = [relative_error(data, tracked_states(data, guess[None])) for guess in guesses]
    iwho = states[SearchAlgorithm.IWHO][:, _MOTIONS]
    ship = data.states[:, _MOTIONS]
    lag_gain = _rms(iwho[1:] - ship[1:]) / _rms(iwho[1:] - ship[:-1])
    errors = {a: relative_error(data, path) for a, path in states.items()}
    return Tracking(states[SearchAlgorithm.IWHO], errors, np.mean(guessed, axis=0), lag_gain)


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
