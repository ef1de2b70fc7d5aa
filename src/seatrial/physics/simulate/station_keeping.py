"""A craft with thrusters that keeps its place, simulated by its nonlinear model within its thrusters' limits."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, DivergedError
from seatrial.numerics.kernels import station as kernel
from seatrial.numerics.kernels.feedback import steer
from seatrial.physics.loops.sampling import Sampling
from seatrial.physics.models.outside_forces import OUTSIDE_FORCES
from seatrial.physics.models.thruster_layout import MIN_LAG, AngleInput, Thruster
from seatrial.physics.simulate.sampled_controller import sample_noise, simulation_step


@dataclass(frozen=True, eq=False)
class ThrusterOrders:
    """How a controller orders one thruster: rows of the inverse (6,), table of share (k,) over rising thrust (k,)."""

    thruster: Thruster
    rows: Array
    share: Array
    thrust: Array


@dataclass(frozen=True, eq=False)
class StationController:
    """A sampled PID in body axes: gains (3, 3), filter lags [s] (3,), how it samples, the thrusters.

    Every sample: v by Tustin's rule from the moves of the pose, the integral by trapezoids, kept while forces are cut.
    sampling: noise and resolution are those of the heading [rad]. step: of the simulation at most [s].
    """

    KP: Array
    KI: Array
    KD: Array
    lag: Array
    sampling: Sampling
    thrusters: Sequence[ThrusterOrders]
    step: float = MIN_LAG

    @property
    def dt(self) -> float:
        """The step of the simulation [s]: it divides sample and dead time."""
        return simulation_step(self.sampling, self.step)


@dataclass(frozen=True, eq=False)
class StationRun:
    """Distance north and east of the station [m], heading [rad], (n,) each; thrust ordered (n, thrusters).

    given: share of the ordered force that is within the limits (n,); states: last of the model (nx,).
    """

    dt: float
    north: Array
    east: Array
    heading: Array
    thrust: Array
    given: Array
    states: Array


def filter_coefficients(lag: Array, sample: float) -> tuple[Array, Array]:
    """Return a, b of v[k] = a v[k-1] + b (x[k] - x[k-1]): s / (lag s + 1) by Tustin's rule; each (3,)."""
    return (2.0 * lag - sample) / (2.0 * lag + sample), 2.0 / (2.0 * lag + sample)


def keep_station(
    model: Model, controller: StationController, resting: Array, drift: Array, forces: Array, seed: int = 0
) -> StationRun:
    """Return the run of a craft, from rest at its station, in water that moves and under forces from outside.

    Args:
        model: of `with_outside_forces`, without a current of its own.
        resting: inputs with all commands at rest, without the outside forces, (nu - 3,).
        drift: how far the water has gone north and east at each step [m], (2, n).
        forces: X, Y, N from outside held over each step, (3, n), in the model's unit.
        seed: of the compass's noise.

    Raises:
        DivergedError: the craft runs away.
    """
    dt, count = controller.dt, drift.shape[1]
    pushes = np.concatenate([drift, forces, sample_noise(controller.sampling, count, seed)[None]])
    memory, series = _memory(model, controller, dt, pushes)
    inputs = np.concatenate([resting, np.zeros(len(OUTSIDE_FORCES))])
    states, applied = np.empty((count, len(model.states))), np.empty((count, len(inputs)))
    lost = steer(
        model.compiled.rates, kernel.station_keeper, np.zeros(len(model.states)), inputs, model.parameters.values,
        memory, dt, states, applied,
    )  # fmt: skip
    if lost >= 0:
        raise DivergedError(f"the craft leaves its station at {lost * dt:g} s")
    rows = memory[series + kernel.DISTURBANCES * count :].reshape(-1, count)
    place = model.states.index
    return StationRun(
        dt, states[:, place("x0")] + drift[0], states[:, place("y0")] + drift[1], states[:, place("psi")].copy(),
        rows[2:-1:3].T.copy(), rows[-1].copy(), states[-1].copy(),
    )  # fmt: skip


def _memory(model: Model, controller: StationController, dt: float, pushes: Array) -> tuple[Array, int]:
    """Return the memory of `station_keeper` and where its series begin; pushes: what disturbs, (6, n)."""
    n, count, size = len(controller.thrusters), pushes.shape[1], len(controller.thrusters[0].share)
    sampling = controller.sampling
    series = int(kernel.series_start(n, size))
    memory = np.zeros(series + (kernel.DISTURBANCES + 3 * n + 1) * count)
    values = {
        kernel.THRUSTERS: n, kernel.COUNT: count, kernel.HOLD: round(sampling.sample_s / dt),
        kernel.DELAY: round(sampling.dead_time / dt), kernel.SAMPLE: sampling.sample_s, kernel.TABLE: size,
        kernel.PSI: model.states.index("psi"), kernel.NORTH: model.states.index("x0"),
        kernel.EAST: model.states.index("y0"), kernel.FORCE_INPUT: model.input_names.index(OUTSIDE_FORCES[0]),
        kernel.RESOLUTION: sampling.resolution,
    }  # fmt: skip
    memory[list(values)] = list(values.values())
    past, forward = filter_coefficients(controller.lag, sampling.sample_s)
    parts: tuple[tuple[int, Array], ...] = (
        (kernel.KP, controller.KP), (kernel.KI, controller.KI), (kernel.KD, controller.KD), (kernel.PAST, past),
        (kernel.FORWARD, forward), (series, pushes),
    )  # fmt: skip
    for start, part in parts:
        memory[start : start + part.size] = part.ravel()
    for i, orders in enumerate(controller.thrusters):
        _write_thruster(memory, kernel.ROWS + i * kernel.TRAITS, orders, model)
        start = kernel.tables_start(n) + 2 * i * size
        memory[start : start + 2 * size] = np.concatenate([orders.share, orders.thrust])
    return memory, series


def _write_thruster(memory: Array, row: int, orders: ThrusterOrders, model: Model) -> None:
    thruster, angle = orders.thruster, orders.thruster.angle
    memory[row : row + 6] = orders.rows
    turns = isinstance(angle, AngleInput)
    traits = {
        kernel.AZIMUTH: float(turns), kernel.COMMAND_INPUT: model.input_names.index(thruster.command.channel),
        kernel.ZERO: thruster.command.zero, kernel.SPAN: thruster.command.span,
        kernel.LEAST: orders.thrust[0], kernel.MOST: orders.thrust[-1],
        kernel.ANGLE_INPUT: model.input_names.index(angle.channel) if isinstance(angle, AngleInput) else -1,
    }  # fmt: skip
    memory[row + np.array(list(traits), dtype=np.int64)] = list(traits.values())
