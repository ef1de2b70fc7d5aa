"""The result of an earlier fit as priors of the next one."""

from pathlib import Path

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.core.values.arrays import correlation_matrix
from seatrial.data.folder.model_file import read_model_file
from seatrial.data.trial.earlier_result import EarlierResult
from seatrial.data.trial.literature import LiteraturePrior


def read_earlier_result(folder: Path, own_model: Model | None = None) -> EarlierResult:
    """Return the free coefficients of a result's model file as independent priors, and the files behind it.

    Raises:
        InputError: no model file, or one that states no uncertainty.
    """
    file = read_model_file(folder / "model.toml", own_model)
    free = file.model.parameters.free
    if file.covariance.shape != (len(free), len(free)) or not len(free):
        raise InputError(f"'{folder / 'model.toml'}' states no uncertainty; priors need the covariance of a fit")
    source = f"fit in {folder.name}, {len(file.provenance.records)} records"
    deviations = independent_deviations(file.covariance)
    priors = {p.name: LiteraturePrior(p.value, source, float(sd)) for p, sd in zip(free, deviations, strict=True)
              if np.isfinite(sd) and sd > 0.0}  # fmt: skip
    digests = frozenset(r.sha256 for r in file.provenance.records if r.sha256 and r.role == "training")
    return EarlierResult(file.model.name, priors, digests)


def independent_deviations(covariance: Array) -> Array:
    """Return standard deviations of independent errors that claim nothing that the covariance (k, k) does not, (k,).

    Those of the covariance times the root of the largest eigenvalue of its correlations: diag(s^2) - C is then positive
    semidefinite, so that no combination of coefficients is taken for better known than it was.
    """
    determined = np.isfinite(covariance).all(axis=0) & (np.diag(covariance) > 0.0)
    deviations = np.full(len(covariance), np.nan)
    if determined.any():
        part = covariance[np.ix_(determined, determined)]
        largest = float(np.linalg.eigvalsh(correlation_matrix(part))[-1])
        deviations[determined] = np.sqrt(max(largest, 1.0) * np.diag(part))
    return deviations
