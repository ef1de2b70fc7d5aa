"""Controllers tuned on the coefficients that the paper prints, on ours, and on those of the searches repeated here."""

import numpy as np

from seatrial_studies.controller_cost import ControllerCost
from seatrial_studies.output_error_fit import OutputErrorResults
from seatrial_studies.pitch_control import pitch_controller_costs
from seatrial_studies.published_ship import HEADINGS, SIGNIFICANT_HEIGHT
from seatrial_studies.qi2025.published import SearchAlgorithm, printed_estimate, true_values
from seatrial_studies.qi2025.reproduction import SearchSetting, WildHorseReproduction


def controllers(
    reproduction: WildHorseReproduction, output_error: dict[int, OutputErrorResults], seed: int
) -> dict[int, tuple[ControllerCost, ...]]:
    """Return, by heading, controllers tuned on the print's means of ten (b53 negative), and on first runs made here."""
    columns, truths = {}, {}
    for heading in HEADINGS:
        truth = reproduction.seas[heading][0].truth
        signs = np.sign(truth)
        columns[heading] = {
            **{f"{a}, printed": signs * printed_estimate(heading, a) for a in SearchAlgorithm},
            "theory with b53 positive, printed": true_values(heading),
            **{
                f"{a}, one run here": reproduction.searches[SearchSetting.PAPER, heading, a].points[0]
                for a in SearchAlgorithm
            },
            "ours, one run with noise": truth * (1.0 + output_error[heading].noisy_errors[0]),
        }
        truths[heading] = truth
    return pitch_controller_costs(columns, truths, SIGNIFICANT_HEIGHT, seed)
