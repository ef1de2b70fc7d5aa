"""Two fits compared: coefficients, manoeuvres, and what else changed."""

from typing import TYPE_CHECKING

from seatrial.core.values import InputError

if TYPE_CHECKING:
    from seatrial.core.results import Comparison, Fit
    from seatrial.core.results.comparison import ManoeuvreDifferences
    from seatrial.core.values import ProgressReporter
    from seatrial.estimation.information.covariance import QuantityInterval

MANOEUVRES = ("turning-circle:35", "turning-circle:35:port", "zigzag:10/10", "zigzag:20/20")
"""Manoeuvres that are compared where none are named: those of IMO MSC.137(76)."""


def compare(
    first: "Fit",
    second: "Fit",
    *,
    names: tuple[str, str] = ("first", "second"),
    manoeuvres: tuple[str, ...] = MANOEUVRES,
    speed: float | None = None,
    report_progress: "ProgressReporter | None" = None,
) -> "Comparison":
    """Compare two fits: differences of coefficients and of manoeuvres with intervals, and what else changed.

    The intervals count the errors of both fits as independent; fits that share records are compared with a warning.

    Args:
        names: of both, for tables and page.
        manoeuvres: e.g. ``zigzag:20/20``; those that a model cannot be steered through are left out with a note.
        speed: approach speed of both, m/s; without it each fit's own approach condition.

    Raises:
        InputError: the fits have neither a coefficient nor a manoeuvre in common.
    """
    from seatrial.core.results.comparison import Comparison
    from seatrial.core.values.versions import versions
    from seatrial.estimation.identify.fit_result import changes, coefficient_differences, compared_fit, findings

    report = report_progress or (lambda _: None)
    rows, test = coefficient_differences(first, second)
    steered = [m for m in manoeuvres if _is_steered(first) and _is_steered(second)]
    compared = []
    for number, manoeuvre in enumerate(steered, 1):
        report(f"manoeuvres: {number} of {len(steered)}, {manoeuvre}")
        compared.append(_manoeuvre(first, second, manoeuvre, speed))
    if not rows and not any(m.measures for m in compared):
        raise InputError(
            f"{names[0]} is a {first.model.name} and {names[1]} a {second.model.name} model: they have neither free "
            "coefficients nor manoeuvres in common; compare fits of one ship"
        )
    return Comparison(
        compared_fit(first, names[0]), compared_fit(second, names[1]), changes(first, second), rows, test,
        tuple(compared), findings(first, second), versions(),
    )  # fmt: skip


def _is_steered(fit: "Fit") -> bool:
    from seatrial.physics.simulate.thrust import is_steered_by_angle

    return is_steered_by_angle(fit.model)


def _manoeuvre(first: "Fit", second: "Fit", manoeuvre: str, speed: float | None) -> "ManoeuvreDifferences":
    """Both models steered through a manoeuvre, and the measures that both show."""
    from seatrial.core.results.comparison import ManoeuvreDifferences
    from seatrial.estimation.information.covariance import differences
    from seatrial.physics.manoeuvres.measures import ORDERED_MEASURE

    try:
        both = [_measured(fit, manoeuvre, speed) for fit in (first, second)]
    except InputError as error:
        return ManoeuvreDifferences(manoeuvre, (), str(error))
    shared = [name for name in both[0] if name in both[1] and name != ORDERED_MEASURE]
    first_values, second_values = ([one[name] for name in shared] for one in both)
    return ManoeuvreDifferences(manoeuvre, differences(first_values, second_values))


def _measured(fit: "Fit", manoeuvre: str, speed: float | None) -> "dict[str, QuantityInterval]":
    """Measure -> value and ends of its interval."""
    from seatrial.api.prediction import measure_intervals, measures
    from seatrial.api.simulation import as_model_file, steering
    from seatrial.estimation.information.covariance import QuantityInterval

    file = as_model_file(fit)
    steer = steering(file, manoeuvre, speed=speed)
    values, intervals = measures(file, steer(file.model)), measure_intervals(file, steer)
    ends = {name: intervals.get(name) or (None, None) for name in values}
    return {name: QuantityInterval(name, "", value, *ends[name]) for name, value in values.items()}
