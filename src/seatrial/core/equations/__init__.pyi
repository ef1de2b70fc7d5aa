from seatrial.core.equations.bindings import Binding, Input, ModelEquations
from seatrial.core.equations.model import Model
from seatrial.core.equations.sheet import Sheet

__all__ = ["Binding", "Input", "Model", "ModelEquations", "Sheet"]
