"""Sentences at the head of a fit's sections: what the ship is, what limits coefficients, residuals and search."""

from seatrial.core.results import Fit, Search
from seatrial.core.text.numbers import duration, exact, percent
from seatrial.core.text.words import counted, enumeration

# offset of a rudder or nozzle, and the coefficients of models that have the same effect: hull, side forces of a screw
_STEERING_ZERO, _ASYMMETRIES = "delta zero", ("Y_0", "N_0", "Y_T", "N_T")


def facts(fit: Fit) -> list[str]:
    """Return ship, model and records in a few words each."""
    ship = fit.ship
    trained = [p for p in fit.predictions if p.role == "training"]
    ratio = f"1:{exact(ship.scale)}"
    scale = [f"model scale {ratio}"] if ship.scale != 1.0 and ratio not in ship.name else []
    length = [f"L = {exact(ship.length)} m"] if "L" in ship.particulars else []
    free = sum(not c.fixed for c in fit.coefficients)
    seconds = sum(p.measured.duration for p in trained)
    return [
        *length, *scale, f"model {fit.model.name} with {counted(free, 'free coefficient')}",
        f"fitted to {counted(len(trained), 'run')}, {duration(seconds)} of records", fit.method.criterion,
    ]  # fmt: skip


def residual_sentence(fit: Fit) -> str:
    """Return in which channels the residuals are not white; empty where that is not known."""
    if not fit.channel_noise:
        return ""
    coloured = [n.channel for n in fit.channel_noise if not n.is_white]
    if not coloured:
        return "The residuals are white in all channels (Ljung-Box with 20 and 100 lags)."
    return (
        f"The residuals are not white in {len(coloured)} of {len(fit.channel_noise)} channels "
        f"({enumeration(coloured)}): model error "
        "or disturbances remain."
    )


def convergence_sentence(fit: Fit) -> str:
    """Return that a search did not converge, or how a search by a population ended; empty for one that did."""
    if fit.search is not None:
        return _search_end(fit.search)
    return "" if fit.solution.status.is_success else f"The search did not converge: {search_status(fit)}."


def search_status(fit: Fit) -> str:
    """Return how the search ended, without what only the caller of an optimiser can do about it."""
    return fit.solution.status.value.partition(";")[0]


def steering_zero_note(fit: Fit) -> str:
    """Return what else a rudder or nozzle amidships that turns the ship may come from; empty where all that is free."""
    present = [c for c in fit.coefficients if c.name in _ASYMMETRIES]
    held = [c.name for c in present if c.fixed and c.estimate == 0.0]
    if not any(offset.name == _STEERING_ZERO for offset in fit.offsets) or (present and not held):
        return ""
    where = f"held at zero here ({enumeration(held)})" if held else "which this model does not have"
    return (
        f"{_STEERING_ZERO} is known only as the angle at which the ship goes straight: a side force of the propeller "
        f"or an asymmetric hull, {where}, would look the same."
    )


def _search_end(search: Search) -> str:
    """What a search by a population can say of its end: its restarts and their scatter, no test of convergence."""
    text = f"The search has no test of convergence: it spends all its iterations, here {search.effort}."
    if search.track is not None:
        return text  # a stream is followed once
    used = search.restarts[search.used].values
    shares = {name: sd / abs(used[name]) for name, sd in search.scatter.items() if used[name] != 0.0}
    if not shares:
        return f"{text} More restarts would show how far its values scatter."
    widest = max(shares, key=lambda name: shares[name])
    return f"{text} Its values scatter over the restarts by up to {percent(shares[widest])} % ({widest})."
