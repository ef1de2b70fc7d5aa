"""Time constants below the step of the records are noted; those above it, and other units, are not."""

from types import SimpleNamespace
from typing import Any

from seatrial.core.equations import Model
from seatrial.estimation.identify.warnings import short_time_constant_findings
from seatrial.physics.models import model_named


def estimation(model: Model, step: float) -> Any:
    """What is read of an estimation."""
    return SimpleNamespace(
        model=model, estimate=SimpleNamespace(problem=SimpleNamespace(data=SimpleNamespace(dt=step)))
    )


def test_only_what_lies_between_two_samples_is_noted() -> None:
    craft = model_named("thrusters")
    name = next(p.name for p in craft.parameters.free if p.unit == "s")
    others = {p.name: 9.0 for p in craft.parameters.free if p.unit == "s" and p.name != name}
    craft = craft.with_values({**others, name: 0.056})
    (found,) = short_time_constant_findings(estimation(craft, 0.1))
    assert found.message == f"{name} is below the step of the records"
    assert found.evidence == f"{name} 0.056 s; a sample every 0.10 s"
    assert short_time_constant_findings(estimation(craft, 0.05)) == ()
