"""Criteria as residuals and Jacobians: output error, prediction error, spectra, static forces."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
