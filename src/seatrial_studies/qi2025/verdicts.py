"""Claims of the paper with their evidence, and checks of our own numbers."""

import numpy as np

from seatrial.core.results import Check, Claim
from seatrial_studies.qi2025 import method_claims, print_claims, search_claims
from seatrial_studies.qi2025.evidence import WildHorseEvidence, count_below_printed
from seatrial_studies.qi2025.published import SearchAlgorithm, misprinted_errors, printed_mean_errors
from seatrial_studies.qi2025.reproduction import SearchSetting

PRINTED_ERROR_FACTOR, ON_BOUND_SHARE, MISPRINT_COUNT, EXACT_ERROR, LEAST_TIME_RATIO, HOLD_BIAS_PERCENT = (
    3.0,
    0.5,
    6,
    1e-9,
    50.0,
    0.1,
)
BOUND_RATIO_RANGE = (0.7, 1.3)


def claims(evidence: WildHorseEvidence) -> tuple[Claim, ...]:
    """Return the claims, each with its evidence."""
    return (*search_claims.claims(evidence), *print_claims.claims(evidence), *method_claims.claims(evidence))


def checks(evidence: WildHorseEvidence) -> tuple[Check, ...]:
    """Return the checks of our own numbers; each can fail."""
    return (*_search_checks(evidence), *_output_error_checks(evidence))


def _search_checks(evidence: WildHorseEvidence) -> list[Check]:
    found = [
        _check_at_most(
            f"IWHO's error of the mean of ten at {h} deg, median of {len(again)} tens, %",
            100.0 * float(np.median(again)),
            PRINTED_ERROR_FACTOR * printed,
        )
        for (h, again), printed in zip(evidence.reproduction.ten_run_errors.items(), printed_mean_errors(), strict=True)
    ]
    share = evidence.share_at_lower_bound(SearchSetting.MODEL_STATE, SearchAlgorithm.WHO)
    name = "WHO's values on the lower bound, candidates from the model's own state, share"
    wrong = len(misprinted_errors())
    return [
        *found,
        Check(name, share, f"at least {ON_BOUND_SHARE:g}", share >= ON_BOUND_SHARE),
        Check("printed errors that do not recompute", wrong, f"{MISPRINT_COUNT}", wrong == MISPRINT_COUNT),
    ]


def _output_error_checks(evidence: WildHorseEvidence) -> list[Check]:
    entries = sum(
        count_below_printed(np.mean(np.abs(o.noise_free_errors), axis=0), h) for h, o in evidence.output_error.items()
    )
    ratio = evidence.search_seconds(SearchAlgorithm.IWHO) / evidence.output_error_seconds
    size = float(np.sqrt(np.mean([o.error_over_bound**2 for o in evidence.output_error.values()])))
    return [
        Check("ours below IWHO's printed errors, noise-free, of 24", entries, "24", entries == 24),
        _check_at_most(
            "our largest relative error, noise-free",
            max(float(np.max(np.abs(o.noise_free_errors))) for o in evidence.output_error.values()),
            EXACT_ERROR,
        ),
        _check_at_most(
            "our largest bias in continuous waves, noise-free, %",
            max(100.0 * float(np.max(np.abs(b.fine))) for b in evidence.hold_bias.values()),
            HOLD_BIAS_PERCENT,
        ),
        Check("IWHO's time over ours", ratio, f"at least {LEAST_TIME_RATIO:g}", ratio >= LEAST_TIME_RATIO),
        Check(
            "our errors in noise over the Cramer-Rao bound",
            size,
            f"{BOUND_RATIO_RANGE[0]} to {BOUND_RATIO_RANGE[1]}",
            BOUND_RATIO_RANGE[0] <= size <= BOUND_RATIO_RANGE[1],
        ),
    ]


def _check_at_most(name: str, value: float, limit: float) -> Check:
    return Check(name, value, limit, bool(value <= limit))
