"""The loop on board: poll, admit, note, estimate, show. No threads, and nothing that is sent can end it."""

import math
from collections import deque
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import monotonic

import numpy as np

from seatrial.core.results import Fit
from seatrial.core.results.online import Counts, Snapshot
from seatrial.core.values import Progress
from seatrial.data.trial import Trial
from seatrial.data.trial.follow_table import followed
from seatrial.data.trial.trial import Feed, Stream
from seatrial.estimation.identify import identify
from seatrial.estimation.identify.online import Online
from seatrial.onboard.advice import Adviser
from seatrial.onboard.journal import Journal, identity_of
from seatrial.onboard.needs import refuse_lacking
from seatrial.onboard.opened import source_of
from seatrial.onboard.raw import Kept, with_runs
from seatrial.onboard.sample import Sample, Source
from seatrial.onboard.voyage import Estimator, Voyage

_WAIT_S, _TURN_S, _SHOW_S, _PATIENCE = 0.2, 0.1, 0.5, 3
# samples that may wait for the estimator
_QUEUE = 10_000
# sources that give everything once more when they are opened again
_AGAIN = (Feed.FILE, Feed.NMEA_FILE)

Show = Callable[[Snapshot, Counts], None]
Stop = Callable[[], bool]


@dataclass(frozen=True, eq=False)
class Outcome:
    """How following ended.

    Attributes:
        snapshot: the last one; None where no sample came. counts: of all samples, those of the journal included.
        fit: what `identify` says of the samples accepted, where they were followed to their end with `once`.
        notes: what else is to be said: a torn journal, trouble of the estimator.
    """

    snapshot: Snapshot | None
    counts: Counts
    fit: Fit | None = None
    notes: tuple[str, ...] = ()


def follow(
    trial: Trial,
    *,
    source: Source | None = None,
    once: bool = False,
    journal: Path | None = None,
    show: Show | None = None,
    stop: Stop | None = None,
    estimator: Estimator | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Outcome:
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
    stream = followed(trial)
    refuse_lacking(trial)
    kept = Kept(stream.layout) if once else None
    with ExitStack() as held:
        is_known = journal is not None and journal.exists()
        log = None if journal is None else _journal(held, journal, trial)
        if log is not None and is_known and progress is not None:
            progress(f"taking in {log.path.name}")
        # open before the journal is taken in, so that what comes meanwhile waits in the socket
        feed = source or _opened(held, stream, once=once)
        known = estimator or Online(trial)
        voyage, adviser = Voyage(stream, known, log, kept), Adviser(trial, known)
        watch = _Watch(voyage, _advising(show, adviser), stop or _never)
        again = partial(_opened, held, stream, once=once) if source is None and stream.feed in _AGAIN else None
        is_ended = False
        try:
            early = [] if log is None else _recalled(voyage, log, feed, watch, waits=again is not None)
            if early is not None:
                feed, first = _resumed(voyage, feed, early, again)
                is_ended = _sailed(voyage, feed, first, watch)
        except KeyboardInterrupt:
            pass
        finally:
            voyage.finish()
        counts = voyage.counts(feed.counts)
    latest = voyage.snapshot
    if latest is not None:
        latest = adviser.concluded(known.relinearise() if isinstance(known, Online) else latest)
    if latest is not None and show is not None:
        show(latest, counts)
    fit = None
    if kept is not None and is_ended:
        fit = identify(with_runs(trial, kept.records()), seed=seed, progress=progress)
    trouble = (log.trouble,) if log is not None and log.trouble else ()
    return Outcome(latest, counts, fit, (*voyage.notes, *trouble))


def _advising(show: Show | None, adviser: Adviser) -> Show:
    """Shows what would help, too."""
    if show is None:
        return _nobody
    return lambda snapshot, counts: show(adviser.advised(snapshot), counts)


class _Watch:
    """Shows what is known and asks whether to go on, twice a second at most."""

    def __init__(self, voyage: Voyage, show: Show, stop: Stop) -> None:
        self._voyage, self._show, self._stop = voyage, show, stop
        self._shown = -math.inf

    def goes_on(self, feed: Source) -> bool:
        """False where the end was asked for."""
        if monotonic() - self._shown < _SHOW_S:
            return True
        self._shown = monotonic()
        if self._voyage.snapshot is not None:
            self._show(self._voyage.snapshot, self._voyage.counts(feed.counts))
        return not self._stop()


def _recalled(voyage: Voyage, journal: Journal, feed: Source, watch: _Watch, *, waits: bool) -> list[Sample] | None:
    """What came while the journal was taken in, unless the source waits for its reader; None: the end was asked for."""
    early: list[Sample] = []
    polled = monotonic()
    for event in voyage.recalled(journal):
        voyage.follow(event)
        if not watch.goes_on(feed):
            return None
        if not waits and monotonic() - polled > _TURN_S and len(early) < _QUEUE and not feed.is_over:
            early += feed.poll(0.0)
            polled = monotonic()
    return early


def _sailed(voyage: Voyage, feed: Source, first: list[Sample], watch: _Watch) -> bool:
    """The loop itself; whether the source ended, rather than somebody's patience.

    Between two samples that take long the source is asked again, so that nothing is lost while a search goes on.
    """
    queue = deque(voyage.admitted(first))
    while watch.goes_on(feed):
        if feed.is_over and not queue:
            return True
        if len(queue) < _QUEUE and not feed.is_over:
            queue.extend(voyage.admitted(feed.poll(0.0 if queue else _WAIT_S)))
        turn = monotonic() + _TURN_S
        while queue:
            voyage.follow(queue.popleft())
            if monotonic() > turn:
                break
    return False


def _opened(held: ExitStack, stream: Stream, *, once: bool) -> Source:
    feed = source_of(stream, once=once)
    held.callback(feed.close)
    return feed


def _resumed(
    voyage: Voyage, feed: Source, early: list[Sample], again: Callable[[], Source] | None
) -> tuple[Source, list[Sample]]:
    """The source behind a journal, and what of it has come that is new, first of all `early`.

    again: opens a source that gives everything once more. That is read up to the journal's last sample, which is passed
    over with all before it; where it is not found, the file is another one and begins from its start, with a run of its
    own. So does what comes from any other source, for nobody knows how long the break was.
    """
    if voyage.last is None:
        return feed, early
    new = None if again is None else _behind(feed, voyage.last)
    if new is not None:
        return feed, new
    voyage.restarted()
    return (feed, early) if again is None else (again(), [])


def _behind(feed: Source, last: Sample) -> list[Sample] | None:
    """What of a poll comes behind that sample; None if the source does not hold it."""
    empty = 0
    while not feed.is_over and empty < _PATIENCE:
        samples = feed.poll(_WAIT_S)
        empty = 0 if samples else empty + 1
        for place, sample in enumerate(samples, start=1):
            if sample.time == last.time and np.array_equal(sample.values, last.values, equal_nan=True):
                return samples[place:]
    return None


def _journal(held: ExitStack, path: Path, trial: Trial) -> Journal:
    layout = followed(trial).layout
    journal = Journal(path, identity_of(trial.model, layout), len(layout.columns))
    held.callback(journal.close)
    return journal


def _nobody(snapshot: Snapshot, counts: Counts) -> None:
    """Nobody looks."""


def _never() -> bool:
    return False
