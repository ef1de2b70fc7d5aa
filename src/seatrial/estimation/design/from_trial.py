"""From a trial file's table `[design]`, and perhaps a model file, to the task of the search."""

from seatrial.core.equations import Model
from seatrial.core.values import InputError
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.trial import Trial
from seatrial.estimation.design.task import DesignTask


def design_task(trial: Trial, model_file: ModelFile | None = None) -> DesignTask:
    """The task that the trial describes.

    Args:
        model_file: its values, freedom and covariance take the place of the trial's.

    Raises:
        InputError: the trial has no [design], the model file holds other equations, a coefficient has no size, or what
            `DesignTask` refuses; the sentence begins with the trial file.
    """
    where = f"{trial.path}: " if trial.path else ""
    request = trial.design_request
    if request is None:
        raise InputError(f"{where}there is no table [design]; add it with duration, rate and [design.inputs]")
    try:
        model = trial.model if model_file is None else _demand_same_equations(model_file.model, trial.model)
        _demand_sizes(model)
        task = DesignTask(
            question=trial.question,
            ship=trial.ship,
            model=model,
            sensors=trial.noise,
            request=request,
            covariance=model_file.covariance if model_file is not None and model_file.covariance.size else None,
        )
        _ = task.initial_state
    except InputError as error:
        raise InputError(f"{where}{error}") from None
    return task


def _demand_same_equations(file_model: Model, model: Model) -> Model:
    if file_model.equation_hash != model.equation_hash:
        raise InputError(
            f"the model file holds the equations '{file_model.name}', the trial '{model.name}'; "
            "name the same model under [model]"
        )
    return file_model


def _demand_sizes(model: Model) -> None:
    for p in model.parameters.free:
        if p.value == 0.0 and p.scale == 0.0:
            raise InputError(
                f"coefficient '{p.name}' is zero, so that nothing can be relative to it; "
                "give it a likely value under [model.start], or leave it out of model.free"
            )
