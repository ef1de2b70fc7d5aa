"""Results: fits, designs, tunings, studies and estimates on a stream, described field by field."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
