"""RMSE and CC as measures of coefficients: a move of 100 % along the least identifiable direction of a record."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Direction
from seatrial.core.values import Array, Record
from seatrial.data.example_series import SENSOR_NOISE
from seatrial.estimation.information import directions
from seatrial.physics.simulate import SegmentBatch, initial_state, inputs_of
from seatrial_studies.song2025.craft_models import TRUTH, replay_inputs
from seatrial_studies.song2025.generalisation import prediction_accuracy
from seatrial_studies.song2025.published import Accuracy

# relative change of a coefficient that a sentence names; our choice
NOTABLE_CHANGE = 0.2


@dataclass(frozen=True)
class Discrimination:
    """What accuracy sees of coefficients moved by 100 % along the weakest direction of the Fisher information.

    Attributes:
        weakest_direction: the weakest of output error with the sensors' noise, with its standard deviation.
        changes: coefficient -> relative change of the moved craft.
        accuracy: of the moved craft on the same nozzle history, against the truth.
        sensor_noise: channel -> the noise whose standard deviation the RMSE is to be compared with, SI units.
    """

    weakest_direction: Direction
    changes: dict[str, float]
    accuracy: Accuracy
    sensor_noise: dict[str, float]

    @property
    def changes_text(self) -> str:
        """Return the changes above a fifth, per cent of the signed value."""
        return ", ".join(f"{n} {100 * c:+.0f} %" for n, c in self.changes.items() if abs(c) > NOTABLE_CHANGE)

    @property
    def cc_loss(self) -> dict[str, float]:
        """Return 1 - CC by channel."""
        return {channel: 1.0 - cc for channel, cc in self.accuracy.cc.items()}


def discrimination(series: Record) -> Discrimination:
    """Return the discrimination of the consecutive zigzags, noise-free (0.8 s)."""
    craft = TRUTH.craft()
    names = craft.parameters.free_names
    sizes = np.array([p.characteristic_scale for p in craft.parameters.free])
    weakest = directions(fisher_information(craft, series), names, sizes)[0]
    moved = {p.name: p.value + weakest.combination[p.name] * p.characteristic_scale for p in craft.parameters.free}
    changes = {p.name: moved[p.name] / p.value - 1.0 for p in craft.parameters.free}
    accuracy = prediction_accuracy(series, replay_inputs(craft.with_values(moved), series))
    return Discrimination(weakest, changes, accuracy, {c: SENSOR_NOISE[c] for c in accuracy.cc})


def fisher_information(craft: Model, record: Record) -> Array:
    """Return the Fisher information (k, k) of the free coefficients: output error, known initial state, white noise."""
    outputs = tuple(SENSOR_NOISE)
    offsets = np.array([0, len(record)])
    batch = SegmentBatch(craft, inputs_of(craft, record), offsets, record.dt, outputs, craft.parameters.free_names)
    start, none = initial_state(craft, record, {}), np.empty((1, 0))
    _, slopes, _ = batch.differentiate(0, 1, start[None], craft.parameters.values[None], none)
    weighted = slopes / np.array([SENSOR_NOISE[name] for name in outputs])[None, :, None]
    rows = weighted.reshape(-1, weighted.shape[2])
    return rows.T @ rows
