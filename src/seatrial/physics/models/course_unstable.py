"""The twin of a steering model that does not hold its course: where a search for such a ship begins."""

from seatrial.core.equations import Model

_SLOW_TIME_CONSTANTS = ("T", "T_1")


def course_unstable(model: Model) -> Model:
    """Return a steering model with the gain and the slow time constant of the other sign, which turns by itself.

    K delta / T, by which the rudder acts, stays as it is. Another model, or one whose signs are bounded or fixed, is
    returned itself.
    """
    parameters = model.parameters
    names = [name for name in ("K", *_SLOW_TIME_CONSTANTS) if name in parameters.free_names]
    is_bounded = any(not parameters[name].lower <= -parameters[name].value <= parameters[name].upper for name in names)
    if len(names) != 2 or is_bounded:  # the gain and one time constant
        return model
    return model.with_values({name: -parameters[name].value for name in names})
