"""Runs predicted open loop, with what their intervals are made of."""
