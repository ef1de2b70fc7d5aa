"""The sides to which heave and pitch are positive, by the waves that move the craft."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, Record
from seatrial.data.draft.column_guess import Changes, ColumnGuess

_SURE = 0.5  # share of the motion in long waves that is in phase with what a craft follows, from which it shows; chosen
_LONG_WAVES = 0.5  # share of the waves' energy that lies below the frequency up to which waves count as long; chosen


def wave_motion_signs(record: Record) -> Changes:
    """Return the signs of z and theta: a craft rises with long waves, and in head seas its bow with their slope.

    Where neither shows, a heave sensor's usual sign stays open.
    """
    if "zeta" not in record:
        return {}
    changes: Changes = {}
    if "z" in record:
        changes["z"] = _decided(
            -_in_phase(record, "z"), "up", "down", "a craft rises with long waves, here those of a probe at midship"
        )
    if "theta" in record:
        text = "its bow rises on their front, if they come from ahead"
        changes["theta"] = _decided(_in_phase(record, "theta", of_slope=True), "bow down", "bow up", text)
    return changes


def _decided(share: float, other: str, standard: str, text: str) -> Callable[[ColumnGuess], ColumnGuess]:
    def decided(guess: ColumnGuess) -> ColumnGuess:
        opposite = "" if guess.positive == other else other
        if abs(share) < _SURE:
            evidence = f"in phase with long waves by only {abs(share):.2f}"
            return replace(guess, other_reading=f'positive = "{other}"').with_evidence(evidence)
        positive = guess.positive if share > 0.0 else opposite
        return replace(guess, positive=positive).with_evidence(f"{text}: the column is positive {positive or standard}")

    return decided


def _in_phase(record: Record, symbol: str, of_slope: bool = False) -> float:
    """The share, -1 to 1, of a motion in long waves that is in phase with their elevation or with its rate."""
    waves, motion = _spectrum(record["zeta"]), _spectrum(record[symbol])
    energy = np.cumsum(np.abs(waves) ** 2)
    long = energy <= _LONG_WAVES * energy[-1]
    followed = waves[long] * (1j if of_slope else 1.0)
    size = float(np.sqrt(np.sum(np.abs(followed) ** 2) * np.sum(np.abs(motion[long]) ** 2)))
    return float(np.real(np.sum(np.conj(followed) * motion[long]))) / size if size > 0.0 else 0.0


def _spectrum(values: Array) -> NDArray[np.complex128]:
    return np.fft.rfft((values - np.mean(values)) * np.hanning(len(values)))
