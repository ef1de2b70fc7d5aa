"""On which arithmetic a result was computed: another processor or linear algebra may round differently."""

import platform
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

_PROCESSOR_TABLE = Path("/proc/cpuinfo")


@cache
def processor() -> str:
    """Return the model of this machine's processor."""
    if _PROCESSOR_TABLE.exists():
        lines = _PROCESSOR_TABLE.read_text(encoding="utf-8", errors="replace").splitlines()
        names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
        if names:
            return names[0]
    return platform.processor() or platform.machine()


@cache
def linear_algebra() -> str:
    """Return the linear-algebra library of NumPy and SciPy with its version and the code it chose for the processor."""
    loaded = [one for one in _loaded().info() if one.get("user_api") == "blas"]
    # other packages bring libraries of their own, which depends on what else this process has imported
    libraries = [one for one in loaded if _is_of_numpy_or_scipy(Path(one["filepath"]))] or loaded
    words = {
        f"{library['internal_api']} {library.get('version')} {library.get('architecture', '')}".strip()
        for library in libraries
    }
    return ", ".join(sorted(words)) or "unknown"


def _is_of_numpy_or_scipy(library: Path) -> bool:
    return any(part.startswith(("numpy", "scipy")) for part in library.parts)


@contextmanager
def serial_linear_algebra() -> Iterator[None]:
    """Let the linear algebra of this process use one thread: sums are then rounded alike whatever the cores."""
    with _loaded().limit(limits=1, user_api="blas"):
        yield


def _loaded() -> "ThreadpoolController":
    """The libraries of this process, after loading those of NumPy and SciPy, of which a task may use either."""
    import scipy.linalg  # noqa: F401  # and with it that of NumPy
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
