"""Copies of a run count once."""

from dataclasses import replace

import numpy as np

from seatrial.core.values import Record
from seatrial.data.check.examine import copies


def record(name: str, start: float = 0.0, shift: float = 0.0) -> Record:
    time = start + 0.1 * np.arange(50)
    return Record.from_arrays(name, time, {"psi": np.sin(np.arange(50.0)) + shift, "delta": np.full(50, 0.1)})


def test_a_copy_is_known_by_its_samples_whatever_its_name_and_clock() -> None:
    assert copies([record("a"), record("b"), record("c", start=1000.3)]) == {1: 0, 2: 0}


def test_runs_that_differ_in_a_sample_a_channel_or_their_length_are_no_copies() -> None:
    a = record("a")
    without = replace(a, channels={"psi": a.channel("psi")})
    assert copies([a, record("b", shift=1e-12), without, a.rows(slice(0, 49))]) == {}
