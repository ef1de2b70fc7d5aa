"""Start values that follow from what is known of the ship, where a model has none of its own."""

from seatrial.core.equations import Model
from seatrial.core.values import Ship
from seatrial.physics.models.heave_pitch_coefficients import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.heave_pitch_coefficients import physical_start_values

_REQUIRED_PARTICULARS = ("m", "I5", "c33", "c55")


def with_start_values(model: Model, ship: Ship) -> Model:
    """Return heave and pitch with missing coefficients from mass, inertia and stiffness; other models as given."""
    absent = [n for n in model.parameters.missing if n.removesuffix("_0") in COEFFICIENTS]
    model_values = {p.name: p.value for p in model.parameters}
    basis = {n: ship.particulars.get(n, model_values.get(n, float("nan"))) for n in _REQUIRED_PARTICULARS}
    if not absent or any(value != value for value in basis.values()):
        return model
    start = physical_start_values(basis)
    values = {n: start[n.removesuffix("_0")] for n in absent}
    return model.with_values(values, source="start: added mass as mass, no coupling, damping ratio 0.3")
