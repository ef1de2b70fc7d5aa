"""What process noise alone leaves of a prediction's error, however good the model: the floor printed beside it."""

from collections.abc import Mapping

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.simulate.channels import inputs_of
from seatrial.physics.simulate.filtering import FilterPoint, KalmanFilter


def process_noise_floor(
    template: OutputError,
    model: Model,
    record: Record,
    start: Array,
    nuisances: Array,
    intensities: Mapping[str, float],
) -> dict[str, float]:
    """Rms error over time of an open-loop prediction that process noise alone causes, to first order.

    Args:
        template: the problem whose nuisances `own` (k,) are; model: at the estimate.
        record: the run that is predicted, for its inputs; start: its initial state, (nx,).
        intensity: of states, SI over the root of a second.

    Returns:
        psi_deg in degrees, position_m in m, u, v in m/s, r in rad/s, as far as the model has them.
    """
    split, parameters = len(template.session_parameters), model.parameters
    values = parameters.values
    values[[parameters.index(n) for n, _ in template.session_parameters]] = nuisances[:split]
    inputs = inputs_of(model, record)
    run = KalmanFilter(
        model, inputs, np.array([0, len(inputs)]), record.dt, template.data.outputs,
        corrections=tuple(n.correction for n in template.nuisances), substeps=template.substeps,
        driven=tuple(intensities),
    )  # fmt: skip
    at = FilterPoint(start[None], np.zeros((1, len(start))), values[None], nuisances[None, split:],
               np.array(list(intensities.values())), np.ones(len(template.data.outputs)))  # fmt: skip
    mean = dict(zip(model.states, run.variances(0, at).mean(axis=0), strict=True))
    floor = {}
    if "psi" in mean:
        floor["psi_deg"] = float(np.degrees(np.sqrt(mean["psi"])))
    if {"x0", "y0"} <= set(mean):
        floor["position_m"] = float(np.sqrt(mean["x0"] + mean["y0"]))
    return floor | {s: float(np.sqrt(mean[s])) for s in ("u", "v", "r") if s in mean}
