"""The helmsman's table in the units people read: as columns of text, and as the file that is taken on board."""

import math

from seatrial.core.results import Actuator, Design, Order
from seatrial.core.values import NOTATION, display

_TIME_DECIMALS = 3
# an order is said to so many decimals that its last digit is less than a hundredth of the range
_FINENESS = 2


def shown_unit(name: str) -> tuple[float, str]:
    """Factor from SI and unit of an input as people read it."""
    return display(NOTATION[name].unit if name in NOTATION else "1")


def heads(actuators: tuple[Actuator, ...]) -> list[str]:
    """``time [s]``, then each input with its unit."""
    return ["time [s]", *(f"{a.name} [{shown_unit(a.name)[1]}]" for a in actuators)]


def row(order: Order, actuators: tuple[Actuator, ...]) -> list[str]:
    """Time and orders as text; an input that the order leaves alone stays empty."""
    return [_text(order.time, _TIME_DECIMALS), *(_order(order, a) for a in actuators)]


def orders_text(design: Design) -> str:
    """The whole table as CSV."""
    rows = [heads(design.actuators), *(row(order, design.actuators) for order in design.orders)]
    return "\n".join(",".join(cells) for cells in rows) + "\n"


def _order(order: Order, actuator: Actuator) -> str:
    if actuator.name not in order.values:
        return ""
    factor = shown_unit(actuator.name)[0]
    reach = (actuator.upper - actuator.lower) * factor
    return _text(order.values[actuator.name] * factor, max(0, _FINENESS - math.floor(math.log10(reach))))


def _text(value: float, decimals: int) -> str:
    text = f"{round(value, decimals) + 0.0:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text
