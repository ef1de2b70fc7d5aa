"""Files to records, one format a file: parses and converts units, judges nothing."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
