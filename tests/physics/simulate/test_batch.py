"""Many segments at once against one replay at a time, with corrected inputs."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate import inputs_of, replay
from seatrial.physics.simulate.batch import InputCorrection, SegmentBatch

ROWS, DT = 120, 0.25
START = {"u": 0.9, "v": 0.02, "r": -0.01, "psi": 0.3, "x0": 5.0, "y0": -2.0}
OUTPUTS = ("psi", "u", "y0")


def plan(shift: float = 0.0, zero: float = 0.0, gain: float = 1.0) -> Record:
    """A smooth steering programme, later by `shift`, with its nozzle angle times `gain` plus `zero`."""
    time = DT * np.arange(ROWS)
    delta = gain * 0.3 * np.sin(0.4 * (time - shift)) + zero
    return Record.from_arrays("plan", time, {"delta": delta, "v_j": 1.8 + 0.1 * np.cos(0.1 * time)})


def batch(records: tuple[Record, ...], corrections: tuple[InputCorrection, ...] = ()) -> SegmentBatch:
    model = waterjet()
    inputs = np.concatenate([inputs_of(model, r) for r in records])
    return SegmentBatch(model, inputs, ROWS * np.arange(len(records) + 1), DT, OUTPUTS, corrections=corrections)


def simulated(of: SegmentBatch, corrections: np.ndarray) -> np.ndarray:
    start = np.tile([START[s] for s in of.model.states], (of.segment_count, 1))
    values = np.tile(of.model.parameters.values, (of.segment_count, 1))
    return of.simulate(0, of.segment_count, start, values, corrections)[0]


def test_segments_equal_replays_bit_for_bit() -> None:
    records = (plan(), plan(gain=0.5))
    y = simulated(batch(records), np.empty((2, 0)))
    alone = np.concatenate([replay(waterjet(), r, START).matrix(OUTPUTS) for r in records])
    np.testing.assert_array_equal(y, alone)


@pytest.mark.parametrize(("kind", "value", "tolerance"), [("gain", 0.8, 1e-12), ("zero", 0.05, 1e-12)])
def test_corrections_equal_corrected_records(kind: str, value: float, tolerance: float) -> None:
    of = batch((plan(),), (InputCorrection("delta", kind),))
    sign = -1.0 if kind == "zero" else 1.0  # the model's nozzle angle is positive to port, the record's to starboard
    corrected = plan(gain=value) if kind == "gain" else plan(zero=sign * value)
    np.testing.assert_allclose(
        simulated(of, np.array([[value]])), replay(waterjet(), corrected, START).matrix(OUTPUTS), atol=tolerance
    )


def test_a_delay_of_whole_samples_shifts_the_input() -> None:
    """Before the first sample the first value holds."""
    of = batch((plan(),), (InputCorrection("delta", "delay"),))
    delta = plan()["delta"]
    late = np.concatenate([np.full(4, delta[0]), delta[:-4]])
    record = plan().with_channel("delta", plan().channel("delta").with_values(late))
    np.testing.assert_allclose(
        simulated(of, np.array([[4 * DT]])), replay(waterjet(), record, START).matrix(OUTPUTS), atol=1e-9
    )


def test_each_segment_has_its_own_correction() -> None:
    of = batch((plan(), plan()), (InputCorrection("v_j", "gain"),))
    y = simulated(of, np.array([[1.0], [1.1]]))
    assert y[ROWS - 1, 1] < y[2 * ROWS - 1, 1]
    np.testing.assert_array_equal(y[:ROWS], replay(waterjet(), plan(), START).matrix(OUTPUTS))


def test_states_that_reach_an_output() -> None:
    of = batch((plan(),))
    assert of.influential_states() == ("u", "v", "r", "psi", "y0")


def test_states_whose_initial_value_is_added_to_them_and_shows_nowhere_else() -> None:
    assert batch((plan(),)).offset_states() == ("x0", "y0")
    shifted = replay(waterjet(), plan(), {**START, "y0": START["y0"] + 3.0}).matrix(OUTPUTS)
    offset = shifted - replay(waterjet(), plan(), START).matrix(OUTPUTS)
    np.testing.assert_allclose(offset, np.broadcast_to([0.0, 0.0, 3.0], offset.shape), atol=1e-12)
