"""Notes on inputs that step, and on records that a loop of Euler steps made."""

import numpy as np

from seatrial.core.values import Record
from seatrial.data.check.inputs import integration_step_findings, stepped_input_findings

DT, K, T = 0.5, 0.12, 9.0


def loop(rng: np.random.Generator, pieces: int) -> Record:
    """A craft of first order by explicit steps of DT / pieces, its orders held over DT."""
    count = 1000
    order = 0.2 * np.sign(np.sin(2.0 * np.pi * (DT * np.arange(count) + 0.1) / 52.0))
    psi, r = np.zeros(count), np.zeros(count)
    for k in range(count - 1):
        psi[k + 1], r[k + 1] = psi[k], r[k]
        for _ in range(pieces):
            step = DT / pieces
            psi[k + 1] += step * r[k + 1]
            r[k + 1] += step * (K * order[k] - r[k + 1]) / T
    noise = rng.normal(size=(2, count))
    values = {"delta": order, "psi": psi + 1e-3 * noise[0], "r": r + 1e-4 * noise[1]}
    return Record.from_arrays("loop", DT * np.arange(count), values)


def test_stepped_orders_are_a_note_unless_they_are_declared(rng: np.random.Generator) -> None:
    record = loop(rng, 1)
    (finding,) = stepped_input_findings(record)
    assert finding.code == "stepped-input" and "delta" in finding.message
    assert not stepped_input_findings(Record.from_dataframe(record.to_dataframe(), kind={"delta": "command"}))


def test_a_slewing_rudder_is_no_note(rng: np.random.Generator) -> None:
    record = loop(rng, 1)
    smooth = 0.2 * np.sin(0.12 * record.time)
    assert not stepped_input_findings(record.with_channel("delta", record.channel("delta").with_values(smooth)))


def test_only_a_loop_that_steps_with_the_samples_is_named(rng: np.random.Generator) -> None:
    (finding,) = integration_step_findings(loop(rng, 1))
    assert finding.code == "integration-step" and "0.5 s" in finding.advice
    assert not integration_step_findings(loop(rng, 50))
