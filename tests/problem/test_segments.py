"""Records cut into segments."""

from itertools import pairwise

import numpy as np
import pytest

from seatrial.equations import Model
from seatrial.models.nomoto import nomoto
from seatrial.problem.segments import compared_outputs, cut
from seatrial.values import Channel, InputError, Record


def record(name: str, rows: int, dt: float = 0.5, port: bool = False) -> Record:
    time = dt * np.arange(rows)
    made = Record.of(name, time, {"r": np.sin(time), "psi": np.cos(time), "delta": 0.1 * time})
    return made.with_channel("delta", Channel(-0.1 * time, "rad", "body", "port")) if port else made


@pytest.fixture
def model() -> Model:
    return nomoto()


def test_neighbours_share_one_sample_and_nothing_is_lost(model: Model) -> None:
    data = cut(model, [record("a", 101)], ("r", "psi"), 12.0)
    assert data.count == round(50.0 / 12.0)
    pieces = [data.measured[a:b] for a, b in pairwise(data.offsets)]
    for one, two in pairwise(pieces):
        np.testing.assert_array_equal(one[-1], two[0])
    joined = np.concatenate([pieces[0], *(p[1:] for p in pieces[1:])])
    np.testing.assert_array_equal(joined, record("a", 101).matrix(("r", "psi")))
    assert np.ptp(np.diff(data.offsets)) <= 1


def test_whole_runs_and_runs_shorter_than_a_segment(model: Model) -> None:
    whole = cut(model, [record("a", 30), record("b", 50)], ("r",), None)
    np.testing.assert_array_equal(whole.offsets, [0, 30, 80])
    assert cut(model, [record("a", 30)], ("r",), 1e6).count == 1


def test_runs_and_sessions_are_told_apart(model: Model) -> None:
    data = cut(model, [record("a", 41), record("b", 41), record("c", 41)], ("r",), 10.0, ["day 2", "day 1", "day 2"])
    np.testing.assert_array_equal(data.run, [0, 0, 1, 1, 2, 2])
    np.testing.assert_array_equal(data.session, [0, 0, 1, 1, 0, 0])
    assert data.sessions == ("day 2", "day 1")
    assert data.runs == ("a", "b", "c")


def test_inputs_take_the_models_sign(model: Model) -> None:
    one, other = (cut(model, [record("a", 21, port=p)], ("r",), None).inputs for p in (False, True))
    np.testing.assert_array_equal(one, other)


def test_a_channel_that_was_not_measured_is_nan(model: Model) -> None:
    data = cut(model, [record("a", 21), record("b", 21).without("r")], ("r", "psi"), None)
    assert np.all(np.isfinite(data.measured[:21]))
    assert np.all(np.isnan(data.measured[21:, 0]))
    assert np.all(np.isfinite(data.measured[21:, 1]))


def test_outputs_are_those_the_records_hold(model: Model) -> None:
    records = [record("a", 21), record("b", 21).without("r")]
    assert compared_outputs(model, records) == ("r", "psi")
    assert compared_outputs(model, records, ("psi",)) == ("psi",)
    with pytest.raises(InputError, match=r"channel 'phi' cannot be compared; did you mean 'psi'"):
        compared_outputs(model, records, ("phi",))
    with pytest.raises(InputError, match="no record holds any output of model 'nomoto': r, psi, x0, y0"):
        compared_outputs(model, [records[0].without("r", "psi")])


def test_rates_that_differ_and_short_records_are_refused(model: Model) -> None:
    with pytest.raises(InputError, match=r"record 'b' has a time step of 0\.25 s, the first one 0\.5 s"):
        cut(model, [record("a", 21), record("b", 21, dt=0.25)], ("r",), None)
    with pytest.raises(InputError, match="record 'a' has 2 samples; at least three"):
        cut(model, [record("a", 2)], ("r",), None)
