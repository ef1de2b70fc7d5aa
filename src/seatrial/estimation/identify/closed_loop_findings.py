"""What to warn of where a controller was on while the training runs were recorded."""

from collections.abc import Iterator

from seatrial.core.results.coefficients import REFERENCE_LEVEL, FeedbackEvidence
from seatrial.core.text.numbers import p_value, significant
from seatrial.core.values import Finding, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.process_noise import has_noise

LEAST_AGREEMENT = 0.5
"""Correlation of a declared controller's orders with the input below which they contradict each other; chosen."""


def closed_loop_findings(estimation: Estimation) -> list[Finding]:
    """Return warnings of a closed loop that is fitted by output error, and of declarations that do not agree."""
    loop = estimation.noise_model.closed_loop
    if loop is None:
        return []
    findings = list(_contradictions(loop))
    if not estimation.has_process_noise and has_noise(estimation.estimate):
        was_compared = bool(estimation.noise_model.candidates)
        advice = (
            "runs left out decided for it; use the coefficients for predictions under the same controller"
            if was_compared
            else 'write method = "auto" under [estimate], without robust and segment_s, so that prediction error is '
            "compared with it"
        )
        findings.append(Finding(Severity.WARNING, "closed-loop", f"'{loop.input}' follows '{loop.output}', and the "
                                f"criterion is {estimation.criterion}: disturbances that are answered count as the "
                                "craft's own response", "", advice))  # fmt: skip
    return findings


def _contradictions(loop: FeedbackEvidence) -> Iterator[Finding]:
    if loop.reference_p is not None and loop.reference_p < REFERENCE_LEVEL:
        yield Finding(Severity.WARNING, "reference-residual", "the innovations follow earlier changes of the "
                      "reference, as those of a true model do not: model error, which the intervals do not cover",
                      p_value(loop.reference_p), "free more coefficients, allow for a delay of the input under "
                      "[estimate] delays, or take a richer model")  # fmt: skip
    agreement = loop.controller_correlation
    if agreement is not None and agreement < LEAST_AGREEMENT:
        yield Finding(Severity.WARNING, "controller-mismatch", f"'{loop.input}' is not what the declared controller "
                      "orders", f"correlation {significant(agreement, 2)}", "correct sign, gains or reference under "
                      "[feedback], or name the runs in which it was on with runs = [...]")  # fmt: skip
