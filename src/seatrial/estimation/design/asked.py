"""From a trial file's table `[design]`, and perhaps a model file, to the task of the search."""

from seatrial.core.equations import Model
from seatrial.core.values import InputError
from seatrial.data.folder.model_file import ModelFile
from seatrial.data.trial import Trial
from seatrial.estimation.design.task import Criterion, Task


def task_of(trial: Trial, known: ModelFile | None = None) -> Task:
    """The task that the trial describes.

    Args:
        known: its values, freedom and covariance take the place of the trial's.

    Raises:
        InputError: the trial has no [design], the model file holds other equations, a coefficient has no size, or what
            `Task` refuses; the sentence begins with the trial file.
    """
    where = f"{trial.path}: " if trial.path else ""
    brief = trial.design
    if brief is None:
        raise InputError(f"{where}there is no table [design]; add it with duration, rate and [design.inputs]")
    try:
        model = trial.model if known is None else _of_same_equations(known.model, trial.model)
        _demand_sizes(model)
        task = Task(
            question=trial.question,
            ship=trial.ship,
            model=model,
            sensors=trial.noise,
            rate=brief.rate,
            duration=brief.duration,
            actuators=brief.actuators,
            limits=brief.limits,
            held=brief.held,
            speed=brief.speed,
            criterion=Criterion(brief.criterion),
            draws=brief.draws,
            spread=brief.prior,
            covariance=known.covariance if known is not None and known.covariance.size else None,
        )
        _ = task.start
    except InputError as error:
        raise InputError(f"{where}{error}") from None
    return task


def _of_same_equations(known: Model, model: Model) -> Model:
    if known.equation_hash != model.equation_hash:
        raise InputError(
            f"the model file holds the equations '{known.name}', the trial '{model.name}'; "
            "name the same model under [model]"
        )
    return known


def _demand_sizes(model: Model) -> None:
    for p in model.parameters.free:
        if p.value == 0.0 and p.scale == 0.0:
            raise InputError(
                f"coefficient '{p.name}' is zero, so that nothing can be relative to it; "
                "give it a likely value under [model.start], or leave it out of model.free"
            )
