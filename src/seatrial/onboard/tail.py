"""Lines of a file that grows: appended, truncated, replaced while it is read."""

import os
import time
from pathlib import Path
from stat import S_ISREG

from seatrial.core.results.online import Counts
from seatrial.core.values import InputError
from seatrial.onboard.lines import Batch, LineCutter

_CHUNK = 1 << 18
_MARK = 64
_PAUSE = 0.05


class TailLines:
    """Lines of the file at `path`; with `once` it is over at the end of the file, whose last line may lack its end.

    The last bytes read are read again each time: where they are no longer there, the file has been truncated (or
    written anew), which is counted, and reading goes on from its start. Where another file has taken its place, the
    old one is read to its end first.

    Raises:
        InputError: there is no such file, it is packed, or it is no regular file.
    """

    def __init__(self, path: Path, *, once: bool = False) -> None:
        if path.suffix == ".gz":
            raise InputError(f"{path.name} is packed and cannot be followed; unpack it, or run 'seatrial identify'")
        if not path.exists():
            raise InputError(f"{path} does not exist; start the logger first, or check the path")
        if not S_ISREG(path.stat().st_mode):
            raise InputError(f"{path} is no regular file; feed it to standard input instead")
        self._path, self._once = path, once
        self._cutter = LineCutter()
        self._truncated = self._garbled = 0
        self._last = ""
        self._is_over = False
        self._open()

    def read(self, seconds: float) -> Batch:
        """Lines that have been appended, waiting at most so long for the first."""
        deadline = time.monotonic() + seconds
        while True:
            lines = self._appended()
            left = deadline - time.monotonic()
            if lines or self._is_over or left <= 0:
                begins, self._begins = self._begins, False
                return Batch(lines, begins)
            time.sleep(min(_PAUSE, left))

    @property
    def is_over(self) -> bool:
        """Whether the end was reached; never unless `once`."""
        return self._is_over

    @property
    def counts(self) -> Counts:
        """truncated, garbled (half lines lost with it) and dropped (too long)."""
        return Counts(garbled=self._garbled, dropped=self._cutter.dropped, truncated=self._truncated, last=self._last)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def _open(self) -> None:
        try:
            self._file = self._path.open("rb", buffering=0)
        except OSError as error:
            raise InputError(f"{self._path} cannot be read ({error.strerror}); check its permissions") from None
        self._inode = os.fstat(self._file.fileno()).st_ino
        self._rewind()

    def _rewind(self) -> None:
        self._position, self._mark, self._begins = 0, b"", True

    def _appended(self) -> list[bytes]:
        try:
            self._file.seek(self._position - len(self._mark))
            data = self._file.read(len(self._mark) + _CHUNK) or b""
        except OSError as error:
            self._last = f"{self._path.name} could not be read ({error.strerror}); trying again"
            return []
        if not data.startswith(self._mark):
            self._begin_anew()
            return []
        chunk = data[len(self._mark) :]
        if chunk:
            self._position += len(chunk)
            self._mark = data[-_MARK:]
            return self._cutter.cut(chunk)
        return self._at_end()

    def _at_end(self) -> list[bytes]:
        is_replaced = self._is_replaced()
        if not is_replaced and not self._once:
            return []
        rest = self._cutter.rest()
        if is_replaced and not rest:
            self._last = f"{self._path.name} was replaced by another file while it was read; reading goes on there"
            self._reopen()
        elif not is_replaced:
            self._is_over = True
        return rest

    def _is_replaced(self) -> bool:
        try:
            return self._path.stat().st_ino != self._inode
        except OSError:
            return False

    def _reopen(self) -> None:
        old = self._file
        try:
            self._open()
        except InputError as error:
            self._last = str(error)
        else:
            old.close()

    def _begin_anew(self) -> None:
        self._truncated += 1
        self._garbled += len(self._cutter.rest())
        self._last = f"{self._path.name} was truncated while it was read; reading goes on from its start"
        self._rewind()
