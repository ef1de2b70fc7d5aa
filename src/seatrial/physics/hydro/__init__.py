"""Hydrodynamics: dispersion, excitation, strip theory, roll damping, data of panel codes."""
