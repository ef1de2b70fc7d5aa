"""Optimal manoeuvres: the input sequence that tells the coefficients best within limits."""
