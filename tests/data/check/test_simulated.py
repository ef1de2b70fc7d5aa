"""A simulated waterjet trial, nozzle positive to port, passes as it is declared and fails when it is not."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Channel, Record, Severity, frozen
from seatrial.data.check import examine
from seatrial.numerics.kernels.integrate import replay
from seatrial.physics.models.waterjet import waterjet

SIGMA = {"u": 0.02, "v": 0.02, "r": np.radians(0.1), "psi": np.radians(0.2), "x0": 0.5, "y0": 0.5, "delta": 0.0}


@pytest.fixture(scope="module")
def clean() -> Record:
    model = waterjet()
    count, dt = 6000, 0.1
    time = dt * np.arange(count)
    inputs = np.zeros((count, 2))
    delta, jet = (model.input_names.index(name) for name in ("delta", "v_j"))
    inputs[:, delta] = np.radians(20.0) * np.clip(3.0 * np.sin(2 * np.pi * time / 90.0), -1, 1)
    inputs[:, jet] = 1.866
    start = np.zeros((1, len(model.states)))
    start[0, model.states.index("u")] = 0.8
    out, failed = np.empty((count, len(model.states))), np.full(1, -1)
    ones, zeros = np.ones((1, 2)), np.zeros((1, 2))
    everything, offsets = np.arange(len(model.states)), np.array([0, count])
    compiled, p = model.compiled, model.parameters.values[None]
    replay(
        compiled.rates, compiled.outputs, inputs, np.array([[0, 0, count]]), np.ones(2), offsets, 0, 1, dt, 1,
        start, p, ones, zeros, zeros,
        everything, 0, out, failed,
    )  # fmt: skip
    record = Record.from_arrays("waterjet", time, {s: out[:, i] for i, s in enumerate(model.states)})
    nozzle = Channel(frozen(inputs[:, delta]), "rad", "body", model.inputs[delta].direction)
    return record.with_channel("delta", nozzle)


def noisy(record: Record, seed: int) -> Record:
    rng = np.random.default_rng(seed)
    channels = {
        s: c.with_values(c.values + SIGMA[s] * rng.standard_normal(len(record))) for s, c in record.channels.items()
    }
    return replace(record, channels=channels)


def test_noise_free_record_passes(clean: Record) -> None:
    assert examine(clean) == ()


@pytest.mark.parametrize("seed", range(8))
def test_noisy_records_pass_without_error_or_warning(clean: Record, seed: int) -> None:
    assert [f.text for f in examine(noisy(clean, seed)) if f.severity is not Severity.INFO] == []


def test_the_wrong_nozzle_sign_is_an_error(clean: Record) -> None:
    wrong = replace(clean.channel("delta"), positive="starboard")
    findings = examine(noisy(clean.with_channel("delta", wrong), 1))
    assert [f.code for f in findings if f.severity is Severity.ERROR] == ["wrong-sign"]


def test_position_noise_on_a_short_track_is_no_closure_error(clean: Record) -> None:
    """Half a metre of position noise on a track of 80 m is noise, not another reference point or frame."""
    short = noisy(clean.between(0.0, 100.0), 3)
    assert [f.text for f in examine(short) if f.code == "closure"] == []
    shifted = short.with_channel("v", short.channel("v").with_values(short["v"] + 3.0 * short["r"]))
    assert [f.code for f in examine(shifted) if f.code == "closure"] == ["closure"]
