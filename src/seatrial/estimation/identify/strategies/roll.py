"""A ship that rolls about its rest: out from a release, or by recorded inputs."""

from seatrial.core.results import Fit
from seatrial.core.text.words import enumeration
from seatrial.core.values import InputError
from seatrial.data.check.phases import begins_before_release
from seatrial.data.trial.records import require_decay
from seatrial.estimation.estimate.criterion_choice import is_explained
from seatrial.estimation.identify.assembled_fit import assembled_fit
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.selection import selected_model


def identify_free_decay(task: Identification) -> Fit:
    """Return the fit of roll decays, which their initial states explain.

    Raises:
        InputError: a roll that does not decay, one that begins before its release and that no initial state explains,
            or records that do not determine the coefficients.
    """
    for record in task.runs.records:
        require_decay(record)
    late = [record.name for record in task.runs.records if begins_before_release(record)]
    if late and not is_explained(task.estimation.shooting):
        raise InputError(
            f"no initial state explains the roll of {enumeration(late)}, which begins before the release of the ship; "
            "set from_release = true under [[records]], which drops what lies before it"
        )
    return assembled_fit(task, selected_model(task))


def identify_driven_roll(task: Identification) -> Fit:
    """Return the fit of roll that recorded inputs drive.

    Raises:
        InputError: the records do not determine the coefficients, or lead to no model that can be simulated.
    """
    return assembled_fit(task, selected_model(task))
