"""The candidates of eq. (2): the craft's equations with N_vrr and N_vvr besides, both zero in truth."""

from dataclasses import replace
from functools import cache

from seatrial.core.equations import Model
from seatrial.core.values import Parameter, Parameters
from seatrial.physics.models import waterjet
from seatrial_studies.song2025.craft_models import symbol, with_expressions
from seatrial_studies.song2025.published import DROPPED_COEFFICIENTS, SOURCE


@cache
def thirteen_coefficient_model() -> Model:
    """The thirteen-coefficient model; q L [L^2 v r^2 / U, L v^2 r / U] make the two further ones nondimensional."""
    craft = waterjet()
    more = tuple(
        Parameter(n, 0.0, source=f"{SOURCE}, eq. (2); not in table 2", free=True) for n in DROPPED_COEFFICIENTS
    )
    wide = replace(
        craft,
        equations=replace(craft.equations, parameters=(*craft.parameters.names, *DROPPED_COEFFICIENTS)),
        parameters=Parameters((*craft.parameters.items, *more)),
    )
    v, r_L, U, q, L, N_vrr, N_vvr = (symbol(n) for n in ("v", "r_L", "U", "q", "L", *DROPPED_COEFFICIENTS))
    (N_H,) = [b.expression for b in craft.bindings if b.name == "N_H"]
    return with_expressions(wide, "waterjet_13", {"N_H": N_H + q * L * (N_vrr * v * r_L**2 + N_vvr * v**2 * r_L) / U})
