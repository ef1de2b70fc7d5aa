"""Track keeping on the page of a tuning: a table of what disturbs, the corner in a sentence and as a figure."""

import math

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.panels import NamedCurve, curves_chart
from seatrial.core.figures.svg_text import svg
from seatrial.core.results.tuning import DisturbanceSimulation, TrackKeeping, Tuning
from seatrial.core.text.numbers import exact, significant
from seatrial.data.folder.gains_file import channel_display_unit

_HALF = 1.96  # standard errors to either side of a mean: 95 % of a Gaussian
_BEFORE, _AFTER = 2.0, 5.0  # lookahead distances before and behind the corner that the figure shows; chosen
CAPTION = "The corner from above, north up. The heading order changes no faster than half the actuator keeps up."


def corner_sentence(track: TrackKeeping) -> str:
    """Return how far the craft goes beyond a corner, as identified and at worst of those drawn."""
    c = track.corner
    text = (
        f"At a corner of {exact(math.degrees(c.turn), 3)}°, taken {exact(c.acceptance, 3)} m before it, in "
        f"{exact(c.current, 2)} m/s of current towards the outside, the craft goes "
        f"{significant(c.overshoot, 3)} m beyond the new leg"
    )
    text += " and settles on it" if c.is_kept else " and does not settle on it"
    if c.draws:
        most = f"{significant(c.worst_overshoot, 3)} m at most"
        worst = "the simulation of one diverges" if math.isinf(c.worst_overshoot) else most
        known = "" if math.isnan(c.worst_overshoot) else f" ({worst})"
        text += f"; {c.stable_draws} of {c.draws} ships that the fit allows keep a track{known}"
    return f"{text}."


def track_rows(tuning: Tuning, track: TrackKeeping) -> list[tuple[str, ...]]:
    """Return of each disturbance rms: distance predicted, simulated, limited; actuator and rate but for the second."""
    factor = channel_display_unit(tuning.actuator)[0]

    def row(s: DisturbanceSimulation) -> tuple[str, ...]:
        half = significant(_HALF * s.standard_error["output"], 1)
        moved = [significant(factor * rms[key], 3)
                 for key in ("actuator", "actuator_rate") for rms in (s.predicted, s.limited)]  # fmt: skip
        free = f"{significant(s.unlimited['output'], 3)} ± {half}"
        return s.disturbance, significant(s.predicted["output"], 3), free, significant(s.limited["output"], 3), *moved

    return [row(s) for s in track.disturbances]


def corner_figure(track: TrackKeeping) -> Markup:
    """Return the track and the craft's path about the corner as SVG."""
    before, after = _BEFORE * track.lookahead, _AFTER * track.lookahead
    turn, north, east = track.corner.turn, track.corner.record["x0"], track.corner.record["y0"]
    near = (north > -before) & (np.hypot(north, east) < after)
    planned_north = np.array([-before, 0.0, after * math.cos(turn)])
    planned_east = np.array([0.0, 0.0, after * math.sin(turn)])
    curves = (NamedCurve("track", planned_east, planned_north), NamedCurve("craft", east[near], north[near]))
    return Markup(svg(curves_chart("corner", curves, "y₀, east [m]", "x₀, north [m]", is_map=True)))
