"""What records can and cannot identify: covariance, symmetries, collinearity, extrapolation."""
