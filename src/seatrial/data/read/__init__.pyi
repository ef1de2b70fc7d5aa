from seatrial.data.read.layout import ColumnSpec, Layout
from seatrial.data.read.log import Log, LogEvent, RawTable, Reader, topic_table
from seatrial.data.read.record_file import read_log, read_record, read_record_csv, write_record_csv
from seatrial.data.read.registry import FORMATS, format_of, reader_of, require_format

__all__ = [
    "FORMATS",
    "ColumnSpec",
    "Layout",
    "Log",
    "LogEvent",
    "RawTable",
    "Reader",
    "format_of",
    "read_log",
    "read_record",
    "read_record_csv",
    "reader_of",
    "require_format",
    "topic_table",
    "write_record_csv",
]
