"""The list of models on the screen."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from seatrial.cli.screen import print_heading, print_lines, print_next, print_table, print_verbatim

if TYPE_CHECKING:
    from seatrial.data.trial.model_table import FilledValue, ModelGuide
    from seatrial.physics.models import ModelSummary


def print_models(summaries: "Sequence[ModelSummary]") -> None:
    """Print name, states, inputs and source of each model; why an installed one cannot be loaded."""
    rows = []
    for model in summaries:
        signature = f"states {', '.join(model.states)}; inputs {', '.join(model.inputs)}"
        rows.append([model.name, model.problem or signature])
        rows += [["", text] for text in (model.source, model.package and f"installed by {model.package}") if text]
    print_table(rows, flush_left=(0, 1))
    print_next("seatrial models NAME says what a model needs, with a trial file to begin with")


def print_model_guide(guide: "ModelGuide") -> None:
    """Print what a model needs, what is filled from where, and the tables of a trial file to begin with."""
    from seatrial.core.text.words import enumeration

    print_lines([f"{guide.name}: {guide.source}"])
    needed = [name for name in guide.inputs if name not in guide.optional_inputs]
    needs = f"{enumeration(needed)}, and " if needed else ""
    print_lines([f"records need {needs}one or more of {', '.join(guide.observables)}"])
    if guide.optional_inputs:
        print_lines([f"where recorded: {enumeration(list(guide.optional_inputs))}"])
    print_lines([f"estimated unless you say otherwise: {', '.join(guide.free)}"])
    by_source: dict[str, list[FilledValue]] = {}
    for value in guide.filled:
        by_source.setdefault(value.source, []).append(value)
    print_lines(["filled, where you do not state it:"])
    for source, values in by_source.items():
        print_lines([f"  {', '.join(_with_deviation(value) for value in values)}: {source}"])
    print_heading("A trial file begins so ('seatrial init LOG... --out trial.toml' writes the records)")
    print_verbatim(["", *guide.trial.splitlines()])


def _with_deviation(value: "FilledValue") -> str:
    return f"{value.name} (prior sd {value.deviation:g})" if value.deviation else value.name
