"""Lines of standard input, or of any pipe."""

import os
import time

from seatrial.core.results.online import SampleCounts
from seatrial.core.values import InputError
from seatrial.numerics.platform import has_input
from seatrial.onboard.lines import LineBatch, LineSplitter

# bytes read at once: what a pipe holds
_CHUNK = 1 << 16
STANDARD_INPUT = 0


class PipeLines:
    """Lines of an open file descriptor, standard input by default, until its end.

    Raises:
        InputError: the descriptor is not open.
    """

    def __init__(self, descriptor: int = STANDARD_INPUT) -> None:
        try:
            os.fstat(descriptor)
        except OSError:
            raise InputError("standard input is closed; pipe the samples into the command") from None
        self._descriptor = descriptor
        self._splitter = LineSplitter()
        self.is_over = False
        self._starts_file = True

    def read(self, seconds: float) -> LineBatch:
        """As `LineSource.read`."""
        deadline = time.monotonic() + seconds
        lines: list[bytes] = []
        remaining = seconds
        while not (lines or self.is_over) and has_input(self._descriptor, remaining):
            lines = self._read_lines()
            remaining = deadline - time.monotonic()
            if remaining <= 0.0:
                break
        starts_file, self._starts_file = self._starts_file, False
        return LineBatch(lines, starts_file)

    @property
    def counts(self) -> SampleCounts:
        """dropped: lines that were too long."""
        return SampleCounts(dropped=self._splitter.dropped)

    def close(self) -> None:
        """Do nothing: the descriptor belongs to the caller."""

    def _read_lines(self) -> list[bytes]:
        try:
            chunk = os.read(self._descriptor, _CHUNK)
        except BlockingIOError:
            return []
        except OSError:
            chunk = b""
        if chunk:
            return self._splitter.split(chunk)
        self.is_over = True
        return self._splitter.flush()
