"""Priors from an earlier result of the same ship: what yesterday's records say is what is known before today's."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.core.values.files import is_file, is_folder
from seatrial.data.trial.literature import LiteraturePrior


@dataclass(frozen=True)
class EarlierResult:
    """What a result says of its coefficients before new records.

    Attributes:
        model: name of its equations; priors: coefficient -> mean and standard deviation.
        digests: SHA-256 of the files that it was estimated from.
    """

    model: str
    priors: Mapping[str, LiteraturePrior]
    digests: frozenset[str]


ResultReader = Callable[[Path], EarlierResult]


def earlier_results(
    names: Iterable[str], home: Path, expand: Callable[[str], str], read: ResultReader | None
) -> dict[str, EarlierResult]:
    """Return the results among the sources of priors, by the name in the trial file: folders with a model.toml.

    Args:
        home: folder of the trial file, from which paths count; expand: puts environment variables in.

    Raises:
        InputError: a folder that holds no such result.
    """
    folders = {name: home / expand(name) for name in names if "/" in name or is_folder(home / name)}
    for name, folder in folders.items():
        if read is None or not is_file(folder / "model.toml"):
            raise InputError(
                f"model.priors_from: '{name}' is no result of identify (no {folder / 'model.toml'}); give the DIR of "
                "'seatrial identify TRIAL --out DIR'"
            )
    return {name: read(folder) for name, folder in folders.items() if read is not None}
