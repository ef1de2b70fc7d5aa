"""Errors of runs on the terminal: under the names and in the units of the report, angles in degrees."""

import math
from collections.abc import Mapping

ERROR_DIGITS = 3  # significant ones of an error; chosen


def errors_text(rms: Mapping[str, float]) -> str:
    """Return errors with their names and units, ``heading 1.2 deg, r 0.3 deg/s``; rms as in `Prediction.rms`."""
    texts = []
    for key, value in rms.items():
        label, unit = label_and_unit(key)
        texts.append(f"{label} {error_text(key, value)} {unit}")
    return ", ".join(texts)


def label_and_unit(key: str) -> tuple[str, str]:
    """Return how the report names an error of `Prediction.rms`, or a measure, and the unit in which it is shown."""
    from seatrial.reporting.grades import ERROR_LABELS
    from seatrial.reporting.measures import measure_label

    return ERROR_LABELS[key] if key in ERROR_LABELS else measure_label(key)


def quantity_label(name: str) -> str:
    """Return name and unit of a measure: ``advance, L``."""
    from seatrial.reporting.measures import measure_label

    return ", ".join(part for part in measure_label(name) if part)


def corrected_label(name: str) -> str:
    """Return name and unit of a measure of a run that is corrected for the current: ``advance, L``."""
    from seatrial.reporting.measures import bare_measure_label

    return ", ".join(part for part in bare_measure_label(name) if part)


def simulated_label(name: str) -> str:
    """Return name and unit of a measure of a simulated manoeuvre: ``advance in still water, L``."""
    from seatrial.reporting.measures import simulated_measure_label

    return ", ".join(part for part in simulated_measure_label(name) if part)


def error_text(key: str, value: float) -> str:
    """Return the number of an error of `Prediction.rms` in the unit of `label_and_unit`."""
    from seatrial.core.text.numbers import exact

    return exact(math.degrees(value) if key == "r" else value, ERROR_DIGITS)
