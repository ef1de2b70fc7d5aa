"""The helmsman's table in the units people read: as columns of text, and as the file for the trial."""

import math

from seatrial.core.results import Actuator, Design, TimedOrder
from seatrial.core.values import NOTATION, display_unit

TIME_DECIMALS = 3
"""Decimals of a time in seconds: milliseconds, below any helmsman's delay."""
RANGE_DECIMALS = 2
"""Decimals of an order relative to its range: the last digit is less than a hundredth of it."""


def channel_display_unit(name: str) -> tuple[float, str]:
    """Return the factor from SI and the unit of an input as people read it."""
    return display_unit(NOTATION[name].unit if name in NOTATION else "1")


def order_headings(actuators: tuple[Actuator, ...]) -> list[str]:
    """Return the headings: ``time [s]``, then each input with its unit."""
    return ["time [s]", *(f"{a.name} [{channel_display_unit(a.name)[1]}]" for a in actuators)]


def order_cells(order: TimedOrder, actuators: tuple[Actuator, ...]) -> list[str]:
    """Return time and orders as text; an input that the order does not change stays empty."""
    return [_decimal_text(order.time, TIME_DECIMALS), *(_order_text(order, a) for a in actuators)]


def orders_csv(design: Design) -> str:
    """Return the table as CSV."""
    rows = [order_headings(design.actuators), *(order_cells(order, design.actuators) for order in design.orders)]
    return "\n".join(",".join(cells) for cells in rows) + "\n"


def _order_text(order: TimedOrder, actuator: Actuator) -> str:
    if actuator.name not in order.values:
        return ""
    factor = channel_display_unit(actuator.name)[0]
    reach = (actuator.upper - actuator.lower) * factor
    return _decimal_text(order.values[actuator.name] * factor, max(0, RANGE_DECIMALS - math.floor(math.log10(reach))))


def _decimal_text(value: float, decimals: int) -> str:
    text = f"{round(value, decimals) + 0.0:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text
