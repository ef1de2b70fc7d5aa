"""Searches of coefficients by a population, as published: fitness over a record or a sample, restarts."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
