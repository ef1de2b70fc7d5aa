"""What a simulated run is worth: predict, measures with their intervals, extrapolation."""

from typing import TYPE_CHECKING

from seatrial.api.simulation import as_model_file, replay
from seatrial.core.values import InputError

if TYPE_CHECKING:
    from seatrial.api.simulation import Steering
    from seatrial.core.equations import Model
    from seatrial.core.results import Extrapolation, Prediction
    from seatrial.core.values import Record
    from seatrial.data.folder.model_file import ModelFile


def predict(model: "ModelFile | Model", record: "Record") -> "Prediction":
    """Predict a measured run from its inputs and first sample alone, and compare it with the measurement.

    Returns:
        the prediction: both records, root-mean-square differences, manoeuvring measures where the ship's length is
        known, and how far the run leaves the training runs where the model file states them.

    Raises:
        InputError: an input channel is missing, or the simulation diverges.
    """
    from seatrial.core.results import Prediction
    from seatrial.estimation.predict.open_loop import compare_measures, is_steered, rms_errors

    file = as_model_file(model)
    simulated = replay(file, record)
    length = None if file.ship is None else file.ship.particulars.get("L")
    pairs = {} if length is None or not is_steered(record, file.model) else compare_measures(record, simulated, length)
    return Prediction(
        record.name,
        "validation",
        record,
        simulated,
        rms_errors(record, simulated),
        pairs,
        initial_seconds=0.0,
        extrapolation=extrapolation(file, simulated),
    )


def measure_intervals(model: "ModelFile", steer: "Steering") -> dict[str, tuple[float, float]]:
    """Return the 95 % interval of each measure of the manoeuvre; empty where the model file states no uncertainty.

    Raises:
        InputError: most of the ships within the fit's uncertainty cannot be steered through the manoeuvre.
    """
    from seatrial.estimation.predict.measure_intervals import measure_intervals

    if model.interval_basis is None or model.ship is None:
        return {}
    return measure_intervals(model.model, model.interval_basis, steer, model.ship.length)


def extrapolation(model: "ModelFile", record: "Record") -> "Extrapolation | None":
    """Return how far a simulated run leaves the training runs; None where the model file does not state them."""
    from seatrial.estimation.information.extrapolation import extrapolation

    return None if model.interval_basis is None else extrapolation(record, model.interval_basis.training_envelope)


def rms_differences(measured: "Record", simulated: "Record") -> dict[str, float]:
    """Return root-mean-square differences of two runs on one time base: keys as in `Prediction.rms`."""
    from seatrial.estimation.predict.open_loop import rms_errors

    return rms_errors(measured, simulated)


def measures(model: "ModelFile", record: "Record", measured: "Record | None" = None) -> dict[str, float]:
    """Return overshoots, advance, transfer, tactical diameter and the like, as far as the record shows them.

    Args:
        measured: the measured run whose inputs `record` replays; the manoeuvre is then recognised on it.

    Raises:
        InputError: the ship's length is not known, or the record has no heading or rudder.
    """
    from seatrial.physics.manoeuvres.measures import measures

    if model.ship is None:
        raise InputError("the model file has no [ship] with the length L, which measures need; add it")
    return measures(record, model.ship.length, reference=measured)
