"""Versions of Python and of the packages that a result depends on."""

import platform
from importlib.metadata import PackageNotFoundError, version

_PACKAGES = ("seatrial", "numpy", "scipy", "numba", "sympy", "pandas")


def versions() -> dict[str, str]:
    """Return package -> version, Python included."""
    table = {"python": platform.python_version()}
    for name in _PACKAGES:
        try:
            table[name] = version(name)
        except PackageNotFoundError:
            table[name] = "unknown"
    return table
