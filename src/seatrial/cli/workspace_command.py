"""The command that opens the workspace in the browser."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from seatrial.cli.application import app, requiring_app
from seatrial.cli.screen import print_file, print_verbatim


@app.command()
def open(
    path: Annotated[
        Path, typer.Argument(metavar="[LOGS|TRIAL.toml]", help="A trial file, a log, or a folder with either.")
    ] = Path(),
    port: Annotated[int, typer.Option(help="Port of the page on this machine; 0: any.")] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Print the address, open no browser.")] = False,
    shortcut: Annotated[
        bool, typer.Option("--shortcut", help="Put a shortcut to this folder on the desktop instead.")
    ] = False,
) -> None:
    """Open logs or a trial in the browser: columns, runs, fit, what if, gains; each act is an edit of the trial file.

    Example: seatrial open examples/ship

    It ends with the terminal, or with Ctrl-C. Only this machine's browser reaches it.
    """
    with requiring_app():
        from seatrial.workspace import serve_workspace, write_shortcut
    if shortcut:
        print_file("shortcut", write_shortcut(path))
        return

    def opened(address: str) -> None:
        import webbrowser

        print_verbatim([f"the workspace is open at {address}", "it ends with this terminal, or with Ctrl-C"])
        sys.stdout.flush()
        if not no_browser:
            webbrowser.open(address)

    serve_workspace(path, port, opened)
