"""Values that a trial file marks as estimated: the fit rests on them, and says so."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from seatrial.core.equations import Model
from seatrial.core.text.words import enumeration
from seatrial.core.values import NOT_MEASURED, Finding, Severity
from seatrial.data.trial.trial import Trial
from seatrial.physics.hydro.empirical import OOSTERVELD

ESTIMATED = "ESTIMATED"
"""Marks a line of a trial file whose number is not measured, in a comment, as `seatrial init` writes it."""
_TABLE = re.compile(r"^\[+(?P<name>[\w.]+)\]+")
_MARKED = re.compile(rf"^(?P<key>\w+)\s*=[^#]*# {ESTIMATED}: (?P<text>[^;]*)")
_THRUSTER_NAME = re.compile(r'^name\s*=\s*"(?P<name>[^"]*)"')
ESTIMATED_VALUES = "estimated-values"
_FOLLOWING = {"pitch_ratio": ("k_0", "k_1", "k_2")}
"""Particulars of a ship that no model holds -> its parameters that formulas take from them."""


def with_estimates_named(trial: Trial, text: str) -> Trial:
    """Return the trial of a file with this text: marked values say that they are estimated, as does a warning.

    Where the mark is removed with the number, nothing is said of it.
    """
    marks = dict(_marks(text))
    if not marks:
        return trial
    return replace(trial, model=_with_sources(trial.model, marks), findings=(*trial.findings, _finding(list(marks))))


def _marks(text: str) -> Iterator[tuple[str, str]]:
    """Keys of marked lines, those of a thruster as its parameters are named, and how each value was estimated."""
    table, thruster = "", ""
    for line in text.splitlines():
        if heading := _TABLE.match(line):
            table = heading["name"]
        elif table == "thruster" and (name := _THRUSTER_NAME.match(line)):
            thruster = name["name"]
        elif mark := _MARKED.match(line):
            key = f"{mark['key']}_{thruster}" if table == "thruster" else mark["key"]
            yield key, mark["text"].strip()


def _with_sources(model: Model, marks: Mapping[str, str]) -> Model:
    """The model whose marked values say so, and those that follow from a marked particular of the ship."""
    following = {name: f"of {key}: {text}" for key, text in marks.items() for name in _FOLLOWING.get(key, ())}
    from_series = {n for n in following if n in model.parameters and OOSTERVELD in model.parameters[n].source}
    for name, text in {**marks, **{n: following[n] for n in from_series}}.items():
        if name in model.parameters and not model.parameters[name].free:
            value = model.parameters[name].value
            model = model.with_values({name: value}, source=f"{NOT_MEASURED}: {text}")
    return model


def _finding(names: list[str]) -> Finding:
    is_one, listed = len(names) == 1, enumeration(names, len(names))
    return Finding(
        Severity.WARNING, ESTIMATED_VALUES, f"{listed} {'is' if is_one else 'are'} {NOT_MEASURED}",
        f"marked {ESTIMATED} in the trial file",
        "write what you can measure in place of the estimate, and remove the mark",
        f"coefficients and intervals are right only as far as {'this value is' if is_one else 'these values are'}",
    )  # fmt: skip
