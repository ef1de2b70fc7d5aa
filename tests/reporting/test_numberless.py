"""No page or sentence of a tuning or a verification prints a number that there is not."""

import math
import re
from collections.abc import Callable

import pytest
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_fin
from tests.reporting.numberless import numberless
from tests.reporting.test_verification import LEGS, TURNS

from seatrial.core.results.tuning import Tuning
from seatrial.core.results.verification import Verification
from seatrial.reporting import tuning, tuning_text, verification
from seatrial.reporting import verification as verification_text

TUNINGS = {"fin": fabricated_fin, "autopilot": fabricated_autopilot}


def texts_of(result: Tuning | Verification) -> str:
    """Return page, verdict and key facts."""
    if isinstance(result, Tuning):
        facts, verdict, page = tuning_text.key_facts(result), tuning_text.verdict(result), tuning.html(result)
    else:
        facts, verdict = verification_text.key_facts(result), verification_text.verdict(result)
        page = verification.html(result)
    return " ".join([verdict, *(fact.text for fact in facts), page])


def fields_printed(result: Tuning | Verification, number: float) -> list[str]:
    """Return the fields without which a text prints nan or inf."""
    return [name for name, made in numberless(result, number) if re.search(r"(?<![\w.-])-?(nan|inf)\b", texts_of(made))]


@pytest.mark.long(every=2)
@pytest.mark.parametrize("number", [math.nan, math.inf])
@pytest.mark.parametrize("result", [LEGS, TURNS], ids=["legs", "changes"])
def test_no_verification_prints_what_is_unknown(result: Verification, number: float) -> None:
    assert fields_printed(result, number) == []


@pytest.mark.long(every=2)
@pytest.mark.parametrize("number", [math.nan, math.inf])
@pytest.mark.parametrize("make", list(TUNINGS.values()), ids=list(TUNINGS))
def test_no_tuning_prints_what_is_unknown(make: Callable[[], Tuning], number: float) -> None:
    assert fields_printed(make(), number) == []
