"""Compiled arithmetic on float64 arrays: integrators, filters, propagators."""
