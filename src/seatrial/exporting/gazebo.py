"""Hydrodynamics of VRX and of Gazebo (gz-sim): XML of a plugin, its coefficients projected from the model.

Structures as the plugins compute them (VRX 2, SimpleHydrodynamics.cc; gz-sim 8, Hydrodynamics.cc). VRX applies added
mass to the acceleration in space and leaves out its Coriolis force. gz-sim applies it to the rate of the velocity; the
signs of its Coriolis terms differ from Fossen's, so they are switched off and the coefficients of v r, u r and u v
take their place. Gazebo's axes point forward, to port and up: turned by half a revolution about the x axis, which
leaves these coefficients as they are.
"""

import math
from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.exporting.projection import ForceTerm, MotionError, TargetStructure, project, unsuitable_hull
from seatrial.exporting.source import (
    Export,
    ExportSource,
    plain,
    provenance_lines,
    range_text,
    rendered,
    require_values,
)
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.thruster_layout import layout_of, steering_angles
from seatrial.physics.simulate.replay import replay
from seatrial.physics.simulate.steer import manoeuvre
from seatrial.physics.simulate.thrust import craft_manoeuvre, craft_programme

VRX = TargetStructure(
    (
        ForceTerm("xU", "X", "u", sign=-1.0), ForceTerm("xUU", "X", "u", "|u|", -1.0),
        ForceTerm("yV", "Y", "v", sign=-1.0), ForceTerm("yVV", "Y", "v", "|v|", -1.0),
        ForceTerm("nR", "N", "r", sign=-1.0), ForceTerm("nRR", "N", "r", "|r|", -1.0),
    ),
    1.0, is_inertial=True,
)  # fmt: skip
"""Drag coefficients are positive."""
GZ_SIM = TargetStructure(
    (
        ForceTerm("xU", "X", "u"), ForceTerm("xUabsU", "X", "u", "|u|"), ForceTerm("xVV", "X", "v", "v"),
        ForceTerm("xVR", "X", "v", "r"), ForceTerm("xRR", "X", "r", "r"),
        *(
            ForceTerm(f"{force.lower()}{first.upper()}{'abs' if second[:1] == '|' else ''}{second.strip('|').upper()}",
                      force, first, second)
            for force in "YN"
            for first, second in (
                ("v", ""), ("r", ""), ("u", "v"), ("u", "r"), ("v", "|v|"), ("v", "|r|"), ("r", "|v|"), ("r", "|r|"),
            )
        ),
    ),
    -1.0, is_inertial=False,
)  # fmt: skip
"""Stability derivatives: drag and added mass are negative."""
RUDDER_MOTIONS, THRUST_MOTIONS = ("zigzag:20/20", "turning-circle:20"), ("zigzag:30/20", "spin:30")
_MOST_RUNS = 4  # training runs that a projection is refitted over; chosen
_DIGITS = 9  # of a coefficient: more than any refit determines


def export_vrx(source: ExportSource, name: str) -> Export:
    """Return ``name.xml``: the plugin of VRX.

    Raises:
        InputError: a parameter has no value, or the projected craft runs away.
    """
    return _export(source, name, VRX, "vrx.xml")


def export_gazebo(source: ExportSource, name: str) -> Export:
    """Return ``name.xml``: the plugin of gz-sim.

    Raises:
        InputError: a parameter has no value, or the projected craft runs away.
    """
    return _export(source, name, GZ_SIM, "gazebo.xml")


def unsuitable_craft(source: ExportSource) -> str:
    """Return why Gazebo has no place for a model; empty where it has one."""
    return unsuitable_hull(source.file)


def training_runs(source: ExportSource) -> list[Record]:
    """Return the model under the inputs of its training runs: those that turn most, without those it runs away on."""
    runs = []
    for record in source.runs:
        with suppress(InputError):
            runs.append(replay(source.model, record))
    return sorted(runs, key=lambda run: -float(np.mean(run["r"] ** 2)))[:_MOST_RUNS]


def training_motions(source: ExportSource) -> list[Record]:
    """Return a zigzag and a circle of the model, of a craft without a rudder a zigzag and a turn by thrust.

    Raises:
        InputError: the model cannot be taken through them.
    """
    model, file = source.model, source.file
    if model.has_thrusters:
        layout = layout_of(model)
        texts = RUDDER_MOTIONS if steering_angles(layout) else THRUST_MOTIONS
        return [craft_manoeuvre(model, craft_programme(layout, text)) for text in texts]
    held = {name: value for name, value in file.approach.items() if name in model.input_names}
    return [manoeuvre(model, programme(text), inputs=held, slew_rate=file.rudder_rate.value) for text in RUDDER_MOTIONS]


def _export(source: ExportSource, name: str, structure: TargetStructure, template: str) -> Export:
    require_values(source)
    try:
        motions = training_motions(source)
    except InputError as error:
        raise InputError(f"the motions to fit the projection to cannot be simulated: {error}") from None
    runs = training_runs(source)
    projection = project(source.file, structure, motions, runs)
    price = [_price_text(error) for error in projection.errors]
    price.append(_runs_text(projection.run_errors))
    content = rendered(
        template,
        head=[*provenance_lines(source), range_text(source)],
        price=price,
        mass=f"{projection.rigid.mass:.{_DIGITS}g}",
        inertia=f"{projection.rigid.inertia:.{_DIGITS}g}",
        x_G=f"{projection.rigid.x_G:.{_DIGITS}g}",
        coefficients=[(tag, f"{value:.{_DIGITS}g}") for tag, value in projection.coefficients.items()],
    )
    return Export({f"{name}.xml": content}, (*price, range_text(source)))


def _runs_text(errors: Sequence[MotionError]) -> str:
    if not errors:
        return "Refitted over these two alone: no training runs lie beside the model file."
    names = ", ".join(plain(error.manoeuvre) for error in errors)
    refitted, truncated = (
        math.sqrt(math.fsum(value**2 for value in values) / len(errors))
        for values in ([e.refitted for e in errors], [e.truncated for e in errors])
    )
    return _price_text(MotionError(f"training runs {names}", refitted, truncated))


def _price_text(error: MotionError) -> str:
    refitted, truncated = (f"{math.degrees(value):.3g}" for value in (error.refitted, error.truncated))
    return f"{error.manoeuvre}: rms heading error of the projection {refitted} deg, of the truncation {truncated} deg."
