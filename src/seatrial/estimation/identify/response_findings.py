"""A warning where the model's frequency response leaves the region of the records' own."""

from collections.abc import Iterator, Sequence

from seatrial.core.results.ship_motions import FrequencyResponse
from seatrial.core.text.words import enumeration
from seatrial.core.values import Finding, Severity

# frequencies compared from which on a response is judged, and share of them inside the 95 % region below which it is
# named; chosen: chance leaves 95 % inside, and half outside are no longer a matter of estimators
_FEWEST_COMPARED, _LEAST_INSIDE = 5, 0.5


def response_findings(responses: Sequence[FrequencyResponse]) -> tuple[Finding, ...]:
    """Return a warning `frequency-response` with the responses of which the model misses more than half."""
    texts = list(_missed(responses))
    if not texts:
        return ()
    return (Finding(
        Severity.WARNING, "frequency-response", f"the model lies outside the 95 % region of the records in "
        f"{enumeration(texts, len(texts))} frequencies", "",
        "look at which frequencies it misses: coefficients that change with frequency, or forces of the wrong size",
        "intervals of coefficients do not cover this error",
    ),)  # fmt: skip


def _missed(responses: Sequence[FrequencyResponse]) -> Iterator[str]:
    for r in responses:
        compared, inside = int(r.is_compared.sum()), int((r.is_inside & r.is_compared).sum())
        if compared >= _FEWEST_COMPARED and inside < _LEAST_INSIDE * compared:
            yield f"{r.output} over {r.input} at {compared - inside} of {compared}"
