"""Work that needs no records of the user's: the demo, published studies, the list of models."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from seatrial.core.results import Fit, Study
    from seatrial.core.values import ProgressReporter
    from seatrial.data.trial.model_table import ModelGuide
    from seatrial.physics.models.registry import ModelSummary

STUDY_GROUP = "seatrial.studies"


class Reproduction(Protocol):
    """What an entry point of the group ``seatrial.studies`` names: repeats a study, `quick` with fewer cases."""

    def __call__(self, *, quick: bool, seed: int, report_progress: "ProgressReporter | None") -> "Study": ...


def reproduce(
    study: str, *, quick: bool = False, seed: int = 0, report_progress: "ProgressReporter | None" = None
) -> "Study":
    """Repeat a published study and check its claims.

    Args:
        study: its name, e.g. ``alexandersson2022``.
        quick: fewer cases.
        seed: of everything drawn at random; the same seed gives the same bits.
        report_progress: called with one line of text at each step.

    Raises:
        InputError: unknown study (the nearest is named), or an installed one that cannot be loaded.
    """
    from seatrial._plugins import installed, load_plugin
    from seatrial.core.values import InputError, spelling_hint

    if study not in (names := installed(STUDY_GROUP)):
        raise InputError(f"unknown study '{study}'{spelling_hint(study, list(names))}")
    if report_progress:
        report_progress(f"study {study}, loading and compiling")
    reproduction: Reproduction = load_plugin(STUDY_GROUP, study, InputError)
    return replace(reproduction(quick=quick, seed=seed, report_progress=report_progress), quick=quick)


def demo(folder: str | Path, seed: int = 0, report_progress: "ProgressReporter | None" = None) -> "Fit":
    """Identify a craft with known coefficients from simulated trials; trials, result and report go to `folder`.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.api.files import save
    from seatrial.api.trials import identify, load_trial
    from seatrial.core.values.files import writable_folder
    from seatrial.data.example_series import write_demo

    report_progress = report_progress or (lambda _: None)
    folder = writable_folder(Path(folder))
    report_progress("simulation of the trials")
    fit = identify(load_trial(write_demo(folder / "trials", seed)), seed=seed, report_progress=report_progress)
    report_progress("result and report")
    save(fit, folder)
    return fit


def model_guide(name: str) -> "ModelGuide":
    """Return what a model needs: channels, particulars, what is filled from where, and the tables of a trial file.

    Raises:
        InputError: there is no such model; the nearest name is given.
    """
    from seatrial.data.trial.model_table import model_guide

    return model_guide(name)


def list_models() -> "tuple[ModelSummary, ...]":
    """List the built-in models, then the installed ones: name, states, inputs, source.

    An installed model that cannot be loaded is listed with the reason as its `problem`.
    """
    from seatrial.physics.models.registry import model_summaries

    return model_summaries()
