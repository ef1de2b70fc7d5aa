"""Lines of columns to samples, by the layout that reads the same file at rest."""

import codecs
from collections.abc import Callable
from operator import itemgetter

import numpy as np

from seatrial.core.results.online import Counts
from seatrial.core.values import Array, InputError, nearest, quantity
from seatrial.data.read.layout import Column, Layout
from seatrial.data.read.text import TABLE_MARK, separator
from seatrial.onboard.lines import Batch
from seatrial.onboard.sample import Sample

_PATIENCE = 3
_BOM = b"\xef\xbb\xbf"


class ColumnReader:
    """Lines to samples: values in SI, frames, signs and reference points as the layout declares them.

    An empty cell, or one that is no finite number, is NaN; a row that is too short ends in such cells. A line is
    garbled (counted, no sample) where its time is no number or it has more cells than the lines before it; three such
    in a row and they set the width. Blank lines count nothing. Header lines are skipped as `read_text` does at the
    first beginning; after a truncation only where they are there; and wherever all wanted names stand in a line.
    A column that the header does not name stays NaN, and `complaint` says so.

    Raises:
        InputError: the layout is of no text file, wants no channel, or has a scale, encoding or unit that cannot be
            used.
    """

    def __init__(self, layout: Layout) -> None:
        if layout.format != "text":
            raise InputError(f"format '{layout.format}' cannot be followed; follow a text file")
        if not layout.columns:
            raise InputError("there are no channels to follow; name their columns")
        if layout.scale != 1.0:
            raise InputError(f"a stream cannot be Froude-scaled by {layout.scale:g}; follow it at its own scale")
        _refuse_encoding(layout.encoding)
        self._layout = layout
        self._wanted = (layout.time, *layout.columns)
        units = ["s", *(quantity(column.symbol).unit for column in layout.columns)]
        self._factors = np.array([c.factor(unit) for c, unit in zip(self._wanted, units, strict=True)])
        self._header = max(layout.header_lines, 1) if layout.has_names else layout.header_lines
        self._skip, self._spare = 0, 0
        self._names: bytes | None = None
        self._mark: bytes | None = None
        self._is_settled = False
        self._width = self._line = self._garbled = self._wider = self._wider_times = 0
        self._has_begun = False
        self._getter: Callable[[list[bytes]], tuple[bytes, ...]] | None = None
        self._places: tuple[int | None, ...] = tuple(
            c.source - 1 if isinstance(c.source, int) else None for c in self._wanted
        )
        self._last = ""
        self.complaint = ""

    @property
    def counts(self) -> Counts:
        """garbled: lines that could not be read."""
        return Counts(garbled=self._garbled, last=self.complaint or self._last)

    def samples(self, batch: Batch) -> list[Sample]:
        """The samples of these lines, in order."""
        if batch.begins:
            self._begin()
        rows: list[list[float]] = []
        take = rows.append
        comma = self._layout.decimal == ","
        for line in batch.lines:
            self._line += 1
            getter = self._getter
            if getter is not None and b"_" not in line:
                cells = self._cells(line, self._mark) if comma else line.split(self._mark)
                if len(cells) == self._width:
                    try:
                        take([*map(float, getter(cells))])
                        continue
                    except ValueError:
                        pass
            row = self._row(line)
            if row is not None:
                take(row)
        return self._samples(rows)

    def rest(self) -> list[Sample]:
        """Nothing is kept back."""
        return []

    def _samples(self, rows: list[list[float]]) -> list[Sample]:
        if not rows:
            return []
        with np.errstate(over="ignore"):
            block = np.array(rows) * self._factors
        block[~np.isfinite(block)] = np.nan
        readable = np.isfinite(block[:, 0])
        if not readable.all():
            self._garbled += int(np.sum(~readable))
            self._last = f"line {self._line} or shortly before: the time is no number"
            block = block[readable]
        block.setflags(write=False)
        values: Array = block[:, 1:]
        return [Sample(time, row) for time, row in zip(block[:, 0].tolist(), values, strict=True)]

    def _begin(self) -> None:
        """A file begins: its header is skipped, strictly the first time."""
        self._skip, self._spare = (0, self._header) if self._has_begun else (self._header, 0)
        self._has_begun = True
        self._getter = None

    def _row(self, line: bytes) -> list[float] | None:
        """The row of a line that is not plain; None for a header, a blank line or one that cannot be read."""
        line = line.removeprefix(_BOM)
        if line.startswith(TABLE_MARK.encode()):
            return None
        if self._skip:
            self._skip -= 1
            self._names = line
            return None
        if not line.strip():
            return None
        row = self._numbers(line)
        if row is not None:
            self._spare = 0
            if self._getter is None:
                self._hasten()
            return row
        if self._is_heading(line):
            self._names, self._is_settled, self._spare, self._getter = line, False, 0, None
            return None
        if self._spare:
            self._spare -= 1
            return None
        self._garbled += 1
        self._last = f"line {self._line} could not be read: {_shown(line)}"
        return None

    def _numbers(self, line: bytes) -> list[float] | None:
        if not self._is_settled:
            return self._settled(line)
        cells = self._cells(line, self._mark)
        if len(cells) > self._width and not self._is_wider(len(cells)):
            return None
        row = [_number(cells, place) for place in self._places]
        return row if np.isfinite(row[0]) else None

    def _is_wider(self, count: int) -> bool:
        """Whether so many lines of this greater width have come that it is the right one."""
        self._wider_times = self._wider_times + 1 if count == self._wider else 1
        self._wider = count
        if self._wider_times < _PATIENCE:
            return False
        self._width = count
        return True

    def _settled(self, line: bytes) -> list[float] | None:
        """The row of the first line that can be read, which sets separator, width and places."""
        text = line.decode("latin-1")
        found = separator(text, self._layout)
        mark = None if found == r"\s+" else found.encode()
        places, complaint = self._located(mark)
        cells = self._cells(line, mark)
        row = [_number(cells, place) for place in places]
        if not np.isfinite(row[0]):
            if complaint and np.isfinite(_number(cells, 0)):
                self.complaint = complaint
            return None
        self._mark, self._places, self.complaint = mark, places, complaint
        self._width, self._is_settled = len(cells), True
        return row

    def _located(self, mark: bytes | None) -> tuple[tuple[int | None, ...], str]:
        """Where the wanted columns stand, and the complaint about the first that stands nowhere."""
        names = [] if self._names is None else self._header_names(self._names, mark)
        places: list[int | None] = []
        complaint = ""
        for column in self._wanted:
            if isinstance(column.source, int):
                places.append(column.source - 1)
            elif column.source in names:
                places.append(names.index(column.source))
            else:
                places.append(None)
                complaint = complaint or _complaint(column, [name for name in names if name])
        return tuple(places), complaint

    def _hasten(self) -> None:
        """The quick way for lines like this one, if all wanted cells stand in it."""
        places = [place for place in self._places if place is not None and place < self._width]
        self._getter = itemgetter(*places) if len(places) == len(self._places) else None

    def _cells(self, line: bytes, mark: bytes | None) -> list[bytes]:
        if self._layout.decimal == "," and mark != b",":
            line = line.replace(b",", b".")
        return line.split(mark)

    def _header_names(self, line: bytes, mark: bytes | None) -> list[str]:
        text = line.decode(self._layout.encoding, errors="replace").strip()
        cells = text.split(None if mark is None else mark.decode())
        return [cell.strip().strip('"') for cell in cells]

    def _is_heading(self, line: bytes) -> bool:
        if not self._layout.has_names:
            return False
        found = separator(line.decode("latin-1"), self._layout)
        names = self._header_names(line, None if found == r"\s+" else found.encode())
        return all(column.source in names for column in self._wanted if isinstance(column.source, str))


def _number(cells: list[bytes], place: int | None) -> float:
    if place is None or place >= len(cells):
        return np.nan
    cell = cells[place].strip().strip(b'"')
    try:
        return np.nan if b"_" in cell else float(cell)
    except ValueError:
        return np.nan


def _complaint(column: Column, names: list[str]) -> str:
    hint = nearest(str(column.source), names) if names else "; no header line has come, give numbers"
    return f"no column '{column.source}' for channel '{column.symbol}'{hint}"


def _shown(line: bytes) -> str:
    """The beginning of a line nobody trusts, in plain ASCII."""
    return repr(line[:40])[1:]


def _refuse_encoding(encoding: str) -> None:
    try:
        name = codecs.lookup(encoding).name
    except LookupError:
        raise InputError(f"unknown encoding '{encoding}'; try 'utf-8' or 'cp1252'") from None
    if name.startswith(("utf-16", "utf-32")):
        raise InputError(f"encoding '{encoding}' cannot be followed line by line; have the logger write utf-8")
