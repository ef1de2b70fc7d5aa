"""Windows of held-out runs on the page: their scores next to predictions that need no fit."""

from collections.abc import Sequence

from seatrial.core.results import Fit, Prediction, WindowScore
from seatrial.core.results.prediction import ChannelScore
from seatrial.core.text.numbers import DASH, fixed, significant
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.reporting.text_tables import TextTable

WINDOW_NOTE = (
    "Errors in windows: root-mean-square errors open loop, each window from the state estimated in its first seconds. "
    "Fit in windows: 100 % less the error over the spread about the mean (NRMSE, as MATLAB's compare): 100 is perfect, "
    "0 no better than the mean; in brackets R², one less the squares of the errors over those about the mean."
)
"""How the tables of windows are to be read, once for all runs."""


def window_tables(
    prediction: Prediction, labels: dict[str, tuple[str, str]], factors: dict[str, float]
) -> list[TextTable]:
    """Return errors and fit for each length of windows; labels: score -> name, unit; factors: to that, 1 if absent."""
    tables = []
    for w in prediction.windows:
        header = ("this fit", *(b.name for b in w.baselines))
        tables += [_errors(w, header, labels, factors), _fits(w, header, labels)]
    return tables


def _scores(w: WindowScore, channel: str) -> list[ChannelScore | None]:
    """Scores of the fit and of each baseline; None where it does not predict the channel."""
    return [w.scores[channel], *(b.scores.get(channel) for b in w.baselines)]


def _errors(
    w: WindowScore, header: tuple[str, ...], labels: dict[str, tuple[str, str]], factors: dict[str, float]
) -> TextTable:
    rows = []
    for name, own in w.scores.items():
        texts = [DASH if s is None else significant(s.rms * factors.get(name, 1.0), 3) for s in _scores(w, name)]
        share = DASH if own.inside_band is None else f"{fixed(100.0 * own.inside_band, 0)} %"
        share += " (too wide to test)" if own.is_band_too_wide else ""
        rows.append((f"{labels[name][0]}, {labels[name][1]}", *texts, share))
    columns = ("", *header, "inside 95 % band")
    lost = f"; {w.divergence_text}" if w.diverged else ""
    title = f"{counted(w.count, 'window')} of {w.window}{lost}"
    return TextTable(title, columns, (False, *(True for _ in columns[1:])), tuple(rows), "")


def _fits(w: WindowScore, header: tuple[str, ...], labels: dict[str, tuple[str, str]]) -> TextTable:
    rows = tuple(
        (
            labels[name][0],
            *(DASH if s is None else f"{fixed(s.fit_percent, 1)} ({fixed(s.r_squared, 3)})" for s in _scores(w, name)),
        )
        for name in w.scores
    )
    numeric = (False, *(True for _ in header))
    return TextTable(f"Fit in windows of {w.window}, % (R²)", ("", *header), numeric, rows, "")


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
