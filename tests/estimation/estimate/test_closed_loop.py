"""A controller shows in the records or is declared; its reference and its orders are compared with the fit."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.data.trial import ControllerGains, Feedback
from seatrial.estimation.estimate.closed_loop import (
    closed_loop,
    controller_agreement,
    loop_evidence,
    reference_p,
    reference_steps,
)
from seatrial.estimation.estimate.disturbance_models import refuse_short_runs

DT, ROWS, DELAY = 0.1, 1200, 7
TIME = DT * np.arange(ROWS)
DECLARED = Feedback(
    input="delta", output="psi", reference="psi_ref", controller=ControllerGains(gain=1.0, rate_gain=4.0, sample_s=DT)
)


def recorded(seed: int, *, sign: float = 1.0) -> Record:
    """A rudder that follows the declared orders seven samples late; heading and yaw rate are noise."""
    rng = np.random.default_rng(seed)
    psi, r = 0.1 * rng.standard_normal((2, ROWS)).cumsum(axis=1) / np.sqrt(ROWS)
    reference = np.where((TIME // 30.0) % 2 == 0, 0.2, -0.2)
    order = reference - psi - 4.0 * r
    delta = sign * np.concatenate([np.full(DELAY, order[0]), order[:-DELAY]])
    return Record.from_arrays("run", TIME, {"delta": delta, "psi": psi, "r": r, "psi_ref": reference})


def with_innovations(values: np.ndarray) -> Any:
    """What `reference_p` reads of a prediction-error optimum."""
    innovations = SimpleNamespace(normalised=values)
    problem = SimpleNamespace(innovations=lambda _: innovations)
    return SimpleNamespace(problem=problem, optimum=SimpleNamespace(solution=SimpleNamespace(point=None)))


def test_orders_agree_with_the_input_at_its_delay() -> None:
    agreement = controller_agreement(DECLARED, [recorded(1), recorded(2)])
    assert agreement is not None
    assert agreement == (pytest.approx(1.0, abs=1e-2), pytest.approx(DELAY * DT))
    reversed_one = controller_agreement(DECLARED, [recorded(1, sign=-1.0)])
    assert reversed_one is not None
    assert reversed_one[0] < 0.5


def test_changes_of_the_reference_are_counted() -> None:
    ramp = np.clip(TIME - 30.0, 0.0, 5.0)
    record = Record.from_arrays("ramp", TIME, {"delta": TIME, "psi": TIME, "r": TIME, "psi_ref": ramp})
    assert reference_steps(DECLARED, [recorded(1)]) == 3
    assert reference_steps(DECLARED, [recorded(1), record]) == 4
    assert reference_steps(Feedback(input="delta", output="psi"), [record]) is None


def test_white_innovations_do_not_depend_on_the_reference() -> None:
    """p is uniform: a hundredth of them below 0.01, a half below 0.5 (one channel)."""
    record, rng = recorded(1), np.random.default_rng(3)
    p = [reference_p(DECLARED, [record], with_innovations(rng.standard_normal((ROWS, 1)))) for _ in range(400)]
    assert np.mean(np.array(p) < 0.5) == pytest.approx(0.5, abs=0.08)
    assert np.mean(np.array(p) < 0.01) <= 0.03


def test_an_answer_to_the_reference_is_seen() -> None:
    """One standard deviation for three seconds after each change, in its direction."""
    record, rng = recorded(1), np.random.default_rng(4)
    answer = np.zeros((ROWS, 2))
    for k, direction in ((1, -1.0), (2, 1.0), (3, -1.0)):
        first = int(30.0 * k / DT)
        answer[first + 1 : first + 30, 1] = direction
    p = reference_p(DECLARED, [record], with_innovations(answer + rng.standard_normal((ROWS, 2))))
    assert p is not None
    assert p < 1e-6


def test_innovations_in_other_pieces_than_the_records_are_not_tested() -> None:
    assert reference_p(DECLARED, [recorded(1)], with_innovations(np.zeros((ROWS + 1, 1)))) is None


def test_a_declared_loop_needs_no_test() -> None:
    still = Record.from_arrays("still", TIME, {"delta": 0.0 * TIME, "psi": TIME, "psi_ref": 0.0 * TIME})
    assert not loop_evidence([still], None).is_closed
    assert closed_loop(loop_evidence([still], None), None, None) is None
    evidence = loop_evidence([still], Feedback(input="delta", output="psi", reference="psi_ref"))
    assert evidence.runs == ("still",)
    loop = closed_loop(evidence, None, None)
    assert loop is not None
    assert (loop.is_declared, loop.correlation, loop.reference, loop.reference_steps) == (True, None, "psi_ref", 0)


def test_a_disturbance_model_needs_fifty_samples() -> None:
    refuse_short_runs([recorded(1)])
    with pytest.raises(InputError) as caught:
        refuse_short_runs([recorded(1).rows(slice(0, 49))])
    assert str(caught.value) == (
        "a disturbance model needs a run of at least 50 samples, and the longest one, 'run', has 49; record longer, or "
        'write method = "output-error" under [estimate]'
    )
