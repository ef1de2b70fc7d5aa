"""The loop on board: poll, admit, note, estimate, show. No threads, and nothing that is sent can end it."""

import math
from collections import deque
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from time import monotonic

import numpy as np

from seatrial.core.results import Fit
from seatrial.core.results.online import NO_SAMPLE, SampleCounts, Snapshot
from seatrial.core.values import ProgressReporter
from seatrial.data.trial import Trial
from seatrial.data.trial.follow_table import require_stream
from seatrial.data.trial.trial import Stream, StreamSource
from seatrial.estimation.identify import identify
from seatrial.estimation.identify.online import OnlineEstimator
from seatrial.onboard.advice import ManoeuvreAdviser
from seatrial.onboard.journal import Journal, journal_identity
from seatrial.onboard.required_channels import check_required_channels
from seatrial.onboard.run_buffer import RunBuffer, with_training_records
from seatrial.onboard.sample import Sample, SampleSource
from seatrial.onboard.sources import open_source
from seatrial.onboard.stream_session import StreamEstimator, StreamSession

_POLL_WAIT_S, _PROCESSING_S, _DISPLAY_INTERVAL_S, _MAX_EMPTY_POLLS = 0.2, 0.1, 0.5, 3
# samples that may wait for the estimator
_MAX_QUEUE = 10_000
# sources that give everything once more when they are opened again
_REOPENABLE = (StreamSource.FILE, StreamSource.NMEA_FILE)

Show = Callable[[Snapshot, SampleCounts], None]
Stop = Callable[[], bool]


@dataclass(frozen=True, eq=False)
class FollowResult:
    """How following ended.

    Attributes:
        snapshot: the last one; None where no sample came. counts: of all samples, those of the journal included.
        fit: what `identify` says of the samples accepted, where they were followed to their end with `once`.
        messages: what else is to be said: a torn journal, trouble of the estimator.
    """

    snapshot: Snapshot | None
    counts: SampleCounts
    fit: Fit | None = None
    messages: tuple[str, ...] = ()

    @property
    def result(self) -> Fit | Snapshot:
        """Return the fit where there is one, else the last estimate with the counts of all samples."""
        return self.fit if self.fit is not None else replace(self.snapshot or NO_SAMPLE, counts=self.counts)


def follow(
    trial: Trial,
    *,
    source: SampleSource | None = None,
    once: bool = False,
    journal: Path | None = None,
    show: Show | None = None,
    stop: Stop | None = None,
    estimator: StreamEstimator | None = None,
    seed: int = 0,
    report_progress: ProgressReporter | None = None,
) -> FollowResult:
    """Estimate the trial's model from the samples of its stream, until they end, `stop` says so, or Ctrl-C.

    Args:
        source: takes the place of the one that [follow] names, and is left open.
        once: end at the end of the input; the fit of what was accepted then is that of `identify`.
        journal: where admitted samples are kept; what is there already is taken in first.
        show: called with the newest snapshot twice a second at most, and at the end.
        estimator: takes the place of the house's.
        seed: of that fit.

    Raises:
        InputError: no [follow], channels that are lacking, a source that cannot be opened, a journal of another trial;
            with `once` also whatever `identify` refuses.
    """
    stream = require_stream(trial)
    check_required_channels(trial)
    kept = RunBuffer(stream.layout) if once else None
    with ExitStack() as held:
        is_known = journal is not None and journal.exists()
        log = None if journal is None else _open_journal(held, journal, trial)
        if log is not None and is_known and report_progress is not None:
            report_progress(f"taking in {log.path.name}")
        # open before the journal is taken in, so that what comes meanwhile waits in the socket
        feed = source or _open_stream(held, stream, once=once)
        known = estimator or OnlineEstimator(trial)
        voyage, adviser = StreamSession(stream, known, log, kept), ManoeuvreAdviser(trial, known)
        watch = _Display(voyage, _show_with_advice(show, adviser), stop or _never_stop)
        again = (
            partial(_open_stream, held, stream, once=once) if source is None and stream.source in _REOPENABLE else None
        )
        is_ended = False
        try:
            early = [] if log is None else _replay_journal(voyage, log, feed, watch, source_waits=again is not None)
            if early is not None:
                feed, first = _resume_source(voyage, feed, early, again)
                is_ended = _process_stream(voyage, feed, first, watch)
        except KeyboardInterrupt:
            pass
        finally:
            voyage.finish()
        counts = voyage.counts(feed.counts)
    latest = voyage.snapshot
    if latest is not None:
        latest = adviser.with_final_advice(known.relinearise() if isinstance(known, OnlineEstimator) else latest)
    if latest is not None and show is not None:
        show(latest, counts)
    fit = None
    if kept is not None and is_ended:
        fit = identify(with_training_records(trial, kept.records()), seed=seed, report_progress=report_progress)
    trouble = (log.write_error,) if log is not None and log.write_error else ()
    return FollowResult(latest, counts, fit, (*voyage.messages, *trouble))


def _show_with_advice(show: Show | None, adviser: ManoeuvreAdviser) -> Show:
    """Shows what would help, too."""
    if show is None:
        return _show_nothing
    return lambda snapshot, counts: show(adviser.with_advice(snapshot), counts)


class _Display:
    """Shows what is known and asks whether to go on, twice a second at most."""

    def __init__(self, session: StreamSession, show: Show, stop: Stop) -> None:
        self._session, self._show, self._stop = session, show, stop
        self._shown_at = -math.inf

    def should_continue(self, source: SampleSource) -> bool:
        """False where the end was asked for."""
        if monotonic() - self._shown_at < _DISPLAY_INTERVAL_S:
            return True
        self._shown_at = monotonic()
        if self._session.snapshot is not None:
            self._show(self._session.snapshot, self._session.counts(source.counts))
        return not self._stop()


def _replay_journal(
    session: StreamSession, journal: Journal, source: SampleSource, watch: _Display, *, source_waits: bool
) -> list[Sample] | None:
    """What came while the journal was taken in, unless the source waits for its reader; None: the end was asked for."""
    early: list[Sample] = []
    polled = monotonic()
    for event in session.journal_events(journal):
        session.process(event)
        if not watch.should_continue(source):
            return None
        if not source_waits and monotonic() - polled > _PROCESSING_S and len(early) < _MAX_QUEUE and not source.is_over:
            early += source.poll(0.0)
            polled = monotonic()
    return early


def _process_stream(session: StreamSession, source: SampleSource, first_samples: list[Sample], watch: _Display) -> bool:
    """The loop itself; whether the source ended, rather than somebody's patience.

    Between two samples that take long the source is asked again, so that nothing is lost while a search goes on.
    """
    queue = deque(session.admit(first_samples))
    while watch.should_continue(source):
        if source.is_over and not queue:
            return True
        if len(queue) < _MAX_QUEUE and not source.is_over:
            queue.extend(session.admit(source.poll(0.0 if queue else _POLL_WAIT_S)))
        turn = monotonic() + _PROCESSING_S
        while queue:
            session.process(queue.popleft())
            if monotonic() > turn:
                break
    return False


def _open_stream(stack: ExitStack, stream: Stream, *, once: bool) -> SampleSource:
    feed = open_source(stream, once=once)
    stack.callback(feed.close)
    return feed


def _resume_source(
    session: StreamSession, source: SampleSource, early_samples: list[Sample], reopen: Callable[[], SampleSource] | None
) -> tuple[SampleSource, list[Sample]]:
    """The source behind a journal, and what of it has come that is new, first of all `early_samples`.

    reopen: opens a source that gives everything once more. That is read up to the journal's last sample, which is
        skipped with all before it; where it is not found, the file is another one and begins from its start, with a
        run of its own. So does what comes from any other source, as the length of the break is not known.
    """
    if session.last_journalled is None:
        return source, early_samples
    new = None if reopen is None else _samples_after(source, session.last_journalled)
    if new is not None:
        return source, new
    session.restart()
    return (source, early_samples) if reopen is None else (reopen(), [])


def _samples_after(source: SampleSource, last: Sample) -> list[Sample] | None:
    """What of a poll comes behind that sample; None if the source does not hold it."""
    empty = 0
    while not source.is_over and empty < _MAX_EMPTY_POLLS:
        samples = source.poll(_POLL_WAIT_S)
        empty = 0 if samples else empty + 1
        for place, sample in enumerate(samples, start=1):
            if sample.time == last.time and np.array_equal(sample.values, last.values, equal_nan=True):
                return samples[place:]
    return None


def _open_journal(stack: ExitStack, path: Path, trial: Trial) -> Journal:
    layout = require_stream(trial).layout
    journal = Journal(path, journal_identity(trial.model, layout), len(layout.columns))
    stack.callback(journal.close)
    return journal


def _show_nothing(snapshot: Snapshot, counts: SampleCounts) -> None:
    """Nobody looks."""


def _never_stop() -> bool:
    return False
