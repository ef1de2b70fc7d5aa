"""Start values that follow from what is known of the ship, where a model has none of its own."""

from seatrial.core.equations import Model
from seatrial.core.values import Ship
from seatrial.physics.models.heave_pitch_coefficients import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.heave_pitch_coefficients import physical_start_values

_REQUIRED_PARTICULARS = ("m", "I5", "c33", "c55")


def with_start_values(model: Model, ship: Ship) -> Model:
    """Heave and pitch: coefficients without a value start from mass, inertia and stiffness; others are as they are."""
    absent = [n for n in model.parameters.missing if n.removesuffix("_0") in COEFFICIENTS]
    own = {p.name: p.value for p in model.parameters}
    known = {n: ship.particulars.get(n, own.get(n, float("nan"))) for n in _REQUIRED_PARTICULARS}
    if not absent or any(value != value for value in known.values()):
        return model
    start = physical_start_values(known)
    values = {n: start[n.removesuffix("_0")] for n in absent}
    return model.with_values(values, source="start: added mass as mass, no coupling, damping ratio 0.3")
