"""The page of a designed manoeuvre: its precision compared with standard ones, its orders, its track."""

import math
from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.equations.latex import latex_symbol
from seatrial.core.figures.run import RunView
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Actuator, Design, ManoeuvrePrecision
from seatrial.core.results.design import (
    best_baseline,
    criterion_error,
    has_drift,
    has_track,
    is_within_limits,
    ranked_baselines,
    sampled_criterion_errors,
)
from seatrial.core.text.numbers import DASH, exact, fixed, significant
from seatrial.core.values import NOTATION, Record
from seatrial.core.values.notation import reading_order
from seatrial.core.values.record_chart import channel_panels, is_constant
from seatrial.data.folder.gains_file import channel_display_unit, order_cells
from seatrial.reporting import design_text
from seatrial.reporting.design_text import LARGEST_SHOWN_ERROR
from seatrial.reporting.document import page_text
from seatrial.reporting.figures.designed_manoeuvre import order_view, track_chart
from seatrial.reporting.figures.relative_errors import FILLED, OPEN, TICK, ErrorSeries, error_chart
from seatrial.reporting.finding_chapter import finding_section
from seatrial.reporting.first_screen import FirstScreen
from seatrial.reporting.mathml import inline
from seatrial.reporting.measures import manoeuvre_name
from seatrial.reporting.time_figures import run_figure

TITLES = {
    "orders": "Orders: the helmsman’s card",
    "manoeuvres": "Compared with standard manoeuvres",
    "coefficients": "Precision of each coefficient",
    "ships": "Ships that differ from the assumed one",
    "confirmation": "Simulated trials",
    "findings": "Findings",
    "method": "Method and provenance",
}
# columns of orders side by side, rows from which there is a second one, baselines in the table
MAX_COLUMNS, MIN_COLUMN_ROWS, MAX_BASELINES = 4, 12, 3


@dataclass(frozen=True)
class ManoeuvreRow:
    """One manoeuvre as text, errors in per cent."""

    name: str
    worst: str
    mean: str
    worst_over_draws: str
    drift: str
    distance: str
    is_designed: bool
    is_within_limits: bool


@dataclass(frozen=True)
class DesignCoefficientRow:
    """One coefficient: relative standard errors [%] of design and baselines; error of simulated fits and its bound."""

    symbol: Markup
    name: str
    value: str
    spread: str
    designed: str
    baselines: tuple[str, ...]
    simulated_error: str
    predicted_error: str


def html(design: Design) -> str:
    """Return the page as text; sections without content are left out."""
    baselines = ranked_baselines(design)
    has_content = {
        "ships": bool(len(design.designed.sampled_relative_error)),
        "confirmation": design.confirmation is not None,
        "findings": bool(design.findings),
    }
    context: dict[str, object] = {
        "design": design,
        "titles": {key: title for key, title in TITLES.items() if has_content.get(key, True)},
        "screen": _first_screen(design),
        "order_warnings": design_text.order_warnings(design),
        "facts": design_text.facts(design),
        "settings": design_text.settings(design),
        "manoeuvres": [_manoeuvre_row(w, design) for w in (design.designed, *baselines)],
        "heads": order_headings(design.actuators),
        "meanings": order_meanings(design.actuators),
        "order_columns": order_columns(design),
        "channels": _all_channels(design.designed.executed),
        "has_track": has_track(design),
        "has_drift": has_track(design) and has_drift(design),
        "baselines": [manoeuvre_name(w.name) for w in baselines[:MAX_BASELINES]],
        "coefficients": _coefficient_rows(design, baselines[:MAX_BASELINES]),
        "speed": _speed_option(design),
        "errors": Markup(_errors_figure(design)),
        "ships": Markup(_drawn_ships_figure(design, baselines)),
        "findings": finding_section(design.findings),
    }
    return page_text("design.html", context)


def _first_screen(design: Design) -> FirstScreen:
    """How precise the manoeuvre is; its track within the sea room and its orders over time."""
    figure = run_figure(order_view(design), is_wide=True, track=track_chart(design) if has_track(design) else None)
    room = " Dashed on the track: sea room about the start." if math.isfinite(design.limits.sea_room) else ""
    drift = (
        " Drift is positive when the bow points to starboard of the course."
        if has_track(design) and has_drift(design)
        else ""
    )
    ships = "; ships at equal times, to scale" if has_track(design) else ""
    caption = f"The ship as assumed{ships}.{room}{drift}"
    return FirstScreen(design_text.verdict(design), design_text.key_facts(design), figure, caption)


def _all_channels(executed: Record) -> Markup:
    """Every channel that moves, over time."""
    names = [name for name in reading_order(list(executed.channels)) if not is_constant(executed, name)]
    return run_figure(RunView("all channels", channel_panels(executed, names))) if names else Markup()


def percent_text(share: float) -> str:
    """Return per cent with two digits; beyond the largest shown error only that it is larger."""
    if math.isnan(share) or share < LARGEST_SHOWN_ERROR:
        return significant(100.0 * share, 2)
    return f"> {significant(100.0 * LARGEST_SHOWN_ERROR, 1)}"


def minutes_seconds(seconds: float) -> str:
    """Return minutes and seconds: ``2:05``, ``0:07.5``."""
    minutes, rest = divmod(round(seconds, 2), 60.0)  # s of a minute
    return f"{int(minutes)}:{exact(rest, 4).rjust(2, '0') if rest >= 10 else '0' + exact(rest, 4)}"


def order_headings(actuators: tuple[Actuator, ...]) -> list[tuple[Markup, str]]:
    """Return symbol and unit of each column of the helmsman's table after the time."""
    return [(Markup(inline(_latex(a.name))), channel_display_unit(a.name)[1]) for a in actuators]


def order_meanings(actuators: tuple[Actuator, ...]) -> list[tuple[Markup, str]]:
    """Return symbol and meaning of each input, with its positive direction."""
    return [(Markup(inline(_latex(a.name))), design_text.order_meaning(a.name)) for a in actuators]


def _latex(name: str) -> str:
    return NOTATION[name].latex if name in NOTATION else latex_symbol(name)


def order_columns(design: Design) -> list[list[list[str]]]:
    """Return the helmsman's table cut into columns that stand side by side: minutes and seconds, then the orders."""
    rows = []
    for order in design.orders:
        cells = [cell.replace("-", "−") or DASH for cell in order_cells(order, design.actuators)[1:]]
        rows.append([minutes_seconds(order.time), *cells])
    count = min(MAX_COLUMNS, max(1, math.ceil(len(rows) / MIN_COLUMN_ROWS)))
    each = math.ceil(len(rows) / count) if rows else 1
    return [rows[k : k + each] for k in range(0, len(rows), each)]


def _speed_option(design: Design) -> str:
    """The option of `simulate` that starts a replay as the design did; empty for a model without surge."""
    executed = design.designed.executed
    return f" --speed {float(executed['u'][0]):.7g}" if design.model.has_speed and "u" in executed else ""


def _manoeuvre_row(manoeuvre: ManoeuvrePrecision, design: Design) -> ManoeuvreRow:
    return ManoeuvreRow(
        manoeuvre_name(manoeuvre.name),
        percent_text(manoeuvre.worst),
        percent_text(manoeuvre.mean),
        percent_text(manoeuvre.worst_sampled_error),
        fixed(math.degrees(manoeuvre.drift), 1) if math.isfinite(manoeuvre.drift) else DASH,
        significant(manoeuvre.distance, 3),
        manoeuvre is design.designed,
        is_within_limits(manoeuvre, design.limits),
    )


def _coefficient_rows(design: Design, baselines: tuple[ManoeuvrePrecision, ...]) -> list[DesignCoefficientRow]:
    confirmation = design.confirmation
    return [
        DesignCoefficientRow(
            Markup(inline(design.model.parameters[name].latex or latex_symbol(name))),
            name,
            significant(design.model.parameters[name].value, 4),
            percent_text(float(design.relative_spread[i])),
            percent_text(float(design.designed.relative_error[i])),
            tuple(percent_text(float(w.relative_error[i])) for w in baselines),
            percent_text(float(confirmation.error[i])) if confirmation else "",
            percent_text(float(confirmation.bound[i])) if confirmation else "",
        )
        for i, name in enumerate(design.coefficients)
    ]


def _errors_figure(design: Design) -> str:
    """Dots for each coefficient: the design and the best standard manoeuvre."""
    best = best_baseline(design)
    series = []
    if best:
        series.append(ErrorSeries(manoeuvre_name(best.name), [[100.0 * float(x)] for x in best.relative_error], OPEN))
    series.append(ErrorSeries("designed", [[100.0 * float(x)] for x in design.designed.relative_error], FILLED))
    return svg(error_chart(design.coefficients, series, "relative standard error, per cent of the coefficient"))


def _drawn_ships_figure(design: Design, baselines: tuple[ManoeuvrePrecision, ...]) -> str:
    """A row for each manoeuvre, a dot for each ship drawn from the prior."""
    manoeuvres, criterion = (design.designed, *baselines), design.criterion
    sampled = [[100.0 * x for x in sampled_criterion_errors(w, criterion)] for w in manoeuvres]
    assumed = [[100.0 * criterion_error(w, criterion)] for w in manoeuvres]
    series = [
        ErrorSeries("ships drawn from the prior", sampled, OPEN),
        ErrorSeries("the ship as assumed", assumed, TICK),
    ]
    axis_name = f"{'worst' if criterion == 'worst' else 'mean'} relative standard error, per cent"
    return svg(error_chart([manoeuvre_name(w.name) for w in manoeuvres], series, axis_name))
