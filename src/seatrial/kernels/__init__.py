"""Numba on float64 arrays: integrators with typed function pointers. Knows no ship."""

from numba.core import config

from seatrial.kernels.cache import cache_folder

config.CACHE_DIR = str(cache_folder() / "numba")  # pyright: ignore[reportAttributeAccessIssue]
