"""Priors from an earlier result of the same ship: what yesterday's records say is what is known before today's."""

from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, InputError, Parameters, Prior
from seatrial.core.values.files import is_file, is_folder
from seatrial.data.trial.literature import LiteraturePrior


@dataclass(frozen=True, eq=False)
class JointPrior:
    """What an earlier result says of several coefficients together.

    Attributes:
        names: of the coefficients; mean: (n,); covariance: (n, n); both SI.
    """

    names: tuple[str, ...]
    mean: Array
    covariance: Array

    def restricted(self, names: Collection[str]) -> "JointPrior":
        """Return what it says of some of them, whatever the others are."""
        rows = [i for i, name in enumerate(self.names) if name in names]
        return JointPrior(tuple(self.names[i] for i in rows), self.mean[rows], self.covariance[np.ix_(rows, rows)])


@dataclass(frozen=True, eq=False)
class EarlierResult:
    """What a result says of its coefficients before new records.

    Attributes:
        model: name of its equations; source: what it is, in a phrase; joint_prior: of its free coefficients.
        digests: SHA-256 of the files that it was estimated from.
    """

    model: str
    source: str
    joint_prior: JointPrior
    digests: frozenset[str]

    @property
    def priors(self) -> dict[str, LiteraturePrior]:
        """Mean and standard deviation of each coefficient by itself."""
        prior = self.joint_prior
        deviations = np.sqrt(np.diag(prior.covariance))
        return {
            name: LiteraturePrior(float(mean), self.source, float(sd))
            for name, mean, sd in zip(prior.names, prior.mean, deviations, strict=True)
        }

    def joint_prior_of(self, parameters: Parameters) -> JointPrior:
        """Return what it says of those free parameters whose priors are its own."""
        own = self.priors
        return self.joint_prior.restricted({
            p.name for p in parameters.free
            if p.name in own and p.prior == Prior(own[p.name].mean, own[p.name].deviation, own[p.name].source)
        })  # fmt: skip


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
