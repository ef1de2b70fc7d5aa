"""Are the bands right? Heading and position in windows of runs left out, against bands that never saw the run."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from seatrial.core.values import Array, InputError
from seatrial.data.trial import TrialRecord
from seatrial.estimation.estimate.fit import Identified
from seatrial.estimation.information.discrepancy import Miss, discrepancy
from seatrial.estimation.information.extrapolation import index_of
from seatrial.estimation.predict.cross_validation import Protocol, windows
from seatrial.estimation.predict.forecast import scatter_of
from seatrial.estimation.predict.margins import missed_track, without


@dataclass(frozen=True)
class Covered:
    """Share of the measured samples, over all windows of a run, in the 95 % band of each channel (psi, x0, y0)."""

    run: str
    windows: int
    shares: dict[str, float]


@dataclass(frozen=True, eq=False)
class Missed:
    """How windows were missed, for each training run by the estimate without it, and for each run held out."""

    trained: tuple[tuple[Miss, ...], ...]
    held: tuple[tuple[Miss, ...], ...]
    degrees_of_freedom: float


def missed_windows(
    found: Identified, train: Sequence[TrialRecord], held: Sequence[TrialRecord], protocol: Protocol, seed: int = 0
) -> Missed:
    """Every window of the training runs predicted without its run, and of the runs held out with all.

    Raises:
        InputError: fewer runs than a jackknife needs.
    """
    left_out = found.uncertainty.left_out
    if left_out is None:
        raise InputError("bands are judged by runs left out; the trial has too few training runs, add some")
    problem, scatter, rng = found.made.problem, scatter_of(found), np.random.default_rng(seed)

    def of(item: TrialRecord, point: Array, others: Sequence[TrialRecord]) -> tuple[Miss, ...]:
        index = index_of(item.record, [o.record for o in others])
        by = without(problem, point, item.session)
        pieces = windows(item.record, protocol)
        made = [missed_track(problem, by, piece, protocol.initial_s, scatter, rng) for piece in pieces]
        return tuple(replace(m, index=index) for m in made if m is not None)

    trained = tuple(of(item, left_out[i], [*train[:i], *train[i + 1 :]]) for i, item in enumerate(train))
    return Missed(trained, tuple(of(item, found.made.shared, train) for item in held), scatter.degrees_of_freedom)


def covered(missed: Missed) -> tuple[tuple[Covered, ...], tuple[Covered, ...]]:
    """How much of the training runs and of the runs held out lies within their bands.

    The discrepancy of a training run is that of the other training runs.
    """
    t, trained = float(stats.t.ppf(0.975, missed.degrees_of_freedom)), missed.trained
    everything = [m for mine in trained for m in mine]
    within = tuple(_share(own, [m for other in trained if other is not own for m in other], t) for own in trained)
    return within, tuple(_share(own, everything, t) for own in missed.held)


def _share(own: Sequence[Miss], others: Sequence[Miss], t: float) -> Covered:
    known = discrepancy(others)
    inside: dict[str, list[float]] = {}
    for miss in own:
        for channel, error in miss.errors.items():
            half = t * known.of_channel(channel, miss.foreseen[channel], miss.dt, miss.index)
            seen = np.isfinite(error)
            if seen.any():
                inside.setdefault(channel, []).append(float(np.mean((np.abs(error) <= half)[seen])))
    shares = {channel: float(np.mean(each)) for channel, each in inside.items()}
    return Covered(own[0].run if own else "", len(own), shares)
