"""What a target of an export is, and what it returns."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from seatrial.exporting.source import ExportSource


@dataclass(frozen=True)
class Export:
    """Files of one export and what a user has to know of them.

    Attributes:
        files: name -> content; one file is written to the path itself, several into a folder of that name.
        notes: sentences to print: prices of a projection, what could not be done.
    """

    files: Mapping[str, bytes]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Target:
    """A tool that models are exported to.

    Attributes:
        meaning: what is written, in a phrase.
        suffix: of the file; empty where a folder is written.
        unsuitable: returns why the target has no place for a model; empty where it has one.
        export: returns the files; its second argument is the name that the path gives.
        takes_gains: whether gains of a tuned autopilot have a place in it.
        takes_runs: whether it is fitted to the training runs.
    """

    name: str
    meaning: str
    suffix: str
    unsuitable: Callable[[ExportSource], str]
    export: Callable[[ExportSource, str], Export] = field(repr=False)
    takes_gains: bool = False
    takes_runs: bool = False
