"""Lines of standard input, or of any pipe."""

import os
import select
import time

from seatrial.core.results.online import Counts
from seatrial.core.values import InputError
from seatrial.onboard.lines import Batch, LineCutter

_CHUNK = 1 << 16
STANDARD_INPUT = 0


class PipeLines:
    """Lines of an open file descriptor, standard input unless told otherwise; over at its end.

    Raises:
        InputError: the descriptor is not open.
    """

    def __init__(self, descriptor: int = STANDARD_INPUT) -> None:
        try:
            os.fstat(descriptor)
        except OSError:
            raise InputError("standard input is closed; pipe the samples into the command") from None
        self._descriptor = descriptor
        self._cutter = LineCutter()
        self._is_over = False
        self._begins = True

    def read(self, seconds: float) -> Batch:
        """Lines that have come, waiting at most so long for the first."""
        deadline = time.monotonic() + seconds
        lines: list[bytes] = []
        left = seconds
        while not (lines or self._is_over) and select.select([self._descriptor], [], [], max(left, 0.0))[0]:
            lines = self._come()
            left = deadline - time.monotonic()
            if left <= 0.0:
                break
        begins, self._begins = self._begins, False
        return Batch(lines, begins)

    @property
    def is_over(self) -> bool:
        """Whether the writer has closed its end."""
        return self._is_over

    @property
    def counts(self) -> Counts:
        """dropped: lines that were too long."""
        return Counts(dropped=self._cutter.dropped)

    def close(self) -> None:
        """Nothing: the descriptor belongs to whoever opened it."""

    def _come(self) -> list[bytes]:
        try:
            chunk = os.read(self._descriptor, _CHUNK)
        except BlockingIOError:
            return []
        except OSError:
            chunk = b""
        if chunk:
            return self._cutter.cut(chunk)
        self._is_over = True
        return self._cutter.rest()
