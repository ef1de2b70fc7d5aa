from seatrial.data.read.layout import ColumnSpec, Layout
from seatrial.data.read.raw_table import RawTable, Reader
from seatrial.data.read.record_csv import read_record_csv, write_record_csv
from seatrial.data.read.record_file import read_record
from seatrial.data.read.registry import READERS, format_of, reader_of, require_format

__all__ = [
    "READERS",
    "ColumnSpec",
    "Layout",
    "RawTable",
    "Reader",
    "format_of",
    "read_record",
    "read_record_csv",
    "reader_of",
    "require_format",
    "write_record_csv",
]
