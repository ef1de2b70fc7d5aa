"""The control task of heave and pitch: a fin fed back from pitch, in seas that the ship meets."""

from collections.abc import Mapping

import numpy as np

from seatrial.core.results import Table
from seatrial.core.values import Array
from seatrial.physics.simulate import trajectories
from seatrial_studies.controller_cost import (
    ControlLabels,
    ControlledMotion,
    ControllerCost,
    ControlTask,
    controller_cost_table,
    controller_costs,
    with_uncontrolled,
)
from seatrial_studies.seaway import FIN
from seatrial_studies.swarm_search import candidate_matrices, simulate_search_data

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
    "A fin (6 m², 25 m aft, assumed as elsewhere) turned by KP pitch + KD pitch rate, tuned by simulation of the ship "
    f"that the coefficients describe, in {SEAS} seas of 200 s, for least pitch variance plus {FIN_WEIGHT:g}² fin "
    "variance; then simulated on the true ship in the same seas. A positive fin angle lifts the stern; pitch is "
    "positive bow up, so that positive gains work against it. Fin angles are not limited. 'Predicted': pitch of the "
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
