"""Training runs, each left out of the estimate in turn: what bands of predictions are calibrated by.

A band is judged by runs left out that are cut and begun as what it is shown for: windows of its length, or whole runs.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.data.check.signal import sample_noise
from seatrial.estimation.information.discrepancy import Discrepancy, HoldoutError, discrepancy
from seatrial.estimation.predict.draws import PredictionUncertainty, StartStates
from seatrial.estimation.predict.open_loop import open_loop_runs
from seatrial.estimation.predict.prediction_intervals import HoldoutModel, window_spreads
from seatrial.estimation.predict.windows import Windows
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.workers import map_in_threads

_WINDOWS = 20  # of each run left out, evenly spread; chosen: neighbours err alike


@dataclass(frozen=True, eq=False)
class LeftOutRun:
    """A training run, and what is known of it without it.

    Attributes:
        holdout: model and offsets by the other runs; uncertainty: what they leave open.
        index: extrapolation index of the run against the others.
    """

    record: Record
    holdout: HoldoutModel
    uncertainty: PredictionUncertainty
    index: float


@dataclass(frozen=True, eq=False)
class LeftOutRuns:
    """Runs left out that calibrate windows of any length, each length once.

    Attributes:
        template: the problem whose outputs, noise and nuisances are used; seed: of what is drawn.
        seconds: of a window's beginning, for its initial state, at most.
        whole: discrepancy of whole runs, for windows that fewer runs hold than a discrepancy needs.
        of_length: discrepancies found so far, by number of steps.
    """

    template: OutputError
    runs: tuple[LeftOutRun, ...]
    seconds: float
    whole: Discrepancy
    seed: int
    workers: int | None = None
    of_length: dict[int, Discrepancy] = field(default_factory=dict)

    def discrepancy(self, seconds: float) -> Discrepancy:
        """Return what windows of this length [s] of runs left out miss beyond what is foreseen and sensors add."""
        steps = Windows.steps_of(seconds, self.runs[0].record.dt) if self.runs else 0
        if steps not in self.of_length:
            found = map_in_threads(
                lambda i: list(self._errors(i, seconds)), range(len(self.runs)), workers=self.workers
            )
            self.of_length[steps] = discrepancy([e for errors in found for e in errors], self.whole)
        return self.of_length[steps]

    def _errors(self, number: int, seconds: float) -> Iterator[HoldoutError]:
        run = self.runs[number]
        windows = Windows.cut([run.record], seconds).evenly_spread(_WINDOWS)
        rng = np.random.default_rng((self.seed, number, windows.steps))
        initial = windows.initial_seconds(self.seconds)
        found = band_errors(self.template, run.holdout, windows, initial, run.uncertainty, rng)
        yield from (replace(error, index=run.index) for error in found)


def band_errors(
    template: OutputError, holdout: HoldoutModel, windows: Windows, seconds: float, uncertainty: PredictionUncertainty,
    rng: np.random.Generator,
) -> Iterator[HoldoutError]:  # fmt: skip
    """Yield how each window of a run is missed by a model fitted without it, those left out that diverge.

    The sensors' noise counts as foreseen: a measured sample lies about the true one by as much.

    seconds: of a window's beginning, for its initial state.
    """
    if not len(windows):
        return
    own = holdout.nuisances[None]
    runs = open_loop_runs(template, holdout.model, windows, own, seconds)
    simulated, starts = [run.record for run in runs], StartStates.joined([run.start for run in runs])
    spreads = window_spreads(template, holdout.model, windows, simulated, starts, own, uncertainty, rng)
    for piece, run, spread in zip(windows.pieces, runs, spreads, strict=True):
        sds = with_sensor_noise(piece, spread)
        if run.divergence is None and sds:
            yield HoldoutError(piece.name, piece.dt, {c: run.record[c] - piece.measured(c) for c in sds}, sds)


def with_sensor_noise(measured: Record, spread: dict[str, Array]) -> dict[str, Array]:
    """Return standard deviations of what is measured, of the channels that are, from those of what is simulated."""
    return {c: np.hypot(sd, sample_noise(measured.channel(c).readings)) for c, sd in spread.items() if c in measured}
