"""The sheet on which a model is written: states, inputs, parameters, named bindings and rates, each with its source.

It reads like the paper:

    sheet = Sheet("yaw", source="Nomoto et al. 1957")
    r, psi = sheet.states("r psi")
    delta = sheet.input("delta")
    T = sheet.parameter("T", unit="s", meaning="time constant", value=10.0)
    K = sheet.parameter("K", unit="1/s", value=0.1)
    sheet.rate(r, (K * delta - r) / T, "eq. (1)")
    sheet.rate(psi, r)
    model = sheet.model()
"""

import math

import sympy as sp

from seatrial.core.equations.bindings import Binding, Input, ModelEquations
from seatrial.core.equations.model import Model
from seatrial.core.values import InputError, Parameter, Parameters


class Sheet:
    """Collects the equations of one model in the order in which they are written.

    Raises:
        InputError: a name used twice, a rate missing or given twice, a symbol the sheet does not know.
    """

    def __init__(self, name: str, source: str = "", meaning: str = "", layout: str = "") -> None:
        self.name, self.source, self.meaning, self.layout = name, source, meaning, layout
        self._states: list[str] = []
        self._inputs: list[Input] = []
        self._parameters: list[Parameter] = []
        self._bindings: list[Binding] = []
        self._rates: dict[str, tuple[sp.Expr, str]] = {}
        self._outputs: list[str] = []

    @property
    def _declared_names(self) -> set[str]:
        return {*self._states, *(item.name for item in (*self._inputs, *self._parameters, *self._bindings))}

    def _declare(self, name: str) -> sp.Symbol:
        if not name.isidentifier():
            raise InputError(f"model '{self.name}': '{name}' is no ASCII identifier")
        if name in self._declared_names:
            raise InputError(f"model '{self.name}': the name '{name}' is used twice")
        return sp.Symbol(name, real=True)

    def states(self, names: str) -> tuple[sp.Symbol, ...]:
        """Declare states, names separated by spaces; symbols of the notation table are measured channels."""
        symbols = []
        for name in names.split():
            symbols.append(self._declare(name))
            self._states.append(name)
        return tuple(symbols)

    def input(self, name: str, positive: str = "", *, is_held: bool = False) -> sp.Symbol:
        """Declare an input; `positive` names its positive direction where it differs from the notation table's.

        is_held: linear models keep it constant from sample to sample (a command); else it runs on between them.
        """
        symbol = self._declare(name)
        self._inputs.append(Input(name, positive, is_held))
        return symbol

    def parameter(
        self,
        name: str,
        value: float = math.nan,
        unit: str = "1",
        meaning: str = "",
        source: str = "",
        *,
        free: bool = False,
        lower: float = -math.inf,
        upper: float = math.inf,
        scale: float = 0.0,
        latex: str = "",
    ) -> sp.Symbol:
        """Declare a parameter; without a value it is a particular that the ship must give."""
        symbol = self._declare(name)
        self._parameters.append(
            Parameter(name, value, unit, lower, upper, scale, None, free, source or self.source, meaning, latex)
        )
        return symbol

    def bind(self, name: str, expression: sp.Expr | float, source: str = "", unit: str = "1") -> sp.Symbol:
        """Name an expression of states, inputs, parameters and earlier bindings; returns its symbol."""
        symbol = self._declare(name)
        self._check(sp.sympify(expression), f"binding '{name}'")
        self._bindings.append(Binding.from_expression(name, sp.sympify(expression), source, unit))
        return symbol

    def rate(self, state: sp.Symbol, expression: sp.Expr | float, source: str = "") -> None:
        """Give d(state)/dt."""
        if str(state) not in self._states:
            raise InputError(f"model '{self.name}': '{state}' is no state")
        if str(state) in self._rates:
            raise InputError(f"model '{self.name}': the rate of '{state}' is given twice")
        self._check(sp.sympify(expression), f"rate of '{state}'")
        self._rates[str(state)] = (sp.sympify(expression), source)

    def output(self, channel: str, expression: sp.Expr, source: str = "", unit: str = "1") -> sp.Symbol:
        """Declare a binding that can be measured: the record channel of this name is compared with it."""
        symbol = self.bind(channel, expression, source, unit)
        self._outputs.append(channel)
        return symbol

    def _check(self, expression: sp.Expr, where: str) -> None:
        strangers = sorted({str(s) for s in expression.free_symbols} - self._declared_names)
        if strangers:
            raise InputError(f"model '{self.name}', {where}: unknown symbol '{strangers[0]}'; declare it first")

    def model(self) -> Model:
        """Return the finished, immutable model."""
        absent = [s for s in self._states if s not in self._rates]
        if absent:
            raise InputError(f"model '{self.name}': no rate given for state '{absent[0]}'")
        rates = tuple(Binding.from_expression(s, *self._rates[s]) for s in self._states)
        parameters = Parameters(tuple(self._parameters))
        equations = ModelEquations(
            self.name, self.source, tuple(self._inputs), tuple(self._bindings), rates, tuple(self._outputs),
            parameters.names, self.meaning, self.layout,
        )  # fmt: skip
        return Model(equations, parameters)
