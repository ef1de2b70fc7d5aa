"""Arithmetic on arrays: compiled kernels, optimisers, workers. Nothing here knows what a ship is."""
