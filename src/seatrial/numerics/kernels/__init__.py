"""Compiled arithmetic on float64 arrays: integrators, filters, propagators."""

import hashlib
from pathlib import Path

from numba.core import config

from seatrial.numerics.kernels.cache import cache_folder

# machine code of a kernel holds that of the kernels it calls: any of them changed, all are compiled again
_TEXTS = hashlib.sha256(b"".join(p.read_bytes() for p in sorted(Path(__file__).parent.glob("*.py")))).hexdigest()
config.CACHE_DIR = str(cache_folder() / f"numba_{_TEXTS[:12]}")  # pyright: ignore[reportAttributeAccessIssue]
