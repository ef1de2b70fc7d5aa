"""The command line: parse, call, print, exit code (0 done, 2 input, 70 internal, 130 interrupted)."""

import gc
import io
import os
import sys
from pathlib import Path

from seatrial.cli.commands import app

INPUT_EXIT_CODE, INTERNAL_EXIT_CODE, INTERRUPT_EXIT_CODE = 2, 70, 130  # 70: EX_SOFTWARE of sysexits.h
# new objects between two searches for unreachable cycles; chosen: more than the 215,000 modules, classes and functions
# that an identification imports, all of which live as long as the process
COLLECTION_THRESHOLD = 250_000
# read when NumPy and pydantic are first imported: matrices are small and work is shared out over runs, so that threads
# of the linear algebra would wait for one another, and round differently from machine to machine; plugins of pydantic
# have no part in reading a file, and looking for them opens every package that is installed
_LIBRARIES = {"OPENBLAS_NUM_THREADS": "1", "PYDANTIC_DISABLE_PLUGINS": "__all__"}
_INTERRUPT_MESSAGE = "seatrial: interrupted; files are written whole or not at all"


def main() -> None:
    """Run the command line; bad input is one line on standard error, and so is an error of the program itself."""
    gc.set_threshold(COLLECTION_THRESHOLD)
    for variable, value in _LIBRARIES.items():
        os.environ.setdefault(variable, value)
    _prepare_streams()
    try:
        try:
            app()
        finally:
            _flush_output()
    except SystemExit as ending:
        if ending.code == INTERRUPT_EXIT_CODE:
            print(_INTERRUPT_MESSAGE, file=sys.stderr)
        raise
    except KeyboardInterrupt:
        print(_INTERRUPT_MESSAGE, file=sys.stderr)
        sys.exit(INTERRUPT_EXIT_CODE)
    except Exception as error:
        from seatrial.cli.errors import error_message, is_of_input

        print(f"seatrial: {error_message(error)}", file=sys.stderr)
        sys.exit(INPUT_EXIT_CODE if is_of_input(error) else INTERNAL_EXIT_CODE)


def _prepare_streams() -> None:
    """Let any name be printed, whatever the terminal's encoding; a stream that is closed takes what it is given."""
    sys.stdout = sys.stdout or _nowhere()
    sys.stderr = sys.stderr or _nowhere()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _nowhere() -> io.TextIOWrapper:
    return io.TextIOWrapper(Path(os.devnull).open("wb"), encoding="utf-8")


def _flush_output() -> None:
    """Print what is still to be printed; nothing where nobody reads it any more.

    Raises:
        OSError: the disk that it goes to is full.
    """
    try:
        sys.stdout.flush()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for the flush at the end of the process
        if not isinstance(error, BrokenPipeError):
            raise


__all__ = ["app", "main"]
