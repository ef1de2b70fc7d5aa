"""A task whose model has the errors of instruments that its records show, which the estimate with them confirms."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Finding, InputError, Parameters, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.identify.held_couplings import standard_error_ratio
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.sensor_errors import Suspect, detected_errors
from seatrial.physics.sensors import Sensors, with_sensors
from seatrial.physics.sensors.measured_outputs import without_sensors


def with_detected_sensor_errors(task: Identification) -> Identification:
    """Return the task with the errors of instruments that its records show as coefficients of its model.

    The task itself where they show none, or none that the estimate with it confirms.
    """
    try:
        information = task.instrument_errors
        detected = detected_errors(information, standard_error_ratio(task.estimation)) if information else []
    except (ArithmeticError, np.linalg.LinAlgError):  # of the intervals that is a finding of its own
        return task
    if not detected:
        return task
    stated = Sensors.from_text(task.trial.model.equations.sensors)
    for one in detected:
        stated = one.stated(stated)
    tried = replace(task, trial=replace(task.trial, model=_with_stated(task.trial.model, stated)))
    try:
        finding = _confirmed(tried.estimation, detected)
    except InputError:  # the records do not determine the coefficients beside these errors
        return task
    return task if finding is None else replace(tried, findings=(*tried.findings, finding))


def _with_stated(model: Model, stated: Sensors) -> Model:
    """The model with these sensors; coefficients that it has already keep their values, bounds and priors."""
    wider = with_sensors(without_sensors(model), stated)
    present = {p.name: p for p in model.parameters}
    return wider.with_parameters(Parameters(tuple(present.get(p.name, p) for p in wider.parameters)))


def _confirmed(estimation: Estimation, detected: Sequence[Suspect]) -> Finding | None:
    """The finding on these errors; None where that of one instrument may be negligible."""
    problem = estimation.estimate.problem
    values = dict(zip(problem.free, estimation.estimate.common_parameters.tolist(), strict=False))
    spread = dict(zip(problem.free, estimation.interval.standard_error.tolist(), strict=False))
    if not all(one.matters(values, spread) for one in detected):
        return None
    sizes = [
        f"{e.name} {significant(values[e.name], 3)} {e.unit} (standard error {significant(spread[e.name], 2)})"
        for one in detected for e in one.errors
    ]  # fmt: skip
    lines, names = "; ".join(one.line for one in detected), enumeration([one.text(values) for one in detected])
    return Finding(
        Severity.WARNING, "sensor-error",
        f"the records show errors of instruments, which are estimated: {names}",
        "; ".join(sizes).replace(" 1 (", " ("),
        f"state what is so under [sensors] ({lines}), and correct in the log what is not",
        "held at none they go into the coefficients",
    )  # fmt: skip
