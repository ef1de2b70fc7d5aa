"""Runs as they might have come out: coefficients, offsets and noise drawn from what the training leaves open."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import IntervalBasis
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.information.discrepancy import Discrepancy
from seatrial.estimation.information.extrapolation import extrapolation
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.manoeuvres import bounded_interval, measures
from seatrial.physics.simulate.batch import batch_class

# Runs as they might have come out: coefficients, offsets and process noise drawn from what the training leaves open.

# s for which a disturbance of the states is held constant, ours
_KICK_SECONDS = 0.5


@dataclass(frozen=True, eq=False)
class PredictionUncertainty:
    """What makes a run differ from its prediction, as far as the training runs show it.

    Attributes:
        coefficients: covariance of the free coefficients, shape (n, n).
        offsets: covariance, between sessions, of what each has of its own, shape (k, k).
        process: intensity of each state's process noise, SI over the root of a second, shape (nx,).
        degrees_of_freedom: of Student's t.
        waves: channel -> rms of what waves add to it beside the craft's own motion, SI.
    """

    coefficients: Array
    offsets: Array
    process: Array
    degrees_of_freedom: float
    waves: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class StartStates:
    """Initial states of w simulations, and what they may be instead.

    Attributes:
        values: (w, nx), SI.
        open: gives derivatives by a session's own unknowns, (w, nx, k), as with another rudder zero the same first
            seconds of a run are explained by another state, and the covariance, (w, nx, nx), of the error that the
            sensors' noise leaves; asked once, where runs are drawn.
    """

    values: Array
    open: Callable[[], tuple[Array, Array]]

    @property
    def by_offsets(self) -> Array:
        """Derivatives by a session's own unknowns."""
        return self._alternatives[0]

    @property
    def covariance(self) -> Array:
        """Of the error that the sensors' noise leaves."""
        return self._alternatives[1]

    @cached_property
    def _alternatives(self) -> tuple[Array, Array]:
        return self.open()

    @classmethod
    def given(cls, values: Array, kinds: int) -> "StartStates":
        """Return states that are known, whatever a session has of its own, of so many kinds."""
        none = np.zeros((*values.shape, kinds)), np.zeros((*values.shape, values.shape[1]))
        return cls(values, lambda: none)

    @classmethod
    def joined(cls, parts: Sequence["StartStates"]) -> "StartStates":
        """Return those of several simulations together."""

        def alternatives() -> tuple[Array, Array]:
            return np.concatenate([p.by_offsets for p in parts]), np.concatenate([p.covariance for p in parts])

        return cls(np.concatenate([p.values for p in parts]), alternatives)

    def __getitem__(self, indices: slice) -> "StartStates":
        """Return those of the chosen simulations."""
        return StartStates(self.values[indices], lambda: (self.by_offsets[indices], self.covariance[indices]))

    def draws(self, offsets: Array, rng: np.random.Generator) -> Array:
        """Return states, (w, count, nx), where offsets differ from the expected ones by `offsets`, (w, count, k)."""
        states = self.values[:, None] + np.einsum("wxk,wck->wcx", self.by_offsets, offsets)
        if np.any(self.covariance):
            states += np.einsum("wxz,wcz->wcx", square_root(self.covariance), rng.standard_normal(states.shape))
        return states


def simulate_points(
    template: OutputError, model: Model, dt: float, inputs: Array, start: Array, points: Array, nuisances: Array
) -> Array:
    """Return all observables along inputs for many sets of unknowns, shape (m, rows, observables).

    Args:
        template: the problem whose unknowns these are.
        inputs: in the model's signs, (m, rows, nu), every `dt` seconds.
        start: initial states, (m, nx); points: free coefficients, (m, n); nuisances: a session's own unknowns, (m, k).

    Returns:
        NaN after a divergence.
    """
    count, rows, parameters = len(points), inputs.shape[1], model.parameters
    split = len(template.session_parameters)
    values = np.tile(parameters.values, (count, 1))
    values[:, [parameters.index(n) for n in template.free]] = points
    values[:, [parameters.index(n) for n, _ in template.session_parameters]] = nuisances[:, :split]
    batch = batch_class(model)(
        model,
        np.ascontiguousarray(inputs).reshape(count * rows, -1),
        np.arange(count + 1) * rows,
        dt,
        model.observables,
        corrections=tuple(n.correction for n in template.nuisances),
        substeps=template.substeps_at(dt),
    )
    y, _ = batch.simulate(0, count, start, values, np.ascontiguousarray(nuisances[:, split:]))
    return y.reshape(count, rows, -1)


def draw_runs(
    template: OutputError,
    model: Model,
    dt: float,
    inputs: Array,
    starts: StartStates,
    nuisances: Array,
    uncertainty: PredictionUncertainty,
    rng: np.random.Generator,
    count: int,
) -> Array:
    """Return `count` runs about the model's values along each of w inputs, (w, count, rows, observables).

    Coefficients drawn beyond their bounds are moved onto them: a hull does not drive itself.

    Args:
        inputs: in the model's signs, (w, rows, nu), every `dt` seconds.
        starts: of a run with the expected `nuisances` (a session's own unknowns, (w, k)).
    """
    width, total = len(inputs), len(inputs) * count
    free = [model.parameters[n] for n in template.free]
    points = np.array([p.value for p in free])
    points = points + rng.standard_normal((total, len(free))) @ square_root(uncertainty.coefficients).T
    points = np.clip(points, [p.lower for p in free], [p.upper for p in free])
    offsets = rng.standard_normal((total, nuisances.shape[1])) @ square_root(uncertainty.offsets).T
    owns = np.repeat(nuisances, count, axis=0) + offsets
    along = np.repeat(inputs, count, axis=0)
    state = starts.draws(offsets.reshape(width, count, -1), rng).reshape(total, -1)
    shape = (width, count, inputs.shape[1], -1)
    if not np.any(uncertainty.process):
        return simulate_points(template, model, dt, along, state, points, owns).reshape(shape)
    steps = max(1, round(_KICK_SECONDS / dt))
    kick = uncertainty.process * np.sqrt(steps * dt)
    pieces = []
    for first in range(0, inputs.shape[1] - 1, steps):
        piece = simulate_points(template, model, dt, along[:, first : first + steps + 1], state, points, owns)
        pieces.append(piece if first == 0 else piece[:, 1:])
        state = piece[:, -1, : len(model.states)] + kick * rng.standard_normal((total, len(kick)))
    return np.concatenate(pieces, axis=1).reshape(shape)


def square_root(covariance: Array) -> Array:
    """Return a square root of covariances that may be singular, shape (..., n, n)."""
    if covariance.size == 0:
        return covariance
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :]


# Intervals of a manoeuvre that was only simulated: steered with ships drawn from the fit and with tied models.

_RUDDER_OFFSET = "delta zero"

MeasuresPair = tuple[dict[str, float] | None, dict[str, float] | None]


def measure_intervals(
    model: Model, interval_basis: IntervalBasis, steer: Callable[[Model], Record], length: float, scale: float = 1.0
) -> dict[str, tuple[float, float] | None]:
    """Return the 95 % interval of each measure of the manoeuvre that `steer` makes of a model; None: not determined.

    The helmsman steers two ships along every principal direction of the coefficients' covariance, one standard
    deviation to either side, and two with the rudder's zero off by what it differs between runs (where the model has it
    as `delta_0`); half their differences add up in squares. Nothing is drawn at random. Measures of a kind that runs
    left out have shown get the discrepancy found there, others the foreseen spread times the margin's factor; the
    distance of tied models comes on top. Process noise is not counted: the interval is for the manoeuvre in water as
    calm as discrepancy and factor have it. A model test adds what its scale leaves open, see `models_at_scale`.

    length: of the ship as tested [m]; scale: that of the ship over it.

    Raises:
        InputError: more than half of these ships diverge.
    """
    nominal = steer(model)
    centre = measures(nominal, length)
    reached = extrapolation(nominal, interval_basis.training_envelope, model.equations.layout)
    index = reached.index if reached else 1.0
    pairs = [
        (_measures_or_none(up, steer, length), _measures_or_none(down, steer, length))
        for up, down in (*perturbed_models(model, interval_basis), *models_at_scale(model, nominal, length, scale))
    ]
    lost = sum(m is None for pair in pairs for m in pair)
    if lost > len(pairs):
        raise InputError(
            f"{lost} of {2 * len(pairs)} ships one standard deviation from the fit cannot be steered through this "
            "manoeuvre: the records do not determine it, and its measures have no interval"
        )
    tied = [
        m for one in interval_basis.tied if (m := _measures_or_none(model.with_values(one), steer, length)) is not None
    ]
    beyond = Discrepancy(interval_basis.measure_deviation, interval_basis.factor, 1.0, {})
    t = two_sided_quantile(STORED_LEVEL, interval_basis.degrees_of_freedom)
    intervals: dict[str, tuple[float, float] | None] = {}
    for name, value in centre.items():
        away = [d for pair in pairs if (d := _half_difference(pair, name, value)) is not None]
        if 2 * len(away) > len(pairs) or not pairs:
            spread = beyond.measure_sd(name, float(np.sqrt(np.sum(np.square(away)))), index)
            apart = [m[name] - value for m in tied if name in m]
            half = t * float(np.hypot(spread, np.sqrt(np.mean(np.square(apart))) if apart else 0.0))
            intervals[name] = bounded_interval(name, value, half)
    return intervals


def _half_difference(pair: MeasuresPair, name: str, centre: float) -> float | None:
    """Return half the difference of both sides; the distance of one where only one shows the measure; else None."""
    sides = [m[name] for m in pair if m is not None and name in m]
    if len(sides) == 2:
        return 0.5 * (sides[0] - sides[1])
    return sides[0] - centre if sides else None


def perturbed_models(model: Model, interval_basis: IntervalBasis) -> list[tuple[Model, Model]]:
    """Return pairs of models one standard deviation to either side of the fit, along every principal direction."""
    free = model.parameters.free_names
    centre: Array = np.array([p.value for p in model.parameters.free])
    columns = [c for c in square_root(interval_basis.covariance).T if np.any(c)]
    models = [
        (
            model.with_values(dict(zip(free, centre + c, strict=True))),
            model.with_values(dict(zip(free, centre - c, strict=True))),
        )
        for c in columns
    ]
    between = interval_basis.offsets.get(_RUDDER_OFFSET, 0.0)
    if between > 0 and "delta_0" in model.parameters:
        zero = model.parameters["delta_0"].value
        models.append((model.with_values({"delta_0": zero + between}), model.with_values({"delta_0": zero - between})))
    return models


# What a test at model scale leaves open of the ship: its wake, and how much of the thrust its friction takes.

_WAKE_OF_SCALE = 0.05  # 1, 0.40 of KVLCC2's models less 0.35 of the ship (Yasukawa & Yoshimura 2015)
_VISCOSITY = 1.14e-6  # m^2/s, of fresh water at 15 deg C (ITTC 7.5-02-01-03)


def models_at_scale(model: Model, run: Record, length: float, scale: float) -> list[tuple[Model, Model]]:
    """Return pairs of models with wake and resistance to either side of a model test's, by what the scale may change.

    The resistance by the difference of friction lines, which is also how much the propeller is loaded beyond that of
    the ship. A model without a propeller has neither, and no pair.

    run: as tested, of whose first sample the speed is taken.
    """
    if not scale > 1.0 or not {"w_P0", "R_0"} <= set(model.parameters.names) or "u" not in run:
        return []
    value = {name: model.parameters[name].value for name in ("m", "rho", "d", "w_P0", "R_0")}
    wetted = 1.7 + value["m"] / (value["rho"] * length * value["d"] ** 2)  # over L d, Mumford's formula
    number = max(float(run["u"][0]), np.finfo(float).eps) * length / _VISCOSITY
    friction = wetted * (_friction(number) - _friction(number * scale**1.5))  # by Froude's law U L grows so
    return [
        (model.with_values({name: value[name] + size}), model.with_values({name: value[name] - size}))
        for name, size in (("w_P0", _WAKE_OF_SCALE), ("R_0", friction))
    ]


def _friction(reynolds_number: float) -> float:
    """The friction coefficient of the ITTC 1957 line."""
    return 0.075 / (np.log10(reynolds_number) - 2.0) ** 2  # ITTC 7.5-02-02-02, eq. (1)


def _measures_or_none(model: Model, steer: Callable[[Model], Record], length: float) -> dict[str, float] | None:
    try:
        return measures(steer(model), length)
    except InputError:
        return None
