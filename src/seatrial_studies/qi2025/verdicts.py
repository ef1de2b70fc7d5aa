"""Claims of the paper with their evidence, and checks of our own numbers."""

import numpy as np

from seatrial.core.results import Check, Claim
from seatrial_studies.qi2025 import judged_method, judged_print, judged_searches
from seatrial_studies.qi2025.evidence import Evidence, below
from seatrial_studies.qi2025.published import Algorithm, misprinted, printed_means
from seatrial_studies.qi2025.repetition import Setting

TIMES_PRINTED, ON_BOUND, MISPRINTS, EXACT, FASTER, CONTINUOUS = 3.0, 0.5, 6, 1e-9, 50.0, 0.1
RATIO = (0.7, 1.3)


def claims(seen: Evidence) -> tuple[Claim, ...]:
    """Each with what it rests on."""
    return (*judged_searches.claims(seen), *judged_print.claims(seen), *judged_method.claims(seen))


def checks(seen: Evidence) -> tuple[Check, ...]:
    """Ours; each can fail."""
    return (*_searches(seen), *_ours(seen))


def _searches(seen: Evidence) -> list[Check]:
    found = [
        _at_most(
            f"IWHO's error of the mean of ten at {h} deg, median of {len(again)} tens, %",
            100.0 * float(np.median(again)),
            TIMES_PRINTED * printed,
        )
        for (h, again), printed in zip(seen.made.tens.items(), printed_means(), strict=True)
    ]
    share = seen.at_lower(Setting.CARRIED, Algorithm.WHO)
    name = "WHO's values on the lower bound, candidates from the model's own state, share"
    wrong = len(misprinted())
    return [
        *found,
        Check(name, share, f"at least {ON_BOUND:g}", share >= ON_BOUND),
        Check("printed errors that do not recompute", wrong, f"{MISPRINTS}", wrong == MISPRINTS),
    ]


def _ours(seen: Evidence) -> list[Check]:
    entries = sum(below(np.mean(np.abs(o.exact), axis=0), h) for h, o in seen.own.items())
    ratio = seen.seconds(Algorithm.IWHO) / seen.own_seconds
    size = float(np.sqrt(np.mean([o.ratio**2 for o in seen.own.values()])))
    return [
        Check("ours below IWHO's printed errors, noise-free, of 24", entries, "24", entries == 24),
        _at_most(
            "our largest relative error, noise-free",
            max(float(np.max(np.abs(o.exact))) for o in seen.own.values()),
            EXACT,
        ),
        _at_most(
            "our largest bias in continuous waves, noise-free, %",
            max(100.0 * float(np.max(np.abs(b.fine))) for b in seen.bias.values()),
            CONTINUOUS,
        ),
        Check("IWHO's time over ours", ratio, f"at least {FASTER:g}", ratio >= FASTER),
        Check(
            "our errors in noise over the Cramer-Rao bound",
            size,
            f"{RATIO[0]} to {RATIO[1]}",
            RATIO[0] <= size <= RATIO[1],
        ),
    ]


def _at_most(name: str, value: float, limit: float) -> Check:
    return Check(name, value, limit, bool(value <= limit))
