"""Lines of columns as samples, by the layout that reads the same file once it is complete."""

import codecs
from collections.abc import Callable, Iterator
from dataclasses import replace
from operator import itemgetter

import numpy as np

from seatrial.core.results.online import Sample, SampleCounts
from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.data.read.formats.text import RECORD_MARK, detect_separator
from seatrial.data.read.layout import ColumnSpec, Layout
from seatrial.onboard.lines import LineBatch

# lines in a row with more cells than before after which their number is taken as the right one
_WIDTH_CONFIRMATIONS = 3
# byte order mark of UTF-8
_BOM = b"\xef\xbb\xbf"


class ColumnReader:
    """Turns lines into samples: SI, in the frames, signs and reference points that the layout declares.

    A cell that is empty or not a finite number is NaN; so are the cells that a short row lacks. A line is garbled
    (counted, no sample) where its time is not a number or where it has more cells than the lines before it; after three
    such lines in a row their width is the right one. Blank lines are ignored. Header lines are skipped as `read_text`
    does at the start of the stream, after a truncation only where they are present, and wherever a line has all the
    names required. A column that the header does not name stays NaN, and `column_warning` says so.

    Raises:
        InputError: the layout is not of a text file, has no channel, or has a scale, encoding or unit that cannot be
            used.
    """

    def __init__(self, layout: Layout) -> None:
        if layout.format != "text":
            raise InputError(f"format '{layout.format}' cannot be followed; follow a text file")
        if not layout.columns:
            raise InputError("no channels to follow; name their columns in [follow.channels]")
        if layout.scale != 1.0:
            raise InputError(f"a stream cannot be Froude-scaled by {layout.scale:g}; follow it at its own scale")
        _refuse_encoding(layout.encoding)
        self._layout = layout
        twins = (replace(column, source=column.twin) for column in layout.columns if column.twin)
        self._columns = (layout.time, *layout.columns, *twins)
        self._time_factor = layout.time.si_factor("s")
        for column in layout.columns:
            column.in_si(np.zeros(1))
        self._header_count = max(layout.header_lines, 1) if layout.has_named_columns else layout.header_lines
        self._lines_to_skip, self._lines_skippable = 0, 0
        self._header_line: bytes | None = None
        self._delimiter: bytes | None = None
        self._is_format_known = False
        self._width = self._line = self._garbled = self._wider_width = self._wider_count = 0
        self._has_started = False
        self._cell_getter: Callable[[list[bytes]], tuple[bytes, ...]] | None = None
        self._column_indices: tuple[int | None, ...] = tuple(
            c.source - 1 if isinstance(c.source, int) else None for c in self._columns
        )
        self._last_error = ""
        self.column_warning = ""

    @property
    def counts(self) -> SampleCounts:
        """garbled: lines that could not be read."""
        return SampleCounts(garbled=self._garbled, last_problem=self.column_warning or self._last_error)

    def samples(self, batch: LineBatch) -> list[Sample]:
        """Return the samples of these lines, in order."""
        if batch.starts_file:
            self._start_file()
        rows: list[list[float]] = []
        append_row = rows.append
        for line in batch.lines:
            self._line += 1
            getter = self._cell_getter
            if getter is not None and b"_" not in line:
                cells = _split_cells(line, self._delimiter)
                if len(cells) == self._width:
                    try:
                        append_row([*map(float, getter(cells))])
                        continue
                    except ValueError:
                        pass
            row = self._parse_line(line)
            if row is not None:
                append_row(row)
        return self._to_samples(rows)

    def flush(self) -> list[Sample]:
        """Return an empty list: no line waits for another."""
        return []

    def _to_samples(self, rows: list[list[float]]) -> list[Sample]:
        if not rows:
            return []
        with np.errstate(over="ignore"):
            cells = np.array(rows)
            values = [
                one.in_si(numbers) for one, numbers in zip(self._layout.columns, self._numbers(cells), strict=True)
            ]
            block = np.column_stack([self._time_factor * cells[:, 0], *values])
        block[~np.isfinite(block)] = np.nan
        readable = np.isfinite(block[:, 0])
        if not readable.all():
            self._garbled += int(np.sum(~readable))
            self._last_error = f"line {self._line} or shortly before: the time is not a number"
            block = block[readable]
        block.setflags(write=False)
        channels: Array = block[:, 1:]
        return [Sample(time, row) for time, row in zip(block[:, 0].tolist(), channels, strict=True)]

    def _numbers(self, cells: Array) -> Iterator[Array]:
        """What the columns of the layout hold, (n,) each; twins stand behind all others, in their order."""
        columns = self._layout.columns
        place = 1 + len(columns)
        for k, column in enumerate(columns, start=1):
            if column.twin:
                yield column.of_twins(cells[:, k], cells[:, place])
                place += 1
            else:
                yield cells[:, k]

    def _start_file(self) -> None:
        """Skip the header of a file that begins: its lines the first time, later only lines that are no numbers."""
        self._lines_to_skip, self._lines_skippable = (
            (0, self._header_count) if self._has_started else (self._header_count, 0)
        )
        self._has_started = True
        self._cell_getter = None

    def _parse_line(self, line: bytes) -> list[float] | None:
        """The row of a line the fast path cannot read; None for a header, a blank line or a garbled one."""
        line = line.removeprefix(_BOM)
        if line.startswith(RECORD_MARK.encode()):
            return None
        if self._lines_to_skip:
            self._lines_to_skip -= 1
            self._header_line = line
            return None
        if not line.strip():
            return None
        row = self._parse_numbers(line)
        if row is not None:
            self._lines_skippable = 0
            if self._cell_getter is None:
                self._set_fast_path()
            return row
        if self._is_header(line):
            self._header_line, self._is_format_known, self._lines_skippable, self._cell_getter = line, False, 0, None
            return None
        if self._lines_skippable:
            self._lines_skippable -= 1
            return None
        self._garbled += 1
        self._last_error = f"line {self._line} could not be read: {_escaped(line)}"
        return None

    def _parse_numbers(self, line: bytes) -> list[float] | None:
        if not self._is_format_known:
            return self._detect_format(line)
        cells = _split_cells(line, self._delimiter)
        if len(cells) > self._width and not self._confirm_width(len(cells)):
            return None
        row = [_parse_number(cells, index) for index in self._column_indices]
        return row if np.isfinite(row[0]) else None

    def _confirm_width(self, count: int) -> bool:
        """Whether enough lines of this greater width have arrived for it to be the right one."""
        self._wider_count = self._wider_count + 1 if count == self._wider_width else 1
        self._wider_width = count
        if self._wider_count < _WIDTH_CONFIRMATIONS:
            return False
        self._width = count
        return True

    def _detect_format(self, line: bytes) -> list[float] | None:
        """The row of the first line that can be read, which sets separator, width and column positions."""
        delimiter = self._find_delimiter(line)
        indices, warning = self._locate_columns(delimiter)
        cells = _split_cells(line, delimiter)
        row = [_parse_number(cells, index) for index in indices]
        if not np.isfinite(row[0]):
            if warning and np.isfinite(_parse_number(cells, 0)):
                self.column_warning = warning
            return None
        self._delimiter, self._column_indices, self.column_warning = delimiter, indices, warning
        self._width, self._is_format_known = len(cells), True
        return row

    def _locate_columns(self, delimiter: bytes | None) -> tuple[tuple[int | None, ...], str]:
        """Positions of the columns required, and a warning about the first that is missing."""
        names = [] if self._header_line is None else self._header_names(self._header_line, delimiter)
        indices: list[int | None] = []
        warning = ""
        for column in self._columns:
            if isinstance(column.source, int):
                indices.append(column.source - 1)
            elif column.source in names:
                indices.append(names.index(column.source))
            else:
                indices.append(None)
                warning = warning or _missing_column_text(column, [name for name in names if name])
        return tuple(indices), warning

    def _set_fast_path(self) -> None:
        """Prepare the fast path for lines like this one, if it has all cells required."""
        indices = [index for index in self._column_indices if index is not None and index < self._width]
        self._cell_getter = itemgetter(*indices) if len(indices) == len(self._column_indices) else None

    def _find_delimiter(self, line: bytes) -> bytes | None:
        """The separator of a line; None: white space."""
        separator = detect_separator(line.decode("latin-1"), self._layout.separator)
        return None if separator == r"\s+" else separator.encode()

    def _header_names(self, line: bytes, delimiter: bytes | None) -> list[str]:
        text = line.decode(self._layout.encoding, errors="replace").strip()
        cells = text.split(None if delimiter is None else delimiter.decode())
        return [cell.strip().strip('"') for cell in cells]

    def _is_header(self, line: bytes) -> bool:
        if not self._layout.has_named_columns:
            return False
        names = self._header_names(line, self._find_delimiter(line))
        return all(column.source in names for column in self._columns if isinstance(column.source, str))


def _split_cells(line: bytes, delimiter: bytes | None) -> list[bytes]:
    """The cells of a line; a comma that separates none is a decimal sign."""
    return (line if delimiter == b"," else line.replace(b",", b".")).split(delimiter)


def _parse_number(cells: list[bytes], index: int | None) -> float:
    if index is None or index >= len(cells):
        return np.nan
    cell = cells[index].strip().strip(b'"')
    try:
        return np.nan if b"_" in cell else float(cell)
    except ValueError:
        return np.nan


def _missing_column_text(column: ColumnSpec, names: list[str]) -> str:
    hint = spelling_hint(str(column.source), names) if names else "; no header line has arrived, give column numbers"
    return f"no column '{column.source}' for channel '{column.symbol}'{hint}"


def _escaped(line: bytes) -> str:
    """The first bytes of a line, which may hold anything, in plain ASCII."""
    return repr(line[:40])[1:]


def _refuse_encoding(encoding: str) -> None:
    try:
        name = codecs.lookup(encoding).name
        bytes(range(256)).decode(encoding, errors="replace")  # as lines are: codecs that are none of text refuse
    except (LookupError, ValueError):
        raise InputError(f"unknown encoding {encoding!r}; try 'utf-8' or 'cp1252'") from None
    if name.startswith(("utf-16", "utf-32")):
        raise InputError(f"encoding '{encoding}' cannot be followed line by line; have the logger write utf-8")
