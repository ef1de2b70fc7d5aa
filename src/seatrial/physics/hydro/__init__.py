"""Hydrodynamics: dispersion, excitation, strip theory, roll damping, data of panel codes."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
