"""Windows of held-out runs on the page: their scores next to predictions that need no fit."""

from collections.abc import Sequence

from seatrial.core.results import Prediction, WindowScore
from seatrial.core.text.numbers import DASH, fixed, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.reporting.text_tables import TextTable

_NOTE = (
    "Root-mean-square errors open loop, each window from the state estimated in its first seconds. Fit: 100 % less the "
    "error over the spread about the mean (NRMSE, as MATLAB's compare)."
)


def window_tables(
    prediction: Prediction, labels: dict[str, tuple[str, str]], factors: dict[str, float]
) -> list[TextTable]:
    """Return a table for each length of windows; labels: score -> name and unit; factors: to that unit, 1 if absent."""
    return [_table(w, labels, factors) for w in prediction.windows]


def _table(w: WindowScore, labels: dict[str, tuple[str, str]], factors: dict[str, float]) -> TextTable:
    header = ("", "this fit", *(b.name for b in w.baselines), "fit %", "R²", "inside 95 % band")
    rows = []
    for name, s in w.scores.items():
        errors = (s.rms, *(b.rms.get(name) for b in w.baselines))
        texts = [DASH if e is None else significant(e * factors.get(name, 1.0), 3) for e in errors]
        share = DASH if s.inside_band is None else f"{fixed(100.0 * s.inside_band, 0)} %"
        rows.append(
            (f"{labels[name][0]}, {labels[name][1]}", *texts, fixed(s.fit_percent, 1), fixed(s.r_squared, 3), share)
        )
    numeric = (False, *(True for _ in header[1:]))
    return TextTable(f"{counted(w.count, 'window')} of {w.window}", header, numeric, tuple(rows), _NOTE)


def baseline_sentence(predictions: Sequence[Prediction], labels: dict[str, tuple[str, str]]) -> str:
    """Return which runs a prediction without this fit predicts better, and in what; empty where none does."""
    clauses = []
    for p in predictions:
        for w in p.windows:
            better = [f"{labels[name][0]} by {baseline}" for name, baseline in w.better_baselines.items()]
            if better:
                clauses.append(f"{p.record} in windows of {w.window}: {enumeration(better)}")
    if not clauses:
        return ""
    return f"Predictions without this fit are better in places, so do not rely on it there: {'; '.join(clauses)}."
