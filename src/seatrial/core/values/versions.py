"""Versions of Python and of the packages that a result depends on."""

import platform
from importlib.metadata import PackageNotFoundError, version

from seatrial import __version__

_PACKAGES = ("numpy", "scipy", "numba", "sympy", "pandas")


def versions() -> dict[str, str]:
    """Return package -> version, Python included; of seatrial that of the code that runs."""
    table = {"python": platform.python_version(), "seatrial": __version__}
    for name in _PACKAGES:
        try:
            table[name] = version(name)
        except PackageNotFoundError:
            table[name] = "unknown"
    return table
