"""The helmsman's table in the units people read: as columns of text, and as the file that is taken on board."""

from seatrial.results import Actuator, Design, Order
from seatrial.values import NOTATION, display

DIGITS = 6


def shown_unit(name: str) -> tuple[float, str]:
    """Factor from SI and unit of an input as people read it."""
    return display(NOTATION[name].unit if name in NOTATION else "1")


def heads(actuators: tuple[Actuator, ...]) -> list[str]:
    """``time [s]``, then each input with its unit."""
    return ["time [s]", *(f"{a.name} [{shown_unit(a.name)[1]}]" for a in actuators)]


def row(order: Order, actuators: tuple[Actuator, ...]) -> list[str]:
    """Time and orders as text; an input that the order leaves alone stays empty."""
    return [
        _text(order.time),
        *(_text(order.values[a.name] * shown_unit(a.name)[0]) if a.name in order.values else "" for a in actuators),
    ]


def orders_text(design: Design) -> str:
    """The whole table as CSV."""
    rows = [heads(design.actuators), *(row(order, design.actuators) for order in design.orders)]
    return "\n".join(",".join(cells) for cells in rows) + "\n"


def _text(value: float) -> str:
    return f"{round(value, DIGITS) + 0.0:.{DIGITS}g}"
