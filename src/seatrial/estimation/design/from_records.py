"""A manoeuvre designed like the recorded ones: as long, with orders as large and as quick, by the same sensors."""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.motion import sample_noise
from seatrial.data.trial import Trial, load_records
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.data.trial.trial import Role

# percentiles of an input that are its range and of its steps that are its rate; fewest orders of a run; chosen
_REACH, _FASTEST, _ORDERS = 99.0, 99.0, 20
_SLOWEST_RATE = 1.0  # Hz at which a design is sampled at most: standard errors go with the square root; chosen


def recorded_request(trial: Trial) -> tuple[DesignRequest, dict[str, float]]:
    """Return the request for a manoeuvre like the training runs, and the noise of their sensors [SI] by observable.

    As long as the longest run; an input that moves may be ordered as far and as fast as it was, a twentieth of the run
    apart; the others are held at their median.

    Raises:
        InputError: the trial has no training run, or no input moves in one.
    """
    records = [one.record for one in load_records(trial)[0] if one.role is Role.TRAIN] if trial.runs else []
    if not records:
        raise InputError("there is no table [design]; add it with duration, rate and [design.inputs]")
    longest = max(records, key=lambda record: record.duration)
    names = [name for name in trial.model.input_names if all(name in record for record in records)]
    hold = longest.duration / _ORDERS
    ranges = {name: _range(records, name, hold) for name in names}
    moved = {name: one for name, one in ranges.items() if one is not None}
    if not moved:
        raise InputError("no input moves in the training runs; add a table [design] with [design.inputs]")
    held = {name: float(np.median(longest[name])) for name in names if name not in moved}
    request = DesignRequest(
        duration=longest.duration, rate=min(_SLOWEST_RATE, 1.0 / longest.dt), inputs=moved, held=held
    )
    return request, _sensors(trial.model, records)


def _range(records: Sequence[Record], name: str, hold: float) -> InputRange | None:
    """How far an input went to both sides, SI; None where it hardly moves."""
    values = np.concatenate([record[name] for record in records])
    low, high = (float(one) for one in np.percentile(values, [100.0 - _REACH, _REACH]))
    if high - low <= 0.1 * max(abs(low), abs(high)):  # of its size: it is steady; chosen
        return None
    steps = np.concatenate([np.abs(np.diff(record[name])) / record.dt for record in records])
    rate = float(np.percentile(steps, _FASTEST))
    unit = records[0].channel(name).unit
    return InputRange(lower=low, upper=high, unit=unit, rate=rate or None, hold=hold)


def _sensors(model: Model, records: Sequence[Record]) -> dict[str, float]:
    levels: Mapping[str, Array] = {
        name: np.array([sample_noise(record[name]) for record in records if name in record])
        for name in model.observables
    }
    return {name: float(np.median(one)) for name, one in levels.items() if one.size and np.median(one) > 0.0}
