"""The page and the terminal of a designed manoeuvre."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from markupsafe import Markup

from seatrial.core.equations.latex import latex_symbol
from seatrial.core.figures.run import RunView
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Actuator, Design, ManoeuvrePrecision
from seatrial.core.results.design import (
    best_baseline,
    count_outside_limits,
    criterion_error,
    has_drift,
    has_track,
    is_within_limits,
    ranked_baselines,
    sampled_criterion_errors,
)
from seatrial.core.text.numbers import DASH, duration, exact, fixed, significant
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import NOTATION, Record, Severity, display_unit
from seatrial.core.values.notation import channel_meaning, reading_order, unit_text
from seatrial.core.values.record_chart import channel_panels, is_constant
from seatrial.data.folder.gains_file import channel_display_unit, order_cells
from seatrial.reporting.document import chapters_page
from seatrial.reporting.figures.coefficient_charts import FILLED, OPEN, TICK, ErrorSeries, error_chart
from seatrial.reporting.figures.designed_manoeuvre import order_view, track_chart
from seatrial.reporting.mathml import inline
from seatrial.reporting.measures import manoeuvre_name
from seatrial.reporting.section import (
    Cell,
    Column,
    FirstScreen,
    Heading,
    KeyFact,
    Kind,
    Level,
    Picture,
    Row,
    Section,
    TextTable,
    fact_table,
    finding_section,
    formula,
    name,
    number,
    table_of,
    words,
)
from seatrial.reporting.time_figures import run_figure

# A designed manoeuvre in sentences: how much more precise it is, on how many ships, and within which limits.

# relative standard error from which on only its order is shown
LARGEST_SHOWN_ERROR = 100.0
_SIDES = ("port", "starboard")
_BEYOND = 3.0  # standard deviations by which an error may exceed the one predicted: one in a thousand does; chosen
_CRITERION_NAMES = {"worst": "worst relative standard error", "mean": "mean relative standard error"}


def verdict(design: Design) -> str:
    """Return how precise the manoeuvre is, compared with the best standard one."""
    return _comparison(design)


def key_facts(design: Design) -> tuple[KeyFact, ...]:
    """Return the rows at the top: ships that differ, simulated trials, limits, warnings."""
    is_kept = is_within_limits(design.designed, design.limits) and not count_outside_limits(
        design.designed, design.limits
    )
    rows = (
        KeyFact("Ships that differ", _prior_draws(design), "ships"),
        KeyFact("Simulated trials", _confirmation(design), "confirmation", _is_confirmed(design)),
        KeyFact("Limits", _limits(design), "orders", None if is_kept and design.designed.diverged else is_kept),
    )
    warned = [f.code for f in design.findings if f.severity is not Severity.INFO]
    warnings = KeyFact("Warnings", enumeration(warned) or "none", "findings" if design.findings else "", not warned)
    return (*(row for row in rows if row.text), warnings)


def order_meaning(name: str) -> str:
    """Return what an input is and where its orders count positive: ``rudder angle, positive to starboard``."""
    if name not in NOTATION or NOTATION[name].positive == "none":
        return channel_meaning(name)
    side = NOTATION[name].positive
    return f"{NOTATION[name].meaning}, positive {'to ' if side in _SIDES else ''}{side}"


def order_warnings(design: Design) -> list[str]:
    """Return what the helmsman must know beside the orders: limits that are left, and the checks' warnings."""
    is_left = has_track(design) and not is_within_limits(design.designed, design.limits)
    limits = [_limits(design)] if is_left else []
    return limits + [sentence(f.text) for f in design.findings if f.severity is not Severity.INFO]


def _percent(share: float) -> str:
    if share < LARGEST_SHOWN_ERROR:
        return f"{significant(100.0 * share, 2)} %"
    return f"more than {significant(100.0 * LARGEST_SHOWN_ERROR, 1)} %"


def _weakest_coefficient(manoeuvre: ManoeuvrePrecision, design: Design) -> str:
    if design.criterion != "worst" or not np.isfinite(manoeuvre.relative_error).any():
        return ""
    return f" ({design.coefficients[int(np.argmax(manoeuvre.relative_error))]})"


def _comparison(design: Design) -> str:
    best, criterion = best_baseline(design), design.criterion
    error = criterion_error(design.designed, criterion)
    start = f"The {_CRITERION_NAMES[criterion]} is {_percent(error)}{_weakest_coefficient(design.designed, design)}"
    if best is None:
        return f"{start}; there is no standard manoeuvre to compare it with."
    theirs = criterion_error(best, criterion)
    where = " within the limits" if _has_limits(design) else ""
    where = where if is_within_limits(best, design.limits) else ", which leaves the limits,"
    against = f"the best standard manoeuvre{where} has {_percent(theirs)}"
    return f"{start}, no better: {against}." if error >= theirs else f"{start}; {against}."


def _prior_draws(design: Design) -> str:
    """On how many of the drawn ships it is more precise than every standard manoeuvre."""
    errors = sampled_criterion_errors(design.designed, design.criterion)
    if not errors:
        return ""
    within = [rival for rival in design.baselines if is_within_limits(rival, design.limits)]
    compared = [sampled_criterion_errors(rival, design.criterion) for rival in within or design.baselines]
    wins = sum(
        all(not ours >= theirs[k] for theirs in compared) for k, ours in enumerate(errors) if not math.isnan(ours)
    )
    finite = [x for x in errors if not math.isnan(x)]
    ends = list(dict.fromkeys(_percent(end) for end in (min(finite), max(finite)))) if finite else []
    reach = f"from {' to '.join(ends)}" if len(ends) > 1 else next(iter(ends), "not known")
    text = f"On {counted(len(errors), 'ship')} drawn from the prior it is {reach}"
    if compared:
        which = "any standard manoeuvre within the limits" if _has_limits(design) else "any standard manoeuvre"
        text += f", smaller than with {which} on {wins} of {len(errors)}"
    lost = design.designed.diverged
    return text + (f"; {counted(lost, 'ship')} cannot be simulated." if lost else ".")


def _has_limits(design: Design) -> bool:
    return math.isfinite(design.limits.drift) or math.isfinite(design.limits.sea_room)


def _confirmation(design: Design) -> str:
    confirmation = design.confirmation
    if confirmation is None:
        return ""
    text = f"{confirmation.converged_runs} of {counted(confirmation.runs, 'simulated trial')} could be fitted"
    ratios = confirmation.error / confirmation.bound
    if not np.isfinite(ratios).any():
        return f"{text}."
    reach = " to ".join(fixed(float(end), 2) for end in (np.nanmin(ratios), np.nanmax(ratios)))
    most = "" if _is_confirmed(design) else f", most that of {design.coefficients[int(np.nanargmax(ratios))]}"
    return f"{text}; their errors are {reach} of those predicted{most}."


def _is_confirmed(design: Design) -> bool | None:
    """Whether no error of the simulated trials is beyond the one predicted; None where none was tried."""
    confirmation = design.confirmation
    if confirmation is None or not confirmation.converged_runs:
        return None
    spread = 1.0 / math.sqrt(2.0 * confirmation.converged_runs)  # of an rms over so many normal errors, over itself
    return bool(np.all(confirmation.error <= (1.0 + _BEYOND * spread) * confirmation.bound))


def _limits(design: Design) -> str:
    limits, manoeuvre = design.limits, design.designed
    reached: list[str] = []
    if not has_track(design):
        return ""
    if math.isfinite(limits.drift):
        reached.append(f"a drift angle of {_degrees(manoeuvre.drift)} ({_degrees(limits.drift)} allowed)")
    if math.isfinite(limits.sea_room):
        reached.append(f"{significant(manoeuvre.distance)} m from the start ({significant(limits.sea_room)} m allowed)")
    if not reached:
        return ""
    verb = "reaches" if is_within_limits(manoeuvre, limits) else "leaves the limits: it reaches"
    straying, draws = count_outside_limits(manoeuvre, limits), len(manoeuvre.sampled_relative_error)
    drawn = f"; {straying} of {draws} drawn ships leave the limits" if straying else ""
    return f"The ship as assumed {verb} at most {enumeration(reached)}{drawn}."


def _degrees(angle: float) -> str:
    return f"{fixed(math.degrees(angle), 1)}°"


def facts(design: Design) -> list[tuple[str, str]]:
    """Return ship, model, duration, actuators and limits as pairs of name and text."""
    pairs = [
        ("Ship", design.ship),
        ("Model", design.model.name),
        ("Duration", duration(design.duration)),
        ("Steered with", "; ".join(actuator_text(a) for a in design.actuators)),
    ]
    allowed = [f"drift angle {_degrees(design.limits.drift)}"] if math.isfinite(design.limits.drift) else []
    allowed += [f"{exact(design.limits.sea_room)} m from the start"] if math.isfinite(design.limits.sea_room) else []
    return [*pairs, ("Limits", ", ".join(allowed) or "none")]


def actuator_text(a: Actuator) -> str:
    """Return an actuator with its limits: ``delta −35 to 35 deg, 10 deg/s, orders 6 s apart at least``."""
    factor, unit = channel_display_unit(a.name)
    rate = f"{exact(a.rate * factor)} {unit}/s" if math.isfinite(a.rate) else "may jump"
    reach = f"{exact(a.lower * factor)} to {exact(a.upper * factor)} {'' if unit == '1' else unit}".rstrip()
    return f"{a.name} {reach}, {rate}, orders {exact(a.hold)} s apart at least"


def settings(design: Design) -> list[tuple[str, str]]:
    """Return criterion, sensors and provenance as pairs of name and text."""
    sensors = [f"{name} {_noise_text(name, sd)}" for name, sd in design.sensors.items()]
    return [
        ("Criterion", _CRITERION_NAMES[design.criterion]),
        ("Sensors", f"{', '.join(sensors)} (standard deviations) at {exact(design.rate)} Hz"),
        ("Ships drawn", str(len(design.designed.sampled_relative_error))),
        ("Manoeuvres tried", str(design.solution.evaluations)),
        ("Seed", str(design.seed)),
        ("Elapsed", duration(design.elapsed_s)),
        ("Versions", ", ".join(f"{name} {version}" for name, version in design.versions.items())),
    ]


def _noise_text(name: str, sd: float) -> str:
    si_unit = NOTATION[name].unit if name in NOTATION else "1"
    return f"{exact(sd * display_unit(si_unit)[0], 3)} {unit_text(si_unit)}".rstrip()


# The page of a designed manoeuvre: its precision compared with standard ones, its orders, its track.

# columns of orders side by side, rows from which there is a second one, baselines in the table
MAX_COLUMNS, MIN_COLUMN_ROWS, MAX_BASELINES = 4, 12, 3
_BOUND_NOTE = (
    "Standard errors over the magnitude of the coefficients, as the sensors' noise allows at best (Cramér-Rao bound); "
    "mean: root mean square over the coefficients."
)
_ERRORS_CAPTION = (
    "Relative standard errors with the ship as assumed. Filled: the designed manoeuvre. Open: the best standard one."
)
_SHIPS_CAPTION = (
    "The design's criterion for each manoeuvre. Open: ships drawn from the prior. Tick: the ship as assumed."
)


def html(design: Design) -> str:
    """Return the page as text; sections without content are left out."""
    return chapters_page(
        "Designed manoeuvre", f"A manoeuvre for {design.ship}", _first_screen(design), sections(design),
        title=f"{design.ship}: a designed manoeuvre", question=design.question,
    )  # fmt: skip


def sections(design: Design) -> list[Section]:
    """Return the chapters: orders, standard manoeuvres, precision, drawn ships, simulated trials, findings, method."""
    baselines = best_of_each_kind(ranked_baselines(design))
    method = fact_table({**dict(facts(design)), **dict(settings(design))})
    every = (
        _orders(design),
        _manoeuvres(design, baselines),
        _coefficients(design, baselines[:MAX_BASELINES]),
        _drawn_ships(design, baselines),
        _confirmation_section(design),
        finding_section(design.findings),
        Section("Method and provenance", "method", table=method, level=Level.PAGE),
    )
    return [chapter for chapter in every if chapter]


def best_of_each_kind(manoeuvres: Sequence[ManoeuvrePrecision]) -> list[ManoeuvrePrecision]:
    """Return the first of each kind: of random steps and of consecutive zigzags one would run one."""
    kinds = {manoeuvre_name(m.name).partition(",")[0]: m for m in reversed(manoeuvres)}
    return [m for m in manoeuvres if m in kinds.values()]


def _orders(design: Design) -> Section:
    """The helmsman's card: what to set when, with what must be known beside it."""
    meanings = [f"{a.name}: {order_meaning(a.name)}." for a in design.actuators]
    channels = Section(
        "All channels", pictures=(Picture(lambda: _all_channels(design.designed.executed), "The ship as assumed."),),
        is_folded=True, level=Level.PAGE,
    )  # fmt: skip
    files = (
        "The same stands in orders.csv; plan.csv has the inputs at every sample, for seatrial simulate model.toml "
        f"--inputs plan.csv{_speed_option(design)} --out run.csv."
    )
    return Section(
        f"Orders: the helmsman’s card, {duration(design.duration)}",
        "orders",
        sentences=(*order_warnings(design), *meanings, "Set at each time what its line says, and hold it."),
        table=order_table(design),
        note=files,
        parts=(channels,),
    )


def _manoeuvres(design: Design, baselines: Sequence[ManoeuvrePrecision]) -> Section:
    """The designed manoeuvre beside those one would run."""
    is_tracked = has_track(design)
    is_drifting = is_tracked and has_drift(design)
    table = table_of(
        (design.designed, *baselines),
        words("Manoeuvre", lambda w: manoeuvre_name(w.name)),
        number("worst", lambda w: percent_text(w.worst), "%"),
        number("mean", lambda w: percent_text(w.mean), "%"),
        number("worst, drawn ships", lambda w: percent_text(w.worst_sampled_error), "%"),
        number("drift angle", lambda w: fixed(math.degrees(w.drift), 1) if is_drifting else "", "deg"),
        number("distance", lambda w: significant(w.distance, 3) if is_tracked else "", "m"),
        words("", lambda w: Cell(f"{counted(w.diverged, 'ship')} diverged" if w.diverged else "", tone="bad")),
        words("", lambda w: "" if is_within_limits(w, design.limits) else Cell(_leaving(w, design), tone="bad")),
        is_marked=lambda w: w is design.designed,
    )
    reach = "Drift angle and distance" if is_drifting else "Distance"
    largest = f" {reach} from the start: largest for the ship as assumed." if is_tracked else ""
    return Section("Compared with standard manoeuvres", "manoeuvres", table=table, note=f"{_BOUND_NOTE}{largest}")


def _leaving(manoeuvre: ManoeuvrePrecision, design: Design) -> str:
    """Which ships leave the limits with a manoeuvre."""
    straying = count_outside_limits(manoeuvre, design.limits)
    return (
        f"{straying} of {counted(len(manoeuvre.sampled_drift), 'ship')} leave the limits"
        if straying
        else "leaves the limits"
    )


def _coefficients(design: Design, baselines: Sequence[ManoeuvrePrecision]) -> Section:
    """How precise each coefficient becomes."""
    parameters = design.model.parameters
    table = table_of(
        range(len(design.coefficients)),
        *_coefficient_columns(design),
        number("assumed value", lambda i: significant(parameters[design.coefficients[i]].value, 4)),
        number("may differ by", lambda i: percent_text(float(design.relative_spread[i])), "± %"),
        number("designed", lambda i: percent_text(float(design.designed.relative_error[i])), "%"),
        *(number(manoeuvre_name(w.name), _errors_of(w), "%") for w in baselines),
    )
    pictures = (Picture(lambda: _errors_figure(design), _ERRORS_CAPTION),)
    return Section("Precision of each coefficient", "coefficients", table=table, pictures=pictures, level=Level.PAGE)


def _errors_of(manoeuvre: ManoeuvrePrecision) -> Callable[[int], str]:
    """Error of a coefficient with a manoeuvre, by its place."""
    return lambda i: percent_text(float(manoeuvre.relative_error[i]))


def _coefficient_columns(design: Design) -> tuple[Column[int], Column[int]]:
    """Symbol and name of a coefficient by its place."""
    names, parameters = design.coefficients, design.model.parameters
    return (
        formula("", lambda i: Markup(inline(parameters[names[i]].latex or latex_symbol(names[i])))),
        name("Coefficient", lambda i: names[i]),
    )


def _drawn_ships(design: Design, baselines: Sequence[ManoeuvrePrecision]) -> Section:
    """What the orders are worth on ships that differ from the one assumed."""
    if not len(design.designed.sampled_relative_error):
        return Section("")
    return Section(
        "Ships that differ from the assumed one",
        "ships",
        sentences=(
            "The coefficients are not known before the trial. Each dot is a ship drawn from the prior, steered with "
            "the same orders.",
        ),
        pictures=(Picture(lambda: _drawn_ships_figure(design, baselines), _SHIPS_CAPTION),),
        level=Level.PAGE,
    )


def _confirmation_section(design: Design) -> Section:
    """Errors of fits of simulated trials beside those predicted."""
    done = design.confirmation
    if done is None:
        return Section("")
    table = table_of(
        range(len(design.coefficients)),
        *_coefficient_columns(design),
        number("error of the fits", lambda i: percent_text(float(done.error[i])), "%"),
        number("predicted", lambda i: percent_text(float(done.bound[i])), "%"),
    )
    return Section(
        "Simulated trials",
        "confirmation",
        sentences=(
            "Trials were simulated with the designed manoeuvre, sensor noise added, and the coefficients fitted: "
            f"{done.converged_runs} of {done.runs} fits succeeded.",
        ),
        table=table,
        note="Predicted: root mean square over the ships, over the magnitude of the coefficient. Error of the fits: "
        "that times the root mean square of each fit’s error over the one predicted for its ship.",
        level=Level.PAGE,
    )


def _first_screen(design: Design) -> FirstScreen:
    """How precise the manoeuvre is; its track within the sea room and its orders over time."""
    figure = run_figure(order_view(design), is_wide=True, track=track_chart(design) if has_track(design) else None)
    drift = (
        " Drift is positive when the bow points to starboard of the course."
        if has_track(design) and has_drift(design)
        else ""
    )
    ships = "; ships at equal times, to scale" if has_track(design) else ""
    caption = f"The ship as assumed{ships}.{drift}"
    return FirstScreen(verdict(design), key_facts(design), figure, caption)


def _all_channels(executed: Record) -> Markup:
    """Every channel that moves, over time."""
    names = [channel for channel in reading_order(list(executed.channels)) if not is_constant(executed, channel)]
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


def order_table(design: Design) -> TextTable:
    """Return the helmsman's table, its parts side by side: minutes and seconds, then the orders."""
    rows = []
    for order in design.orders:
        cells = [cell.replace("-", "−") or DASH for cell in order_cells(order, design.actuators)[1:]]
        rows.append([minutes_seconds(order.time), *cells])
    count = min(MAX_COLUMNS, max(1, math.ceil(len(rows) / MIN_COLUMN_ROWS)))
    each = math.ceil(len(rows) / count)
    units = [(a.name, channel_display_unit(a.name)[1]) for a in design.actuators]
    heads = [Heading("time", "min:s", Kind.NUMBER), *(Heading(n, "" if u == "1" else u, Kind.NUMBER) for n, u in units)]
    empty = [""] * len(heads)
    parts = [rows[k : k + each] for k in range(0, len(rows), each or 1)]
    lines = ([cell for part in parts for cell in (part[i] if i < len(part) else empty)] for i in range(each))
    return TextTable(tuple(heads) * count, tuple(Row(tuple(map(Cell, line))) for line in lines))


def _speed_option(design: Design) -> str:
    """The option of `simulate` that starts a replay as the design did; empty for a model without surge."""
    executed = design.designed.executed
    return f" --speed {float(executed['u'][0]):.7g}" if design.model.has_speed and "u" in executed else ""


def _errors_figure(design: Design) -> str:
    """Dots for each coefficient: the design and the best standard manoeuvre."""
    best = best_baseline(design)
    series = []
    if best:
        series.append(ErrorSeries(manoeuvre_name(best.name), [[100.0 * float(x)] for x in best.relative_error], OPEN))
    series.append(ErrorSeries("designed", [[100.0 * float(x)] for x in design.designed.relative_error], FILLED))
    return svg(error_chart(design.coefficients, series, "relative standard error, per cent of the coefficient"))


def _drawn_ships_figure(design: Design, baselines: Sequence[ManoeuvrePrecision]) -> str:
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
