"""Held-out runs that repeat a trained manoeuvre: same kind, same orders, same speed, by what the runs show."""

from collections.abc import Sequence

from seatrial.core.results import Prediction
from seatrial.core.text.words import enumeration
from seatrial.physics.manoeuvres import steered_orders

MAX_NAMES = 3  # of runs that a sentence holds; chosen


def repeated_runs(p: Prediction, predictions: Sequence[Prediction]) -> list[str]:
    """Return the names of the training runs whose manoeuvre a held-out run repeats."""
    orders = steered_orders(p.measured)
    if orders is None:
        return []
    trained = (
        (prediction.record, steered_orders(prediction.measured))
        for prediction in predictions
        if prediction.role == "training"
    )
    return [name for name, other in trained if other is not None and orders.is_repeated_by(other)]


def repeat_clause(p: Prediction, predictions: Sequence[Prediction]) -> str:
    """Return which trained manoeuvre a held-out run repeats, and what that leaves open; empty where it repeats none."""
    names = repeated_runs(p, predictions)
    if not names:
        return ""
    were = "which was" if len(names) == 1 else "which were"
    return f"a repeat of {enumeration(names, MAX_NAMES)}, {were} fitted: it does not test other manoeuvres"
