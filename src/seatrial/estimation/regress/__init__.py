"""Regression on features of the equations: cleaning, derivatives, solvers, the weak form."""
