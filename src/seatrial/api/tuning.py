"""From a loop file to a tuned controller, and back from its trial: load_loop, tune, verify."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seatrial.control.task import TuningTask
    from seatrial.core.equations import Model
    from seatrial.core.results.tuning import Tuning
    from seatrial.core.results.verification import Verification
    from seatrial.core.values import ProgressReporter, Record


def load_loop(path: str | Path, own_model: "Model | None" = None, model_file: str | Path | None = None) -> "TuningTask":
    """Load the tuning task that a loop file describes (see docs/loop-file.md).

    Args:
        path: the loop file.
        own_model: equations of a model file that are not built in.
        model_file: takes the place of the model file that the loop file names.

    Raises:
        InputError: one sentence naming file, key and what to do.
    """
    from seatrial.control.loopfile.load import tuning_task

    return tuning_task(Path(path), own_model, None if model_file is None else Path(model_file))


def tune(
    task: "TuningTask | str | Path",
    seed: int = 0,
    report_progress: "ProgressReporter | None" = None,
    method: str = "front",
) -> "Tuning":
    """Tune a feedback loop: the front, the chosen gains with the reasons, and their nonlinear simulation.

    Args:
        task: as `load_loop` returns it, or the path of a loop file.
        seed: of the search, of the simulated seas, and of the ships drawn from the fit.
        report_progress: called with one line of text at each step.
        method: where the chosen gains come from: "front", or "genetic" (Yu et al. 2014, settings of the loop file's
            table [genetic]), with the choice from the front beside it as `reference`.

    Raises:
        InputError: as `load_loop`; an unknown method; no gains keep the limits (which limit, by how much).
    """
    from seatrial.control.task import TuningTask
    from seatrial.control.tune import tune
    from seatrial.core.results.tuning import TuningMethod
    from seatrial.core.values import InputError, spelling_hint

    if method not in (known := [one.value for one in TuningMethod]):
        raise InputError(f"there is no tuning method '{method}'{spelling_hint(method, known)}")
    task = task if isinstance(task, TuningTask) else load_loop(task)
    return tune(task, seed=seed, report_progress=report_progress or (lambda _: None), method=TuningMethod(method))


def verify(
    task: "TuningTask | str | Path",
    gains: "Mapping[str, float] | str | Path",
    records: "Sequence[Record | str | Path]",
) -> "Verification":
    """Verify a tuned controller by the log of its trial: what was predicted, what was achieved, what was wrong.

    Args:
        task: as `load_loop` returns it, or the path of a loop file; its first sea has the heading of the legs.
        gains: those that were on, by name, or the path of a ``gains.toml``.
        records: with the loop's output and actuator, and what was ordered where it follows a demand (``psi_ref``); or
            paths: of trial files, of which every run that is not left out is taken, and of record files of
            `write_record`. Legs with and without control, and changes of what was ordered, are recognised.

    Raises:
        InputError: gains of another loop, a log without legs or too short, or an actuator that does not follow the
            gains.
    """
    from seatrial.control.actuator_log import logged_records
    from seatrial.control.task import TuningTask
    from seatrial.control.verification.verify import verify
    from seatrial.data.folder.gains_file import read_gains

    loaded = [
        record
        for one in records
        for record in ([one] if not isinstance(one, str | Path) else logged_records(Path(one)))
    ]
    values = read_gains(gains) if isinstance(gains, str | Path) else gains
    return verify(task if isinstance(task, TuningTask) else load_loop(task), values, loaded)
