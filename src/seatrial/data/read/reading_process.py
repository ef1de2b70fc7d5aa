"""Files of binary formats, read in a process of its own: a damaged one can end that process, and nothing else."""

import contextlib
import pickle
import signal
import subprocess
import sys
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.read.layout import Layout
from seatrial.data.read.log import Log
from seatrial.numerics.platform import limit_resources

# bytes of memory that a reader may use: at least so many, and so many for each byte of the file; ours
_LEAST_MEMORY, _MEMORY_PER_BYTE = 4 * 2**30, 64
# CPU seconds: at least so many, and so many for each byte (two minutes for 10 MB); ours
_LEAST_CPU_S, _CPU_S_PER_BYTE = 120, 12e-6
_TOO_LARGE = "its reader needs more memory than such a file can fill"
_OUT_OF_TIME = (getattr(signal, "SIGXCPU", None), getattr(signal, "SIGKILL", None))


def read_in_process(name: str, path: Path, layout: Layout) -> Log:
    """Read a file by the built-in reader of a format, in a process with limits of memory and of CPU time.

    Raises:
        InputError: what the reader raises; the reader crashed, or exceeded a limit.
    """
    command = [sys.executable, "-c", "from seatrial.data.read.reading_process import serve; serve()"]
    request = pickle.dumps((name, path, layout, [place for place in sys.path if place]))
    done = subprocess.run(command, input=request, capture_output=True, check=False)
    try:
        answer = pickle.loads(done.stdout)
    except Exception:
        raise InputError(f"{path.name} is damaged: {_end_text(done)}; copy it again or convert it to CSV") from None
    if isinstance(answer, Log):
        return answer
    raise InputError(str(answer))


def _end_text(done: subprocess.CompletedProcess) -> str:
    """How a process ended that gave no answer."""
    if b"MemoryError" in done.stderr or b"bad_alloc" in done.stderr:
        return _TOO_LARGE
    if -done.returncode in [one for one in _OUT_OF_TIME if one is not None]:
        return "its reader does not come to an end"
    return f"its reader ends with code {done.returncode}"


def serve() -> None:
    """Read the request on standard input, and write the log or the sentence of the error to standard output."""
    name, path, layout, places = pickle.load(sys.stdin.buffer)
    sys.path[:] = places
    from seatrial.data.read.registry import FORMATS

    answer_to = sys.stdout.buffer
    size = path.stat().st_size
    limit_resources(max(_LEAST_MEMORY, _MEMORY_PER_BYTE * size), int(_LEAST_CPU_S + _CPU_S_PER_BYTE * size))
    with contextlib.redirect_stdout(sys.stderr):
        try:
            answer: Log | str = FORMATS[name].reader()(path, layout)
        except (InputError, MemoryError) as error:
            out_of_memory = isinstance(error, MemoryError) or isinstance(error.__context__, MemoryError)
            answer = f"{path.name} is damaged: {_TOO_LARGE}; copy it again" if out_of_memory else str(error)
    pickle.dump(answer, answer_to, protocol=pickle.HIGHEST_PROTOCOL)
    answer_to.flush()
