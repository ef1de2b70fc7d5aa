"""What records can and cannot identify: covariance, symmetries, collinearity, extrapolation."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
