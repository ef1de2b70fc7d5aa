"""The machine code of a model compiled in another process while this one compiles the integrators: half the wait."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from seatrial.numerics.platform import usable_cores
from seatrial.physics.models.registry import MODELS, model_named

_PROGRAM = "import sys; from seatrial.physics.models import model_named; model_named(sys.argv[1]).compiled.load()"
# the other process is given up after that: the largest model (MMG, 77 parameters) takes 6 s, measured
_PATIENCE_S = 20.0


@contextmanager
def precompile(name: str) -> Iterator[None]:
    """Compile a built-in model and its integrators while the body runs; at the end all of it is in the compile cache.

    Does nothing for other models, for one that is in the cache already, or on a single core. Whatever goes wrong in the
    other process goes wrong again here, where it is reported.
    """
    if name not in MODELS or usable_cores() < 2 or _is_cached(name):
        yield
        return
    from seatrial.numerics.kernels.cache import cache_folder

    environment = {**os.environ, "SEATRIAL_CACHE": str(cache_folder().parent)}
    command = [sys.executable, "-c", _PROGRAM, name]
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
        _load_integrators(is_affine=model_named(name).is_affine)
        process.wait(_PATIENCE_S)
    except subprocess.TimeoutExpired:
        pass
    finally:
        process.kill()
        process.wait()


def _is_cached(name: str) -> bool:
    from seatrial.core.equations.compiled import is_cached

    return is_cached(model_named(name).equations)


def _load_integrators(*, is_affine: bool) -> None:
    from seatrial.numerics.kernels import integrate, linear, propagate, sensitivity
    from seatrial.numerics.kernels.kernel import load_kernels

    for module in (linear, propagate) if is_affine else (integrate, sensitivity):
        load_kernels(module)
