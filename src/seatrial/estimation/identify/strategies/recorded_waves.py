"""A ship in waves whose forces, or whose elevation, were recorded."""

from dataclasses import replace

from seatrial.core.results import Fit
from seatrial.estimation.estimate.force_consistency import force_consistency
from seatrial.estimation.estimate.unmeasured_waves import refuse_unmeasured_waves
from seatrial.estimation.identify.assembled_fit import assembled_fit
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.selection import selected_model
from seatrial.estimation.information.frequency_range import frequency_range, frequency_range_finding


def identify_in_recorded_waves(task: Identification) -> Fit:
    """Return the fit of a ship in recorded waves: output error over whole runs, with the range of frequencies covered.

    Raises:
        InputError: the ship moves although no wave is recorded, or the records do not determine the coefficients.
    """
    refuse_unmeasured_waves(task.estimation, task.runs.records)
    selected = selected_model(task)
    fit = assembled_fit(task, selected, force_consistency(selected.estimation.estimate))
    if not task.trial.model.is_affine:
        return fit
    covered = frequency_range(task.runs.records, task.outputs)
    return replace(fit, findings=(*fit.findings, frequency_range_finding(covered))) if covered else fit
