"""Models written once as named bindings; code, Jacobians and LaTeX are generated from them."""

from seatrial.equations.bindings import Binding, Equations, Input
from seatrial.equations.model import Model
from seatrial.equations.sheet import Sheet

__all__ = ["Binding", "Equations", "Input", "Model", "Sheet"]
