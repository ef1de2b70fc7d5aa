"""Windows of held-out runs on the page: their scores next to predictions that need no fit."""

from collections.abc import Sequence

from seatrial.core.results import Fit, Prediction
from seatrial.core.text.words import enumeration, sentence

WINDOW_NOTE = (
    "Errors in windows: root-mean-square errors open loop, each window from the state estimated in its first seconds. "
    "Fit in windows: 100 % less the error over the spread about the mean (NRMSE, as MATLAB's compare): 100 is perfect, "
    "0 no better than the mean. In brackets R², one less the squares of the errors over those about the mean."
)
"""How the tables of windows are to be read, once for all runs."""


def shortest_judged(fit: Fit) -> float:
    """Return the s of windows from which on a better prediction without the fit speaks against it.

    Of roll its natural period: over less, the motion goes on as it began, and any smooth curve predicts it.
    """
    return fit.roll.natural_period.value if fit.roll is not None else 0.0


def baseline_sentence(
    predictions: Sequence[Prediction], labels: dict[str, tuple[str, str]], shortest: float = 0.0
) -> str:
    """Return in which windows the model diverges, and which runs predictions without this fit predict better.

    shortest: s of the windows that are compared, at least.
    """
    clauses, lost = [], []
    for p in predictions:
        for w in p.windows:
            if w.diverged:
                lost.append(f"{p.record}, windows of {w.window}: {w.divergence_text}")
            better = [f"{labels[name][0]} by {baseline}" for name, baseline in w.better_baselines.items()]
            if better and w.seconds >= shortest:
                clauses.append(f"{p.record} in windows of {w.window}: {enumeration(better)}")
    sentences = [f"{sentence('; '.join(lost))}"] if lost else []
    if clauses:
        sentences.append(
            f"Predictions without this fit are better in places, so do not rely on it there: {'; '.join(clauses)}."
        )
    return " ".join(sentences)
