"""The tools that models are exported to, by name."""

from seatrial.core.values import InputError, spelling_hint
from seatrial.exporting.ardupilot.parameters import export_ardupilot, unsuitable_boat
from seatrial.exporting.c_source import export_c
from seatrial.exporting.fmu import export_fmu
from seatrial.exporting.gazebo import export_gazebo, export_vrx, unsuitable_craft
from seatrial.exporting.scripts import export_casadi, export_matlab
from seatrial.exporting.source import ExportSource, Target


def _suits_every_model(source: ExportSource) -> str:  # noqa: ARG001
    return ""


_ALL = (
    Target("c99", "a folder with one .h and one .c: rates, outputs, Jacobians, step", "", _suits_every_model, export_c),
    Target("fmu", "an FMU of FMI 2.0 for co-simulation, with C sources", ".fmu", _suits_every_model, export_fmu),
    Target("casadi", "a Python module that builds CasADi functions", ".py", _suits_every_model, export_casadi),
    Target("matlab", "a folder with a function as MSS calls it and a .mat", "", _suits_every_model, export_matlab),
    Target("vrx", "the hydrodynamics plugin of VRX, refitted", ".xml", unsuitable_craft, export_vrx, takes_runs=True),
    Target(
        "gazebo",
        "the hydrodynamics plugin of gz-sim, refitted",
        ".xml",
        unsuitable_craft,
        export_gazebo,
        takes_runs=True,
    ),
    Target(
        "ardupilot",
        "gains of ArduPilot's heading and speed control",
        ".param",
        unsuitable_boat,
        export_ardupilot,
        takes_gains=True,
    ),
)
TARGETS: dict[str, Target] = {target.name: target for target in _ALL}
"""Name -> target."""


def target_named(name: str) -> Target:
    """Return a target.

    Raises:
        InputError: there is none of that name; the nearest is given.
    """
    if name not in TARGETS:
        raise InputError(f"unknown target '{name}'{spelling_hint(name, list(TARGETS))}")
    return TARGETS[name]
