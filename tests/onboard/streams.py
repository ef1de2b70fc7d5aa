"""Streams to follow in tests: the example's voyage, in pieces, and an estimator that only takes notes."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from seatrial.core.results import Fit
from seatrial.core.results.online import EstimatorPhase, Sample, SampleCounts, Snapshot
from seatrial.data.folder.document import document
from seatrial.data.trial import EstimateMethod, Trial, load_trial
from seatrial.data.trial.runs import require_stream
from seatrial.onboard.follow import FollowResult

EXAMPLES = Path(__file__).parents[2] / "examples"
VOYAGE = EXAMPLES / "heave_pitch" / "voyage_1.csv"
LINES = VOYAGE.read_text(encoding="utf-8").splitlines(keepends=True)


class RecordingEstimator:
    """An estimator that remembers what it was given."""

    def __init__(self) -> None:
        self.runs: list[list[float]] = []
        self.values: list[np.ndarray] = []

    def begin_run(self) -> None:
        self.runs.append([])

    def update(self, sample: Sample) -> Snapshot:
        self.runs[-1].append(sample.time)
        self.values.append(sample.values)
        count = len(self.values)
        return Snapshot(
            sample.time, count, len(self.runs), EstimatorPhase.WAITING, ("a",), ("1",), np.ones(1), np.ones(1)
        )


class ListSource:
    """A source that gives what it has, one list a poll, then is over; a list that is None is Ctrl-C."""

    def __init__(self, *polls: list[Sample] | None) -> None:
        self._polls = list(polls)
        self.counts = SampleCounts()
        self.is_closed = False

    def poll(self, seconds: float) -> list[Sample]:  # noqa: ARG002
        samples = self._polls.pop(0)
        if samples is None:
            raise KeyboardInterrupt
        return samples

    @property
    def is_over(self) -> bool:
        return not self._polls

    def close(self) -> None:
        self.is_closed = True


def stream_trial(file: Path = VOYAGE) -> Trial:
    """The example's trial, its stream from `file`, no runs besides, estimated by output error."""
    trial = load_trial(EXAMPLES / "heave_pitch_follow.toml")
    plain = replace(trial.estimate, method=EstimateMethod.OUTPUT_ERROR)
    return replace(trial, runs=(), estimate=plain, stream=replace(require_stream(trial), file=file, name=file.stem))


def sample_range(first: int, last: int, start: float = 0.0) -> list[Sample]:
    """Samples of the four channels, numbers `first` to before `last`, at 10 Hz."""
    return [Sample(start + 0.1 * i, np.array([i, 1.0, 2.0, 3.0])) for i in range(first, last)]


def fit_json_without_time(fit: Fit | None) -> dict:
    """The fit as JSON, but for the time it took."""
    assert fit is not None
    return {key: value for key, value in document(fit).items() if key != "elapsed_s"}


def accepted_count(outcome: FollowResult) -> int:
    """How many samples were used."""
    return outcome.counts.accepted
