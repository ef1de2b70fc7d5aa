"""The tools that models are exported to, by name."""

from seatrial.core.values import InputError, spelling_hint
from seatrial.exporting.c_source import export_c
from seatrial.exporting.source import ExportSource
from seatrial.exporting.target import Target


def _suits_every_model(source: ExportSource) -> str:  # noqa: ARG001
    return ""


_ALL = (
    Target("c99", "a folder with one .h and one .c: rates, outputs, Jacobians, step", "", _suits_every_model, export_c),
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
