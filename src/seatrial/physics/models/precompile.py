"""A model's machine code made in another process while this one compiles the integrators: half the wait at first."""

import os
import subprocess
import sys

from seatrial.physics.models.registry import MODELS

_COMPILE_COMMAND = "import sys; from seatrial.physics.models import model_named; model_named(sys.argv[1]).compiled"
_TIMEOUT_S = 20.0


class Precompilation:
    """A compilation under way; does nothing for models that are not built in, are in the cache, or on a single core."""

    def __init__(self, name: str) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        if name in MODELS and (os.cpu_count() or 1) > 1 and not _is_cached(name):
            self._process = subprocess.Popen(
                [sys.executable, "-c", _COMPILE_COMMAND, name], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )

    def wait(self) -> None:
        """Wait until it is done; whatever went wrong in there goes wrong here again, where it is said."""
        if self._process is not None:
            try:
                self._process.wait(_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                self._process.kill()


def _is_cached(name: str) -> bool:
    from seatrial.core.equations.compiled import is_cached
    from seatrial.physics.models import model_named

    return is_cached(model_named(name).equations)
