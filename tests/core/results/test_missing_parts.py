"""A part that cannot be computed is a finding; the other parts stay."""

import numpy as np

from seatrial.core.results.fields import MissingParts
from seatrial.core.values import InputError


def test_what_cannot_be_computed_is_said_and_replaced() -> None:
    def refused() -> str:
        raise InputError("the table ends at 2.3 rad/s")

    parts = MissingParts()
    assert parts.computed("the motions in waves", refused, "") == ""
    assert parts.computed("the inverse", lambda: float(np.linalg.inv(np.zeros((2, 2)))[0, 0]), 0.0) == 0.0
    assert parts.computed("the mean", lambda: 3.0, 0.0) == 3.0
    first, second = parts.findings
    assert first.code == "part-missing"
    assert first.text == (
        "the result is without the motions in waves, which could not be computed (the table ends at 2.3 rad/s)"
    )
    assert second.evidence == "LinAlgError: Singular matrix"
