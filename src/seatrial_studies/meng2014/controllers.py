"""Controllers tuned on the coefficients of the swarms and on ours; the paper's own are lost with its table."""

from seatrial_studies.controller_cost import ControllerCost
from seatrial_studies.meng2014.reproduction import (
    HEADINGS,
    SEA_STATE_3,
    BoxPlacement,
    CloudSwarmReproduction,
    SwarmAlgorithm,
)
from seatrial_studies.output_error_fit import OutputErrorResults
from seatrial_studies.pitch_control import pitch_controller_costs


def controllers(
    reproduction: CloudSwarmReproduction, output_error: dict[int, OutputErrorResults], seed: int
) -> dict[int, tuple[ControllerCost, ...]]:
    """Return, by heading, controllers tuned on first runs off centre: of both swarms, of eq. (4) as printed, ours."""
    columns, truths = {}, {}
    for heading in HEADINGS:
        truths[heading] = reproduction.seas[heading][0].truth
        swarms = {a: reproduction.searches[BoxPlacement.OFF_CENTRE, heading, a] for a in SwarmAlgorithm}
        columns[heading] = {
            **{f"{a}, one run": found.points[0] for a, found in swarms.items()},
            "PSO by eq. (4) as printed, one run": reproduction.unweighted_searches[heading].points[0],
            "ours, one run": truths[heading] * (1.0 + output_error[heading].noisy_errors[0]),
        }
    return pitch_controller_costs(columns, truths, SEA_STATE_3, seed)
