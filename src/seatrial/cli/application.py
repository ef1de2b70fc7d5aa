"""The application, the options that several commands share, and what they do with them."""

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from seatrial.cli.progress import notices
from seatrial.cli.screen import Detail, printing

if TYPE_CHECKING:
    from seatrial.core.equations import Model

Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors and names of written files only.")]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Print everything, with each step of the work.")]


class Application(typer.Typer):
    """Commands that all have --quiet and --verbose."""

    def command(self, name: str | None = None) -> Callable[[Callable[..., None]], Callable[..., None]]:  # type: ignore[override]
        """Return what registers a function as the command of that name, its own by default."""
        register = super().command(name)
        return lambda function: register(_with_detail(function))


def _with_detail(function: Callable[..., None]) -> Callable[..., None]:
    """The function with two options more, which set how much it prints."""

    @functools.wraps(function)
    def run(*, quiet: bool, verbose: bool, **arguments: object) -> None:
        from seatrial.core.values import InputError

        if quiet and verbose:
            raise InputError("--quiet and --verbose exclude one another; give one of them")
        with printing(Detail.QUIET if quiet else Detail.VERBOSE if verbose else Detail.NORMAL), notices():
            function(**arguments)

    signature, options = inspect.signature(function), {"quiet": Quiet, "verbose": Verbose}
    added = [
        inspect.Parameter(n, inspect.Parameter.KEYWORD_ONLY, default=False, annotation=a) for n, a in options.items()
    ]
    run.__signature__ = signature.replace(parameters=[*signature.parameters.values(), *added])  # type: ignore[attr-defined]
    run.__annotations__ = {**function.__annotations__, **options}
    return run


app = Application(
    name="seatrial",
    help="Sea-trial records into ship motion models you can defend.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)


def _version(requested: bool) -> None:
    if requested:
        from seatrial import __version__

        print(f"seatrial {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Show it.")] = False,
) -> None:
    pass


def _writable_json_path(path: Path | None) -> Path | None:
    """Return the path of the JSON file after checking, before any work, that it can be written."""
    if path is not None:
        from seatrial.core.values import InputError
        from seatrial.core.values.files import is_device_or_pipe, is_folder, writable_folder

        if is_folder(path):
            raise InputError(f"--json {path} is a folder; name a file")
        if not is_device_or_pipe(path):
            writable_folder(path.parent)
    return path


Json = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", callback=_writable_json_path, help="Write the result as JSON.")
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of random numbers; the same seed gives the same bits.")]
TrialPath = Annotated[Path, typer.Argument(metavar="TRIAL.toml", help="Trial file.")]
OwnModelPath = Annotated[
    Path | None, typer.Option("--model", metavar="FILE.py", help="A model of your own; the file is executed.")
]


def own_model(path: Path | None) -> "Model | None":
    """Return the model of a Python file, which is executed; None where none is named."""
    if path is None:
        return None
    from seatrial.physics.models import model_from_file

    return model_from_file(path)


def result_document(result: object) -> dict[str, Any]:
    """Return the JSON document of a result."""
    from seatrial.data.folder.document import document

    return document(result)


@contextmanager
def requiring_app() -> Iterator[None]:
    """Import from `seatrial.workspace` in the body.

    Raises:
        InputError: the packages of the extra `app` are not installed.
    """
    from seatrial.core.values import InputError

    try:
        yield
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("starlette", "uvicorn", "h11", "anyio"):
            raise
        raise InputError("the workspace needs two more packages; pip install 'seatrial[app]'") from None


def write_json(path: Path | None, table: Callable[[], Mapping[str, Any]]) -> None:
    """Write `table()` as JSON where a file is wanted.

    Raises:
        InputError: the place cannot be written.
    """
    if path is not None:
        from seatrial.core.values.files import write_atomically
        from seatrial.data.folder.document import strict_json

        write_atomically(path, strict_json(table()).encode())
