"""The command export: a model as files of another tool."""

from pathlib import Path
from typing import Annotated

import typer

from seatrial.cli.application import Json, OwnModelPath, Seed, app, own_model, write_json
from seatrial.cli.screen import print_file, print_lines


@app.command()
def export(
    model_file: Annotated[
        Path, typer.Argument(metavar="MODEL.toml", help="Model file, as identify writes it, or its folder.")
    ],
    to: Annotated[
        str | None,
        typer.Option("--to", metavar="TARGET", help="c99, fmu, casadi, matlab, vrx, gazebo or ardupilot; see --list."),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", metavar="PATH", help="New file or folder.")] = None,
    gains: Annotated[
        Path | None, typer.Option("--gains", metavar="GAINS.toml", help="gains.toml of tune, for ardupilot.")
    ] = None,
    show_list: Annotated[bool, typer.Option("--list", help="Show which targets suit the model, and why not.")] = False,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """Export a model to another tool, with units, signs, identified range and provenance in every file.

    Example: seatrial export results/kvlcc2/model.toml --to c99 --out kvlcc2

    What suits a model: seatrial export results/kvlcc2/model.toml --list
    """
    from seatrial import api
    from seatrial.core.values import InputError
    from seatrial.data.folder.gains_file import controller_gains
    from seatrial.exporting import TARGETS

    file = model_file if model is None else api.load_model(model_file, own_model(model))
    if show_list:
        reasons = api.export_targets(file)
        print_lines(
            f"{name:10s} {(reason and f'no: {reason}') or TARGETS[name].meaning}" for name, reason in reasons.items()
        )
        write_json(json, lambda: {"targets": reasons})
        return
    if to is None or out is None:
        raise InputError("give --to TARGET and --out PATH, or --list to see what suits the model")
    result = api.export(file, to, out, None if gains is None else controller_gains(gains))
    print_lines(result.notes)
    write_json(json, lambda: {"target": to, "path": str(out), "files": list(result.files), "notes": list(result.notes)})
    print_file("exported", out)
