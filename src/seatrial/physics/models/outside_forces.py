"""A craft with thrusters that something outside pushes: gusts and waves, as forces that its equations do not have."""

from dataclasses import replace

from seatrial.core.equations import Model
from seatrial.core.equations.bindings import Binding, Input, ModelEquations
from seatrial.core.equations.manifest import stored_equations

OUTSIDE_FORCES = ("X_outside", "Y_outside", "N_outside")
"""Inputs of `with_outside_forces`: force ahead and to starboard, moment to starboard, in the model's unit of force."""
_SUMS = ("X_sum", "Y_sum", "N_sum")  # bindings of the model `thrusters` that they are added to


def with_outside_forces(model: Model) -> Model:
    """Return a craft of the model ``thrusters`` with the inputs `OUTSIDE_FORCES` behind its own."""
    return replace(model, equations=stored_equations((model.equation_hash, "outside"), lambda: _pushed(model)))


def _pushed(model: Model) -> ModelEquations:
    import sympy as sp

    added = dict(zip(_SUMS, OUTSIDE_FORCES, strict=True))

    def rewritten(binding: Binding) -> Binding:
        if binding.name not in added:
            return binding
        return binding.bound_to(binding.expression + sp.Symbol(added[binding.name], real=True))

    old = model.equations
    return replace(
        old, name=f"{old.name} pushed from outside", inputs=(*old.inputs, *map(Input, OUTSIDE_FORCES)),
        bindings=tuple(map(rewritten, old.bindings)),
    )  # fmt: skip
