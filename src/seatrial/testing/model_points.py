"""States and inputs of ordinary size at which a model is evaluated."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Array

# standard deviation of the states and inputs at which a model is evaluated, SI, by symbol; ours: a ship model of some
# metres; every other state 1 and every other input 0.4 in its SI unit
_SPREAD = {"omega_e": 2.0, "F3": 1e5, "M5": 1e6, "u": 1.0, "v": 0.3, "r": 0.1, "n": 8.0, "wind_speed": 3.0, "v_j": 2.0}
_STATE_SPREAD, _INPUT_SPREAD = 1.0, 0.4  # SI of any other state and input; chosen


@dataclass(frozen=True)
class MirrorLaw:
    """What port/starboard symmetry changes besides the channels that the notation table counts to starboard or east.

    Attributes:
        odd: names of parameters, states and inputs that change sign.
        swapped: names of one side -> their counterparts of the other, of parameters, states, inputs and outputs.
    """

    odd: frozenset[str] = frozenset()
    swapped: Mapping[str, str] = field(default_factory=dict)

    def motion(self, names: Sequence[str], values: Array) -> Array:
        """Return states, inputs or outputs of the mirrored ship, shape (len(names),)."""
        return self._mirrored(names, values, {name for name in names if name in self.odd or _is_lateral(name)})

    def parameters(self, names: Sequence[str], values: Array) -> Array:
        """Return the parameters of the mirrored ship, shape (np,); they change only as declared."""
        return self._mirrored(names, values, self.odd)

    def _mirrored(self, names: Sequence[str], values: Array, odd: Collection[str]) -> Array:
        by_name = dict(zip(names, values, strict=True))
        pairs = {**self.swapped, **{starboard: port for port, starboard in self.swapped.items()}}
        return np.array([by_name[pairs.get(n, n)] * (-1.0 if n in odd else 1.0) for n in names])


@dataclass(frozen=True, eq=False)
class Point:
    """Where a model is evaluated: states (nx,), inputs (nu,) and parameters (np,), SI."""

    states: Array
    inputs: Array
    parameters: Array

    @property
    def vector(self) -> Array:
        """States, inputs and parameters in one, shape (nx + nu + np,)."""
        return np.concatenate([self.states, self.inputs, self.parameters])

    @property
    def size(self) -> int:
        """Number of columns of a Jacobian."""
        return len(self.states) + len(self.inputs) + len(self.parameters)

    def moved(self, column: int, step: float) -> "Point":
        """Return the point with one entry of `vector` moved by a step."""
        vector = self.vector
        vector[column] += step
        return Point(*np.split(vector, np.cumsum([len(self.states), len(self.inputs)])))

    def mirrored(self, model: Model, law: MirrorLaw) -> "Point":
        """Return the point with port and starboard exchanged."""
        return Point(
            law.motion(model.states, self.states),
            law.motion(model.input_names, self.inputs),
            law.parameters(model.parameters.names, self.parameters),
        )

    def text(self, model: Model) -> str:
        """Return states and inputs as ``u = 1.02, delta = 0.3``."""
        names = (*model.states, *model.input_names)
        return ", ".join(f"{n} = {x:.4g}" for n, x in zip(names, [*self.states, *self.inputs], strict=True))


def random_points(model: Model, generator: np.random.Generator, count: int) -> Iterator[Point]:
    """Yield points of ordinary size, ahead and astern, to either side; parameters at their values."""
    for _ in range(count):
        states = generator.normal(size=len(model.states)) * [_SPREAD.get(s, _STATE_SPREAD) for s in model.states]
        inputs = generator.normal(size=len(model.inputs)) * [_SPREAD.get(i, _INPUT_SPREAD) for i in model.input_names]
        yield Point(states, inputs, model.parameters.values)


def _is_lateral(symbol: str) -> bool:
    return symbol in NOTATION and NOTATION[symbol].positive in ("starboard", "port", "east")
