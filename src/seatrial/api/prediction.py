"""What a simulated run is worth: predict, measures with their intervals, extrapolation."""

from typing import TYPE_CHECKING

from seatrial.api.simulation import as_model_file
from seatrial.core.values import InputError

if TYPE_CHECKING:
    from seatrial.api.simulation import Steering
    from seatrial.core.equations import Model
    from seatrial.core.results import Extrapolation, Fit, Prediction
    from seatrial.core.values import Record
    from seatrial.data.folder.model_file import ModelFile


def predict(model: "Fit | ModelFile | Model", record: "Record", session: str | None = None) -> "Prediction":
    """Predict a measured run open loop from its inputs and its initial state, and compare it with the measurement.

    The initial state is estimated by output error from the first seconds of the run, as `identify` does for the runs
    held out, and what the fit found its session's inputs to be off by is corrected; a simulated or planned record has
    neither, and is started at its first sample.

    Args:
        model: a fit or model file, or a model, of which no offsets are known.
        record: the run.
        session: that it belongs to, of those fitted, or ``new``; without it the only one that was fitted, or a new one.

    Returns:
        the prediction: both records, root-mean-square differences, manoeuvring measures where the ship's length is
        known, and how far the run leaves the training runs where the model file states them.

    Raises:
        InputError: an input channel is missing, no channel can be compared, no such session was fitted, or the
            simulation diverges.
    """
    from seatrial.core.results import Prediction
    from seatrial.core.values import RecordKind
    from seatrial.estimation.predict.open_loop import compare_measures, is_steered, rms_errors
    from seatrial.estimation.predict.session_offsets import simulate_measured
    from seatrial.physics.simulate import replay

    file = as_model_file(model)
    length = 0.0 if file.ship is None else file.ship.particulars.get("L", 0.0)
    is_measured = record.kind is RecordKind.MEASURED
    simulated, seconds = (
        simulate_measured(file.model, record, length, file.offsets, session)
        if is_measured
        else (replay(file.model, record), 0.0)
    )
    pairs = compare_measures(record, simulated, length) if length and is_steered(record, file.model) else {}
    rms, leaving = rms_errors(record, simulated), extrapolation(file, simulated)
    return Prediction(record.name, "validation", record, simulated, rms, pairs, seconds, extrapolation=leaving)


def measure_intervals(model: "ModelFile", steer: "Steering") -> dict[str, tuple[float, float] | None]:
    """Return the 95 % interval of each measure of the manoeuvre, None for those that the fit does not determine.

    Empty where the model file states no uncertainty.

    Raises:
        InputError: most of the ships within the fit's uncertainty cannot be steered through the manoeuvre.
    """
    from seatrial.estimation.predict.draws import measure_intervals

    if model.interval_basis is None or model.ship is None:
        return {}
    return measure_intervals(model.model, model.interval_basis, steer, model.ship.length, model.ship.scale)


def extrapolation(model: "ModelFile", record: "Record") -> "Extrapolation | None":
    """Return how far a simulated run leaves the training runs; None where the model file does not state them."""
    from seatrial.estimation.information.extrapolation import extrapolation

    if model.interval_basis is None:
        return None
    return extrapolation(record, model.interval_basis.training_envelope, model.model.equations.layout)


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
