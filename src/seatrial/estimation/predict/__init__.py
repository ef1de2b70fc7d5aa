"""Runs predicted open loop, with intervals and what these consist of."""
