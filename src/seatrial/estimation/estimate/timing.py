"""When inputs took effect: whether they are held between samples, and a delay that no record states.

A sample shows an input somewhere within the sample interval of its source. That is a delay of mean 0 and standard
deviation dt / sqrt(12), of a uniform distribution over the interval, in every session.
"""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Prior, Record
from seatrial.core.values.arrays import Travel, travel
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.problem.output_error import Nuisance
from seatrial.physics.simulate.batch import InputCorrection

_NOT_SET = ("wind_speed", "wind_direction", "alpha_w", "u", "omega_e")
"""Inputs that nobody aboard sets: wind, slope of waves, speed and frequency of encounter of a run."""

_FORCE_UNITS = ("N", "N m")
"""Units of inputs that are forces of waves."""

_OWN_RATE = 1.001
"""Ratio of the time step of a record to that of an input's source up to which they are one; chosen."""

UNIFORM = math.sqrt(12.0)
"""Length of a uniform distribution over its standard deviation."""

SOURCE = "uniform over the sample interval of its source"


def set_inputs(model: Model) -> tuple[str, ...]:
    """Return the inputs that somebody or something aboard sets, without those that a linear model holds by itself."""
    return tuple(
        i.name
        for i in model.equations.inputs
        if not i.is_held and i.name not in _NOT_SET and not (i.name in NOTATION and _is_force(NOTATION[i.name].unit))
    )


def _is_force(unit: str) -> bool:
    return unit in _FORCE_UNITS


def with_held_inputs(model: Model, records: Sequence[Record]) -> Model:
    """Return the model with those inputs constant from sample to sample that the records hold.

    A channel that says how it runs between samples is believed, and so is a command; others are judged by the share of
    their travel that lies within single samples, unless they were resampled: a step may then lie anywhere in a sample.
    """
    return model.with_held(name for name in set_inputs(model) if _is_held(name, records))


def _is_held(name: str, records: Sequence[Record]) -> bool:
    return sum((_judged_travel(record, name) for record in records if name in record), Travel()).is_stepped


def _judged_travel(record: Record, name: str) -> Travel:
    """Return the travel of a channel, all or nothing of it in steps where that is declared or cannot be judged."""
    channel = record.channel(name)
    seen = travel(channel.values)
    if channel.between or channel.is_command:
        return Travel(seen.total, seen.total if channel.is_held else 0.0)
    return Travel(seen.total, 0.0) if _is_resampled(record, name) else seen


def _is_resampled(record: Record, name: str) -> bool:
    source = record.channel(name).sample_s
    return 0.0 < source * _OWN_RATE < record.dt


def timing_nuisances(model: Model, records: Sequence[Record], settings: EstimateSettings) -> tuple[Nuisance, ...]:
    """Return a delay for each set input that moves in the records and that the settings do not name.

    Inputs that are the same in all records have none: a time between them would separate what no record does.
    """
    names = set_inputs(model)
    return tuple(
        Nuisance(
            InputCorrection(name, "delay"), Prior(0.0, _sample_interval(name, records) / UNIFORM, SOURCE), "s",
            is_spread_fixed=True,
        )
        for name in names
        if name not in settings.delays
        and any(name in r and np.ptp(r[name]) > 0.0 for r in records)
        and not any(_are_same(name, other, records) for other in names if other != name)
    )  # fmt: skip


def _are_same(name: str, other: str, records: Sequence[Record]) -> bool:
    return all(name in r and other in r and np.array_equal(r[name], r[other], equal_nan=True) for r in records)


def _sample_interval(name: str, records: Sequence[Record]) -> float:
    """Return the longest time between two samples of an input's source, s."""
    return max(r.channel(name).sample_s or r.dt for r in records if name in r)
