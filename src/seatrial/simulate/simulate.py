"""One verb for both: a record's inputs are replayed, a programme is steered."""

from collections.abc import Mapping

from seatrial.equations import Model
from seatrial.manoeuvres import Programme
from seatrial.simulate.replay import replay
from seatrial.simulate.steer import SOLAS_SLEW_RATE, manoeuvre
from seatrial.values import Record


def simulate(
    model: Model,
    what: Record | Programme,
    *,
    initial: Mapping[str, float] | None = None,
    inputs: Mapping[str, float] | None = None,
    speed: float | None = None,
    duration: float | None = None,
    dt: float = 0.1,
    slew_rate: float = SOLAS_SLEW_RATE,
) -> Record:
    """Replay a record (`initial` applies) or steer a programme (the other arguments apply).

    See `replay` and `manoeuvre` for what each means, its unit and the errors raised.
    """
    if isinstance(what, Record):
        return replay(model, what, initial)
    return manoeuvre(model, what, dt=dt, duration=duration, speed=speed, inputs=inputs, slew_rate=slew_rate)
