"""What wrong coefficients cost: a controller tuned on each method's coefficients and simulated on the truth."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from scipy.optimize import minimize

from seatrial.core.results import Table
from seatrial.core.text import significant
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


@dataclass(frozen=True)
class ControlLabels:
    """Headings of a table of controllers, with units: each gain, rms of the output, rms of the actuator."""

    gains: tuple[str, ...]
    output: str
    actuator: str


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


def uncontrolled_excess_text(groups: Mapping[int, tuple[ControllerCost, ...]]) -> str:
    """Return the least and the largest excess cost without control over the groups, as text in per cent."""
    excess = [100.0 * c.excess for costs in groups.values() for c in costs if c.method == WITHOUT_CONTROL]
    return f"{significant(min(excess), 2)} to {significant(max(excess), 2)} %"


def controller_cost_table(
    title: str, groups: Mapping[str, tuple[ControllerCost, ...]], labels: ControlLabels, note: str
) -> Table:
    """Return the table that ends the page: a row for each controller of each group, such as a heading."""
    header = (
        "",
        "tuned on",
        *labels.gains,
        f"{labels.output}, predicted",
        labels.output,
        labels.actuator,
        "cost over best, %",
    )
    rows = tuple(
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
    )
    return Table(title, header, rows, note)


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
LABELS = ControlLabels(("KP", "KD, s"), "pitch rms, deg", "fin rms, deg")
CONTROLLER_COST_TITLE = "What wrong coefficients cost a controller"
_NOTE = (
    "A fin (6 m², 25 m aft, assumed as elsewhere) is turned by KP pitch + KD pitch rate. The gains are tuned on the "
    f"ship that the coefficients describe, in {SEAS} seas of 200 s, for least pitch variance plus {FIN_WEIGHT:g}² fin "
    "variance. They are then simulated on the true ship in the same seas. A positive fin angle lifts the stern; pitch "
    "is positive bow up, so that positive gains work against it. Fin angles are not limited. 'Predicted': pitch of the "
    "ship that the coefficients describe. 'Cost over best': the sum that was to be least, on the true ship, over that "
    "of the controller tuned on the truth; without control it is the pitch variance alone."
)


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


def pitch_controller_cost_table(costs: Mapping[int, tuple[ControllerCost, ...]]) -> Table:
    """Return the last table of a page on heave and pitch."""
    groups = {f"{heading}°": each for heading, each in costs.items()}
    return controller_cost_table(CONTROLLER_COST_TITLE, groups, LABELS, _NOTE)
