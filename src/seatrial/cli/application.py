"""The application, the options that several commands share, and what they do with them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from seatrial.core.equations import Model

app = typer.Typer(
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
        from seatrial.core.values.files import is_folder, writable_folder

        if is_folder(path):
            raise InputError(f"--json {path} is a folder; name a file")
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
