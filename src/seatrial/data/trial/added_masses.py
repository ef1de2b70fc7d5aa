"""A warning where added masses are left at zero: inertias that are too small then scale all forces."""

from seatrial.core.equations import Model
from seatrial.core.values import Finding, InputError, Severity, Ship
from seatrial.physics.hydro.empirical import HullForm, added_mass

ADDED_MASSES = {"X_udot": "m_x_prime", "Y_vdot": "m_y_prime", "N_rdot": "J_z_prime"}
"""Acceleration derivative -> the added mass of the formula, of opposite sign and over rho/2 L^2 d instead of L^3."""


def added_mass_findings(model: Model, ship: Ship) -> tuple[Finding, ...]:
    """Return a warning `added-mass-zero` where a model has acceleration derivatives and all are fixed at zero."""
    if not has_held_added_masses(model) or any(model.parameters[name].value for name in ADDED_MASSES):
        return ()
    names = ", ".join(ADDED_MASSES)
    return (Finding(
        Severity.WARNING, "added-mass-zero", f"the added masses {names} are 0: motions show forces per mass, so that "
        "all coefficients come out too small by the share of the mass that is missing", "", _advice(ship),
    ),)  # fmt: skip


def has_held_added_masses(model: Model) -> bool:
    """Return whether a model has acceleration derivatives and all of them are fixed."""
    parameters = model.parameters
    return all(name in parameters.names and not parameters[name].free for name in ADDED_MASSES)


def _advice(ship: Ship) -> str:
    """The edit, with numbers where the ship's form is known."""
    try:
        estimate = added_mass(form := HullForm.from_ship(ship))
    except InputError:
        return (
            "give X_udot, Y_vdot and N_rdot (negative, over rho/2 L^3 and L^5) under [model.fixed]; with B, d and C_b "
            "under [ship] this message gives estimates"
        )
    values = ", ".join(f"{name} = {-estimate.values[key] * form.d / form.L:.2g}" for name, key in ADDED_MASSES.items())
    return f"under [model.fixed] give {values} ({estimate.source})"
