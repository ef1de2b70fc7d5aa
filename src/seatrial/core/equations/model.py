"""A model: equations, written once, and the values of their parameters; read from the compile cache where it can."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np

from seatrial.core.equations.bindings import (
    Binding,
    CompiledEquations,
    Input,
    ModelEquations,
    compile_equations,
    stored,
)
from seatrial.core.values import Array, InputError, Parameter, Parameters, Ship
from seatrial.core.values.notation import TWIN_DIFFERENCES

# A model: equations, written once, and the values of their parameters.

MEASURED = "_measured"
RUDDER = "delta"
"""The input by which a ship with a rudder or nozzle is steered."""
ZERO_BY_DEFAULT = ("wind_speed", "wind_direction", "F3", "M5", "delta_f1", "delta_f2", "alpha_w", "alpha_f",
                   "depth", "bucket", *TWIN_DIFFERENCES.values())  # fmt: skip
"""Inputs that are zero where they are not recorded; water of depth zero is deep."""


def measured_name(channel: str) -> str:
    """Return the name of the output that a channel's instrument shows, where that is not the state itself."""
    return f"{channel}{MEASURED}"


def channel_of(observable: str) -> str:
    """Return the name of the channel that an observable fills."""
    return observable.removesuffix(MEASURED)


@dataclass(frozen=True)
class Model:
    """Equations with the parameters, free and fixed, in the equations' order.

    Attributes:
        held: inputs that stay constant from sample to sample in the records it is used with, besides those that a
            linear model holds by itself.
    """

    equations: ModelEquations
    parameters: Parameters
    held: frozenset[str] = frozenset()

    def __repr__(self) -> str:
        inputs = ", ".join(self.input_names) or "none"
        return f"<Model '{self.name}': states {', '.join(self.states)}; inputs {inputs}; {self.parameters!r}>"

    @property
    def name(self) -> str:
        """The name in the registry and in model files."""
        return self.equations.name

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return self.equations.states

    @cached_property
    def inputs(self) -> tuple[Input, ...]:
        """The input channels, held where equations or records hold them."""
        return tuple(replace(i, is_held=i.is_held or i.name in self.held) for i in self.equations.inputs)

    @property
    def input_names(self) -> tuple[str, ...]:
        """Names of the inputs."""
        return self.equations.input_names

    @property
    def bindings(self) -> tuple[Binding, ...]:
        """The named expressions, in order."""
        return self.equations.bindings

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of bindings that can be measured, besides the states."""
        return self.equations.outputs

    @property
    def observables(self) -> tuple[str, ...]:
        """Everything a record can be compared with: states, then measurable outputs."""
        return (*self.states, *self.outputs)

    def observable_of(self, channel: str) -> str:
        """Return the observable that a record's channel of this name is compared with: what its instrument shows."""
        sensor_name = measured_name(channel)
        return sensor_name if sensor_name in self.outputs else channel

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels that a record can hold of it; readings of instruments by the channel they fill."""
        return tuple(o for o in self.observables if not o.endswith(MEASURED))

    def rest_parameter(self, state: str) -> str:
        """Return the parameter for a state's value at rest, ``phi_0`` of ``phi``; empty where the model has none."""
        name = f"{state}_0"
        return name if state in self.states and name in self.parameters else ""

    @property
    def equation_hash(self) -> str:
        """SHA-256 over names and expressions: what the equations are, whatever the parameter values."""
        return self.equations.digest

    @property
    def is_affine(self) -> bool:
        """Whether it is affine in states and inputs, so that exact propagators serve."""
        return self.equations.is_affine

    @property
    def has_thrusters(self) -> bool:
        """Whether thrusters drive it, which the layout of its equations places."""
        return bool(self.equations.layout)

    @property
    def has_rudder(self) -> bool:
        """Whether a rudder or nozzle is among its inputs."""
        return RUDDER in self.input_names

    @property
    def has_heading(self) -> bool:
        """Whether its heading is a state."""
        return "psi" in self.states

    @property
    def has_speed(self) -> bool:
        """Whether its speed is a state, not given."""
        return "u" in self.states

    @property
    def has_course(self) -> bool:
        """Whether it goes somewhere; without heading and surge, as state or input, it swings about a rest."""
        return bool({"psi", "u"} & {*self.states, *self.input_names})

    @property
    def is_roll(self) -> bool:
        """Whether it can only be released: it rolls, and has no heading to be steered."""
        return {"phi", "p"} <= set(self.states) and not self.has_heading

    @property
    def compiled(self) -> CompiledEquations:
        """The generated machine code: rates, outputs, bindings and exact Jacobians (cached between processes)."""
        return compile_equations(self.equations)

    def with_parameters(self, parameters: Parameters) -> Self:
        """Return the same equations with other parameters (same names, same order).

        Raises:
            InputError: the names differ.
        """
        if parameters.names != self.parameters.names:
            raise InputError(f"the parameters do not belong to model '{self.name}'")
        return replace(self, parameters=parameters)

    def with_held(self, names: Iterable[str]) -> Self:
        """Return the model with these of its inputs constant from sample to sample, the others as its equations say."""
        return replace(self, held=frozenset(names) & frozenset(self.input_names))

    def with_values(self, values: Mapping[str, float], source: str | None = None) -> Self:
        """Return the model with other parameter values."""
        return self.with_parameters(self.parameters.with_values(values, source))

    def with_ship(self, ship: Ship) -> Self:
        """Return the model with the particulars that it shares with the ship.

        Raises:
            InputError: a parameter still has no value.
        """
        particulars = {n: v for n, v in ship.particulars.items() if n in self.parameters}
        model = self.with_values(particulars, source=ship.source or ship.name)
        if model.parameters.missing:
            names = ", ".join(model.parameters.missing)
            raise InputError(f"model '{self.name}' needs {names}; give them under [ship] or [model.fixed]")
        return model

    def forces(self, states: Array, inputs: Array) -> dict[str, Array]:
        """Return every binding along a record: states (n, nx), inputs (n, nu) -> name -> (n,)."""
        from seatrial.numerics.kernels.integrate import evaluate

        out = np.empty((len(states), max(1, len(self.bindings))))
        x, u = np.ascontiguousarray(states), np.ascontiguousarray(inputs)
        evaluate(self.compiled.bindings, x, u, self.parameters.values, 0.0, out)
        return {b.name: out[:, i] for i, b in enumerate(self.bindings)}


# ModelEquations and models read from the compile cache instead of being written again with SymPy.


def stored_equations(
    key: Sequence[object], write: Callable[[], ModelEquations], sources: Sequence[Path] = ()
) -> ModelEquations:
    """Return the equations that `write` returns, from their manifest where there is one.

    key: what `write` depends on, with the same `repr` in every process. sources: folders of the code that it runs.
    """
    return _equations(stored("equations", key, lambda: _manifest(write()), sources))


def stored_model(key: Sequence[object], write: Callable[[], Model], sources: Sequence[Path]) -> Model:
    """Return the model that `write` returns, from its manifest where there is one.

    key, sources: as for `stored_equations`.
    """

    def manifest() -> dict[str, Any]:
        model = write()
        return {"equations": _manifest(model.equations), "parameters": [asdict(p) for p in model.parameters]}

    about = stored("model", key, manifest, sources)
    return Model(_equations(about["equations"]), Parameters(tuple(Parameter(**p) for p in about["parameters"])))


def _manifest(equations: ModelEquations) -> dict[str, Any]:
    return {**asdict(equations), "is_affine": equations.is_affine}


def _equations(about: dict[str, Any]) -> ModelEquations:
    equations = ModelEquations(
        about["name"], about["source"], tuple(Input(**i) for i in about["inputs"]),
        tuple(Binding(**b) for b in about["bindings"]), tuple(Binding(**b) for b in about["rates"]),
        tuple(about["outputs"]), tuple(about["parameters"]), about["meaning"], about["layout"], about["sensors"],
    )  # fmt: skip
    vars(equations)["is_affine"] = about["is_affine"]  # of the cached property, which would import SymPy
    return equations
