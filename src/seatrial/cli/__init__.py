"""The command line: parse, call, print, exit code."""

import gc
import sys

from seatrial.cli.commands import app

INTERRUPT_EXIT_CODE = 130
# new objects between two searches for unreachable cycles: most are modules and classes that live as long as the
# process; chosen: Python's own 700 costs a sixteenth of the time of a command
_COLLECTION_THRESHOLD = 50_000
_INTERRUPT_MESSAGE = "seatrial: interrupted; files are written whole or not at all"


def main() -> None:
    """Run the command line; bad input is one line on standard error and exit code 2."""
    gc.set_threshold(_COLLECTION_THRESHOLD)
    try:
        app()
    except ValueError as error:
        from seatrial.core.values import InputError

        if not isinstance(error, InputError):
            raise
        print(f"seatrial: {' '.join(str(error).split())}", file=sys.stderr)
        sys.exit(2)
    except SystemExit as ending:
        if ending.code == INTERRUPT_EXIT_CODE:
            print(_INTERRUPT_MESSAGE, file=sys.stderr)
        raise
    except KeyboardInterrupt:
        print(_INTERRUPT_MESSAGE, file=sys.stderr)
        sys.exit(INTERRUPT_EXIT_CODE)


__all__ = ["app", "main"]
