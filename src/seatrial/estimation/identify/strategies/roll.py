"""A ship that rolls about its rest: out from a release, or by recorded inputs."""

from seatrial.core.results import Fit
from seatrial.data.trial.roll_decay_start import require_decay
from seatrial.estimation.identify.assembled_fit import assembled_fit
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.selection import selected_model


def identify_free_decay(task: Identification) -> Fit:
    """Return the fit of roll decays, which their initial states explain.

    Raises:
        InputError: a roll that does not decay, or records that do not determine the coefficients.
    """
    for record in task.runs.records:
        require_decay(record)
    return assembled_fit(task, selected_model(task))


def identify_driven_roll(task: Identification) -> Fit:
    """Return the fit of roll that recorded inputs drive.

    Raises:
        InputError: the records do not determine the coefficients, or lead to no model that can be simulated.
    """
    return assembled_fit(task, selected_model(task))
