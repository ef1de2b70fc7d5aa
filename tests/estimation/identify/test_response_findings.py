"""A model whose frequency response lies outside that of the records at most frequencies is named."""

from dataclasses import replace

import numpy as np
from tests.reporting.fabricated import fabricated_fit

from seatrial.estimation.identify.warnings import response_findings
from seatrial.estimation.information.frequency_response import frequency_responses


def test_a_response_that_misses_most_frequencies_is_named_with_their_number() -> None:
    fit = fabricated_fit()
    (own, *_) = [r for r in frequency_responses(fit.model, fit.predictions, ("r",)) if r.input == "delta"]
    own = replace(own, simulated=own.measured)
    assert response_findings([own]) == response_findings([]) == ()
    wrong = replace(own, simulated=3.0 * np.asarray(own.measured))
    (finding,) = response_findings([own, wrong])
    compared = int(own.is_compared.sum())
    assert finding.code == "frequency-response" and compared >= 5
    assert f"r over delta at {compared} of {compared} frequencies" in finding.message
