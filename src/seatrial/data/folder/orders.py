"""The helmsman's table in the units people read: as columns of text, and as the file that is taken on board."""

import math

from seatrial.core.results import Actuator, Design, TimedOrder
from seatrial.core.values import NOTATION, display_unit

_TIME_DECIMALS = 3
# an order is said to so many decimals that its last digit is less than a hundredth of the range
_RANGE_DECIMALS = 2


def channel_display_unit(name: str) -> tuple[float, str]:
    """Factor from SI and unit of an input as people read it."""
    return display_unit(NOTATION[name].unit if name in NOTATION else "1")


def order_headings(actuators: tuple[Actuator, ...]) -> list[str]:
    """``time [s]``, then each input with its unit."""
    return ["time [s]", *(f"{a.name} [{channel_display_unit(a.name)[1]}]" for a in actuators)]


def order_cells(order: TimedOrder, actuators: tuple[Actuator, ...]) -> list[str]:
    """Time and orders as text; an input that the order leaves alone stays empty."""
    return [_decimal_text(order.time, _TIME_DECIMALS), *(_order_text(order, a) for a in actuators)]


def orders_csv(design: Design) -> str:
    """The whole table as CSV."""
    rows = [order_headings(design.actuators), *(order_cells(order, design.actuators) for order in design.orders)]
    return "\n".join(",".join(cells) for cells in rows) + "\n"


def _order_text(order: TimedOrder, actuator: Actuator) -> str:
    if actuator.name not in order.values:
        return ""
    factor = channel_display_unit(actuator.name)[0]
    reach = (actuator.upper - actuator.lower) * factor
    return _decimal_text(order.values[actuator.name] * factor, max(0, _RANGE_DECIMALS - math.floor(math.log10(reach))))


def _decimal_text(value: float, decimals: int) -> str:
    text = f"{round(value, decimals) + 0.0:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text
