"""Conclusion 2: what each step of the pipeline is worth, on the simulated series and on one with planted bad data."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.estimation.regress import Pipeline, ablations
from seatrial_studies.song2025.reproduction import EstimatorResult, estimator_result

BAD_SHARE = 0.01  # share of the samples that are spoiled; our choice
SPIKE = 10.0  # size of a planted outlier in standard deviations of its channel; our choice
VELOCITIES = ("u", "v", "r")


@dataclass(frozen=True, eq=False)
class PlantedResult:
    """The improved pipeline on a series with one kind of bad data: with all its steps, and without cleaning."""

    kind: str
    spoiled: int
    cleaned: EstimatorResult
    uncleaned: EstimatorResult


@dataclass(frozen=True, eq=False)
class CleaningAblation:
    """Attributes:
    steps: the improved pipeline and each step left out, on the series as it is.
    planted: with bad data planted, one kind at a time and all together.
    """

    steps: tuple[EstimatorResult, ...]
    planted: tuple[PlantedResult, ...]


def cleaning_ablation(series: Record, *, quick: bool, seed: int) -> CleaningAblation:
    """Run the pipeline without each step, then on planted outliers, dropouts and duplicates."""
    improved = Pipeline()
    without_cleaning = ablations(improved)[0]
    spoiled = {
        "outliers": with_outliers(series, np.random.default_rng([seed, 1])),
        "dropouts": with_dropouts(series, np.random.default_rng([seed, 2])),
        "duplicates": with_duplicates(series, np.random.default_rng([seed, 3])),
    }
    planted = tuple(
        PlantedResult(
            kind, round(BAD_SHARE * len(series)), estimator_result(improved, record),
            estimator_result(without_cleaning, record),
        )
        for kind, record in list(spoiled.items())[: 1 if quick else None]
    )  # fmt: skip
    steps = (improved, *ablations(improved))
    return CleaningAblation(tuple(estimator_result(step, series) for step in steps[: 2 if quick else None]), planted)


def with_outliers(record: Record, generator: np.random.Generator) -> Record:
    """Return the record with spikes of ten standard deviations in u, v and r, at the same samples."""
    rows, signs = _rows(record, generator), generator.choice([-1.0, 1.0], len(VELOCITIES))

    def spiked(values: Array, sign: float) -> Array:
        out = values.copy()
        out[rows] += sign * SPIKE * float(np.std(values))
        return out

    changed = {c: spiked(record[c], sign) for c, sign in zip(VELOCITIES, signs, strict=True)}
    return _with_values(record, changed)


def with_dropouts(record: Record, generator: np.random.Generator) -> Record:
    """Return the record with samples in which u, v and r read zero, as a sensor that drops out does."""
    rows = _rows(record, generator)
    changed = {c: np.where(np.isin(np.arange(len(record)), rows), 0.0, record[c]) for c in VELOCITIES}
    return _with_values(record, changed)


def with_duplicates(record: Record, generator: np.random.Generator) -> Record:
    """Return the record with samples that repeat the one before in every channel, as a frozen logger does."""
    source = np.arange(len(record))
    rows = np.sort(_rows(record, generator))
    source[rows] = rows - 1
    return _with_values(record, {c: channel.values[source] for c, channel in record.channels.items()})


def _rows(record: Record, generator: np.random.Generator) -> np.ndarray:
    return 1 + generator.choice(len(record) - 2, round(BAD_SHARE * len(record)), replace=False)


def _with_values(record: Record, values: dict[str, Array]) -> Record:
    channels = {c: record.channel(c).with_values(v) for c, v in values.items()}
    return replace(record, channels={**record.channels, **channels})
