"""Records that the priors were estimated from."""

from collections.abc import Iterable, Mapping

from seatrial.core.values import InputError
from seatrial.core.values.files import is_file
from seatrial.data.read.record_file import file_digest
from seatrial.data.trial.earlier_result import EarlierResult
from seatrial.data.trial.run_data import RecordFile
from seatrial.data.trial.trial import Role, TrialRun


def refuse_used_records(runs: Iterable[TrialRun], results: Mapping[str, EarlierResult]) -> None:
    """Refuse training runs from files that a result behind the priors was estimated from: they would count twice.

    Raises:
        InputError: which run, and which result.
    """
    for run in runs if results else ():
        if run.role is not Role.TRAIN or not isinstance(run.data, RecordFile) or run.data.part is not None:
            continue
        digest = file_digest(run.data.path) if is_file(run.data.path) else ""
        for name, result in results.items():
            if digest in result.digests:
                raise InputError(
                    f"run '{run.data.name}' was already used for '{name}', which gives the priors: its samples would "
                    "count twice; leave the run out, or take other priors"
                )
