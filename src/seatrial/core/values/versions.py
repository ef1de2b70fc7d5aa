"""Versions of everything a result rests on."""

import platform
from importlib.metadata import PackageNotFoundError, version

_PACKAGES = ("seatrial", "numpy", "scipy", "numba", "sympy", "pandas")


def versions() -> dict[str, str]:
    """Package -> version, Python included."""
    found = {"python": platform.python_version()}
    for name in _PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "unknown"
    return found
