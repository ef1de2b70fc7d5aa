"""A ship that is steered, with or without static force points."""

from seatrial.core.results import Fit
from seatrial.estimation.estimate.force_consistency import force_consistency
from seatrial.estimation.identify.assembled_fit import assembled_fit
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.selection import selected_model


def identify_steered(task: Identification) -> Fit:
    """Return the fit of a steered ship: multiple shooting, then output or prediction error by the decision table.

    Raises:
        InputError: the records do not determine the coefficients, or lead to no model that can be simulated.
    """
    return assembled_fit(task, selected_model(task))


def identify_with_static_forces(task: Identification) -> Fit:
    """Return the fit of a steered ship to runs and static force points, with their consistency as findings.

    Raises:
        InputError: as `identify_steered`.
    """
    selected = selected_model(task)
    return assembled_fit(task, selected, force_consistency(selected.estimation.estimate))
