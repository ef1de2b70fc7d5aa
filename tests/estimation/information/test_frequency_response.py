"""Responses of records and model: alike where the model is true, apart where it is not, for inputs that move."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from tests.estimation.estimate.test_large_records import steered

from seatrial.core.results import Prediction
from seatrial.core.values import Record
from seatrial.estimation.information.frequency_response import frequency_responses, segment_length
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate import replay

Array = NDArray[np.float64]
NAMES = ("r", "psi")


def prediction(record: Record, gain: float) -> Prediction:
    model = nomoto().with_values({"K": gain, "T": 8.0})
    return Prediction("run", "training", record, replay(model, record), {}, {}, 1.0)


def test_a_true_model_lies_inside_and_a_false_one_outside() -> None:
    record = steered(np.radians(0.5))
    (true,) = frequency_responses(nomoto(), [prediction(record, 0.15)], NAMES)
    (false,) = frequency_responses(nomoto(), [prediction(record, 0.25)], NAMES)
    assert (true.input, true.output, true.unit) == ("delta", "r", "rad/s / rad")
    assert true.is_compared.sum() > 15
    assert np.mean(true.is_inside[true.is_compared]) > 0.8
    low = false.is_compared & (false.omega < 1.0)
    assert not np.any(false.is_inside[low][-5:])


def test_the_response_of_a_first_order_ship_is_k_over_one_plus_i_omega_t() -> None:
    (found,) = frequency_responses(nomoto(), [prediction(steered(0.0), 0.15)], NAMES)
    middle = found.is_compared & (found.omega > 0.1) & (found.omega < 0.6)
    expected = 0.15 / (1.0 + 8.0j * found.omega[middle])
    np.testing.assert_allclose(found.simulated[middle], expected, rtol=0.06)
    assert np.mean(np.abs(found.measured - found.simulated)[middle] < found.radius[middle]) > 0.8
    assert np.all(found.coherence <= 1.0)
    low, high = found.excited_range
    assert low < 0.1 < 1.0 < high


def test_what_cannot_be_compared_is_left_out() -> None:
    record = steered(0.0)
    one = prediction(record, 0.15)
    still = record.with_channel("delta", record.channel("delta").with_values(np.zeros(len(record))))
    assert frequency_responses(nomoto(), [replace(one, measured=still)], NAMES) == ()
    assert frequency_responses(nomoto(), [one], ("x0",)) == ()
    assert [r.output for r in frequency_responses(nomoto(), [one], ("psi",))] == ["psi"]
    short = replace(one, measured=record.rows(slice(0, 100)), simulated=one.simulated.rows(slice(0, 100)))
    assert frequency_responses(nomoto(), [short], NAMES) == ()


def test_segments_fit_into_runs() -> None:
    assert segment_length([8000]) == 1000
    assert segment_length([600] * 12) == 600
    assert segment_length([601, 599]) == 150
