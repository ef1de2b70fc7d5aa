"""Are the bands right? Heading and position in windows of runs left out, against bands that never saw the run."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from seatrial.estimate.fit import Identified
from seatrial.information.discrepancy import Miss, discrepancy
from seatrial.information.extrapolation import index_of
from seatrial.predict.cross_validation import Protocol, windows
from seatrial.predict.forecast import scatter_of
from seatrial.predict.margins import missed_track, without
from seatrial.trial import TrialRecord
from seatrial.values import InputError


@dataclass(frozen=True)
class Covered:
    """Share of a run's samples, over all its windows, that lie in the 95 % band of each channel (psi, x0, y0)."""

    run: str
    windows: int
    shares: dict[str, float]


def covered(
    found: Identified, train: Sequence[TrialRecord], held: Sequence[TrialRecord], protocol: Protocol, seed: int = 0
) -> tuple[tuple[Covered, ...], tuple[Covered, ...]]:
    """How much of the training runs, each left out in turn, and of the runs held out lies within their bands.

    A training run is predicted without it, and its model discrepancy is that of the other training runs.

    Raises:
        InputError: fewer runs than a jackknife needs.
    """
    left_out = found.uncertainty.left_out
    if left_out is None:
        raise InputError("bands are judged by runs left out; the trial has too few training runs, add some")
    problem, scatter, rng = found.made.problem, scatter_of(found), np.random.default_rng(seed)

    def of(item: TrialRecord, point: np.ndarray, others: Sequence[TrialRecord]) -> list[Miss]:
        index = index_of(item.record, [o.record for o in others])
        by = without(problem, point, item.session)
        pieces = windows(item.record, protocol)
        made = [missed_track(problem, by, piece, protocol.initial_s, scatter, rng) for piece in pieces]
        return [replace(m, index=index) for m in made if m is not None]

    trained = [of(item, left_out[i], [*train[:i], *train[i + 1 :]]) for i, item in enumerate(train)]
    t = float(stats.t.ppf(0.975, scatter.degrees_of_freedom))
    within = []
    for i, item in enumerate(train):
        others = [m for j, mine in enumerate(trained) if j != i for m in mine]
        within.append(_share(item.record.name, trained[i], others, t))
    everything = [m for mine in trained for m in mine]
    beyond = tuple(_share(item.record.name, of(item, found.made.shared, train), everything, t) for item in held)
    return tuple(within), beyond


def _share(run: str, own: Sequence[Miss], others: Sequence[Miss], t: float) -> Covered:
    known = discrepancy(others)
    inside: dict[str, list[float]] = {}
    for miss in own:
        for channel, error in miss.errors.items():
            half = t * known.of_channel(channel, miss.foreseen[channel], miss.dt, miss.index)
            inside.setdefault(channel, []).append(float(np.nanmean(np.abs(error) <= half)))
    return Covered(run, len(own), {channel: float(np.mean(shares)) for channel, shares in inside.items()})
