"""Models written once as named bindings; code, Jacobians and LaTeX are generated from them."""

from seatrial.equations.model import Binding, Input, Model
from seatrial.equations.sheet import Sheet

__all__ = ["Binding", "Input", "Model", "Sheet"]
