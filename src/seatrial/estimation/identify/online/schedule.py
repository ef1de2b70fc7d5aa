"""When the window is searched and left, in seconds of samples that it holds."""

from dataclasses import dataclass

# s without a search that make one worthwhile when a run ends, and the share of the window that must be new by then
_RUN_END_SECONDS, _RUN_END_NEW_SHARE = 10.0, 0.1
# s between searches from nowhere that check one from the last optimum: at least, and as a share of the window
_COLD_CHECK_SECONDS, _COLD_CHECK_SHARE = 10.0, 0.5
# s of samples after which carried information is renewed, at least: several periods of any motion of a ship
_STRETCH_SECONDS = 60.0


@dataclass(frozen=True)
class SearchIntervals:
    """How often one way of searching is used; a search must cost less than the samples between two take to come.

    Attributes:
        shortest: s between two searches, at least.
        share: between two, as a share of what the window has beyond `excess_from` s.
        stretch_share: of a full window, after which carried information is renewed.
        carried: s between two where information is carried; None: as for a window.
    """

    shortest: float
    share: float
    excess_from: float = 0.0
    stretch_share: float = 0.0
    carried: float | None = None

    def interval(self, seconds: float, *, is_carried: bool) -> float:
        """Return the s until the next search, with `seconds` s of samples in the window."""
        if is_carried and self.carried is not None:
            return self.carried
        return max(self.shortest, self.share * (seconds - self.excess_from))

    def stretch(self, window: float) -> float:
        """Return the s of samples after which carried information is renewed; window: s, a full one."""
        return max(_STRETCH_SECONDS, self.stretch_share * window)


CONTINUED_INTERVALS = SearchIntervals(2.5, 0.15, excess_from=60.0, carried=_STRETCH_SECONDS)
"""From the last optimum, tens of milliseconds each: every 2.5 s over the first 77 s, then 15 % of the rest."""
REPEATED_INTERVALS = SearchIntervals(10.0, 0.25, stretch_share=0.25)
"""From nowhere, seconds each: every 10 s over the first 40 s, then a quarter of the window."""


@dataclass
class SearchSchedule:
    """Times of searches, s of samples in the window.

    Attributes:
        next_search: from which on the next one is made.
        last_search: when the last one was made.
        next_cold_start: from which on a search from nowhere may check one from the last optimum.
    """

    intervals: SearchIntervals
    next_search: float = 0.0
    last_search: float = 0.0
    next_cold_start: float = 0.0

    def note_search(self, seconds: float, *, is_carried: bool) -> None:
        """Set the next search after one made now, with `seconds` s of samples in the window."""
        self.next_search = seconds + self.intervals.interval(seconds, is_carried=is_carried)
        self.last_search = seconds

    def note_cold_start(self) -> None:
        """Set the next check from nowhere after one made with the last search."""
        self.next_cold_start = self.last_search + max(_COLD_CHECK_SECONDS, _COLD_CHECK_SHARE * self.last_search)

    def is_due_at_run_end(self, seconds: float) -> bool:
        """Return whether enough is new for a search as a run ends with `seconds` s of samples in the window."""
        return seconds - self.last_search >= max(_RUN_END_SECONDS, _RUN_END_NEW_SHARE * seconds)

    def restart(self) -> None:
        """Begin with an empty window."""
        self.next_search = self.last_search = self.next_cold_start = 0.0
