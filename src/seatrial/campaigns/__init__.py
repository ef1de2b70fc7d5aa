"""Campaigns: many identifications on one machine or a cluster, each kept once in a store that nothing can spoil."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
