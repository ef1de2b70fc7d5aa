"""Names and units of the coefficients of heave and pitch, and start values where nothing is known of them."""

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Ship

MASSES = {"a33": "kg", "a35": "kg m", "a55": "kg m^2", "a53": "kg m"}
DAMPINGS = {"b33": "kg/s", "b35": "kg m/s", "b55": "kg m^2/s", "b53": "kg m/s"}
HEAVE_PITCH_STIFFNESSES = {"c33": "N/m", "c35": "N/rad", "c53": "N m/m", "c55": "N m/rad"}
HEAVE_PITCH_COEFFICIENTS = (*MASSES, *DAMPINGS)

START_DAMPING_RATIO = 0.3  # of critical, in both motions: chosen, of the order of a hull's at resonance


def physical_start_values(values: dict[str, float]) -> dict[str, float]:
    """Return start values of the eight coefficients from m, I5, c33 and c55.

    Added mass as large as the mass, no coupling, damping ratio 0.3 in both motions.
    """
    m, inertia = values["m"], values["I5"]
    start = dict.fromkeys(HEAVE_PITCH_COEFFICIENTS, 0.0)
    start["a33"], start["a55"] = m, inertia
    start["b33"] = 2.0 * START_DAMPING_RATIO * (values["c33"] * 2.0 * m) ** 0.5
    start["b55"] = 2.0 * START_DAMPING_RATIO * (values["c55"] * 2.0 * inertia) ** 0.5
    return start


_MEANING = {"m": "mass", "I5": "moment of inertia", "c33": "heave stiffness", "c55": "pitch stiffness"}


def with_start_values(model: Model, ship: Ship) -> Model:
    """Return heave and pitch with missing coefficients from mass, inertia and stiffness; other models as given.

    Raises:
        InputError: mass, inertia or stiffness is not positive.
    """
    absent = [n for n in model.parameters.missing if n.removesuffix("_0") in HEAVE_PITCH_COEFFICIENTS]
    model_values = {p.name: p.value for p in model.parameters}
    basis = {n: ship.particulars.get(n, model_values.get(n, float("nan"))) for n in _MEANING}
    if not absent or any(value != value for value in basis.values()):
        return model
    for name, value in basis.items():
        if value <= 0.0:
            raise InputError(f"{name} = {value:g} is not positive; the {_MEANING[name]} of a craft that floats is")
    start = physical_start_values(basis)
    values = {n: start[n.removesuffix("_0")] for n in absent}
    return model.with_values(values, source="start: added mass as mass, no coupling, damping ratio 0.3")
