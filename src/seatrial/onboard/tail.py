"""Lines of a file that grows: appended, truncated, replaced while it is read."""

import os
import time
from pathlib import Path
from stat import S_ISREG

from seatrial.core.results.online import SampleCounts
from seatrial.core.values import InputError
from seatrial.onboard.lines import LineBatch, LineSplitter

# bytes read at once; bytes at the end that are compared to notice a truncation; s between looks at the file; chosen: no
# logger writes more in between, and a wait that nobody notices
_CHUNK, _MARK_BYTES, _POLL_INTERVAL_S = 1 << 18, 64, 0.05


class TailLines:
    """Lines of the file at `path`; with `once` until its present end, where the last line may lack its line feed.

    The last bytes read are compared each time: where they have changed, the file has been truncated (or written anew),
    which is counted, and reading goes on from its start. Where another file has taken its place, the old one is read to
    its end first.

    Raises:
        InputError: the file does not exist, is compressed, or is not a regular file.
    """

    def __init__(self, path: Path, *, once: bool = False) -> None:
        if path.suffix == ".gz":
            raise InputError(f"{path.name} is compressed; decompress it to follow it, or run 'seatrial identify'")
        if not path.exists():
            raise InputError(f"{path} does not exist; start the logger first, or check the path")
        if not S_ISREG(path.stat().st_mode):
            raise InputError(f"{path} is not a regular file; pipe it into standard input instead")
        self._path, self._once = path, once
        self._splitter = LineSplitter()
        self._truncated = self._garbled = 0
        self._last_error = ""
        self.is_over = False
        self._open()

    def read(self, seconds: float) -> LineBatch:
        """As `LineSource.read`."""
        deadline = time.monotonic() + seconds
        while True:
            lines = self._read_appended()
            remaining = deadline - time.monotonic()
            if lines or self.is_over or remaining <= 0:
                starts_file, self._starts_file = self._starts_file, False
                return LineBatch(lines, starts_file)
            time.sleep(min(_POLL_INTERVAL_S, remaining))

    @property
    def counts(self) -> SampleCounts:
        """truncated, garbled (half lines lost with it) and dropped (too long)."""
        dropped, truncated = self._splitter.dropped, self._truncated
        return SampleCounts(garbled=self._garbled, dropped=dropped, truncated=truncated, last_problem=self._last_error)

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
        self._position, self._last_bytes, self._starts_file = 0, b"", True

    def _read_appended(self) -> list[bytes]:
        try:
            self._file.seek(self._position - len(self._last_bytes))
            data = self._file.read(len(self._last_bytes) + _CHUNK) or b""
        except OSError as error:
            self._last_error = f"{self._path.name} could not be read ({error.strerror}); trying again"
            return []
        if not data.startswith(self._last_bytes):
            self._restart()
            return []
        chunk = data[len(self._last_bytes) :]
        if chunk:
            self._position += len(chunk)
            self._last_bytes = data[-_MARK_BYTES:]
            return self._splitter.split(chunk)
        return self._at_end()

    def _at_end(self) -> list[bytes]:
        is_replaced = self._is_replaced()
        if not is_replaced and not self._once:
            return []
        rest = self._splitter.flush()
        if is_replaced and not rest:
            self._last_error = (
                f"{self._path.name} was replaced by another file while it was read; reading goes on there"
            )
            self._reopen()
        elif not is_replaced:
            self.is_over = True
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
            self._last_error = str(error)
        else:
            old.close()

    def _restart(self) -> None:
        self._truncated += 1
        self._garbled += len(self._splitter.flush())
        self._last_error = f"{self._path.name} was truncated while it was read; reading goes on from its start"
        self._rewind()
