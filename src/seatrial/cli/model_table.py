"""The list of models on the screen."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seatrial.physics.models import ModelSummary


def print_models(summaries: "Sequence[ModelSummary]") -> None:
    """Print name, states, inputs and source of each model; why an installed one cannot be loaded."""
    for model in summaries:
        signature = f"states {', '.join(model.states)}; inputs {', '.join(model.inputs)}"
        print(f"{model.name:20s} {model.problem or signature}")
        if model.source:
            print(f"{'':20s} {model.source}")
        if model.package:
            print(f"{'':20s} installed by {model.package}")
