"""The loop on board: poll, order, journal, estimate, show. No threads, and no input can end it."""

import math
from collections import deque
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from time import monotonic, process_time

import numpy as np

from seatrial.core.results import Fit
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.results.online import NO_SAMPLE, CoefficientChange, Sample, SampleCounts, Snapshot
from seatrial.core.text.numbers import signed_percent
from seatrial.core.text.words import enumeration
from seatrial.core.values import Finding, InputError, ProgressReporter, Severity
from seatrial.data.trial import Trial
from seatrial.data.trial.runs import require_stream
from seatrial.data.trial.settings import Stream, StreamSource
from seatrial.estimation.identify import identify
from seatrial.estimation.identify.online import OnlineEstimator, SearchFollower, own_trial
from seatrial.estimation.identify.search import own_estimate_progress, published_fit
from seatrial.onboard.advice import ManoeuvreAdviser
from seatrial.onboard.journal import Journal, journal_identity
from seatrial.onboard.proposer import check_required_channels, gain_proposer
from seatrial.onboard.sources import SampleSource, open_source
from seatrial.onboard.stream_session import (
    RunBuffer,
    StreamEstimator,
    StreamEvent,
    StreamSession,
    with_training_records,
)
from seatrial.onboard.table import change_text, watch_sentence

# s: longest wait for samples, longest computation between two polls, shortest time between two displays; chosen: no
# user sees a delay, and they cost nothing
_POLL_WAIT_S, _PROCESSING_S, _DISPLAY_INTERVAL_S = 0.2, 0.1, 0.5
# polls without a sample after which a file is taken to hold no more for now; chosen: one may fall between two writes
_MAX_EMPTY_POLLS = 3
# samples that may wait for the estimator; chosen: a quarter of an hour at 10 Hz, some megabytes
_MAX_QUEUE = 10_000
# sources that can be read again from their start
_REOPENABLE = (StreamSource.FILE, StreamSource.NMEA_FILE)

Show = Callable[[Snapshot, SampleCounts], None]
Stop = Callable[[], bool]


@dataclass(frozen=True, eq=False)
class FollowResult:
    """The state when following ended.

    Attributes:
        snapshot: the last one; None where no sample arrived.
        counts: of all samples, those of the journal included.
        fit: of the samples accepted, as `identify` makes it; None unless they were followed to their end with `once`,
            and where every coefficient is fixed.
        messages: errors of the journal and of the estimator, in words.
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
    proposal_file: Path | None = None,
) -> FollowResult:
    """Estimate the trial's model from the samples of its stream, until they end, `stop` returns True, or Ctrl-C.

    Arguments and errors as in `seatrial.follow`; `source` is left open, `estimator` replaces `OnlineEstimator`.
    """
    stream = require_stream(trial)
    check_required_channels(trial)
    buffer = RunBuffer(stream.layout) if once else None
    with ExitStack() as stack:
        has_earlier_samples = journal is not None and journal.exists()
        log = None if journal is None else _open_journal(stack, journal, trial)
        if log is not None and has_earlier_samples and report_progress is not None:
            report_progress(f"reading {log.path.name}")
        # opened before the journal is read, so that samples that arrive meanwhile wait in the socket
        current = source or _open_stream(stack, stream, once=once)
        estimator = estimator or _estimator(trial, seed)
        proposer = (
            None if trial.proposal is None else gain_proposer(trial, trial.proposal, estimator, proposal_file, seed)
        )
        session = StreamSession(stream, estimator, log, buffer, proposer)
        adviser = ManoeuvreAdviser(trial, estimator)
        display = _Display(session, adviser, show, stop)
        can_reopen = source is None and stream.source in _REOPENABLE
        reopen = partial(_open_stream, stack, stream, once=once) if can_reopen else None
        is_ended = False
        try:
            waiting = [] if log is None else _replay_journal(session, log, current, display, source_waits=can_reopen)
            if waiting is not None:
                if reopen is not None and session.last_journalled is not None:
                    current, waiting = _resumed(session, current, session.last_journalled, reopen)
                is_ended = _process_stream(session, current, waiting, display)
        except KeyboardInterrupt:
            pass
        finally:
            session.finish()
        counts = session.counts(current.counts)
    latest = session.snapshot
    if latest is not None:
        latest = estimator.relinearise() if isinstance(estimator, OnlineEstimator | SearchFollower) else latest
        latest = replace(adviser.with_final_advice(latest), proposal=session.proposal)
    if latest is not None and show is not None:
        show(latest, counts)
    fit = None
    if buffer is not None and is_ended and trial.model.parameters.free_names:
        fit, reasons = _final_fit(trial, buffer, estimator, seed, report_progress)
        session.messages.extend(reasons)
    writers = [one for one in (log, proposer) if one is not None]
    errors = tuple(writer.write_error for writer in writers if writer.write_error)
    return FollowResult(latest, counts, fit, (*session.messages, *errors))


def _estimator(trial: Trial, seed: int) -> StreamEstimator:
    """The package's own follower, or that of the published method which the trial names."""
    return SearchFollower(trial, seed) if trial.estimate.method.is_published else OnlineEstimator(trial)


def _final_fit(
    trial: Trial, buffer: RunBuffer, estimator: StreamEstimator, seed: int, report_progress: ProgressReporter | None
) -> tuple[Fit | None, tuple[str, ...]]:
    """The fit that `identify` makes; where a published method followed the stream, its values with that fit.

    Of a ship that changed that of the samples behind the change; none, and why, where these do not suffice.
    """
    if isinstance(estimator, SearchFollower):
        trial, began = with_training_records(trial, buffer.records()), process_time()
        reference = identify(own_trial(trial), seed=seed, report_progress=own_estimate_progress(report_progress))
        return published_fit(reference, estimator.estimate(reference), process_time() - began), ()
    change = estimator.change if isinstance(estimator, OnlineEstimator) else None
    if change is None or not change.is_believed:
        whole_trial = with_training_records(trial, buffer.records())
        doubt = watch_sentence(estimator.snapshot) if isinstance(estimator, OnlineEstimator) else ""
        return identify(whole_trial, seed=seed, report_progress=report_progress), (doubt,) if doubt else ()
    final_trial = with_training_records(trial, buffer.records(change.reported_at), has_changed=True)
    try:
        fit = identify(final_trial, seed=seed, report_progress=report_progress)
    except InputError as error:
        return None, (f"{change_text(change)}, and the samples behind it do not suffice for a fit: {error}",)
    return replace(fit, findings=(_change_finding(change, fit), *fit.findings)), ()


_SIZES_SHOWN = 3  # coefficients whose change a finding names, the clearest of those that are certain to 95 %; ours


def _change_finding(change: CoefficientChange, fit: Fit) -> Finding:
    """The warning `coefficients-changed` on a fit of the samples behind a change."""
    differences = [
        (abs(c.estimate - before) / math.hypot(c.standard_error, change.error_before[c.name]),
         f"{c.name} by {signed_percent(c.estimate / before - 1.0)}")
        for c in fit.coefficients if c.standard_error and (before := change.before.get(c.name))
    ]  # fmt: skip
    certain = [row for row in differences if row[0] > two_sided_quantile(STORED_LEVEL, math.inf)]
    clearest = [text for _, text in sorted(certain, reverse=True)[:_SIZES_SHOWN]]
    where = f"the {change_text(change)} of the stream's clock"
    return Finding(Severity.WARNING, "coefficients-changed", where, enumeration(clearest))


class _Display:
    """Shows the newest snapshot with advice and polls `stop`, at most twice a second."""

    def __init__(self, session: StreamSession, adviser: ManoeuvreAdviser, show: Show | None, stop: Stop | None) -> None:
        self._session, self._adviser, self._show, self._stop = session, adviser, show, stop
        self._shown_at = -math.inf
        self._advised: Snapshot | None = None
        self._newest: Snapshot | None = None

    def should_continue(self, source: SampleSource) -> bool:
        """Return False once `stop` has returned True."""
        if monotonic() - self._shown_at < _DISPLAY_INTERVAL_S:
            return True
        self._shown_at = monotonic()
        if self._show is not None and self._session.snapshot is not None:
            self._show(self._with_run(self._session.snapshot), self._session.counts(source.counts))
        return self._stop is None or not self._stop()

    def _with_run(self, snapshot: Snapshot) -> Snapshot:
        """The snapshot with advice, the run so far and the gains proposed; the same object for the same snapshot."""
        advised = self._adviser.with_advice(snapshot)
        proposal = self._session.proposal
        if self._newest is None or advised is not self._advised or proposal is not self._newest.proposal:
            records = self._session.recent_run.records()
            self._advised, self._newest = advised, replace(advised, recent=records, proposal=proposal)
        return self._newest


def _replay_journal(
    session: StreamSession, journal: Journal, source: SampleSource, display: _Display, *, source_waits: bool
) -> list[StreamEvent] | None:
    """Process the journal and return what arrived meanwhile, journalled at once; None where the user stopped it.

    source_waits: whether the source keeps its samples until they are read. Those of any other source begin a new run,
    as the length of the break is unknown.
    """
    early: list[StreamEvent] = []
    if not (source_waits or journal.is_empty):
        session.restart()
    polled = monotonic()
    for event in session.journal_events(journal, continues=source_waits):
        session.process(event)
        if not display.should_continue(source):
            return None
        if not source_waits and monotonic() - polled > _PROCESSING_S and len(early) < _MAX_QUEUE and not source.is_over:
            early += session.admit(source.poll(0.0))
            polled = monotonic()
    return early


def _process_stream(
    session: StreamSession, source: SampleSource, waiting: list[StreamEvent], display: _Display
) -> bool:
    """Process what waits, then samples until the source ends (True) or the user stops it (False).

    The source is polled between two samples that take long, so that none is lost during a search.
    """
    queue = deque(waiting)
    while display.should_continue(source):
        if source.is_over and not queue:
            return True
        if len(queue) < _MAX_QUEUE and not source.is_over:
            queue.extend(session.admit(source.poll(0.0 if queue else _POLL_WAIT_S)))
        deadline = monotonic() + _PROCESSING_S
        while queue:
            _process_first(session, queue)
            if monotonic() > deadline:
                break
    return False


def _process_first(session: StreamSession, queue: deque[StreamEvent]) -> None:
    """Process the first event that waits, and with a sample those behind it in its run, up to a block of them."""
    block: list[Sample] = []
    while queue and len(block) < session.block_size and isinstance(event := queue[0], Sample):
        block.append(event)
        queue.popleft()
    if block:
        session.process_samples(block)
    else:
        session.process(queue.popleft())


def _open_stream(stack: ExitStack, stream: Stream, *, once: bool) -> SampleSource:
    source = open_source(stream, once=once)
    stack.callback(source.close)
    return source


def _resumed(
    session: StreamSession, source: SampleSource, last: Sample, reopen: Callable[[], SampleSource]
) -> tuple[SampleSource, list[StreamEvent]]:
    """Return the source from which to go on behind a journal's last sample, and what is new of it.

    Where that sample is not found the file is another one and is read from its start, as a new run.
    """
    new = _samples_after(source, last)
    if new is not None:
        return source, session.admit(new)
    session.restart()
    return reopen(), []


def _samples_after(source: SampleSource, last: Sample) -> list[Sample] | None:
    """Return the samples behind that one; None if the source does not hold it."""
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
