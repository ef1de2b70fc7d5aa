"""A warning where velocities over ground are fitted as if through the water: a current then ends in coefficients."""

from collections.abc import Sequence

from seatrial.core.equations import Model
from seatrial.core.values import Finding, Severity
from seatrial.data.trial.schema import RecordsTable
from seatrial.physics.sensors import Sensors, VelocityReference


def ground_velocity_findings(
    model: Model, sensors: Sensors | None, blocks: Sequence[RecordsTable]
) -> tuple[Finding, ...]:
    """Return a warning `velocity-over-ground` where a receiver's velocities are those of a model of u and v."""
    is_stated = sensors is not None and sensors.velocity is VelocityReference.GROUND
    if is_stated or not {"u", "v"} <= set(model.states) or not any(map(_is_over_ground, blocks)):
        return ()
    return (Finding(
        Severity.WARNING, "velocity-over-ground",
        "u and v are a receiver's, over ground, and fitted as if through the water", "",
        '[sensors] velocity = "ground" in the trial file; with it a current no longer counts as drift',
        "a current ends in the coefficients, and a run under another one is missed",
    ),)  # fmt: skip


def _is_over_ground(block: RecordsTable) -> bool:
    return any("sog" in columns for columns in (block.channels, *(source.channels for source in block.sources)))
