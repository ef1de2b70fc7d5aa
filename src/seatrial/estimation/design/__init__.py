"""Optimal manoeuvres: the orders that identify the coefficients best within limits."""
