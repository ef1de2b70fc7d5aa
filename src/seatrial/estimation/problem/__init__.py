"""Criteria as residuals and Jacobians: output error, prediction error, spectra, static forces."""
