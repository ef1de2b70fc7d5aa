"""Training runs, each left out of the estimate in turn: what bands of predictions are calibrated by.

A band is judged by runs left out that are cut and begun as what it is shown for: windows of its length, or whole runs.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.motion import sample_noise
from seatrial.estimation.information.discrepancy import Discrepancy, HoldoutError, discrepancy
from seatrial.estimation.predict.draws import PredictionUncertainty, StartStates
from seatrial.estimation.predict.open_loop import open_loop_runs
from seatrial.estimation.predict.prediction_intervals import HoldoutModel, window_spreads
from seatrial.estimation.predict.windows import Windows
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.manoeuvres.recognition import ManoeuvreKind, recognise_manoeuvre

_WINDOWS = 20  # of each run left out, evenly spread; chosen: neighbours err alike


@dataclass(frozen=True, eq=False)
class HoldoutRun:
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
class RunErrors:
    """How the windows of a run of some kind of manoeuvre are missed."""

    kind: str
    errors: tuple[HoldoutError, ...]


@dataclass(frozen=True, eq=False)
class HoldoutRuns:
    """Runs left out that calibrate windows of any length, each length once.

    Attributes:
        template: the problem whose outputs, noise and nuisances are used; seed: of what is drawn.
        seconds: of a window's beginning, for its initial state, at most.
        whole_runs: their discrepancy, for windows that fewer runs hold than a discrepancy needs.
        of_length: what is known so far, by number of steps.
    """

    template: OutputError
    runs: tuple[HoldoutRun, ...]
    seconds: float
    whole_runs: Discrepancy
    seed: int
    workers: int | None = None
    of_length: dict[int, list[RunErrors]] = field(default_factory=dict)

    def discrepancy(self, seconds: float, kind: str = "") -> Discrepancy:
        """Return what windows of this length [s] of runs left out miss beyond what is foreseen and sensors add.

        kind: of manoeuvre (`manoeuvre_kind`), by whose runs alone it is found where there are enough of them.
        """
        if not self.runs:
            return self.whole_runs
        runs = self.errors_of_length(seconds)
        pooled = discrepancy([error for run in runs for error in run.errors], self.whole_runs)
        return discrepancy([error for run in runs if kind and run.kind == kind for error in run.errors], pooled)

    def errors_of_length(self, seconds: float) -> list[RunErrors]:
        """Return how windows of this length [s] of each run are missed."""
        steps = Windows.steps_of(seconds, self.runs[0].record.dt)
        if steps not in self.of_length:
            self.of_length[steps] = map_in_threads(
                lambda i: RunErrors(manoeuvre_kind(self.runs[i].record), tuple(self._errors(i, seconds))),
                range(len(self.runs)), workers=self.workers,
            )  # fmt: skip
        return self.of_length[steps]

    def _errors(self, number: int, seconds: float) -> Iterator[HoldoutError]:
        run = self.runs[number]
        windows = Windows.cut([run.record], seconds).evenly_spread(_WINDOWS)
        rng = np.random.default_rng((self.seed, number, windows.steps))
        initial = windows.initial_seconds(self.seconds)
        found = band_errors(self.template, run.holdout, windows, initial, run.uncertainty, rng)
        yield from (replace(error, index=run.index) for error in found)


def manoeuvre_kind(record: Record) -> str:
    """Return the kind of manoeuvre that a run shows; empty where it is none of those with a name, or has no rudder."""
    if not {"psi", "delta"} <= set(record.channels):
        return ""
    try:
        kind = recognise_manoeuvre(record)
    except InputError:  # nothing but gaps
        return ""
    return "" if kind is ManoeuvreKind.OTHER else kind.value


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
