"""Regression on features of the equations: cleaning, derivatives, solvers, the weak form."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
