"""The result of an earlier fit as priors of the next one."""

from pathlib import Path

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import InputError
from seatrial.data.folder.model_file import ModelFile, read_model_file
from seatrial.data.trial.earlier_result import EarlierResult, JointPrior

_LEAST_SHRINKAGE = 0.01
"""Share of the variances that is added to a covariance before it becomes a prior, at least; chosen."""


def read_earlier_result(folder: Path, own_model: Model | None = None) -> EarlierResult:
    """Return the free coefficients of a result's model file as a joint prior, and the files behind it.

    Raises:
        InputError: no model file, or one that states no uncertainty.
    """
    file = read_model_file(folder / "model.toml", own_model)
    free = file.model.parameters.free
    if file.covariance.shape != (len(free), len(free)) or not len(free):
        raise InputError(f"'{folder / 'model.toml'}' states no uncertainty; priors need the covariance of a fit")
    source = f"fit in {folder.name}, {len(file.provenance.records)} records"
    digests = frozenset(r.sha256 for r in file.provenance.records if r.sha256 and r.role == "training")
    return EarlierResult(file.model.name, source, joint_prior(file), digests)


def joint_prior(file: ModelFile) -> JointPrior:
    """Return the determined free coefficients with their covariance, a little wider than it is stated.

    A covariance of few runs knows some combinations too well by chance. A share of the variances is added to them, one
    over the degrees of freedom, so that no combination is taken for better known than it was (Ledoit & Wolf 2004,
    J. Multivar. Anal. 88, 365, whose target is a diagonal, too).
    """
    free, variances = file.model.parameters.free, np.diag(file.covariance)
    rows = np.flatnonzero(np.isfinite(file.covariance).all(axis=0) & (variances > 0.0))
    degrees = file.interval_basis.degrees_of_freedom if file.interval_basis else np.inf
    share = max(_LEAST_SHRINKAGE, 1.0 / degrees)
    covariance = file.covariance[np.ix_(rows, rows)] + share * np.diag(variances[rows])
    return JointPrior(tuple(free[i].name for i in rows), np.array([free[i].value for i in rows]), covariance)
