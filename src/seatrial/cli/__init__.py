"""The command line: parse, call, print, exit code."""

import sys

from seatrial.cli.commands import app

INTERRUPTED = 130
_STOPPED = "seatrial: interrupted; files are written whole or not at all"


def main() -> None:
    """Run the command line; bad input is one line on standard error and exit code 2."""
    try:
        app()
    except ValueError as error:
        from seatrial.core.values import InputError

        if not isinstance(error, InputError):
            raise
        print(f"seatrial: {' '.join(str(error).split())}", file=sys.stderr)
        sys.exit(2)
    except SystemExit as ending:
        if ending.code == INTERRUPTED:
            print(_STOPPED, file=sys.stderr)
        raise
    except KeyboardInterrupt:
        print(_STOPPED, file=sys.stderr)
        sys.exit(INTERRUPTED)


__all__ = ["app", "main"]
