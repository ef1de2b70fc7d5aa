"""What the columns of a log may be, weighed by what they show together: the judge of readings."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
