"""What wrong coefficients cost: a controller tuned on each method's coefficients and simulated on the truth."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from scipy.optimize import minimize

from seatrial.core.values import Array
from seatrial.physics.simulate import trajectories
from seatrial_studies.heave_pitch_search import candidate_matrices, simulate_search_data
from seatrial_studies.seaway import FIN

Coefficients = TypeVar("Coefficients")
# relative change of gains and cost at which the simplex of the tuning stops (Nelder & Mead 1965); our choice
_TOLERANCE = 1e-9
# evaluations at which a tuning gives up; our choice, ten times what two gains need
_MAX_EVALUATIONS = 2000
TRUTH = "the truth itself"
"""Name of the row whose controller is tuned on the true coefficients."""
WITHOUT_CONTROL = "without control"
"""Name of the row whose gains are zero."""


@dataclass(frozen=True)
class ControlledMotion:
    """A motion under control: rms of what is to be small and of the actuator; infinite where it runs away."""

    output_rms: float
    actuator_rms: float


@dataclass(frozen=True, eq=False)
class ControlTask(Generic[Coefficients]):
    """A controller to be tuned, and the motion by which it is judged.

    Attributes:
        simulate: motion of a ship with these coefficients under a controller with these gains (g,); deterministic.
        start: gains from which the tuning starts, none zero, (g,).
        actuator_weight: output rms that counts as much as an actuator rms of 1.
    """

    simulate: Callable[[Coefficients, Array], ControlledMotion]
    start: Array
    actuator_weight: float

    def cost(self, motion: ControlledMotion) -> float:
        """Return output variance plus weighted actuator variance; infinite for a motion that runs away."""
        cost = motion.output_rms**2 + (self.actuator_weight * motion.actuator_rms) ** 2
        return float(cost) if np.isfinite(cost) else np.inf


@dataclass(frozen=True, eq=False)
class ControllerCost:
    """A controller tuned on one method's coefficients.

    Attributes:
        method: whose coefficients; gains: (g,).
        predicted: motion of the ship that these coefficients describe; actual: of the true ship.
        excess: cost on the true ship over that of the controller tuned on the truth, minus 1.
    """

    method: str
    gains: Array
    predicted: ControlledMotion
    actual: ControlledMotion
    excess: float


def tuned_gains(task: ControlTask[Coefficients], coefficients: Coefficients) -> Array:
    """Return the gains of least cost for a ship with these coefficients, (g,), from the task's start values."""

    def cost(scaled: Array) -> float:
        return min(task.cost(task.simulate(coefficients, scaled * task.start)), np.finfo(float).max)

    start = np.ones(len(task.start))
    solution = minimize(
        cost,
        start,
        method="Nelder-Mead",
        options={"xatol": _TOLERANCE, "fatol": _TOLERANCE * cost(start), "maxfev": _MAX_EVALUATIONS},
    )
    return np.asarray(solution.x * task.start, dtype=np.float64)


def controller_costs(
    columns: Mapping[str, Coefficients], truth: Coefficients, task: ControlTask[Coefficients]
) -> tuple[ControllerCost, ...]:
    """Return one for each column, in its order, the controller tuned on the truth first.

    Each controller is tuned by simulation of the ship that its coefficients describe; all are then simulated on the
    true ship under the same disturbance, so that nothing differs but the coefficients.
    """
    best = task.simulate(truth, tuned_gains(task, truth))
    costs = []
    for method, coefficients in {TRUTH: truth, **columns}.items():
        gains = tuned_gains(task, coefficients)
        actual = task.simulate(truth, gains)
        excess = task.cost(actual) / task.cost(best) - 1.0
        costs.append(ControllerCost(method, gains, task.simulate(coefficients, gains), actual, excess))
    return tuple(costs)


def with_uncontrolled(
    costs: tuple[ControllerCost, ...], truth: Coefficients, task: ControlTask[Coefficients]
) -> tuple[ControllerCost, ...]:
    """Return the costs with that of gains zero on the true ship after the first, which is tuned on the truth."""
    best, *rest = costs
    idle = np.zeros(len(task.start))
    motion = task.simulate(truth, idle)
    excess = task.cost(motion) / task.cost(best.actual) - 1.0
    return (best, ControllerCost(WITHOUT_CONTROL, idle, motion, motion, excess), *rest)


def largest_excess(groups: Mapping[int, tuple[ControllerCost, ...]], selected: Callable[[str], bool]) -> float:
    """Return the largest excess cost of the controllers whose method is selected."""
    return max(cost.excess for costs in groups.values() for cost in costs if selected(cost.method))


def uncontrolled_excess(groups: Mapping[int, tuple[ControllerCost, ...]]) -> list[float]:
    """Return the excess cost without control of each group."""
    return [cost.excess for costs in groups.values() for cost in costs if cost.method == WITHOUT_CONTROL]


def controller_rows(groups: Mapping[str, tuple[ControllerCost, ...]]) -> list[tuple[str | float, ...]]:
    """Return the rows of the table that ends a page: one for each controller of each group, such as a heading."""
    return [
        (
            group,
            cost.method,
            *map(float, cost.gains),
            _finite(cost.predicted.output_rms),
            _finite(cost.actual.output_rms),
            _finite(cost.actual.actuator_rms),
            _finite(100.0 * cost.excess),
        )
        for group, costs in groups.items()
        for cost in costs
    ]


def _finite(value: float) -> float | str:
    return value if np.isfinite(value) else "runs away"


# The control task of heave and pitch: a fin fed back from pitch, in seas that the ship meets.

# seas of 200 s in which a controller is tuned and judged; our choice
SEAS = 3
# rad of pitch that count as much as a radian of fin: 1 degree of pitch against 10 of the fin; our choice
FIN_WEIGHT = 0.1
# start of the tuning: KP [rad/rad], KD [rad/(rad/s)] = [s]; our choice
START_GAINS = np.array([1.0, 1.0])
# sets the seas apart from those of the searches
_SEED_KEY = 23


def pitch_control_task(heading: int, height: float, seed: int) -> ControlTask[Array]:
    """Return the task at a heading [deg] in waves of a significant height [m]; coefficients (8,)."""
    forcings = [
        simulate_search_data(heading, np.random.default_rng([seed, _SEED_KEY, heading, k]), height=height).forcing
        for k in range(SEAS)
    ]
    lift, lever = FIN["lift_1"], FIN["x_f1"]
    fin = np.array([-lift, lever * lift])

    def simulate(coefficients: Array, gains: Array) -> ControlledMotion:
        A, B = candidate_matrices(coefficients[None])
        # angle KP theta + KD theta', positive lifting: the fin's force and moment join those of the waves
        A = A.copy()
        A[0, :, 2:] += np.outer(B[0] @ fin, gains)
        motion = np.concatenate([trajectories(A, B, f, np.zeros(4), (2, 3))[0] for f in forcings])
        if not np.all(np.isfinite(motion)):
            return ControlledMotion(np.inf, np.inf)
        rms = [np.degrees(np.sqrt(np.mean(x**2))) for x in (motion[:, 0], motion @ gains)]
        return ControlledMotion(float(rms[0]), float(rms[1]))

    return ControlTask(simulate, START_GAINS, FIN_WEIGHT)


def pitch_controller_costs(
    columns: Mapping[int, Mapping[str, Array]], truths: Mapping[int, Array], height: float, seed: int
) -> dict[int, tuple[ControllerCost, ...]]:
    """Return the cost of each column of coefficients (8,), by heading [deg], in waves of a significant height [m].

    That of the truth comes first, then that without control.
    """
    costs = {}
    for heading, methods in columns.items():
        task = pitch_control_task(heading, height, seed)
        costs[heading] = with_uncontrolled(controller_costs(methods, truths[heading], task), truths[heading], task)
    return costs
