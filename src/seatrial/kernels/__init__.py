"""Numba on float64 arrays: integrators with typed function pointers. Knows no ship."""

import numba

from seatrial.kernels.cache import cache_folder

numba.config.CACHE_DIR = str(cache_folder() / "numba")
