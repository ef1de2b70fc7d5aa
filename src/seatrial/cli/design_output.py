"""What `design` prints: the manoeuvre compared with standard ones, findings, the first orders."""

from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_warnings
from seatrial.cli.screen import print_heading, print_lines, print_table
from seatrial.cli.summary_output import print_summary

if TYPE_CHECKING:
    from seatrial.core.results import Design
    from seatrial.core.results.design import ManoeuvrePrecision

# orders that are printed; chosen: the file has them all
MAX_ORDERS_PRINTED = 8


def print_design(design: "Design") -> None:
    """Print the manoeuvre's precision compared with the standard ones, findings, and its first orders."""
    from seatrial.core.results.design import has_drift, has_track, ranked_baselines
    from seatrial.reporting.design_text import key_facts, verdict

    print_summary(_heading(design), verdict(design), key_facts(design))
    print_heading("Designed and standard manoeuvres")
    track = ["drift deg"] * has_drift(design) + ["distance m"] if has_track(design) else []
    rows = [["rel. std. error, %", "worst", "mean", "ships drawn", *track, ""]]
    rows += [_manoeuvre_cells(manoeuvre, design) for manoeuvre in (design.designed, *ranked_baselines(design))]
    print_table(rows, flush_left=(0, len(rows[0]) - 1), indent="  ")
    print_warnings(design.findings)
    _print_orders(design)


def _heading(design: "Design") -> str:
    from seatrial.core.text.numbers import duration

    return f"Designed manoeuvre, {design.solution.evaluations} tried, {duration(design.elapsed_s)}"


def _manoeuvre_cells(manoeuvre: "ManoeuvrePrecision", design: "Design") -> list[str]:
    import math

    from seatrial.core.results.design import has_drift, has_track, is_within_limits
    from seatrial.core.text.numbers import exact
    from seatrial.core.text.words import counted

    errors = [exact(100.0 * x, 3) for x in (manoeuvre.worst, manoeuvre.mean, manoeuvre.worst_sampled_error)]
    drift = [exact(math.degrees(manoeuvre.drift), 3)] if has_drift(design) else []
    track = [*drift, exact(manoeuvre.distance, 4)] if has_track(design) else []
    notes = [f"{counted(manoeuvre.diverged, 'ship')} diverged"] if manoeuvre.diverged else []
    notes += [] if is_within_limits(manoeuvre, design.limits) else ["leaves the limits"]
    return [manoeuvre.name, *errors, *track, ", ".join(notes)]


def _print_orders(design: "Design") -> None:
    from seatrial.data.folder.gains_file import order_cells, order_headings
    from seatrial.reporting.design_text import order_meaning

    print_heading("Orders")
    print_lines((f"{a.name}: {order_meaning(a.name)}" for a in design.actuators), "  ")
    orders = [order_cells(order, design.actuators) for order in design.orders[:MAX_ORDERS_PRINTED]]
    print_table([order_headings(design.actuators), *orders], flush_left=(), indent="  ")
    if len(design.orders) > MAX_ORDERS_PRINTED:
        print_lines([f"... and {len(design.orders) - MAX_ORDERS_PRINTED} more orders in orders.csv"], "  ")
